//! Proof that the generated code, compiled on this machine, answers as its model does in every closed loop that was run.

use std::path::Path;
use std::process::{Command, Stdio};

use counterpoise_export::host::{
    C_COMPILER, C_FLAGS, CODE_FOLDER, RUST_COMPILER, RUST_CRATE, RUST_LIBRARY, RUST_PROGRAM, c_replay,
    count_differing, encode_requests, including_file, rust_replay,
};
use counterpoise_export::{File, FixedPointController, Numbers, TargetFigures, Targets};
use counterpoise_pipeline::export::TargetCode;
use counterpoise_pipeline::export::target_proofs::{CodeAgreement, CompiledCodeTest};
use counterpoise_project::Language;
use counterpoise_project::file::NamedChoice;

use crate::files;

/// Compiles each code and replays the closed loops through it.
pub fn prove_code(code: &[TargetCode], compared: &Targets) -> Vec<CompiledCodeTest> {
    let folder = files::scratch_folder();
    let prove = |each: &TargetCode| {
        let answered = match &folder {
            Ok(folder) => {
                let place = folder.path().join(format!("{}-{}", each.language.name(), each.numbers.name()));
                test_code(each, compared, &place)
            }
            Err(error) => CodeAgreement::NotRun(format!("no temporary folder: {error}")),
        };
        CompiledCodeTest { rust: each.language == Language::Rust, numbers: each.numbers, answered }
    };
    code.iter().map(prove).collect()
}

fn test_code(code: &TargetCode, compared: &Targets, folder: &Path) -> CodeAgreement {
    let compiler = if code.language == Language::Rust { RUST_COMPILER } else { C_COMPILER };
    if Command::new(compiler).arg("--version").output().is_err() {
        return CodeAgreement::NotRun(format!("{compiler} not found on this machine"));
    }
    let figures = compared.figures.iter().find(|figures| figures.numbers == code.numbers);
    let fixed = if code.numbers == Numbers::Fixed { compared.fixed.as_ref().ok() } else { None };
    let Some(figures) = figures else { return CodeAgreement::NotRun("no run to compare it with".to_owned()) };
    if let Err(why) = build(code, folder) {
        return CodeAgreement::NotRun(format!("{compiler} failed: {why}"));
    }
    match replay_closed_loops(figures, fixed, folder) {
        Some((samples, 0)) => CodeAgreement::Alike { samples },
        Some((samples, wrong)) => CodeAgreement::Otherwise { samples, wrong },
        None => CodeAgreement::NotRun("the compiled program did not run to its end".to_owned()),
    }
}

/// Builds `replay` in the folder.
///
/// # Errors
/// The first line that the compiler prints, or why a file cannot be written.
fn build(code: &TargetCode, folder: &Path) -> Result<(), String> {
    match code.language {
        Language::Rust => build_rust(code, folder),
        _ => build_c(code, folder),
    }
}

fn build_rust(code: &TargetCode, folder: &Path) -> Result<(), String> {
    let library = code.files.iter().find(|file| file.name.ends_with("src/lib.rs"));
    let library = library.ok_or("the crate has no lib.rs")?;
    files::write_file(&folder.join("generated.rs"), library.text.as_bytes())
        .map_err(|error| error.to_string())?;
    write(folder, &[rust_replay(code.readings)])?;
    let crate_name = ["--crate-name", RUST_CRATE, "generated.rs"];
    run_silent(Command::new(RUST_COMPILER).args(RUST_LIBRARY).args(crate_name), folder)?;
    run_silent(Command::new(RUST_COMPILER).args(RUST_PROGRAM).arg("replay.rs"), folder)
}

fn build_c(code: &TargetCode, folder: &Path) -> Result<(), String> {
    write(&folder.join(CODE_FOLDER), &code.files)?;
    write(
        folder,
        &[
            c_replay(&code.name, code.numbers),
            including_file("controller.c", &format!("{CODE_FOLDER}/{}.c", code.name)),
        ],
    )?;
    let files = ["controller.c", "replay.c", "-o", "replay"];
    run_silent(Command::new(C_COMPILER).args(C_FLAGS).args(files), folder)
}

fn write(folder: &Path, code: &[File]) -> Result<(), String> {
    let write = |file: &File| files::write_file(&folder.join(&file.name), file.text.as_bytes());
    code.iter().try_for_each(write).map_err(|error| error.to_string())
}

/// Runs a compiler that must succeed without a word.
fn run_silent(command: &mut Command, folder: &Path) -> Result<(), String> {
    let output = command.current_dir(folder).output().map_err(|error| error.to_string())?;
    if output.status.success() && output.stderr.is_empty() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stderr);
    Err(said.lines().find(|line| !line.trim().is_empty()).unwrap_or("it says nothing").to_owned())
}

/// Returns samples replayed, and those answered otherwise.
fn replay_closed_loops(
    figures: &TargetFigures,
    fixed: Option<&FixedPointController>,
    folder: &Path,
) -> Option<(usize, usize)> {
    let bytes = encode_requests(&figures.closed_loops, fixed);
    files::write_file(&folder.join("readings"), &bytes).ok()?;
    let readings = std::fs::File::open(folder.join("readings")).ok()?;
    let output = Command::new(folder.join("replay")).stdin(Stdio::from(readings)).output().ok()?;
    if !output.status.success() {
        return None;
    }
    count_differing(&figures.closed_loops, fixed, &output.stdout)
}
