//! The compiled library of an FMI unit.

use std::path::Path;
use std::process::Command;

use counterpoise_export::host::including_file;

use crate::files;

/// Returns the unit's library for 64-bit Linux, if it can be made here.
pub fn compile_library(folder: &Path, name: &str) -> Option<Vec<u8>> {
    if !cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        return None;
    }
    let place = files::scratch_folder().ok()?;
    compiled_library(&folder.join(name).join("sources"), name, place.path())
}

/// The files that include a unit's sources. A unit's name is an identifier, so a name with a hyphen cannot be that of a source,
/// which such a file would then include in place of itself.
const INCLUDING: [&str; 2] = ["including-behaviour.c", "including-unit.c"];

/// Compiles a unit's sources in a folder `place`. The sources are included by files of fixed names, so that no name of a
/// project's stands on the compiler's command line.
fn compiled_library(sources: &Path, name: &str, place: &Path) -> Option<Vec<u8>> {
    for file in [including_file(INCLUDING[0], &format!("{name}.c")), including_file(INCLUDING[1], "fmu.c")] {
        files::write_file(&place.join(&file.name), file.text.as_bytes()).ok()?;
    }
    let library = place.join("unit.so");
    let mut compiler = Command::new("cc");
    compiler
        .args(["-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared", "-iquote", ".", "-o"])
        .arg(&library);
    compiler.args(INCLUDING.map(|file| place.join(file))).arg("-lm");
    let compiled = compiler.current_dir(sources).output().ok()?;
    if !compiled.status.success() {
        return None;
    }
    std::fs::read(library).ok()
}
