//! What the tests of the command line share: folders, the example with a quick campaign, the program, and what is passed over.
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

/// Returns the program, to be given arguments.
pub fn counterpoise() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_counterpoise"));
    command.stdin(Stdio::null());
    command
}

/// Says that a test, or a part of it, is skipped, with the tool that is missing. The line goes past the capture of a test's output, so that
/// `.ci/skips` sees it.
pub fn skipped(why: &str) {
    let _ = writeln!(std::io::stderr(), "skipped: {why}");
}
