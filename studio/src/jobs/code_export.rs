//! The verified controller's code, made and written outside the window's thread.

use std::path::PathBuf;
use std::sync::Arc;

use counterpoise_host::code_files::{LibraryBuilder, write_code};
use counterpoise_host::worker::CancelToken;
use counterpoise_pipeline as pipeline;
use counterpoise_report::wording::code_header::HeaderText;
use counterpoise_report::wording::errors::describe_pipeline_error;
use counterpoise_verify::VerifiedController;

use super::verification::VerificationRequest;

/// Input of an export.
#[derive(Debug, Clone)]
pub struct ExportRequest {
    /// The design and its folder.
    pub design: VerificationRequest,
    /// The verified controller.
    pub verified: Arc<VerifiedController>,
    /// The folder for the code.
    pub output: PathBuf,
    /// Builds the libraries of FMI units.
    pub library: LibraryBuilder,
}

/// Files that an export wrote, and the code that it left out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WrittenCode {
    /// The files.
    pub paths: Vec<PathBuf>,
    /// Code that the project asks for and cannot have, each with the reason.
    pub left_out: Vec<String>,
}

/// Makes the code and writes it; returns `None` if the job was cancelled.
///
/// # Errors
/// Returns why the code could not be made or written.
pub fn export_code(request: &ExportRequest, token: &CancelToken) -> Result<Option<WrittenCode>, String> {
    let VerificationRequest { design, folder } = &request.design;
    let made = pipeline::export(&design.project, &design.modelled, &request.verified, &HeaderText, folder)
        .map_err(|error| describe_pipeline_error(&error))?;
    let paths = write_code(&request.output, &made.files, request.library, &|| !token.is_cancelled())?;
    let left_out = made.left_out.iter().map(ToString::to_string).collect();
    Ok(paths.map(|paths| WrittenCode { paths, left_out }))
}
