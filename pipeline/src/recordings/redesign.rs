//! The consequence of an improved model for the controller: the project's design on it, and a design of its own.

use counterpoise_models::Parameters;
use counterpoise_verify::Verification;
use counterpoise_verify::difference::{FigureChange, figure_changes};

use crate::{
    PipelineError, World, build_plant_model, project_procedure, reduce_plant, synthesise, verify_on,
};
use counterpoise_project::Project;

/// The project's design, verified before and after its model was improved.
#[derive(Debug, Clone)]
pub struct RedesignComparison {
    /// The controller designed on the model as it was, verified on that.
    pub before: Verification,
    /// The same controller on the improved model.
    pub kept: Verification,
    /// A controller redesigned on the improved model, verified on it; `None` if it has no design.
    pub redesigned: Option<Verification>,
    /// Every figure from `before` to `kept`.
    pub changes: Vec<FigureChange>,
}

/// Verifies a project's design on an improved mechanism; `None` if the project has no design to verify.
///
/// # Errors
/// Those of the stages from the project to the verification.
pub fn verify_redesign(
    project: &Project,
    improved: &Parameters,
    world: &dyn World,
) -> Result<Option<RedesignComparison>, PipelineError> {
    if project.synth.is_none() || project.verify.is_none() {
        return Ok(None);
    }
    let procedure = project_procedure(project, world)?;
    let modelled = build_plant_model(project)?;
    let made = synthesise(project, &modelled, &reduce_plant(project, &modelled)?)?;
    let better = Project { plant: improved.clone(), ..project.clone() };
    let truer = build_plant_model(&better)?;
    let anew = reduce_plant(&better, &truer).and_then(|reduced| synthesise(&better, &truer, &reduced));
    let redesigned = anew.and_then(|made| verify_on(&better, &truer.plant, &made, &procedure));
    let before = verify_on(project, &modelled.plant, &made, &procedure)?.into_parts().1;
    let kept = verify_on(project, &truer.plant, &made, &procedure)?.into_parts().1;
    Ok(Some(RedesignComparison {
        changes: figure_changes(&before, &kept),
        redesigned: redesigned.ok().map(|verified| verified.into_parts().1),
        before,
        kept,
    }))
}
