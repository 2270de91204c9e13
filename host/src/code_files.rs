//! Generated code, written into a folder; FMI units are packed.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use counterpoise_export::File;
use counterpoise_export::fmi::pack_unit;

use counterpoise_pipeline::exchange::ControllerResult;

use crate::compilers::unit_library;
use crate::files::{self, FileToWrite};
use crate::json::json_text;

/// Makes the library of an FMI unit from its sources below a folder, by the unit's name; `None` if this machine cannot.
pub type LibraryBuilder = fn(&Path, &str) -> Option<Vec<u8>>;

/// A packed FMI unit.
struct PackedUnit {
    path: PathBuf,
    bytes: Vec<u8>,
}

/// Writes generated files and packed FMI units as a set: no old file is replaced before all new ones are on the disk. Returns `None`
/// and writes nothing if `go_on` returns `false`.
///
/// # Errors
/// The file that cannot be written, and why.
pub fn write_code(
    folder: &Path,
    code: &[File],
    library: LibraryBuilder,
    go_on: &dyn Fn() -> bool,
) -> Result<Option<Vec<PathBuf>>, String> {
    // The library of a unit is compiled from a copy of its sources, so that the set is complete before any old file is replaced.
    let scratch = files::scratch_folder().map_err(|error| format!("no temporary folder: {error}"))?;
    let mut packed: Vec<PackedUnit> = Vec::new();
    for name in units(code) {
        if !go_on() {
            return Ok(None);
        }
        let inside = format!("{name}/");
        let own: Vec<File> = code.iter().filter(|file| file.name.starts_with(&inside)).cloned().collect();
        for file in &own {
            files::write_file(&scratch.path().join(&file.name), file.text.as_bytes())
                .map_err(|error| format!("{} cannot be written: {error}", file.name))?;
        }
        let unit = pack_unit(&own, &name, library(scratch.path(), &name).as_deref());
        packed.push(PackedUnit { path: folder.join(format!("{name}.fmu")), bytes: unit });
    }
    if !go_on() {
        return Ok(None);
    }
    let texts =
        code.iter().map(|file| FileToWrite { path: folder.join(&file.name), bytes: file.text.as_bytes() });
    let units = packed.iter().map(|unit| FileToWrite { path: unit.path.clone(), bytes: &unit.bytes });
    let set: Vec<FileToWrite<'_>> = texts.chain(units).collect();
    files::write_set(&set)?;
    Ok(Some(set.into_iter().map(|file| file.path).collect()))
}

/// Writes generated files, the controller as plain data and further files as one set; FMI units have a library inside if this machine has
/// a C compiler.
///
/// # Errors
/// The file that cannot be written, and why.
pub fn write_with_controller(
    folder: &Path,
    code: &[File],
    controller: &ControllerResult,
    further: &[File],
) -> anyhow::Result<Vec<PathBuf>> {
    let plain = File { name: "controller.json".to_owned(), text: json_text(controller)? };
    let set = [code, &[plain], further].concat();
    let written = write_code(folder, &set, unit_library::compile_library, &|| true);
    Ok(written.map_err(anyhow::Error::msg)?.unwrap_or_default())
}

/// Folders that hold an FMI unit.
fn units(code: &[File]) -> BTreeSet<String> {
    code.iter()
        .filter_map(|file| file.name.strip_suffix("/modelDescription.xml"))
        .map(str::to_owned)
        .collect()
}
