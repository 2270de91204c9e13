//! The check that a generated file is still what the project gives.

use crate::File;

/// The outcome of comparing a file with what the project gives now.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CheckOutcome {
    /// The same text, to the last character.
    Same,
    /// The file carries no project hash: it is no generated file.
    NotGenerated,
    /// The project has changed since the file was generated.
    OtherProject {
        /// Hash in the file.
        found: String,
        /// Hash of the project.
        expected: String,
    },
    /// The same project, but a line differs: the file was edited, or another version generated it.
    Differs {
        /// Number of the first line that differs, from 1.
        line: usize,
        /// First line of the file that differs; `None` if the file ends before it.
        found: Option<String>,
        /// Generated line in its place; `None` if the generated file ends before it.
        expected: Option<String>,
    },
}

/// Compares the text of a file with the one that the project gives now. Only the ends of lines may differ.
pub fn check_file(found: &str, expected: &File) -> CheckOutcome {
    let own = |text: &str| text.lines().find_map(hash);
    match (own(found), own(&expected.text)) {
        (None, Some(_)) => return CheckOutcome::NotGenerated,
        (Some(found), Some(expected)) if found != expected => {
            return CheckOutcome::OtherProject { found, expected };
        }
        _ => {}
    }
    let (mut theirs, mut ours) = (found.lines(), expected.text.lines());
    for line in 1.. {
        match (theirs.next(), ours.next()) {
            (None, None) => return CheckOutcome::Same,
            (a, b) if a.map(str::trim_end) == b.map(str::trim_end) => {}
            (found, expected) => {
                let owned = |line: Option<&str>| line.map(str::to_owned);
                return CheckOutcome::Differs { line, found: owned(found), expected: owned(expected) };
            }
        }
    }
    CheckOutcome::Same
}

/// Returns the hash in a header's line.
fn hash(line: &str) -> Option<String> {
    line.split_once("project-hash:").map(|(_, hash)| hash.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file() -> File {
        File { name: "axis.c".into(), text: "/* project-hash: ab12\n */\nint x = 3;\n".into() }
    }

    #[test]
    fn the_same_text_is_the_same_whatever_ends_its_lines() {
        assert_eq!(check_file(&file().text, &file()), CheckOutcome::Same);
        assert_eq!(check_file(&file().text.replace('\n', "\r\n"), &file()), CheckOutcome::Same);
    }

    #[test]
    fn an_edited_line_is_named() {
        let edited = file().text.replace('3', "4");
        let expected = CheckOutcome::Differs {
            line: 3,
            found: Some("int x = 4;".into()),
            expected: Some("int x = 3;".into()),
        };
        assert_eq!(check_file(&edited, &file()), expected);
        assert!(matches!(
            check_file(&(file().text + "more"), &file()),
            CheckOutcome::Differs { expected: None, .. }
        ));
    }

    #[test]
    fn another_project_and_another_file_are_told_apart() {
        let other = file().text.replace("ab12", "cd34");
        let expected = CheckOutcome::OtherProject { found: "cd34".into(), expected: "ab12".into() };
        assert_eq!(check_file(&other, &file()), expected);
        assert_eq!(check_file("int main(void) { return 0; }", &file()), CheckOutcome::NotGenerated);
    }
}
