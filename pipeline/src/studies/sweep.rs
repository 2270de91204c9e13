//! The robustness campaign that the project asks for.

use counterpoise_controller::Controller;
use counterpoise_verify::robust::{Campaign, Member, configurations, one_at_a_time};
use counterpoise_verify::structured::{RobustStability, Uncertainty};
use counterpoise_verify::{Figure, VerifiedController};

use crate::{Modelled, PipelineError, World, procedure};
use counterpoise_project::Project;

/// The Monte Carlo campaign of the project's requirements over its variations.
///
/// # Errors
/// A section that is missing, a road that cannot be read, variations that make no mechanism.
pub fn campaign(
    project: &Project,
    modelled: &Modelled,
    verified: &VerifiedController,
    world: &dyn World,
) -> Result<Campaign, PipelineError> {
    let asked = project
        .sweep
        .as_ref()
        .ok_or(PipelineError::Missing { section: "sweep", needed_by: "the campaign" })?;
    let judged = project
        .verify
        .as_ref()
        .ok_or(PipelineError::Missing { section: "verify", needed_by: "the campaign" })?;
    if asked.variations.is_empty() {
        return Err(PipelineError::Missing { section: "[sweep.variation]", needed_by: "the campaign" });
    }
    if judged.requirements.is_empty() {
        return Err(PipelineError::Missing { section: "[verify.requirement]", needed_by: "the campaign" });
    }
    Ok(Campaign::new(
        (modelled.parameters.clone(), verified.controller().clone()),
        procedure(project, world)?,
        asked.variations.clone(),
        judged.requirements.clone(),
        (asked.samples, asked.seed, asked.layout),
    )?)
}

/// The figures of the project's requirements in each configuration and with each parameter of a family varied alone.
///
/// # Errors
/// As [`campaign`].
pub fn families(
    project: &Project,
    modelled: &Modelled,
    verified: &VerifiedController,
    world: &dyn World,
) -> Result<Vec<Member>, PipelineError> {
    let asked = project
        .sweep
        .as_ref()
        .ok_or(PipelineError::Missing { section: "sweep", needed_by: "the families" })?;
    let judged = project
        .verify
        .as_ref()
        .ok_or(PipelineError::Missing { section: "verify", needed_by: "the families" })?;
    let figures: Vec<Figure> = judged.requirements.iter().map(|requirement| requirement.figure).collect();
    let (parameters, controller, procedure) =
        (&modelled.parameters, verified.controller(), procedure(project, world)?);
    let mut members = one_at_a_time(parameters, controller, &procedure, &figures, &asked.families)?;
    members.extend(configurations(parameters, controller, &procedure, &figures)?);
    Ok(members)
}

/// How far the ranges of the project's variations may be widened together before the linear loop can be unstable; `None` if the
/// project varies nothing, has no lumped structure, or its loop is unstable as it is.
///
/// # Errors
/// As [`campaign`], and those of the linear loop.
pub fn robust_stability(
    project: &Project,
    modelled: &Modelled,
    controller: &Controller,
    world: &dyn World,
) -> Result<Option<RobustStability>, PipelineError> {
    let Some(asked) = project.sweep.as_ref() else { return Ok(None) };
    if modelled.parameters.lumped.is_none() {
        return Ok(None);
    }
    let uncertainty = Uncertainty {
        variations: asked.variations.clone(),
        input_error: asked.input_error,
        output_error: asked.output_error,
    };
    let procedure = procedure(project, world)?;
    let parameters = &modelled.parameters;
    Ok(counterpoise_verify::structured::robust_stability(parameters, controller, &procedure, &uncertainty)?)
}
