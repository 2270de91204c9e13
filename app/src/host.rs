//! Whether the generated code, compiled on this machine, answers as its model does in every closed loop that was run.

use std::path::Path;
use std::process::{Command, Stdio};

use counterpoise::report::targets::{Answered, Proof};
use counterpoise_project::Language;
use counterpoise_project::export::host::{
    C_COMPILER, C_FLAGS, RUST_COMPILER, RUST_LIBRARY, RUST_PROGRAM, c_replay, differing, requests,
    rust_replay,
};
use counterpoise_project::export::{Fixed, Numbers, TargetFigures, Targets};
use counterpoise_project::pipeline::export::TargetCode;

use crate::files;

/// Compiles each code and replays the closed loops through it.
pub fn proofs(code: &[TargetCode], compared: &Targets) -> Vec<Proof> {
    let folder = std::env::temp_dir().join(format!("counterpoise-host-{}", std::process::id()));
    let prove = |each: &TargetCode| {
        let place = folder.join(format!("{:?}-{:?}", each.language, each.numbers));
        let answered = answered(each, compared, &place);
        Proof { rust: each.language == Language::Rust, numbers: each.numbers, answered }
    };
    let proofs = code.iter().map(prove).collect();
    // What stays behind in a temporary folder harms nobody.
    let _ = std::fs::remove_dir_all(&folder);
    proofs
}

fn answered(code: &TargetCode, compared: &Targets, folder: &Path) -> Answered {
    let compiler = if code.language == Language::Rust { RUST_COMPILER } else { C_COMPILER };
    if Command::new(compiler).arg("--version").output().is_err() {
        return Answered::NotRun(format!("{compiler} not found on this machine"));
    }
    let figures = compared.figures.iter().find(|figures| figures.numbers == code.numbers);
    let fixed = if code.numbers == Numbers::Fixed { compared.fixed.as_ref().ok() } else { None };
    let counts = figures.and_then(|figures| {
        build(code, folder)?;
        replayed(figures, fixed, folder)
    });
    match counts {
        Some((samples, 0)) => Answered::Alike { samples },
        Some((samples, wrong)) => Answered::Otherwise { samples, wrong },
        None => Answered::NotRun(format!("{compiler} failed")),
    }
}

/// `replay` in the folder; nothing where the compiler fails or says a word.
fn build(code: &TargetCode, folder: &Path) -> Option<()> {
    let name = &code.name;
    let program = match code.language {
        Language::Rust => rust_replay(name),
        _ => c_replay(name, code.numbers),
    };
    for file in code.files.iter().chain([&program]) {
        files::write(&folder.join(&file.name), file.text.as_bytes()).ok()?;
    }
    if code.language == Language::Rust {
        let library = format!("{name}/src/lib.rs");
        silent(
            Command::new(RUST_COMPILER).args(RUST_LIBRARY).args(["--crate-name", name, &library]),
            folder,
        )?;
        return silent(Command::new(RUST_COMPILER).args(RUST_PROGRAM).arg("replay.rs"), folder);
    }
    let source = format!("{name}.c");
    silent(Command::new(C_COMPILER).args(C_FLAGS).args([&source, "replay.c", "-o", "replay"]), folder)
}

fn silent(command: &mut Command, folder: &Path) -> Option<()> {
    let output = command.current_dir(folder).output().ok()?;
    (output.status.success() && output.stderr.is_empty()).then_some(())
}

/// Samples replayed, and those answered otherwise.
fn replayed(figures: &TargetFigures, fixed: Option<&Fixed>, folder: &Path) -> Option<(usize, usize)> {
    let bytes = requests(&figures.closed_loops, fixed);
    files::write(&folder.join("readings"), &bytes).ok()?;
    let readings = std::fs::File::open(folder.join("readings")).ok()?;
    let output = Command::new(folder.join("replay")).stdin(Stdio::from(readings)).output().ok()?;
    if !output.status.success() {
        return None;
    }
    differing(&figures.closed_loops, fixed, &output.stdout)
}
