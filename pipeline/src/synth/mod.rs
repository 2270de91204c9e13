//! The three-part design on the reduced plant, and its sampled controller.

pub(crate) mod controller_blocks;
pub mod demanded_rate;
mod design_plant;
pub mod friction_observers;
pub mod schedule;

use counterpoise_linalg::CMat;
use counterpoise_lti::{Discretisation, StateSpace, Timebase, c2d, d2c_tustin, frequency_response};
use counterpoise_models::ControlledQuantity;
use counterpoise_reduce::{ControllerReduction, Method as Truncation, Order, reduce_controller};
use counterpoise_synth::{
    Alternative, Design, DesignFinding, DisturbanceChannel, LightModes, Reference, SampledLoop, Sampling,
    ScheduleEntry, SynthesisMethod, design, design_alternative, discretise, discretise_schedule,
};

use crate::synth::controller_blocks::{with_controller_blocks, with_reading_limits};
use crate::tolerance::SAME_CONTROLLER;
use crate::{PipelineError, PlantModel, ReducedPlant};
use counterpoise_project::Project;
use counterpoise_project::resolve::imported_controller::ImportedController;
use counterpoise_project::resolve::synthesis::DesignRequest;
use counterpoise_synth::error_feedback::from_demand_and_reading;

pub use demanded_rate::DemandedRate;
use demanded_rate::{demanded_rate, with_demand_limit};
pub use design_plant::design_plant;
pub(crate) use design_plant::{sampling, torque_per_volt};

/// A design with the controller that runs.
#[derive(Debug, Clone)]
pub struct SynthesisedDesign {
    /// The continuous design with its certificates.
    pub design: Design,
    /// The sampled controller and its loop.
    pub sampled: SampledLoop,
    /// Warnings for the designer.
    pub warnings: Vec<DesignFinding>,
    /// Sampling of the controller.
    pub sampling: Sampling,
    /// The other method that made the feedback, where the project names one.
    pub other: Option<Alternative>,
    /// The states that were left out of the feedback to reach its order, where the project asks for one.
    pub lowered: Option<LowerOrderFeedback>,
    /// The designs over out-of-balance, nominal first; empty without schedule.
    pub balance: Vec<ScheduleEntry>,
    /// The largest rate that a loop of position demands; `None` for a loop of rate, or without a limit.
    pub demanded_rate: Option<DemandedRate>,
    /// Quantity that the loop controls.
    pub controlled: ControlledQuantity,
    /// Names of the outputs of the plant.
    pub output_names: Vec<String>,
}

impl SynthesisedDesign {
    /// Returns whether the feedback is one of fixed structure: no equation was solved for it.
    pub fn has_fixed_structure(&self) -> bool {
        let specification = &self.design.specification;
        let has_equation =
            specification.feedback.modes == LightModes::Stiffened && specification.position_gain.is_none();
        self.design.substitute.is_some() && self.other.is_none() && self.lowered.is_none() && !has_equation
    }
}

/// A feedback of lower order, and the one before it.
#[derive(Debug, Clone)]
pub struct LowerOrderFeedback {
    /// The feedback before.
    pub before: StateSpace,
    /// The reduction from the error, and what it does to the loop.
    pub reduction: ControllerReduction,
}

/// Designs feedback and feedforwards, and samples them with the other controller blocks.
///
/// # Errors
/// [`PipelineError::NoController`] with every reason, and those of the plant and the design.
pub fn synthesise(
    project: &Project,
    modelled: &PlantModel,
    reduced: &ReducedPlant,
) -> Result<SynthesisedDesign, PipelineError> {
    let asked =
        project.synth.as_ref().ok_or(PipelineError::Missing { section: "synth", needed_by: "the design" })?;
    let plant = design_plant(asked, modelled, reduced)?;
    let mut design = design(&plant, &asked.specification)?;
    let other = by_method(asked, &mut design)?;
    by_structure(asked, &mut design)?;
    let lowered = asked.options.controller_order.map(|order| lower_order(&mut design, order)).transpose()?;
    let sampling = sampling(asked, modelled)?;
    let balance = match &asked.options.schedule {
        Some(wanted) => schedule::schedule_entries(project, asked, modelled, wanted)?,
        None => Vec::new(),
    };
    let sampled = match &asked.options.schedule {
        Some(wanted)
            if schedule::redesigns(wanted, &balance) && design.part(DisturbanceChannel::Heave).is_some() =>
        {
            discretise_schedule(&design, schedule::select_interpolated(wanted, &balance), &sampling)
        }
        _ => discretise(&design, &sampling),
    };
    let sampled = sampled.map_err(|error| named_controller(asked, error))?;
    let sampled = with_controller_blocks(sampled, asked, modelled, &plant, &sampling)?;
    let sampled = with_reading_limits(sampled, &modelled.parameters.sensors)?;
    let demanded_rate = demanded_rate(asked, modelled, &design, &sampled, &sampling)?;
    let sampled = with_demand_limit(sampled, asked, demanded_rate)?;
    let warnings = design.warnings.clone();
    Ok(SynthesisedDesign {
        design,
        sampled,
        warnings,
        sampling,
        other,
        lowered,
        balance,
        demanded_rate,
        controlled: modelled.parameters.controlled_quantity(),
        output_names: modelled.linear.output_names.clone(),
    })
}

