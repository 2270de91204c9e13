//! The open parameters of a feedback of fixed structure, or the weights of the H2 feedback: tuned for the project's own motion, friction and noise.
//!
//! The motions that act on the loop are estimated: the nonlinear closed loop with the file's H2 feedback and its feedforwards moves as the
//! project says (its road, or its sines), and the spectrum of the hub rate over |S|^2 of that loop is the disturbance at the output that any
//! other feedback would meet. It holds what the feedforwards leave and what friction adds.

use counterpoise_linalg::C64;
use counterpoise_lti::response::Response;
use counterpoise_models::plant::Plant;
use counterpoise_models::{ControlledQuantity, Interface, Sensor};
use counterpoise_project::Project;
use counterpoise_project::resolve::controller::RecordingController;
use counterpoise_project::resolve::fixed_structure::{
    FurtherPlants, TunedWeights, TuningObjective, TuningOptions,
};
use counterpoise_project::resolve::synthesis::DesignRequest;
use counterpoise_simulate::Simulator;
use counterpoise_synth::tuning::{RangeEnd, measure_loop};
use counterpoise_synth::{
    BestLoop, Block, DesignPlant, Disturbance, FixedStructure, LoopLimits, LoopMeasures, Sampling,
    TunedDesign, TunedFeedback, TuningSubject, TuningTask, Weight, sampled_plant, tune_parameters,
};
use counterpoise_verify::signals::{WelchOptions, welch};
use counterpoise_verify::{Arrangement, Experiment, History, Procedure, Source, nonlinear_runs};
use serde::ser::SerializeMap as _;
use serde::{Serialize, Serializer};
use std::f64::consts::TAU;

use crate::exchange::UnitValue;
use crate::first_design::{with_angles, with_chosen_weights_on};
use crate::studies::adaptation_choice::with_chosen_adaptation;
use crate::synth::schedule::other_configurations;
use crate::synth::{design_plant, sampling};
use crate::tolerance::{LINES_LEFT_OUT, SAME_LINE, STILL_RAD_S, TUNED_LIMIT_KEPT};
use crate::traverse_file::check_traverse;
use crate::{
    FirstDesign, PipelineError, PlantModel, ReducedPlant, SynthesisedDesign, World, build_plant_model,
    project_procedure, reduce_plant, synthesise,
};

/// A project whose blocks or weights were tuned.
#[derive(Debug, Clone)]
pub struct TunedProject {
    /// The project with a value for every parameter, or with the tuned weights.
    pub project: Project,
    /// Result of the tuning.
    pub tuned: TunedDesign,
    /// Disturbance for which the loop was tuned.
    pub disturbance: Disturbance,
    /// Objective that was minimised; a band if the project moves nothing.
    pub objective: TuningObjective,
    /// Limits that it must keep.
    pub limits: LoopLimits,
    /// Plants on which it keeps that.
    pub plants: usize,
}

/// Plants, limits and disturbance for which the loops of one project are tuned, whatever the structure.
#[derive(Debug, Clone)]
pub struct TuningGround {
    /// The nominal plant, then those that the project asks for.
    pub plants: Vec<DesignPlant>,
    /// The nominal machine with its angles, on which the loop must be stable.
    pub held: Vec<DesignPlant>,
    /// Objective that is minimised; a band if the project moves nothing.
    pub objective: TuningObjective,
    /// Mechanisms of the sweep, from which those are taken that turn out to be the worst.
    pub mechanisms: Vec<DesignPlant>,
    /// Sampling of the controller.
    pub sampling: Sampling,
    /// Disturbance that acts on the loop.
    pub disturbance: Disturbance,
}

impl TuningGround {
    /// Returns what decides the units of the figures of loops that control a quantity.
    pub fn measured_loops(&self, controlled: ControlledQuantity) -> MeasuredLoops {
        MeasuredLoops { objective: self.objective, controlled }
    }
}

