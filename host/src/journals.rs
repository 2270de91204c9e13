//! The place of the studio's journal of a project, and whether it holds edits that were never saved.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

/// Returns the journal's file for a project: one for each project, in the studio's own folder.
pub fn journal_path(state: &Path, project: &Path) -> PathBuf {
    let whole = project.canonicalize().unwrap_or_else(|_| project.to_owned());
    let hash = whole.to_string_lossy().bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    state.join(format!("journal-{hash:016x}.jsonl"))
}

/// Returns the lines of a journal up to the first that is no text; `None` if there is none.
pub fn journal_lines(path: &Path) -> Option<impl Iterator<Item = String>> {
    Some(BufReader::new(fs::File::open(path).ok()?).lines().map_while(Result::ok))
}

/// Returns whether the studio's journal of a project holds edits that are not in the project file.
///
/// A journal's header and each save are lines with the text; edits follow them. The journal counts if its last line is an edit and
/// it is not older than the project file.
pub fn has_unsaved_edits(state: &Path, project: &Path) -> bool {
    let path = journal_path(state, project);
    let Ok(journal) = fs::read_to_string(&path) else { return false };
    let ends_with_edit = journal.lines().next_back().is_some_and(|line| !line.starts_with("{\"project\":"));
    let time = |path: &Path| fs::metadata(path).and_then(|m| m.modified()).ok();
    ends_with_edit && time(&path) >= time(project)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn edits_behind_the_last_save_are_found() {
        let folder = crate::files::scratch_folder().unwrap();
        let project = folder.path().join("project.toml");
        fs::write(&project, "").unwrap();
        assert!(!has_unsaved_edits(folder.path(), &project));
        let journal = journal_path(folder.path(), &project);
        fs::write(&journal, "{\"project\":\"p\",\"text\":\"\"}\n").unwrap();
        assert!(!has_unsaved_edits(folder.path(), &project), "everything is saved");
        fs::write(&journal, "{\"project\":\"p\",\"text\":\"\"}\n\"undo\"\n").unwrap();
        assert!(has_unsaved_edits(folder.path(), &project));
    }
}
