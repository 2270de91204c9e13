//! The reference of keys is what the reader reads.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_project::Project;

const WRITTEN: &str = include_str!("../../docs/reference/project-file.md");

/// With WRITE_MANUAL=1 the tables are regenerated; the introduction stays.
#[test]
fn the_written_reference_is_the_readers() {
    let start = WRITTEN.find("\n## at the top").unwrap();
    if std::env::var_os("WRITE_MANUAL").is_some() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/reference/project-file.md");
        std::fs::write(path, format!("{}{}", &WRITTEN[..start], Project::reference())).unwrap();
        return;
    }
    let (written, read) = (&WRITTEN[start..], Project::reference());
    for (number, (written, read)) in written.lines().zip(read.lines()).enumerate() {
        assert_eq!(written, read, "line {number} after the introduction of docs/reference/project-file.md");
    }
    assert_eq!(written.lines().count(), read.lines().count());
}

#[test]
fn every_key_of_the_good_file_is_in_the_reference() {
    for line in include_str!("data/rig.toml").lines().filter(|l| !l.starts_with(['#', '['])) {
        let Some((key, _)) = line.split_once(" = ") else { continue };
        assert!(WRITTEN.contains(&format!("| `{}` |", key.trim())), "{key}");
    }
}