/// Returns the project with the open parameters of its blocks tuned, or with its weights if `[synth.tune]` asks for them; `None` if
/// there is nothing to tune.
///
/// # Errors
/// Those of the plant, of the H2 design that the disturbance is estimated with, and of the tuning.
pub fn with_tuned_structure(
    project: &Project,
    world: &dyn World,
) -> Result<Option<TunedProject>, PipelineError> {
    let Some(asked) = &project.synth else { return Ok(None) };
    let structure = &asked.options.structure;
    let weights_are_open =
        asked.options.tuning.as_ref().is_some_and(|tuning| tuning.weights == TunedWeights::ToTune);
    let subject = match structure.is_open() {
        true => TuningSubject::Structure(structure),
        false if weights_are_open => TuningSubject::Weights(&asked.specification),
        false => return Ok(None),
    };
    let modelled = build_plant_model(project)?;
    let reduced = reduce_plant(project, &modelled)?;
    let wanted = asked.options.tuning.clone().unwrap_or_default();
    let ground = tuning_ground(project, &modelled, &reduced, &wanted, world)?;
    let (tuned, plants) = tune_feedback(subject, &ground, &wanted)?;
    let mut stated = asked.clone();
    put_in_place(&tuned.feedback, &mut stated);
    let project = Project { synth: Some(stated), ..project.clone() };
    Ok(Some(TunedProject {
        project,
        tuned,
        disturbance: ground.disturbance,
        objective: ground.objective,
        limits: wanted.limits,
        plants,
    }))
}

/// A project with everything that its file leaves to the program: weights chosen, blocks or weights tuned, bands of an adaptation chosen.
#[derive(Debug, Clone)]
pub struct DecidedProject {
    /// The project, nothing left open.
    pub project: Project,
    /// Why the weights are what they are; `None` if the file states them.
    pub first: Option<FirstDesign>,
    /// Tuned blocks or weights; `None` if the file leaves none open.
    pub tuned: Option<TunedProject>,
}

/// Returns the project with the design under which its recordings were made, if that is its own: with everything decided that its file leaves to the
/// program, as `export` decides it. Returns `None` if they were made under another controller, or if the file names none.
///
/// # Errors
/// As [`choose_and_tune`].
pub fn with_recorded_design(project: &Project, world: &dyn World) -> Result<Option<Project>, PipelineError> {
    match project.recording_controller {
        Some(RecordingController::Project) => {
            // weights are chosen for the motions of [verify] or the usual ones, as for the export
            Ok(Some(choose_and_tune(&project.clone().with_usual_verification(), world)?.project))
        }
        _ => Ok(None),
    }
}

/// Chooses and tunes what the file of a project leaves open.
///
/// # Errors
/// As [`check_traverse`], [`with_chosen_weights_on`], [`with_tuned_structure`] and [`with_chosen_adaptation`].
pub fn choose_and_tune(project: &Project, world: &dyn World) -> Result<DecidedProject, PipelineError> {
    check_traverse(project, world)?;
    let chosen = with_chosen_weights_on(project, world.pool())?;
    let (project, first) = match chosen {
        Some(chosen) => (chosen.project, Some(chosen.first)),
        None => (project.clone(), None),
    };
    let tuned = with_tuned_structure(&project, world)?;
    let project = tuned.as_ref().map_or(project, |tuned| tuned.project.clone());
    let adapted = with_chosen_adaptation(&project, world)?;
    Ok(DecidedProject { project: adapted.unwrap_or(project), first, tuned })
}

/// Puts a tuned feedback in the place of the one that a synthesis states, with the digits that its project file gets.
pub fn put_in_place(tuned: &TunedFeedback, synthesis: &mut DesignRequest) {
    match tuned {
        TunedFeedback::Structure(structure) => {
            let mut structure = structure.clone();
            for parameter in structure.blocks.iter_mut().flat_map(|block| &mut block.parameters) {
                parameter.value = parameter.value.map(round_for_file);
            }
            synthesis.options.structure = structure;
        }
        TunedFeedback::Weights(weights) => {
            let mut weights = (**weights).clone();
            for weight in [&mut weights.error, &mut weights.control] {
                *weight = rounded_weight(weight);
            }
            weights.measurement_noise = round_for_file(weights.measurement_noise);
            weights.loop_recovery = round_for_file(weights.loop_recovery);
            synthesis.specification.feedback = weights;
            if let Some(tuning) = &mut synthesis.options.tuning {
                tuning.weights = TunedWeights::Tuned;
            }
        }
    }
}

