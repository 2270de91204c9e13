//! CONTRIBUTING.md says where a line belongs: every path of its table exists.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::Path;

/// Subjects that the table must have.
const SUBJECTS: usize = 13;

#[test]
fn every_path_of_the_table_of_places_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let page = fs::read_to_string(root.join("CONTRIBUTING.md")).unwrap();
    let rows = page.lines().skip_while(|line| !line.starts_with("| you want to")).skip(2);
    let rows: Vec<&str> = rows.take_while(|line| line.starts_with('|')).collect();
    assert_eq!(rows.len(), SUBJECTS);
    for row in rows {
        let cell = row.trim_matches('|').split('|').nth(1).unwrap();
        let paths: Vec<&str> = cell.split('`').skip(1).step_by(2).filter(|path| path.contains('/')).collect();
        assert!(!paths.is_empty(), "{row}");
        for path in paths {
            assert!(root.join(path).exists(), "{path} in the row {row}");
        }
    }
}
