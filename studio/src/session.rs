//! The project in the studio's hands: its text, what it means, its revisions, and the way back.
//!
//! A session knows no file and no window: the same commands on the same text give the same project.

use std::sync::Arc;

use counterpoise_project::file::EditError;
use counterpoise_project::{Attachments, Diagnostic, Document, Project, Setting};

use crate::command::Command;

/// Steps that can be taken back.
const UNDO_LIMIT: usize = 500;

/// A project as it is worked on.
#[derive(Debug, Clone)]
pub struct Session {
    document: Document,
    attachments: Attachments,
    errors: Vec<Diagnostic>,
    good: Option<Arc<Project>>,
    revision: u64,
    undo: Vec<String>,
    redo: Vec<String>,
    gesture: Option<u64>,
    saved: String,
}

impl Session {
    /// A session on the text of a project file.
    pub fn new(text: &str, name: &str, attachments: Attachments) -> Self {
        let mut session = Self {
            document: Document::parse(text, name),
            attachments,
            errors: Vec::new(),
            good: None,
            revision: 0,
            undo: Vec::new(),
            redo: Vec::new(),
            gesture: None,
            saved: text.to_owned(),
        };
        session.resolve();
        session
    }

    /// The text as it stands.
    pub fn text(&self) -> &str {
        self.document.text()
    }

    /// What the text means; where it has errors, what it meant before.
    pub fn project(&self) -> Option<&Arc<Project>> {
        self.good.as_ref()
    }

    /// What is wrong with the text as it stands.
    pub fn errors(&self) -> &[Diagnostic] {
        &self.errors
    }

    /// A number that grows with every change.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Whether the text differs from what was read or saved last.
    pub fn is_changed(&self) -> bool {
        self.saved != self.document.text()
    }

    /// Whether there is something to take back, and to make again.
    pub fn can(&self) -> (bool, bool) {
        (!self.undo.is_empty(), !self.redo.is_empty())
    }

    /// Gives the project's file another name.
    pub fn rename(&mut self, name: &str) {
        self.document = Document::parse(self.document.text(), name);
    }

    /// Notes that a text has been written: the one as it stands, or one that was edited further while it was written.
    pub fn mark_saved(&mut self, text: &str) {
        self.saved = text.to_owned();
    }

    /// The text that was read or saved last.
    pub fn saved(&self) -> &str {
        &self.saved
    }

    /// Carries out a command that edits; others change nothing.
    ///
    /// # Errors
    /// A path that leads nowhere, or a value that cannot be written; the project is then as it was.
    pub fn apply(&mut self, command: &Command) -> Result<(), EditError> {
        let gesture = if let Command::Set { gesture, .. } = command { *gesture } else { None };
        let changed = match command {
            Command::Set { path, value, .. } => self.document.set(path, &Setting::Number(*value))?,
            Command::SetWhole { path, value } => self.document.set(path, &Setting::Whole(*value))?,
            Command::SetText { path, value } => self.document.set(path, &Setting::Text(value.clone()))?,
            Command::Remove { path } => self.document.remove(path)?,
            Command::Replace { text } => Document::parse(text, self.document.name()),
            Command::Undo => {
                self.back();
                return Ok(());
            }
            Command::Redo => {
                self.forth();
                return Ok(());
            }
            _ => return Ok(()),
        };
        if changed.text() != self.document.text() {
            self.remember(gesture);
            self.take(changed);
        }
        Ok(())
    }

    /// Ends a gesture: what comes next is a step of its own.
    pub fn end_gesture(&mut self) {
        self.gesture = None;
    }

    fn remember(&mut self, gesture: Option<u64>) {
        self.redo.clear();
        if gesture.is_none() || gesture != self.gesture {
            self.undo.push(self.document.text().to_owned());
        }
        if self.undo.len() > UNDO_LIMIT {
            self.undo.remove(0);
        }
        self.gesture = gesture;
    }

    fn back(&mut self) {
        if let Some(text) = self.undo.pop() {
            self.redo.push(self.document.text().to_owned());
            self.gesture = None;
            self.take(Document::parse(&text, self.document.name()));
        }
    }

    fn forth(&mut self) {
        if let Some(text) = self.redo.pop() {
            self.undo.push(self.document.text().to_owned());
            self.gesture = None;
            self.take(Document::parse(&text, self.document.name()));
        }
    }

    fn take(&mut self, document: Document) {
        self.document = document;
        self.revision += 1;
        self.resolve();
    }

    fn resolve(&mut self) {
        match Project::resolve(&self.document, &self.attachments) {
            Ok(parsed) => {
                self.good = Some(Arc::new(parsed.project));
                self.errors.clear();
            }
            Err(errors) => self.errors = errors,
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    const TEXT: &str = include_str!("../../examples/reference-rig/project.toml");
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
    fn a_bad_value_keeps_the_last_good_project() {
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