/// Returns digits of a tuned value in a project file: its last one moves no figure that is shown.
fn round_for_file(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}

fn rounded_weight(weight: &Weight) -> Weight {
    let rational = weight.rational();
    let root = |root: &C64| C64::new(round_for_file(root.re), round_for_file(root.im));
    Weight::ZeroPoleGain {
        zeros: rational.zeros.iter().map(root).collect(),
        poles: rational.poles.iter().map(root).collect(),
        gain: round_for_file(rational.gain),
    }
}

/// Returns what a project's loops are tuned on and for.
///
/// # Errors
/// As [`with_tuned_structure`].
pub fn tuning_ground(
    project: &Project,
    modelled: &PlantModel,
    reduced: &ReducedPlant,
    wanted: &TuningOptions,
    world: &dyn World,
) -> Result<TuningGround, PipelineError> {
    let asked = project.synth.clone().unwrap_or_default();
    let mut plants = vec![design_plant(&asked, modelled, reduced)?];
    let mut mechanisms = Vec::new();
    for further in &wanted.plants {
        match further {
            FurtherPlants::Schedule => plants.extend(of_schedule(project, &asked, modelled)?),
            FurtherPlants::Sweep => mechanisms = of_sweep(project, &asked, modelled)?,
        }
    }
    let held = vec![with_angles(project, modelled, &plants[0])?];
    let mut objective = wanted.objective;
    let mut disturbance = Disturbance::of_band(wanted.band_rad_s);
    if objective == TuningObjective::Motion {
        let expected = expected_disturbance(project, modelled, reduced, world)?;
        if expected.lines.iter().map(|line| line[1]).sum::<f64>().sqrt() > STILL_RAD_S {
            disturbance = expected;
        } else {
            objective = TuningObjective::Band;
        }
    }
    let sampling = sampling(&asked, modelled)?;
    Ok(TuningGround { plants, held, objective, mechanisms, sampling, disturbance })
}

/// Rounds in which the worst mechanism of a sweep is added to the plants that are tuned for.
const ROUNDS: usize = 5;

/// Tunes a feedback on its ground; gives the number of plants on which the limits were checked besides. A mechanism of the sweep on which the answer misses a limit joins
/// the plants, and the feedback is tuned again.
///
/// # Errors
/// Those of the tuning.
pub fn tune_feedback(
    subject: TuningSubject<'_>,
    ground: &TuningGround,
    wanted: &TuningOptions,
) -> Result<(TunedDesign, usize), PipelineError> {
    let mut plants = ground.plants.clone();
    let checked = plants.len() + ground.mechanisms.len();
    let task = |plants: &[DesignPlant]| -> Result<TunedDesign, PipelineError> {
        Ok(tune_parameters(&TuningTask {
            subject,
            plants,
            held: &ground.held,
            sampling: &ground.sampling,
            disturbance: &ground.disturbance,
            limits: wanted.limits,
            starts: wanted.starts,
            seed: u64::from(wanted.seed),
        })?)
    };
    let mut found = task(&plants)?;
    for _ in 0..ROUNDS {
        let mut worst: Option<(f64, &DesignPlant)> = None;
        for plant in &ground.mechanisms {
            let missed = missed_on(&found, plant, ground, &wanted.limits)?;
            if missed > TUNED_LIMIT_KEPT && worst.is_none_or(|(most, _)| missed > most) {
                worst = Some((missed, plant));
            }
        }
        let Some((missed, plant)) = worst else { return Ok((found, checked)) };
        plants.push(plant.clone());
        found = task(&plants)?;
        found.missed =
            found.missed.max(if plants.len() == ground.plants.len() + ROUNDS { missed } else { 0.0 });
    }
    let mut missed = found.missed;
    for plant in &ground.mechanisms {
        let most = missed_on(&found, plant, ground, &wanted.limits)?;
        missed = missed.max(if most > TUNED_LIMIT_KEPT { most } else { 0.0 });
    }
    found.missed = missed;
    Ok((found, checked))
}

