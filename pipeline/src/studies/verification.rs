//! Everything that is stated about a project's controller when it is verified, on the plant and the road that the caller chooses.

use counterpoise_project::{Project, StructureChoice};
use counterpoise_verify::certificate::StabilityCertificate;
use counterpoise_verify::difference::{FigureChange, figure_changes};
use counterpoise_verify::rejection_spectra::{HubRateSpectra, spectral_rejections};
use counterpoise_verify::signals::{RoadClass, RoadDrive, Vehicle, iso_road};
use counterpoise_verify::structured::RobustStability;
use counterpoise_verify::{Road, Triangle, Verification};

use super::adaptation_trials::{AdaptationTrials, own_trials};
use super::advice::{KeptDesigns, WeightAdvice, advise_changes};
use super::certificate::{RegimeRobustness, certify_controller, other_robust_regimes};
use super::sweep::robust_stability;
use crate::exchange::{ErrorBudgetResult, VerifiedLoop, error_budget_result, verified_loop};
use crate::loop_view::{LoopView, loop_view};
use crate::sight_views::{SightView, view_sight};
use crate::{
    DesignedAxis, PipelineError, ProjectIdentity, TwoAxisStudy, World, build_plant_model, design_traverse,
    project_procedure, reduce_plant, study_two_axes, synthesise, verify_linear_on, verify_on,
};

/// On what a controller is verified.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum VerifiedPlant {
    /// As the project's `[model]` says: nonlinear and linear.
    #[default]
    Project,
    /// The linear plant alone: margins, linear step and disturbances, rejection ratios.
    Linear,
    /// Another structure of the mechanism, nonlinear and linear.
    Structure(StructureChoice),
}

/// The differences of a verification from the project.
#[derive(Debug, Clone, PartialEq)]
pub struct VerificationOptions {
    /// The plant that the controller is verified on; the controller stays the project's.
    pub plant: VerifiedPlant,
    /// The motion of the platform; `None` takes the project's.
    pub road: Option<Road>,
    /// A triangle of the demanded rate; `None` takes the project's.
    pub triangle: Option<Triangle>,
    /// The part that is kept of the designs that the advice tries.
    pub kept: KeptDesigns,
}

impl VerificationOptions {
    /// Returns the options of a verification that differs in nothing from the project.
    pub fn of_project() -> Self {
        Self { plant: VerifiedPlant::Project, road: None, triangle: None, kept: KeptDesigns::Systems }
    }
}

/// A project's controller, verified, with everything that is shown of it.
#[derive(Debug, Clone)]
pub struct VerificationStudy {
    /// Name and hash of the project.
    pub identity: ProjectIdentity,
    /// The verification.
    pub found: Verification,
    /// Rejection ratios from the time histories on the road.
    pub on_road: Vec<HubRateSpectra>,
    /// The loop as charts of the plane show it.
    pub loop_view: LoopView,
    /// The systems that the linear figures were measured on.
    pub measured_on: VerifiedLoop,
    /// The linear worst case of the ranges of the project's sweep.
    pub stability: Option<RobustStability>,
    /// Stability in every regime; `None` on the linear plant alone.
    pub certificate: Option<StabilityCertificate>,
    /// The linear worst case in the other regimes and cases.
    pub regimes: Vec<RegimeRobustness>,
    /// The changes that meet a requirement that fails.
    pub advice: Vec<WeightAdvice>,
    /// The contributions to the error of the line of sight, with the angles of its runs if time histories are kept.
    pub budget: Option<ErrorBudgetResult>,
    /// The spectrum of the line of sight at each place; empty if the verification did not ask for it.
    pub sight_views: Vec<SightView>,
    /// Trials of the project's adaptation; `None` if it has none, or on the linear plant alone.
    pub adaptation: Option<AdaptationTrials>,
    /// The traverse axis and both axes together; `None` if the project has none, or on the linear plant alone.
    pub two_axes: Option<TwoAxisStudy>,
}

