//! What the forms of `synth` write alike: the saved project, and the origin of a report.

use std::path::Path;

use counterpoise_host::projects::{self, ProjectOnDisk};
use counterpoise_project::Project;
use counterpoise_report::ReportOrigin;

/// Writes the file with the weights of a project; everything else of it stays as it is.
pub fn save_project(loaded: &ProjectOnDisk, project: &Project, path: &Path) -> anyhow::Result<()> {
    let document = project.update(&loaded.document, &loaded.stated)?;
    projects::write_file(path, document.text().as_bytes())
}

/// Returns the command of a report and the project that it is of.
pub fn report_origin(loaded: &ProjectOnDisk, option: &str) -> ReportOrigin {
    let project = loaded.path.display().to_string();
    ReportOrigin { command: format!("counterpoise synth {project}{option}"), project }
}
