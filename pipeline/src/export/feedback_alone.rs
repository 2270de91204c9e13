//! The certificate of the loop that remains when the exported code hands over to feedback alone.

use counterpoise_verify::{Verification, verify_linear};

use super::ExportTask;
use crate::PipelineError;

/// Returns the verification of the degraded loop: its stability, its loop figures and the verdict on each linear requirement. The loop is that of
/// the exported controller itself, with every sensor other than the hub gyroscope reading 0.
///
/// # Errors
/// Those of the controller and of the verification.
pub(super) fn verify_feedback_alone(task: &ExportTask<'_>) -> Result<Verification, PipelineError> {
    let ExportTask { project, modelled, verified, procedure } = *task;
    let controller = verified.controller().feedback_alone().map_err(counterpoise_verify::Error::from)?;
    let requirements = project.verify.as_ref().map_or(&[][..], |asked| &asked.requirements);
    Ok(verify_linear(&modelled.plant, &controller, procedure, requirements)?)
}
