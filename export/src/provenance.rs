//! The origin of generated code: handed in, written into every header.

use counterpoise_verify::Verification;

use crate::comment::comment_text;
use crate::{Converters, ExportSource};

/// Origin of generated code, as its header states it. All of it is handed in: this crate knows no clock and no file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Provenance {
    /// Program and version that generated the code.
    pub generator: String,
    /// Name of the project.
    pub project: String,
    /// Hash of the project file as it was resolved.
    pub project_hash: String,
    /// The weights of the design, one a line.
    pub weights: Vec<String>,
    /// The verdicts, one a line.
    pub verdicts: Vec<String>,
    /// Quantities of the first two readings, if they are not the demanded and the measured rate of the hub.
    pub loop_signals: Option<String>,
    /// Certified properties of the loop with feedback alone, one a line.
    pub feedback_alone: Vec<String>,
    /// The converters that the readings come from and the control goes to.
    pub converters: Converters,
}

impl Provenance {
    /// Returns the lines of the header, with what the source says of its verification.
    pub(crate) fn header(&self, source: ExportSource) -> Vec<String> {
        let mut lines = self.lines();
        lines.push(verification_line(source.verification()));
        lines.iter().flat_map(|line| wrap_line(line)).map(|line| comment_text(&line)).collect()
    }

    /// Returns the lines that the provenance itself makes.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![
            format!("generator: {}", self.generator),
            format!("project: {}", self.project),
            format!("project-hash: {}", self.project_hash),
        ];
        lines.extend(self.loop_signals.iter().map(|signals| format!("loop: {signals}")));
        lines.extend(self.weights.iter().map(|weight| format!("weight: {weight}")));
        lines.extend(self.verdicts.iter().map(|verdict| format!("verdict: {verdict}")));
        lines.extend(self.feedback_alone.iter().map(|line| format!("feedback-alone: {line}")));
        lines.iter().map(|line| comment_text(line)).collect()
    }
}

/// Returns the line that says whether the controller was verified, and with which verdicts.
fn verification_line(verification: Option<&Verification>) -> String {
    let Some(verification) = verification else {
        return "verified: NO. For tests and experiments only.".to_owned();
    };
    let (hold, fail, open) = verification.counts();
    format!("verified: {hold} requirements hold, {fail} fail, {open} could not be judged")
}

/// Longest line of a header's text.
const WIDTH: usize = 110;

/// Returns the words of a line over several, the following ones indented. A word longer than a line stays
/// whole.
fn wrap_line(line: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in line.split(' ') {
        let full = lines.last().is_some_and(|last| {
            !last.trim().is_empty() && last.chars().count() + 1 + word.chars().count() > WIDTH
        });
        if full {
            lines.push("   ".to_owned());
        }
        if let Some(last) = lines.last_mut() {
            let gap = if last.is_empty() { "" } else { " " };
            last.push_str(gap);
            last.push_str(word);
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_line_is_wrapped_and_loses_no_word() {
        let long = "verdict: ".to_owned() + &"word ".repeat(60);
        let lines = wrap_line(long.trim_end());
        assert!(lines.len() > 2 && lines.iter().all(|line| line.len() <= WIDTH));
        let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(words(&lines.join(" ")), words(&long));
    }

    #[test]
    fn a_line_cannot_leave_its_comment() {
        let hostile = "a */ int x; /*\n\\ *\\ int y; ??/ \u{2028}";
        let provenance = Provenance {
            generator: hostile.into(),
            project: hostile.into(),
            project_hash: hostile.into(),
            weights: vec![hostile.into()],
            verdicts: vec![hostile.into()],
            ..Provenance::default()
        };
        let text = provenance.lines().join("\n");
        assert!(!text.contains(['*', '\\', '?', '\u{2028}']));
        assert_eq!(text.lines().count(), 5);
    }
}
