//! Cross compiler and emulator, for the tests that have them.
#![allow(dead_code)]

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use counterpoise_export::board::{
    COMPILER, CodeCost, EMULATOR, LINK, SIZER, TargetCore, counting_code, emulator_command,
};
use counterpoise_export::{File, Numbers};

use super::support::{STRICT, folder, is_there, report_skip, run, write};

/// Returns whether the tools are there; says which are missing.
pub fn tools_are_there() -> bool {
    let missing: Vec<&str> = [COMPILER, EMULATOR].into_iter().filter(|tool| !is_there(tool)).collect();
    if !missing.is_empty() {
        let packages = "apt install gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm";
        report_skip(&format!("{} missing ({packages})", missing.join(", ")));
    }
    missing.is_empty()
}

/// Cross-compiles sources in a folder without a warning allowed; gives the objects.
pub fn compile(core: &TargetCore, folder: &Path, own: &[String]) -> Vec<String> {
    let strict = STRICT.iter().filter(|flag| !flag.starts_with("-O"));
    let mut command = Command::new(COMPILER);
    command.current_dir(folder).args(core.flags).args(strict);
    command.args(["-O2", "-ffp-contract=off", "-fstack-usage", "-c"]).args(own);
    assert_eq!(run(&mut command), "");
    own.iter().map(|source| source.replace(".c", ".o")).collect()
}

/// Links `firmware.elf` from the controller's sources and a program.
pub fn build(core: &TargetCore, folder: &Path, own: &[String], program: &str) -> PathBuf {
    let objects = compile(core, folder, own);
    let board: Vec<File> = counting_code("axis", Numbers::Double);
    for file in board.iter().filter(|file| file.name != "count.c") {
        std::fs::write(folder.join(&file.name), &file.text).unwrap();
    }
    let mut linker = Command::new(COMPILER);
    linker.current_dir(folder).args(core.flags).args(LINK).args(["startup.c", program]);
    run(linker.args(&objects).args(["-lm", "-o", "firmware.elf"]));
    folder.join("firmware.elf")
}

/// Returns the emulator with the firmware of a folder.
pub fn emulator(core: &TargetCore, folder: &Path) -> Command {
    let mut command = Command::new(EMULATOR);
    command.current_dir(folder).args(emulator_command(core)).stderr(Stdio::inherit());
    command
}

/// Returns what the code called `name` costs on a core.
pub fn cost(core: &TargetCore, test: &str, (name, numbers): (&str, Numbers), files: &[File]) -> CodeCost {
    let folder = folder(&format!("{test}_{}_{numbers:?}", core.machine));
    write(&folder, files);
    write(&folder, &counting_code(name, numbers));
    build(core, &folder, &[format!("{name}.c"), format!("{name}_self_test.c")], "count.c");
    let said = run(&mut emulator(core, &folder));
    let size = run(Command::new(SIZER).current_dir(&folder).arg(format!("{name}.o")));
    let usage = std::fs::read_to_string(folder.join(format!("{name}.su"))).unwrap();
    CodeCost::read(&said, &size, &usage).unwrap_or_else(|| panic!("{said}{size}{usage}"))
}
