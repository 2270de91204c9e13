//! The project as it is edited: its text, what it means, its revisions, and undo.
//!
//! A session knows no file and no window: the same commands on the same text give the same project.

use std::path::Path;
use std::sync::Arc;

use counterpoise_project::file::EditError;
use counterpoise_project::{Assumption, Attachments, Diagnostic, Document, Project, SettingValue};

use super::text_change::TextChange;
use crate::command::Command;

/// Number of steps that can be undone. A text is about 10 kB, so that the steps take a few megabytes at most.
const UNDO_LIMIT: usize = 500;

/// A project with its history of edits.
#[derive(Debug, Clone)]
pub struct Session {
    document: Document,
    attachments: Attachments,
    errors: Vec<Diagnostic>,
    last_valid: Option<Arc<Project>>,
    assumptions: Vec<Assumption>,
    revision: u64,
    undo: Vec<String>,
    redo: Vec<String>,
    gesture: Option<u64>,
    saved: String,
}

/// Availability of undo and redo.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct UndoAvailability {
    /// `true` if there is a step to undo.
    pub undo: bool,
    /// `true` if there is a step to redo.
    pub redo: bool,
}

impl Session {
    /// Starts a session on the text of a project file.
    pub fn new(text: &str, name: &str, attachments: Attachments) -> Self {
        let mut session = Self {
            document: Document::parse(text, name).with_parts(&attachments),
            attachments,
            errors: Vec::new(),
            last_valid: None,
            assumptions: Vec::new(),
            revision: 0,
            undo: Vec::new(),
            redo: Vec::new(),
            gesture: None,
            saved: text.to_owned(),
        };
        session.resolve();
        session
    }

    /// Returns the text as it stands.
    pub fn text(&self) -> &str {
        self.document.text()
    }

    /// Returns the text with its structure and its included parts.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// Returns the files that the project names.
    pub fn attachments(&self) -> &Attachments {
        &self.attachments
    }

    /// Returns what the text means; if it has errors, what it meant before them.
    pub fn project(&self) -> Option<&Arc<Project>> {
        self.last_valid.as_ref()
    }

    /// Returns the values that the project does not state and that defaults stand in for.
    pub fn assumptions(&self) -> &[Assumption] {
        &self.assumptions
    }

    /// Returns the errors of the text as it stands.
    pub fn errors(&self) -> &[Diagnostic] {
        &self.errors
    }

    /// Returns a number that grows with every change.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Returns whether the text differs from what was read or saved last.
    pub fn is_changed(&self) -> bool {
        self.saved != self.document.text()
    }

    /// Returns which way the history can be walked.
    pub fn undo_availability(&self) -> UndoAvailability {
        UndoAvailability { undo: !self.undo.is_empty(), redo: !self.redo.is_empty() }
    }

    /// Replaces the content of the files that the project names.
    pub fn set_attachments(&mut self, attachments: Attachments) {
        self.document = self.document.with_parts(&attachments);
        self.attachments = attachments;
        self.revision += 1;
        self.resolve();
    }

    /// Gives the project's file another name.
    pub fn rename(&mut self, name: &str) {
        self.document = Document::parse(self.document.text(), name).with_parts(&self.attachments);
    }

    /// Records that a text is on disk: the one as it stands, or one that was edited further while it was written.
    pub fn mark_saved(&mut self, text: &str) {
        self.saved = text.to_owned();
    }

    /// Returns the text that was read or saved last.
    pub fn saved_text(&self) -> &str {
        &self.saved
    }

    /// Carries out a command that edits; any other command changes nothing.
    ///
    /// # Errors
    /// Returns an error if a path leads nowhere or a value cannot be written; the project is then as it was.
    pub fn apply(&mut self, command: &Command) -> Result<(), EditError> {
        let gesture = match command {
            Command::Set { gesture, .. } | Command::SpliceText { gesture, .. } => *gesture,
            _ => None,
        };
        let changed = match command {
            Command::Set { path, value, .. } => self.document.set(path, &SettingValue::Number(*value))?,
            Command::SetWhole { path, value } => self.document.set(path, &SettingValue::Whole(*value))?,
            Command::SetText { path, value } => {
                self.document.set(path, &SettingValue::Text(value.clone()))?
            }
            Command::Remove { path } => self.document.remove(path)?,
            Command::Replace { text } => self.document.with_text(text),
            Command::SpliceText { from, to, inserted, .. } => {
                let change = TextChange { replaced: *from..*to, inserted: inserted.clone() };
                // a change of another text, as in a damaged journal, changes nothing
                let Some(text) = change.apply(self.document.text()) else { return Ok(()) };
                self.document.with_text(&text)
            }
            Command::Undo => {
                self.undo();
                return Ok(());
            }
            Command::Redo => {
                self.redo();
                return Ok(());
            }
            _ => return Ok(()),
        };
        if changed.text() != self.document.text() {
            self.push_undo(gesture);
            self.replace_document(changed);
        }
        Ok(())
    }