/// By how much a tuned feedback misses the worst limit on a plant; infinite if the loop is not stable there.
fn missed_on(
    tuned: &TunedDesign,
    plant: &DesignPlant,
    ground: &TuningGround,
    limits: &LoopLimits,
) -> Result<f64, PipelineError> {
    let found = measure_loop(&sampled_plant(plant, &ground.sampling)?, &tuned.sampled, &ground.disturbance)?;
    Ok(if found.decay_rad_s > 0.0 { limits.worst_shortfall(&found) } else { f64::INFINITY })
}

fn of_schedule(
    project: &Project,
    asked: &DesignRequest,
    modelled: &PlantModel,
) -> Result<Vec<DesignPlant>, PipelineError> {
    let missing = PipelineError::Missing { section: "synth.schedule", needed_by: "synth.tune.plants" };
    let wanted = asked.options.schedule.as_ref().ok_or(missing)?;
    let others = other_configurations(project, asked, modelled, wanted)?;
    Ok(others.into_iter().map(|each| each.plant).collect())
}

/// Mechanisms of a sweep that a tuning looks at, at most: linear plants, of which each costs a millisecond.
const MECHANISMS: usize = 100;

fn of_sweep(
    project: &Project,
    asked: &DesignRequest,
    modelled: &PlantModel,
) -> Result<Vec<DesignPlant>, PipelineError> {
    let missing = PipelineError::Missing { section: "sweep", needed_by: "synth.tune.plants" };
    let sweep = project.campaign().ok_or(missing)?;
    let count = sweep.samples.min(MECHANISMS);
    let points = sweep.layout.sample_points(count, sweep.variations.len(), sweep.seed)?;
    let mut plants = Vec::new();
    for point in points.rows() {
        let mut parameters = modelled.parameters.clone();
        for (variation, quantile) in sweep.variations.iter().zip(&point) {
            variation.parameter.scale(&mut parameters, variation.distribution.quantile(*quantile))?;
        }
        let plant = Plant::from_lumped(&parameters)?;
        let equilibrium = plant.equilibrium(&project.model.operating_point);
        let linear = plant.linearise(&equilibrium, project.model.friction, plant.angles())?;
        // A feedback of fixed structure is never a cascade, so no plant of the rate is needed.
        let varied = PlantModel { parameters, plant, linear, rate: None, elements: None };
        let system = varied.linear.system.clone();
        let nominal = reduce_plant(&Project { reduce: Default::default(), ..project.clone() }, &varied)?;
        plants.push(DesignPlant { system, ..design_plant(asked, &varied, &nominal)? });
    }
    Ok(plants)
}

/// Returns what acts on the project's loop: the output's disturbance under its own motion, and the noise of the
/// reading.
///
/// # Errors
/// Those of the H2 design and of the simulation.
pub fn expected_disturbance(
    project: &Project,
    modelled: &PlantModel,
    reduced: &ReducedPlant,
    world: &dyn World,
) -> Result<Disturbance, PipelineError> {
    let mut with_h2 = project.clone();
    if let Some(synth) = &mut with_h2.synth {
        synth.options.remove_fixed_feedback();
    }
    let made = synthesise(&with_h2, modelled, reduced)?;
    let asked_procedure = own_procedure(project, world)?;
    let source = if asked_procedure.road.is_some() { Source::Road } else { Source::Both };
    let experiment = Experiment::Disturbance(source, Arrangement::Compensated);
    let mut simulator = Simulator::new(&modelled.plant)?;
    let controller = &made.sampled.controller;
    let history = nonlinear_runs::run_history(&mut simulator, controller, &asked_procedure, experiment)?;
    let noise = reading_noise(&modelled.parameters.sensors.hub_gyro, &modelled.parameters.interface);
    let lines = output_lines(&history.from_time(asked_procedure.settle_s), &made, noise)?;
    Ok(Disturbance { lines, reading_noise_rad_s: noise })
}

