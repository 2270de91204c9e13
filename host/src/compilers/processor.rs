//! The cost of the generated code on a target: cross-compiled and run in an emulator, where this machine has them.

use std::path::{Path, PathBuf};
use std::process::Command;

use counterpoise_export::board::{
    COMPILE, COMPILER, CORES, CodeCost, EMULATOR, LINK, SIZER, TargetCore, counting_code, emulator_command,
};
use counterpoise_export::host::{CODE_FOLDER, including_file};
use counterpoise_export::{File, Numbers};
use counterpoise_pipeline::export::TargetCode;
use counterpoise_pipeline::export::target_proofs::{CoreCost, StepCosts};
use counterpoise_project::Language;

use crate::files;

/// Counts on every core; where a tool is missing or fails, says so.
pub fn measure_costs(code: &[TargetCode]) -> StepCosts {
    let missing: Vec<&str> = [COMPILER, SIZER, EMULATOR].into_iter().filter(|tool| !is_there(tool)).collect();
    if !missing.is_empty() {
        let what = format!("not counted: {} not found on this machine", missing.join(", "));
        return StepCosts { counted: Vec::new(), remark: Some(what) };
    }
    let folder = match files::scratch_folder() {
        Ok(folder) => folder,
        Err(error) => {
            return StepCosts {
                counted: Vec::new(),
                remark: Some(format!("not counted: no temporary folder: {error}")),
            };
        }
    };
    let (mut counted, mut failed) = (Vec::new(), Vec::new());
    for each in code.iter().filter(|each| each.language == Language::C99) {
        for core in &CORES {
            match count(core, folder.path(), each) {
                Some(cost) => counted.push(CoreCost { core: core.name, numbers: each.numbers, cost }),
                None => failed.push(format!("{} on {}", words(each.numbers), core.name)),
            }
        }
    }
    let remark = (!failed.is_empty()).then(|| format!("the tools failed for {}", failed.join(", ")));
    StepCosts { counted, remark }
}

fn words(numbers: Numbers) -> &'static str {
    match numbers {
        Numbers::Double => "double",
        Numbers::Single => "single",
        Numbers::Fixed => "fixed point",
    }
}

fn is_there(tool: &str) -> bool {
    Command::new(tool).arg("--version").output().is_ok_and(|output| output.status.success())
}

/// Files of fixed names that include the generated ones: no name of a project's stands on a command line.
const CONTROLLER: &str = "controller.c";
const SELF_TEST: &str = "self_test.c";

/// Measures the cost on a core. Returns `None` if a tool or the self test fails.
fn count(core: &TargetCore, folder: &Path, code: &TargetCode) -> Option<CodeCost> {
    let folder = folder.join(format!("{}-{}", core.machine, code.numbers.name()));
    write(&folder.join(CODE_FOLDER), &code.files)?;
    write(&folder, &counting_code(&code.name, code.numbers))?;
    let included = ["", "_self_test"].map(|end| format!("{CODE_FOLDER}/{}{end}.c", code.name));
    write(&folder, &[including_file(CONTROLLER, &included[0]), including_file(SELF_TEST, &included[1])])?;
    command_output(
        Command::new(COMPILER).args(core.flags).args(COMPILE).args([CONTROLLER, SELF_TEST]),
        &folder,
    )?;
    let objects = [CONTROLLER, SELF_TEST].map(|source| source.replace(".c", ".o"));
    let mut linker = Command::new(COMPILER);
    linker.args(core.flags).args(LINK).args(["startup.c", "count.c"]).args(&objects);
    command_output(linker.args(["-lm", "-o", "firmware.elf"]), &folder)?;
    let counted = command_output(Command::new(EMULATOR).args(emulator_command(core)), &folder)?;
    let sizes = command_output(Command::new(SIZER).arg(&objects[0]), &folder)?;
    let usage = std::fs::read_to_string(folder.join(CONTROLLER.replace(".c", ".su"))).ok()?;
    CodeCost::read(&counted, &sizes, &usage)
}

fn write(folder: &Path, files: &[File]) -> Option<()> {
    let place = |file: &File| -> PathBuf { folder.join(&file.name) };
    files.iter().try_for_each(|file| files::write_file(&place(file), file.text.as_bytes()).ok())
}

/// Returns the standard output of a command that succeeded in a folder.
fn command_output(command: &mut Command, folder: &Path) -> Option<String> {
    let output = command.current_dir(folder).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}
