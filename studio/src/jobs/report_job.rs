//! The HTML report that `counterpoise design` writes, made outside the window's thread.

use std::path::PathBuf;
use std::sync::Arc;

use counterpoise_host::compilers::{processor, proofs};
use counterpoise_host::files::{self, ProjectFolder};
use counterpoise_pipeline::results::DesignResult;
use counterpoise_pipeline::{DesignContents, FirstDesignResult, design_project};
use counterpoise_project::{Assumption, Project};
use counterpoise_report::design::DesignRun;
use counterpoise_report::wording::code_header::HeaderText;
use counterpoise_report::{ReportOrigin, html_page, of_design};

use super::error_lines::error_lines;

/// The report to be written.
#[derive(Debug, Clone)]
pub struct ReportRequest {
    /// The project.
    pub project: Arc<Project>,
    /// The values that the project does not state.
    pub assumptions: Vec<Assumption>,
    /// The folder with the project's files.
    pub folder: ProjectFolder,
    /// The project file, which the report names.
    pub project_path: PathBuf,
    /// The file for the report.
    pub output: PathBuf,
}

/// Runs every stage of the project as the command line does, and writes the report; returns its path.
///
/// # Errors
/// Returns why the report cannot be made or written.
pub fn write_report(request: &ReportRequest) -> Result<PathBuf, String> {
    let contents = DesignContents { assumptions: &request.assumptions, ..DesignContents::default() };
    let designed = design_project(&request.project, &contents, &HeaderText, &request.folder)
        .map_err(|error| error_lines(&error).join("; "))?;
    let result = DesignResult::complete(&designed);
    let (code, project) = (&designed.targets.code, request.project_path.display().to_string());
    let first_design = designed.first_design.as_ref().map(FirstDesignResult::from);
    let run = DesignRun {
        origin: &ReportOrigin { command: format!("counterpoise design {project}"), project },
        times: &[],
        proofs: &proofs::prove_code(code, &designed.targets.compared),
        costs: &processor::measure_costs(code),
        first_design: first_design.as_ref(),
    };
    files::write_file(&request.output, html_page(&of_design(&designed, &result, &run)).as_bytes())
        .map_err(|error| format!("{} cannot be written: {error}", request.output.display()))?;
    Ok(request.output.clone())
}
