//! Generated code, written into a folder; FMI units are packed.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use counterpoise_export::File;
use counterpoise_export::fmi::pack;

use crate::files;

/// Makes the library of an FMI unit from its sources below a folder, by the unit's name; `None` if this machine cannot.
pub type Library = fn(&Path, &str) -> Option<Vec<u8>>;

/// Writes generated files and packs FMI units; `None` if `go_on` said no.
///
/// # Errors
/// The file that cannot be written, and why.
pub fn write(
    folder: &Path,
    code: &[File],
    library: Library,
    go_on: &dyn Fn() -> bool,
) -> Result<Option<Vec<PathBuf>>, String> {
    let mut written = Vec::new();
    let mut put = |path: PathBuf, bytes: &[u8]| {
        files::write(&path, bytes)
            .map_err(|error| format!("{} cannot be written: {error}", path.display()))?;
        written.push(path);
        Ok::<bool, String>(go_on())
    };
    for file in code {
        if !put(folder.join(&file.name), file.text.as_bytes())? {
            return Ok(None);
        }
    }
    for name in units(code) {
        let inside = format!("{name}/");
        let own: Vec<File> = code.iter().filter(|file| file.name.starts_with(&inside)).cloned().collect();
        let packed = pack(&own, &name, library(folder, &name).as_deref());
        if !put(folder.join(format!("{name}.fmu")), &packed)? {
            return Ok(None);
        }
    }
    Ok(Some(written))
}

/// Folders that hold an FMI unit.
fn units(code: &[File]) -> BTreeSet<String> {
    code.iter()
        .filter_map(|file| file.name.strip_suffix("/modelDescription.xml"))
        .map(str::to_owned)
        .collect()
}