/// Returns the project's procedure, or the usual one if it has none.
pub(crate) fn own_procedure(project: &Project, world: &dyn World) -> Result<Procedure, PipelineError> {
    match project.verify {
        Some(_) => project_procedure(project, world),
        None => Ok(Procedure {
            operating_point: project.model.operating_point,
            friction: project.model.friction,
            ..Procedure::default()
        }),
    }
}

/// Returns the RMS of the white noise of a reading: its own, and that of the converter's step (one over the root of
/// twelve of it).
fn reading_noise(sensor: &Sensor, interface: &Interface) -> f64 {
    sensor.noise_rms.hypot(interface.reading_step(sensor) / 12f64.sqrt())
}

/// Segments of the spectrum at least, and the longest segment in samples: 8 s at a millisecond resolve 0.12 Hz.
const SEGMENTS: usize = 4;
const LONGEST_SEGMENT: usize = 8192;

/// Returns the spectrum of the hub rate, less that of the reading's noise, over |S|^2.
fn output_lines(
    history: &History,
    made: &SynthesisedDesign,
    noise: f64,
) -> Result<Vec<[f64; 2]>, PipelineError> {
    let error: Vec<f64> =
        history.hub_rate_rad_s().iter().zip(history.demand_rad_s()).map(|(y, r)| y - r).collect();
    let period_s = made.sampling.period_s;
    let mut segment = LONGEST_SEGMENT;
    while segment > 64 && segment * (SEGMENTS + 1) / 2 > error.len() {
        segment /= 2;
    }
    let options = WelchOptions { segment, confidence: 0.95 };
    let spectra = welch(&error, &error, period_s, options)?;
    let width_hz = 1.0 / (segment as f64 * period_s);
    let response = Response::of(&made.sampled.loop_gain)?;
    let noise_density = 2.0 * noise * noise * period_s;
    let mut lines: Vec<[f64; 2]> = Vec::new();
    for (hz, density) in spectra.frequency_hz.iter().zip(&spectra.pyy).skip(1) {
        if *hz > HIGHEST_SHARE * 0.5 / period_s {
            break;
        }
        let loop_gain = response.at(TAU * hz)?[(0, 0)];
        let sensitivity = (C64::ONE + loop_gain).inv();
        let own = (density - noise_density * (loop_gain * sensitivity).norm_sqr()).max(0.0);
        lines.extend(spread([*hz, width_hz], own * width_hz / sensitivity.norm_sqr()));
    }
    Ok(merge_lines(lines))
}

/// Returns the power of a bin of the spectrum on lines that are no further apart than [`SAME_LINE`]: a real spectrum is continuous, and a
/// feedback must not be rewarded for zeros of S at the bins.
fn spread([hz, width_hz]: [f64; 2], power: f64) -> Vec<[f64; 2]> {
    let count = (width_hz / (SAME_LINE * hz)).ceil().clamp(1.0, MOST_LINES) as usize;
    let place = |k: usize| hz + width_hz * ((k as f64 + 0.5) / count as f64 - 0.5);
    (0..count).map(|k| [TAU * place(k), power / count as f64]).collect()
}

/// Lines of a bin at most.
const MOST_LINES: f64 = 16.0;
/// Share of half the sample rate up to which a disturbance has lines: beyond it the hold, not the feedback, decides.
const HIGHEST_SHARE: f64 = 0.5;

fn merge_lines(mut lines: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let total: f64 = lines.iter().map(|line| line[1]).sum();
    let mut beyond = 0.0;
    while let Some(last) = lines.last() {
        beyond += last[1];
        if beyond > LINES_LEFT_OUT * total {
            break;
        }
        lines.pop();
    }
    let mut groups: Vec<Vec<[f64; 2]>> = Vec::new();
    for line in lines.into_iter().filter(|line| line[1] > 0.0) {
        match groups.last_mut() {
            Some(group) if line[0] <= group[0][0] * (1.0 + SAME_LINE) => group.push(line),
            _ => groups.push(vec![line]),
        }
    }
    let one = |group: Vec<[f64; 2]>| {
        let power: f64 = group.iter().map(|line| line[1]).sum();
        [group.iter().map(|line| line[0] * line[1]).sum::<f64>() / power, power]
    };
    groups.into_iter().map(one).collect()
}

