//! What the forms of `synth` write alike: the saved project, the origin of a report, and verdicts.

use std::path::Path;

use counterpoise_host::projects::{self, ProjectOnDisk};
use counterpoise_project::Project;
use counterpoise_report::ReportOrigin;
use counterpoise_report::results::front::VerdictSummary;
use counterpoise_report::wording::figures::{describe_figure, format_figure};
use counterpoise_verify::{Verdict, Verification};

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

/// Returns the verdicts of a verification and what fails.
pub fn verdicts_of(found: &Verification) -> VerdictSummary {
    let (holds, fails, open) = found.counts();
    let failing = found.verdicts.iter().filter_map(|(requirement, verdict)| match verdict {
        Verdict::Fails { value, limit, .. } => Some(format!(
            "{}: {} against {}",
            describe_figure(requirement.figure, found.controlled_quantity()),
            format_figure(*value),
            limit.value()
        )),
        _ => None,
    });
    VerdictSummary { verdicts: [holds, fails, open], failing: failing.collect(), holds: found.passes() }
}
