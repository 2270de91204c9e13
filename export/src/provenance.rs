//! Where generated code comes from: handed in, written into every header.

use crate::Source;

/// What the header of generated code says of its origin. All of it is handed in: this crate knows no clock and no file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
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
}

impl Provenance {
    /// The lines of the header, with what the source says of its verification.
    pub(crate) fn header(&self, source: Source) -> Vec<String> {
        let mut lines = self.lines();
        lines.push(source.line());
        lines
    }

    /// The lines that the provenance itself makes.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![
            format!("generator: {}", self.generator),
            format!("project: {}", self.project),
            format!("project-hash: {}", self.project_hash),
        ];
        lines.extend(self.weights.iter().map(|weight| format!("weight: {weight}")));
        lines.extend(self.verdicts.iter().map(|verdict| format!("verdict: {verdict}")));
        lines.iter().map(|line| one_line(line)).collect()
    }
}

/// The text on one line, unable to end a comment.
fn one_line(text: &str) -> String {
    let plain: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    plain.replace("*/", "* /").replace("/*", "/ *").replace('\\', "/").trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_cannot_leave_its_comment() {
        let provenance = Provenance { project: "a */ int x; /*\n\\".into(), ..Provenance::default() };
        let text = provenance.lines().join("\n");
        assert!(!text.contains("*/") && !text.contains("/*") && !text.contains('\\'));
        assert_eq!(provenance.lines().len(), 3);
    }
}
