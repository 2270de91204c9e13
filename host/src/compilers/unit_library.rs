//! The compiled library of an FMI unit.

use std::path::Path;
use std::process::Command;

use counterpoise_export::host::including;

use crate::files;

/// The unit's library for 64-bit Linux, where it can be made here.
pub fn library(folder: &Path, name: &str) -> Option<Vec<u8>> {
    if !cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        return None;
    }
    let place = files::scratch_folder().ok()?;
    compiled_library(&folder.join(name).join("sources"), name, place.path())
}

/// Compiles a unit's sources in a folder `place`. The sources are included by files of fixed names, so that no name of a
/// project's stands on the compiler's command line.
fn compiled_library(sources: &Path, name: &str, place: &Path) -> Option<Vec<u8>> {
    for file in [including("behaviour.c", &format!("{name}.c")), including("unit.c", "fmu.c")] {
        files::write(&place.join(&file.name), file.text.as_bytes()).ok()?;
    }
    let library = place.join("unit.so");
    let mut compiler = Command::new("cc");
    compiler
        .args(["-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared", "-iquote", ".", "-o"])
        .arg(&library);
    compiler.args([place.join("behaviour.c"), place.join("unit.c")]).arg("-lm");
    let compiled = compiler.current_dir(sources).output().ok()?;
    if !compiled.status.success() {
        return None;
    }
    std::fs::read(library).ok()
}