/// The figures of a feedback loop as plain data.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LoopMeasuresResult {
    /// Largest |S|.
    pub max_sensitivity: f64,
    /// Largest |T|.
    pub max_complementary: f64,
    /// Gain margin, dB.
    pub gain_margin_db: f64,
    /// Phase margin, degrees.
    pub phase_margin_deg: f64,
    /// Delay margin, s.
    pub delay_margin_s: f64,
    /// Crossover, rad/s.
    pub crossover_rad_s: f64,
    /// RMS control for noise of unit RMS, V s/rad.
    pub noise_gain: f64,
    /// Largest |KS|, V s/rad.
    pub control_peak: f64,
    /// Effort and residual under the disturbance.
    #[serde(flatten)]
    pub disturbed: DisturbedFigures,
    /// Slowest decay of a pole of the closed loop, rad/s.
    pub decay_rad_s: f64,
}

/// What a loop takes and what it leaves under the disturbance for which it is measured. Under a motion the keys are `effort_v` and, in a loop of
/// rate, `residual_rad_s`; over a band, whose disturbance has an RMS of 1, the pure numbers per unit are `effort` (RMS of |KS|) and `residual` (RMS
/// of |S|).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisturbedFigures {
    /// Kind of the disturbance.
    pub objective: TuningObjective,
    /// Quantity that the loop controls.
    pub controlled: ControlledQuantity,
    /// RMS control of the feedback: V under a motion, V per unit of what the loop controls over a band.
    pub effort: f64,
    /// RMS that is left: in the unit of what the loop controls under a motion, a share of 1 over a band.
    pub residual: f64,
}

impl Serialize for DisturbedFigures {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(2))?;
        match self.objective {
            TuningObjective::Motion => {
                map.serialize_entry("effort_v", &self.effort)?;
                map.serialize_entry(&self.controlled.key_of("residual"), &self.residual)?;
            }
            TuningObjective::Band => {
                map.serialize_entry("effort", &self.effort)?;
                map.serialize_entry("residual", &self.residual)?;
            }
        }
        map.end()
    }
}

/// The objective of a tuning and the quantity that its loops control, which decide in which units their figures are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredLoops {
    /// Objective.
    pub objective: TuningObjective,
    /// Quantity that the loops control.
    pub controlled: ControlledQuantity,
}

impl MeasuredLoops {
    fn disturbed_figures(self, effort: f64, residual: f64) -> DisturbedFigures {
        let Self { objective, controlled } = self;
        DisturbedFigures { objective, controlled, effort, residual }
    }
}

impl LoopMeasuresResult {
    /// Returns the figures of the best linear feedback. The bound has no controller: margins, crossover and decay are NaN.
    pub fn of_bound(found: &BestLoop, loops: MeasuredLoops) -> Self {
        Self {
            max_sensitivity: found.max_sensitivity,
            max_complementary: found.max_complementary,
            gain_margin_db: f64::NAN,
            phase_margin_deg: f64::NAN,
            delay_margin_s: f64::NAN,
            crossover_rad_s: f64::NAN,
            noise_gain: found.noise_gain,
            control_peak: found.control_peak,
            disturbed: loops.disturbed_figures(found.effort_v, found.residual_rad_s),
            decay_rad_s: f64::NAN,
        }
    }

    /// Returns the figures of a loop that controls a quantity.
    pub fn of(m: &LoopMeasures, loops: MeasuredLoops) -> Self {
        Self {
            max_sensitivity: m.max_sensitivity,
            max_complementary: m.max_complementary,
            gain_margin_db: m.gain_margin_db,
            phase_margin_deg: m.phase_margin_deg,
            delay_margin_s: m.delay_margin_s,
            crossover_rad_s: m.crossover_rad_s,
            noise_gain: m.noise_gain,
            control_peak: m.control_peak,
            disturbed: loops.disturbed_figures(m.effort_v, m.residual_rad_s),
            decay_rad_s: m.decay_rad_s,
        }
    }
}