impl VerificationStudy {
    /// Returns what changed in the figures from an earlier verification to this one.
    pub fn list_changes_from(&self, before: &VerificationStudy) -> Vec<FigureChange> {
        figure_changes(&before.found, &self.found)
    }
}

/// Designs the controller of a project and verifies it.
///
/// # Errors
/// Those of every stage from the model to the verification, and of the studies beside it.
pub fn verify_project(
    project: &Project,
    options: &VerificationOptions,
    world: &dyn World,
) -> Result<VerificationStudy, PipelineError> {
    let modelled = build_plant_model(project)?;
    let reduced = reduce_plant(project, &modelled)?;
    let made = synthesise(project, &modelled, &reduced)?;
    let mut procedure = project_procedure(project, world)?;
    if let Some(road) = &options.road {
        procedure.road = Some(road.clone());
    }
    if let Some(triangle) = &options.triangle {
        procedure.triangle = Some(*triangle);
    }
    let structure = match options.plant {
        VerifiedPlant::Structure(structure) => structure,
        VerifiedPlant::Project | VerifiedPlant::Linear => project.model.structure,
    };
    let linear = options.plant == VerifiedPlant::Linear;
    let on = build_plant_model(&with_structure(project, structure))?;
    let plant = &on.plant;
    let mut found = match linear {
        true => verify_linear_on(project, plant, &made, &procedure)?,
        false => verify_on(project, plant, &made, &procedure)?.into_parts().1,
    };
    let controller = &made.sampled.controller;
    let stability = robust_stability(project, &modelled, controller, world)?;
    let measured_on = verified_loop(plant, controller, &procedure)?;
    let certificate = (!linear).then(|| certify_controller(project, &on, &made, &procedure)).transpose()?;
    certificate.iter().for_each(|certificate| found.take_certificate(certificate));
    let regimes = other_robust_regimes(project, &modelled, &made, &procedure)?;
    let adaptation = if linear { None } else { own_trials(project, &on, &made, &procedure)? };
    let advice = advise_changes(project, &modelled, &reduced, &procedure, &found, options.kept)?;
    let budget = error_budget_result(&found, plant, controller, options.kept)?;
    let axis = DesignedAxis { project, plant, synthesised: &made, procedure: &procedure };
    let two_axes = if linear { None } else { study_two_axes(axis, design_traverse(project, world)?, world)? };
    Ok(VerificationStudy {
        identity: ProjectIdentity::of(project, world),
        measured_on,
        budget,
        on_road: spectral_rejections(&found),
        loop_view: loop_view(&found)?,
        sight_views: view_sight(&found),
        found,
        stability,
        certificate,
        regimes,
        advice,
        adaptation,
        two_axes,
    })
}

fn with_structure(project: &Project, structure: StructureChoice) -> Project {
    let mut other = project.clone();
    other.model.structure = structure;
    other
}

/// Length of a drive, s, the period of its samples, s, and the time in which it fades in and out, s.
const DRIVE_S: (f64, f64, f64) = (30.0, 0.005, 1.0);
/// Standard gravity, m/s^2 (ISO 80000-3); a half of a vehicle does not roll, so that it has no effect here.
const GRAVITY_M_S2: f64 = 9.80665;

/// Returns the motion of the platform during a drive of a heavy vehicle over a road, with the noise of the project's seed.
///
/// # Errors
/// A speed that is not positive.
pub fn drive_over_road(
    project: &Project,
    class: RoadClass,
    speed_m_s: f64,
) -> Result<Road, counterpoise_verify::Error> {
    let (duration_s, sample_period_s, fade_s) = DRIVE_S;
    let seed = project.verify.as_ref().map_or(0, |asked| asked.procedure.seed);
    let drive = RoadDrive { class, speed_m_s, duration_s, sample_period_s, fade_s, seed };
    iso_road(drive, Vehicle::HEAVY, GRAVITY_M_S2)
}
