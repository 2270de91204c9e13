//! Helpers that the tests of the command line share: folders, the example with a quick campaign, the program, and what is passed over.
#![allow(dead_code)]

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The project of the reference rig.
pub const EXAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/reference-rig/project.toml");

/// A quick verification and a campaign of four samples, on the example's design.
pub const CAMPAIGN: &str = r#"
[verify]
duration = 1.0
settle = 0.3
[[verify.requirement]]
figure = "gain_margin_db"
at_least = 9.0
[sweep]
samples = 4
seed = 5
[[sweep.variation]]
parameter = "hub_inertia"
low = 0.8
high = 1.25
"#;

/// Lines of the reference rig that say how long its runs last, and those of short runs.
const SHORT_RUNS: [(&str, &str); 4] = [
    ("duration = 10.0              # s of heave", "duration = 2.0               # s of heave"),
    ("settle = 2.0 ", "settle = 0.5 "),
    ("duration = 3.0\n", "duration = 1.0\n"),
    ("duration = 20.0\n", "duration = 3.0\n"),
];

/// Writes the reference rig with short runs and another number of samples into a folder, with its recording of the road, and returns the text of the
/// project. Its results have every key that those of the whole runs have.
pub fn write_short_rig(folder: &Path, samples: usize) -> String {
    fs::copy(Path::new(EXAMPLE).with_file_name("sandy-loam.parquet"), folder.join("sandy-loam.parquet"))
        .unwrap();
    let samples = format!("\nsamples = {samples}\n");
    let changes = SHORT_RUNS.into_iter().chain([("\nsamples = 200\n", samples.as_str())]);
    let text = changes.fold(fs::read_to_string(EXAMPLE).unwrap(), |text, (from, to)| {
        assert_eq!(text.matches(from).count(), 1, "{from}");
        text.replace(from, to)
    });
    fs::write(folder.join("project.toml"), &text).unwrap();
    text
}

/// Returns an empty folder for one test.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Returns a folder with the example's project, in which another text stands in place of `[verify]` and what follows.
pub fn folder_with(name: &str, rest: &str) -> PathBuf {
    let folder = folder(name);
    let example = fs::read_to_string(EXAMPLE).unwrap();
    let design = example.split("\n[verify]").next().unwrap();
    fs::write(folder.join("project.toml"), format!("{design}\n{rest}")).unwrap();
    folder
}

/// Returns a folder with the project of a direct drive, which is designed quickly.
pub fn quick_folder(name: &str) -> PathBuf {
    let folder = folder(name);
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/direct-gimbal/project.toml");
    fs::copy(example, folder.join("project.toml")).unwrap();
    folder
}

/// Returns the program, to be given arguments.
pub fn counterpoise() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_counterpoise"));
    command.stdin(Stdio::null());
    command
}

/// Says that a test, or a part of it, is skipped, with the tool that is missing. The line goes past the capture of a test's output, so that
/// `.ci/skips` sees it.
pub fn report_skip(why: &str) {
    let _ = writeln!(std::io::stderr(), "skipped: {why}");
}