/// A tuning as plain data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TuningResult {
    /// Blocks, each with its parameters.
    pub blocks: Vec<BlockResult>,
    /// The weights of a tuned H2 feedback.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub weights: Option<WeightsResult>,
    /// Figures on each plant, the nominal one first.
    pub measures: Vec<LoopMeasuresResult>,
    /// Plants on which the limits were checked.
    pub plants: usize,
    /// By how much the worst limit is missed, relative to it.
    pub missed: f64,
    /// Residual that each start reached; absent if it found no loop within the limits.
    #[serde(flatten)]
    pub starts: UnitValue<Vec<Option<f64>>>,
    /// Loops that were evaluated.
    pub evaluations: usize,
    /// Parameters that ended at an end of their range.
    pub range_ends: Vec<RangeEndResult>,
}

/// A parameter of a block that was tuned to an end of its range.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RangeEndResult {
    /// Number of the block, from 1.
    pub block: usize,
    /// Key of the parameter.
    pub parameter: &'static str,
    /// Lowest and highest value of the range.
    pub range: [f64; 2],
}

/// A block as plain data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BlockResult {
    /// Kind.
    pub kind: &'static str,
    /// Parameters by their keys in a project file.
    pub values: Vec<(&'static str, f64)>,
}

impl From<&Block> for BlockResult {
    fn from(block: &Block) -> Self {
        let names = block.kind.parameters().iter().map(|name| name.key());
        let values = block.parameters.iter().map(|each| each.value.unwrap_or(f64::NAN));
        Self { kind: block.kind.name(), values: names.zip(values).collect() }
    }
}

impl From<&RangeEnd> for RangeEndResult {
    fn from(end: &RangeEnd) -> Self {
        Self { block: end.block + 1, parameter: end.parameter.key(), range: end.range }
    }
}

/// Returns the blocks of a structure as plain data.
pub fn block_results(structure: &FixedStructure) -> Vec<BlockResult> {
    structure.blocks.iter().map(BlockResult::from).collect()
}

/// Tuned weights of the H2 feedback as plain data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WeightsResult {
    /// Weight on the error, as a function of s.
    pub error: String,
    /// Weight on the control, as a function of s.
    pub control: String,
    /// Spectral density of the measurement noise, (rad/s)^2 s.
    pub measurement_noise: f64,
    /// Loop recovery, V^2 s.
    pub loop_recovery: f64,
}

/// Returns tuned weights as plain data; `None` for a structure.
pub fn weights_result(tuned: &TunedFeedback) -> Option<WeightsResult> {
    let TunedFeedback::Weights(weights) = tuned else { return None };
    Some(WeightsResult {
        error: weights.error.to_string(),
        control: weights.control.to_string(),
        measurement_noise: weights.measurement_noise,
        loop_recovery: weights.loop_recovery,
    })
}

impl TuningResult {
    /// Returns the tuning of a loop that controls a quantity.
    pub fn of(found: &TunedProject, controlled: ControlledQuantity) -> Self {
        let tuned = &found.tuned;
        let loops = MeasuredLoops { objective: found.objective, controlled };
        let reached = tuned.starts_rad_s.iter().map(|residual| Some(*residual).filter(|r| r.is_finite()));
        Self {
            blocks: block_results(&tuned.structure()),
            weights: weights_result(&tuned.feedback),
            measures: tuned.measures.iter().map(|m| LoopMeasuresResult::of(m, loops)).collect(),
            plants: found.plants,
            missed: tuned.missed,
            starts: match found.objective {
                TuningObjective::Motion => UnitValue::new("starts", controlled, reached.collect()),
                TuningObjective::Band => UnitValue::pure_number("starts", reached.collect()),
            },
            evaluations: tuned.evaluations,
            range_ends: tuned.range_ends.iter().map(RangeEndResult::from).collect(),
        }
    }
}