/// Puts the feedback of another method in place of the three-part one, where the project names one.
fn by_method(asked: &DesignRequest, design: &mut Design) -> Result<Option<Alternative>, PipelineError> {
    let method = asked.options.method;
    if method == SynthesisMethod::ThreePart {
        return Ok(None);
    }
    sees_the_error_alone(design, "method")?;
    let made = design_alternative(&design.plant, &asked.specification.feedback, method)?;
    design.substitute = Some(made.controller.clone());
    Ok(Some(made))
}

/// Puts the feedback of fixed structure, or the one that was made elsewhere, in place of the three-part one, where the project has one.
fn by_structure(asked: &DesignRequest, design: &mut Design) -> Result<(), PipelineError> {
    let structure = &asked.options.structure;
    if let Some(imported) = &asked.options.imported {
        sees_the_error_alone(design, "controller")?;
        design.substitute = Some(imported_feedback(imported)?);
        return Ok(());
    }
    if structure.blocks.is_empty() {
        return Ok(());
    }
    sees_the_error_alone(design, "block")?;
    if structure.values().is_err() {
        return Err(PipelineError::NotTuned);
    }
    design.substitute = Some(structure.controller()?);
    Ok(())
}

/// Returns why a sampled loop is refused, which names the file if the feedback was made elsewhere.
fn named_controller(asked: &DesignRequest, error: counterpoise_synth::Error) -> PipelineError {
    match (PipelineError::from(error), &asked.options.imported) {
        (PipelineError::NoController(findings), Some(imported)) => {
            PipelineError::ControllerUnstable { file: imported.file.clone(), findings }
        }
        (error, _) => error,
    }
}

/// Returns a feedback that was made elsewhere, in continuous time from (demand, reading) to the control. One in sampled time becomes the
/// system whose Tustin discretisation it is, so that it runs as it was given, up to rounding.
fn imported_feedback(imported: &ImportedController) -> Result<StateSpace, PipelineError> {
    let not_read = || PipelineError::ControllerNotRead { file: imported.file.clone() };
    let system = imported.system.as_ref().ok_or_else(not_read)?;
    let from_error = match system.timebase {
        Timebase::Continuous => system.as_ref().clone(),
        Timebase::Discrete { period_s } => {
            let has_pole = || PipelineError::ControllerPole { file: imported.file.clone() };
            let continuous = d2c_tustin(system, None).map_err(|_| has_pole())?;
            let again = c2d(&continuous, period_s, Discretisation::Tustin { prewarp_rad_s: None })?;
            if !has_same_response(system, &again, period_s)? {
                return Err(has_pole());
            }
            continuous
        }
    };
    Ok(from_demand_and_reading(&from_error)?)
}

/// Returns whether two sampled systems with one input and one output have the same response, up to rounding.
fn has_same_response(one: &StateSpace, other: &StateSpace, period_s: f64) -> Result<bool, PipelineError> {
    let shares = [1e-4, 1e-3, 1e-2, 0.1, 0.3, 0.7];
    let rates = shares.map(|share| share * std::f64::consts::PI / period_s);
    let [one, other] = [frequency_response(one, &rates)?, frequency_response(other, &rates)?];
    let is_same =
        |(a, b): (&CMat, &CMat)| (a[(0, 0)] - b[(0, 0)]).norm() <= SAME_CONTROLLER * a[(0, 0)].norm();
    Ok(one.iter().zip(&other).all(is_same))
}

/// Puts a feedback of lower order in place of the design's, by frequency-weighted balancing that keeps the loop.
fn lower_order(design: &mut Design, order: usize) -> Result<LowerOrderFeedback, PipelineError> {
    sees_the_error_alone(design, "controller_order")?;
    let before = design.feedback_controller();
    let seen = design.plant.measured_plant()?.select(&[0], &[design.plant.control]);
    let from_error = before.select(&[0], &[0]);
    let reduction = reduce_controller(&seen, &from_error, Order::States(order), Truncation::MatchDc)?;
    design.substitute = Some(from_demand_and_reading(&reduction.reduction.system)?);
    Ok(LowerOrderFeedback { before, reduction })
}

fn sees_the_error_alone(design: &Design, key: &'static str) -> Result<(), PipelineError> {
    match design.specification.reference {
        Reference::Error => Ok(()),
        Reference::WeightOnly => Err(PipelineError::NeedsError { key }),
    }
}
