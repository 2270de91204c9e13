//! The certificate of the loop that remains when the exported code hands over to feedback alone.

use counterpoise_verify::{Procedure, Verification, VerifiedController, verify_linear};

use crate::wording::feedback_alone::{describe_feedback_alone, describe_uncertified};
use crate::{PipelineError, PlantModel};
use counterpoise_project::Project;

/// Returns the lines of the header: whether the degraded loop is stable, its loop figures, and the verdict on each linear
/// requirement. The loop is that of the exported controller itself, with every sensor other than the hub gyroscope reading 0.
/// A loop that cannot be verified says so instead.
pub(super) fn certificate(
    project: &Project,
    modelled: &PlantModel,
    verified: &VerifiedController,
    procedure: &Procedure,
) -> Vec<String> {
    match verify_feedback_alone(project, modelled, verified, procedure) {
        Ok(found) => describe_feedback_alone(&found),
        Err(why) => vec![describe_uncertified(&why)],
    }
}

fn verify_feedback_alone(
    project: &Project,
    modelled: &PlantModel,
    verified: &VerifiedController,
    procedure: &Procedure,
) -> Result<Verification, PipelineError> {
    let controller = verified.controller().feedback_alone().map_err(counterpoise_verify::Error::from)?;
    let requirements = project.verify.as_ref().map_or(&[][..], |asked| &asked.requirements);
    Ok(verify_linear(&modelled.plant, &controller, procedure, requirements)?)
}
