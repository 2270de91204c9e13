//! The verified controller's code, written into a folder; FMI units are packed.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use counterpoise_project::export::File;
use counterpoise_project::export::fmi::pack;
use counterpoise_project::pipeline;
use counterpoise_project::verify::VerifiedController;

use crate::files;
use crate::jobs::VerifyAsk;
use crate::worker::Token;

/// Makes the library of an FMI unit from its sources below a folder, by the unit's name; none where this machine cannot.
pub type Library = fn(&Path, &str) -> Option<Vec<u8>>;

/// What is asked of the export.
#[derive(Debug, Clone)]
pub struct ExportAsk {
    /// The design and its folder.
    pub design: VerifyAsk,
    /// The verified controller.
    pub verified: Arc<VerifiedController>,
    /// Where to.
    pub out: PathBuf,
    /// Makes libraries.
    pub library: Library,
}

/// What an export wrote, and what it left out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// The files.
    pub paths: Vec<PathBuf>,
    /// Code that the project asks for and cannot have, with the reason.
    pub left_out: Vec<String>,
}

/// Makes the code and writes it; none where it was stopped.
///
/// # Errors
/// Why it could not be made or written.
pub fn export(ask: &ExportAsk, token: &Token) -> Result<Option<Written>, String> {
    let live = &ask.design.live;
    let made = pipeline::export(&live.project, &live.modelled, &ask.verified, &ask.design.folder)
        .map_err(|error| error.to_string())?;
    let paths = write(&ask.out, &made.files, ask.library, &|| !token.is_cancelled())?;
    let left_out = made.left_out.iter().map(ToString::to_string).collect();
    Ok(paths.map(|paths| Written { paths, left_out }))
}

/// Writes generated files and packs FMI units; none where `go_on` said no.
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
