//! The verified controller's code, made and written off the window's thread.

use std::path::PathBuf;
use std::sync::Arc;

use counterpoise_host::code_files::{Library, write};
use counterpoise_host::worker::Token;
use counterpoise_pipeline as pipeline;
use counterpoise_verify::VerifiedController;

use crate::jobs::VerifyAsk;

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

/// Makes the code and writes it; `None` if it was stopped.
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
