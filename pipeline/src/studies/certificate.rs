//! The stability certificate of the exported controller: in every regime, at each setting of the schedule.

use counterpoise_controller::Controller;
use counterpoise_models::Parameters;
use counterpoise_project::Project;
use counterpoise_verify::Procedure;
use counterpoise_verify::certificate::elements::{Elements, quasi_linear};
use counterpoise_verify::certificate::{CertifiedCase, StabilityCertificate, certify};
use counterpoise_verify::structured::{Joints, RobustStability, Uncertainty, robust_stability_in};

use crate::synth::schedule::with_factor;
use crate::{PipelineError, PlantModel, SynthesisedDesign, build_plant_model};

/// Factor by which the ranges of the sweep may be widened in one case and one regime of friction.
#[derive(Debug, Clone, PartialEq)]
pub struct RegimeRobustness {
    /// The case's name.
    pub case: String,
    /// The state of friction: sliding or at rest.
    pub joints: Joints,
    /// The bounds; `None` if the nominal loop is unstable there, or nothing that enters it varies.
    pub found: Option<RobustStability>,
}

/// Returns the cases of a project: the design's own first, then the configurations and factors of its
/// schedule.
///
/// # Errors
/// A configuration that does not exist, and parameters that make no mechanism.
pub fn certified_cases(
    project: &Project,
    modelled: &PlantModel,
    synthesised: &SynthesisedDesign,
) -> Result<Vec<CertifiedCase>, PipelineError> {
    let design = synthesised.sampled.controller.parts().design_out_of_balance_kg_m;
    let mut all = vec![CertifiedCase {
        name: "design".to_owned(),
        plant: modelled.plant.clone(),
        out_of_balance_kg_m: design,
    }];
    let schedule = project.synth.as_ref().and_then(|asked| asked.options.schedule.as_ref());
    let Some(schedule) = schedule else { return Ok(all) };
    let case = |name: String, modelled: PlantModel| {
        let out_of_balance_kg_m = modelled.plant.body().out_of_balance_kg_m;
        CertifiedCase { name, plant: modelled.plant, out_of_balance_kg_m }
    };
    for name in &schedule.configurations {
        let mut configured = project.clone();
        configured.model.configuration = Some(name.clone());
        all.push(case(name.clone(), build_plant_model(&configured)?));
    }
    for &factor in &schedule.factors {
        let name = format!("{:.0} % out-of-balance", 100.0 * factor);
        all.push(case(name, with_factor(project, modelled, factor)?));
    }
    Ok(all)
}

/// Returns the certificate of a project's controller, moved as the project's verification moves it.
///
/// # Errors
/// As [`certified_cases`], and those of the loop and the simulator.
pub fn certify_controller(
    project: &Project,
    modelled: &PlantModel,
    synthesised: &SynthesisedDesign,
    procedure: &Procedure,
) -> Result<StabilityCertificate, PipelineError> {
    let cases = certified_cases(project, modelled, synthesised)?;
    Ok(certify(&synthesised.sampled.controller, procedure, &cases)?)
}

/// Returns the structured singular value in each case and each regime of friction but the first, the design's own case with sliding friction, which
/// [`robust_stability`](super::sweep::robust_stability) computes: the ranges of the sweep, and the presliding stiffness among them where the
/// project varies it. Empty if the project varies nothing.
///
/// # Errors
/// As [`certified_cases`], and those of the linear loop.
pub fn other_robust_regimes(
    project: &Project,
    modelled: &PlantModel,
    synthesised: &SynthesisedDesign,
    procedure: &Procedure,
) -> Result<Vec<RegimeRobustness>, PipelineError> {
    let Some(asked) = project.campaign() else { return Ok(Vec::new()) };
    let uncertainty = Uncertainty {
        variations: asked.variations.clone(),
        input_error: asked.input_error,
        output_error: asked.output_error,
    };
    let controller = &synthesised.sampled.controller;
    let cases = certified_cases(project, modelled, synthesised)?;
    let regimes = cases.iter().flat_map(|case| {
        judged_regimes(case.plant.parameters(), controller).iter().map(move |joints| (case, *joints))
    });
    let robustness = |(case, joints): (&CertifiedCase, Joints)| {
        let linear = match joints {
            Joints::Sliding | Joints::Frictionless => controller.clone(),
            Joints::AtRest => quasi_linear(controller, &Elements::observers_at_rest(case, controller)?)?,
        };
        let found = robust_stability_in(joints, case.plant.parameters(), &linear, procedure, &uncertainty)?;
        Ok(RegimeRobustness { case: case.name.clone(), joints, found })
    };
    regimes.skip(1).map(robustness).collect()
}

/// Returns the regimes of friction in which a mechanism is judged; none without a lumped structure.
fn judged_regimes(parameters: &Parameters, controller: &Controller) -> &'static [Joints] {
    let has_friction = parameters.has_dry_friction() || !controller.parts().observers.is_empty();
    match (&parameters.lumped, has_friction) {
        (None, _) => &[],
        (Some(_), true) => &[Joints::Sliding, Joints::AtRest],
        (Some(_), false) => &[Joints::Frictionless],
    }
}
