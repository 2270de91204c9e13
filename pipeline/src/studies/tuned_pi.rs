//! A design beside a PI with a lag that is tuned under the limits that the design itself reaches: what an engineer would try first.

use counterpoise_project::Project;
use counterpoise_project::TunedWeights;
use counterpoise_project::resolve::synthesis::WeightSource;
use counterpoise_synth::tuning::{feedback_path, measure_loop};
use counterpoise_synth::{SynthesisMethod, TuningSubject, sampled_plant};
use serde::Serialize;

use super::designs::{LimitsResult, limits_of, pi_with_lag};
use crate::exchange::{SystemResult, UnitValue};
use crate::tuning::{BlockResult, LoopMeasuresResult, block_results, tune_feedback, tuning_ground};
use crate::{PipelineError, PlantModel, ReducedPlant, SynthesisedDesign, World};

/// The feedback loop of a design beside that of a tuned PI with a lag.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TunedPiRow {
    /// The limits of the PI: the figures of the design.
    pub limits: LimitsResult,
    /// Blocks of the PI with their values.
    pub blocks: Vec<BlockResult>,
    /// By how much the PI misses the worst limit, relative to it; 0 if it keeps all.
    pub missed: f64,
    /// Figures of the design's loop.
    pub own: LoopMeasuresResult,
    /// Figures of the PI's loop.
    pub tuned: LoopMeasuresResult,
    /// The disturbance of the linear loop: frequency in rad/s and power of each line at the output without feedback, in the square of the
    /// unit of what the loop controls.
    pub disturbance: Vec<[f64; 2]>,
    /// RMS of the white noise of a reading.
    #[serde(flatten)]
    pub reading_noise: UnitValue<f64>,
    /// The sampled plant from the control to the reading, the design's feedback from the error to the control, and that of the PI.
    pub systems: Vec<SystemResult>,
}

impl TunedPiRow {
    /// Returns by how much less the PI leaves than the design, as a share of what the design leaves; negative if it leaves more.
    pub fn improvement(&self) -> f64 {
        1.0 - self.tuned.disturbed.residual / self.own.disturbed.residual
    }
}

/// Tunes the PI; `None` for a design whose weights were not stated, for other kinds of feedback, and if no PI can be tuned.
///
/// # Errors
/// Those of the loop's figures.
pub fn tuned_pi_row(
    project: &Project,
    modelled: &PlantModel,
    reduced: &ReducedPlant,
    made: &SynthesisedDesign,
    world: &dyn World,
) -> Result<Option<TunedPiRow>, PipelineError> {
    let Some(asked) = project.synth.as_ref().filter(|_| is_shaped_by_hand(project)) else { return Ok(None) };
    let mut wanted = asked.options.tuning.clone().unwrap_or_default();
    wanted.plants.clear();
    let Ok(ground) = tuning_ground(project, modelled, reduced, &wanted, world) else { return Ok(None) };
    let controlled = project.plant.controlled_quantity();
    let loops = ground.measured_loops(controlled);
    let plant = sampled_plant(&ground.plants[0], &ground.sampling)?;
    let feedback = feedback_path(&made.sampled.controller, &ground.sampling)?;
    let own = LoopMeasuresResult::of(&measure_loop(&plant, &feedback, &ground.disturbance)?, loops);
    wanted.limits = limits_of(&own, &wanted);
    let structure = pi_with_lag();
    let Ok((tuned, _)) = tune_feedback(TuningSubject::Structure(&structure), &ground, &wanted) else {
        return Ok(None);
    };
    let systems = vec![
        SystemResult::of_plant(&plant, controlled),
        SystemResult::of_feedback("feedback", &feedback, controlled),
        SystemResult::of_feedback("tuned_pi", &tuned.sampled, controlled),
    ];
    Ok(tuned.measures.first().map(|measures| TunedPiRow {
        limits: LimitsResult::from(&wanted.limits),
        blocks: block_results(&tuned.structure()),
        missed: tuned.missed,
        own,
        tuned: LoopMeasuresResult::of(measures, loops),
        disturbance: ground.disturbance.lines.clone(),
        reading_noise: UnitValue::new("reading_noise", controlled, ground.disturbance.reading_noise_rad_s),
        systems,
    }))
}

/// Returns whether the project states the weights of a three-part feedback, so that their shape was chosen by hand.
fn is_shaped_by_hand(project: &Project) -> bool {
    project.synth.as_ref().is_some_and(|asked| {
        asked.weights == WeightSource::Stated
            && asked.options.method == SynthesisMethod::ThreePart
            && asked.options.tuning.as_ref().is_none_or(|tuning| tuning.weights == TunedWeights::Stated)
            && asked.options.fixed_feedback_name().is_none()
            && asked.specification.position_gain.is_none()
    })
}