    /// Ends a gesture: the next edit is a step of its own.
    pub fn end_gesture(&mut self) {
        self.gesture = None;
    }

    fn push_undo(&mut self, gesture: Option<u64>) {
        self.redo.clear();
        if gesture.is_none() || gesture != self.gesture {
            self.undo.push(self.document.text().to_owned());
        }
        if self.undo.len() > UNDO_LIMIT {
            self.undo.remove(0);
        }
        self.gesture = gesture;
    }

    fn undo(&mut self) {
        if let Some(text) = self.undo.pop() {
            self.redo.push(self.document.text().to_owned());
            self.gesture = None;
            self.replace_document(self.document.with_text(&text));
        }
    }

    fn redo(&mut self) {
        if let Some(text) = self.redo.pop() {
            self.undo.push(self.document.text().to_owned());
            self.gesture = None;
            self.replace_document(self.document.with_text(&text));
        }
    }

    fn replace_document(&mut self, document: Document) {
        self.document = document;
        self.revision += 1;
        self.resolve();
    }

    fn resolve(&mut self) {
        match Project::resolve(&self.document, &self.attachments) {
            Ok(parsed) => {
                self.last_valid = Some(Arc::new(parsed.project));
                self.assumptions = parsed.assumptions;
                self.errors.clear();
            }
            Err(errors) => self.errors = errors,
        }
    }
}

/// Returns the name of a path's file.
pub fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    const TEXT: &str = include_str!("../../../examples/reference-rig/project.toml");
    const GAIN: &str = "synth.feedback.error.gain";

    fn session() -> Session {
        Session::new(TEXT, "rig.toml", Attachments::none())
    }

    fn set(value: f64, gesture: Option<u64>) -> Command {
        Command::Set { path: GAIN.to_owned(), value, gesture }
    }

    #[test]
    fn a_drag_is_one_step_of_undo() {
        let mut s = session();
        (0..20).for_each(|k| s.apply(&set(26.0 + f64::from(k), Some(1))).unwrap());
        s.apply(&set(50.0, Some(2))).unwrap();
        s.apply(&Command::Undo).unwrap();
        assert!(s.text().contains("gain = 45.0"));
        s.apply(&Command::Undo).unwrap();
        assert_eq!(s.text(), TEXT);
        assert!(!s.is_changed());
        s.apply(&Command::Redo).unwrap();
        s.apply(&Command::Redo).unwrap();
        assert!(s.text().contains("gain = 50.0"));
    }

    #[test]
    fn what_is_typed_in_one_go_is_one_step_of_undo() {
        let mut s = session();
        let end = s.text().len();
        let typed = |k: usize, letter: &str| Command::SpliceText {
            from: end + k,
            to: end + k,
            inserted: letter.to_owned(),
            gesture: Some(1),
        };
        "# by hand".chars().enumerate().for_each(|(k, c)| s.apply(&typed(k, &c.to_string())).unwrap());
        assert!(s.text().ends_with("# by hand"));
        s.apply(&typed(1_000_000, "x")).unwrap();
        s.apply(&Command::Undo).unwrap();
        assert_eq!(s.text(), TEXT);
    }

    #[test]
    fn a_value_that_is_not_allowed_keeps_the_last_valid_project() {
        let mut s = session();
        let before = s.project().unwrap().clone();
        s.apply(&set(0.0, None)).unwrap();
        assert_eq!(s.errors().len(), 1);
        assert!(Arc::ptr_eq(&before, s.project().unwrap()));
        s.apply(&Command::Undo).unwrap();
        assert!(s.errors().is_empty());
    }

    #[test]
    fn a_log_of_commands_replayed_gives_the_same_project() {
        let mut first = session();
        let log = [
            set(30.0, Some(1)),
            set(31.5, Some(1)),
            Command::SetText { path: "synth.assembly".to_owned(), value: "grimble".to_owned() },
            Command::Undo,
            Command::SetWhole { path: "synth.pade_order".to_owned(), value: 3 },
            Command::Redo,
        ];
        log.iter().for_each(|c| first.apply(c).unwrap());
        let lines: Vec<String> = log.iter().map(|c| serde_json::to_string(c).unwrap()).collect();
        let mut second = session();
        lines.iter().for_each(|l| second.apply(&serde_json::from_str(l).unwrap()).unwrap());
        assert_eq!(first.text(), second.text());
        assert_eq!(first.project(), second.project());
    }
}
