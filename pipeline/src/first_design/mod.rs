//! The weights of a project that states none: the highest bandwidth that the machine allows.
//!
//! `[synth]` may be absent, or hold `bandwidth` alone, or everything but `[synth.feedback]`: then the weights are chosen by
//! [`counterpoise_synth::first_design_on`], from what the project knows of the machine. The chosen weights are ordinary
//! weights: written into the project file, they can be edited from there.

mod tolerance_corners;
mod usual_lags;
mod usual_ranges;

use std::f64::consts::{SQRT_2, TAU};

use counterpoise_linalg::C64;
use counterpoise_lti::StateSpace;
use counterpoise_models::Sensor;
use counterpoise_models::plant::{Angles, FrictionLinearisation, LinearPlant};
use counterpoise_pool::{Pool, Serial};
use counterpoise_project::Project;
use counterpoise_project::resolve::synthesis::{DesignRequest, WeightSource};
use counterpoise_project::resolve::verify::StepSize;
use counterpoise_synth::{
    Circumstances, ControlLimit, DesignFinding, DesignPlant, Error as SynthesisError, ExpectedMotion,
    FirstDesign, LimitKind, LimitLoops, RequiredMargins, Unknown, UsualPlants, Weight, first_design_on,
};
use counterpoise_verify::certificate::elements::rest_impedances;
use counterpoise_verify::{Limit, LoopFigure, PerformanceFigure, Sine, StepFigure};
use serde::Serialize;

use crate::exchange::SystemResult;
use crate::synth::{design_plant, sampling};
use crate::tolerance::{ALLOWS_MORE, MARGINS_TO_SPARE, OVERSHOOT_COST, STEP_THAT_DECIDES};
use crate::{PipelineError, PlantModel, ReducedPlant, build_plant_model, reduce_plant};
pub use usual_ranges::unknown_key;
use usual_ranges::{BothPlants, OpenValues};

/// A project whose weights were chosen.
#[derive(Debug, Clone)]
pub struct ChosenWeights {
    /// The project with the weights stated.
    pub project: Project,
    /// Why they are what they are.
    pub first: FirstDesign,
}

/// Returns the project with its weights chosen; `None` if it states them.
///
/// # Errors
/// Those of the plant; [`PipelineError::NoController`] if no bandwidth keeps the margins.
pub fn with_chosen_weights(project: &Project) -> Result<Option<ChosenWeights>, PipelineError> {
    with_chosen_weights_on(project, &Serial)
}

/// Returns what [`with_chosen_weights`] does, with candidates judged side by side on the processors of a pool.
///
/// # Errors
/// As [`with_chosen_weights`].
pub fn with_chosen_weights_on(
    project: &Project,
    pool: &dyn Pool,
) -> Result<Option<ChosenWeights>, PipelineError> {
    if !leaves_weights_open(project) {
        return Ok(None);
    }
    let modelled = build_plant_model(project)?;
    let reduced = reduce_plant(project, &modelled)?;
    choose_weights_on(project, &modelled, &reduced, pool).map(Some)
}

/// Returns whether the weights of a project are to be chosen, because its file states none.
pub fn leaves_weights_open(project: &Project) -> bool {
    project.synth.as_ref().is_none_or(|asked| asked.weights == WeightSource::Chosen)
}

/// Returns the project with newly chosen weights, whether it states weights or not: the start for a new machine.
///
/// # Errors
/// As [`with_chosen_weights`].
pub fn choose_weights(
    project: &Project,
    modelled: &PlantModel,
    reduced: &ReducedPlant,
) -> Result<ChosenWeights, PipelineError> {
    choose_weights_on(project, modelled, reduced, &Serial)
}

fn choose_weights_on(
    project: &Project,
    modelled: &PlantModel,
    reduced: &ReducedPlant,
    pool: &dyn Pool,
) -> Result<ChosenWeights, PipelineError> {
    let asked = project.synth.clone().unwrap_or_default();
    let stated_step = circumstances(project, &asked, modelled, reduced)?;
    let open_step = Circumstances { demand_step: 0.0, ..stated_step.clone() };
    let usual_step = stated_step.demand_step;
    let (first, step) = match first_design_of(&stated_step, pool) {
        Ok(found) if is_limited_by_usual_step(project, &found) => {
            with_open_step(&open_step, usual_step, Some(found), pool)?
        }
        Err(SynthesisError::Refused(_)) if has_usual_step(project) => {
            with_open_step(&open_step, usual_step, None, pool)?
        }
        found => (found?, None),
    };
    let first = match has_usual_step(project) {
        true => with_lifted_step(first, &open_step, pool)?,
        false => first,
    };
    let mut stated = asked.clone();
    let chosen = &first.specification;
    stated.specification.feedback = chosen.feedback.clone();
    stated.specification.position_gain = chosen.position_gain;
    stated.specification.heave = asked.specification.heave.or_else(|| chosen.heave.clone());
    stated.specification.pitch = asked.specification.pitch.or_else(|| chosen.pitch.clone());
    (stated.weights, stated.bandwidth_rad_s) = (WeightSource::Found, None);
    let mut project = Project { synth: Some(stated), ..project.clone() };
    if let (Some(verify), Some(step)) = (&mut project.verify, step) {
        (verify.procedure.step.rate_rad_s, verify.step_size) = (step, StepSize::Stated);
    }
    Ok(ChosenWeights { project, first })
}

/// Returns the first design, whose loop overshoots no more than is required, unless that costs more than [`OVERSHOOT_COST`] of the bandwidth: a loop of
/// position that has two integrals overshoots at any bandwidth, and a loop so slow that it does not is of no use.
fn first_design_of(given: &Circumstances, pool: &dyn Pool) -> Result<FirstDesign, SynthesisError> {
    let held = design_that_holds(given, pool);
    if given.margins.overshoot.is_infinite() {
        return held;
    }
    let margins = RequiredMargins { overshoot: f64::INFINITY, ..given.margins };
    let free = design_that_holds(&Circumstances { margins, ..given.clone() }, pool)?;
    let least = OVERSHOOT_COST * free.bandwidth.bandwidth_rad_s;
    match held {
        Ok(held) if held.bandwidth.bandwidth_rad_s >= least => Ok(held),
        Ok(_) | Err(SynthesisError::Refused(_)) => Ok(free),
        error => error,
    }
}

/// Returns the first design, whose loop holds what the file leaves open over its usual range, and the friction at rest, unless no loop does.
fn design_that_holds(given: &Circumstances, pool: &dyn Pool) -> Result<FirstDesign, SynthesisError> {
    match first_design_on(given, pool) {
        Err(SynthesisError::Refused(_)) if !given.usual.is_empty() => {
            design_that_holds(&Circumstances { usual: UsualPlants::default(), ..given.clone() }, pool)
        }
        Err(SynthesisError::Refused(_)) if given.others.len() > 1 => {
            let others = given.others.iter().take(1).cloned().collect();
            first_design_on(&Circumstances { others, ..given.clone() }, pool)
        }
        found => found,
    }
}

/// Returns a first design that is as slow as is asked for, with the bandwidth that it would have otherwise, without a step of the demand that nobody stated.
fn with_lifted_step(
    found: FirstDesign,
    open: &Circumstances,
    pool: &dyn Pool,
) -> Result<FirstDesign, PipelineError> {
    let mut found = found;
    if found.bandwidth.limited_by != [LimitKind::Asked] || found.bandwidth.unknown.contains(&Unknown::Demand)
    {
        return Ok(found);
    }
    let free = match first_design_of(&Circumstances { asked_rad_s: None, ..open.clone() }, pool) {
        Err(SynthesisError::Refused(_)) => return Ok(found),
        free => free?,
    };
    let rate_rad_s = free.bandwidth.bandwidth_rad_s;
    let rows = found.bandwidth.limits.iter_mut().zip(&mut found.shown_by);
    for (limit, loops) in rows.filter(|(limit, _)| limit.kind == LimitKind::Asked) {
        if limit.lifted_rad_s.is_none_or(|lifted| lifted < rate_rad_s) {
            limit.lifted_rad_s = Some(rate_rad_s);
            loops.lifted = free.loops.first().cloned();
        }
    }
    Ok(found)
}

/// Returns whether a first design may be as slow as it is because of a step of the demand that nobody stated: the step takes most of the control.
fn is_limited_by_usual_step(project: &Project, first: &FirstDesign) -> bool {
    let control = first.bandwidth.limits.iter().find(|limit| limit.kind == LimitKind::Control);
    let takes_most = control.and_then(|limit| limit.used).is_some_and(|used| used > STEP_THAT_DECIDES);
    let is_named = first.bandwidth.limited_by.contains(&LimitKind::Control);
    has_usual_step(project) && (is_named || takes_most)
}

/// Returns whether nobody stated the step of the demand.
fn has_usual_step(project: &Project) -> bool {
    project.verify.as_ref().is_some_and(|verify| verify.step_size == StepSize::Usual)
}

/// Returns the first design to which no step of the demand is known, which lowers its ceiling, and the step that it takes within the
/// control's limit, which stands out of the readings' noise and resolution; the one with the usual step if there is one that is no slower.
fn with_open_step(
    open: &Circumstances,
    usual_step: f64,
    with_usual_step: Option<FirstDesign>,
    pool: &dyn Pool,
) -> Result<(FirstDesign, Option<f64>), PipelineError> {
    let first = first_design_of(open, pool)?;
    let is_no_quicker =
        |usual: &FirstDesign| first.bandwidth.bandwidth_rad_s <= usual.bandwidth.bandwidth_rad_s;
    if let Some(usual) = with_usual_step.filter(is_no_quicker) {
        return Ok((usual, None));
    }
    let largest = (open.sampling.limit_v - open.holding_v.abs()) / first.judgement.step_gain;
    let visible = SEEN_STEPS * open.reading_step.max(open.noise_rms);
    Ok((first, round_down(largest.max(visible).min(usual_step))))
}

/// Returns the largest of 1, 2 and 5 times a power of ten that is no more than a number; `None` if the number is not above 0.
fn round_down(number: f64) -> Option<f64> {
    if !(number > 0.0 && number.is_finite()) {
        return None;
    }
    let power = number.log10().floor() as i32;
    let nearby = (power - 1..=power + 1).flat_map(|power| [1.0, 2.0, 5.0].map(|digit| (digit, power)));
    let steps = nearby.filter_map(|(digit, power)| format!("{digit}e{power}").parse::<f64>().ok());
    steps.filter(|step| *step <= number).reduce(f64::max)
}

fn circumstances(
    project: &Project,
    asked: &DesignRequest,
    modelled: &PlantModel,
    reduced: &ReducedPlant,
) -> Result<Circumstances, PipelineError> {
    let p = &modelled.parameters;
    let plant = design_plant(asked, modelled, reduced)?;
    let open = OpenValues::of(project);
    let with_angles = with_angles(project, modelled, &plant)?;
    let nominal = BothPlants { as_designed: plant, with_angles };
    let usual = open.usual_plants(project, asked, &nominal)?;
    let BothPlants { as_designed: plant, with_angles: nominal } = nominal;
    let reading = &p.sensors.hub_gyro;
    let motions = project.verify.as_ref().map(|asked| &asked.procedure);
    // A feedforward acts on the load's rate, which a loop of torque or current does not hold.
    let opposed = motions.filter(|_| !p.sensors.measured.is_effort());
    let mut others = plants_beside(modelled, &plant, nominal)?;
    others.extend(usual_ranges::plants_at_small_motions(project, asked).map(|plants| plants.with_angles));
    Ok(Circumstances {
        usual,
        others,
        within_tolerances: tolerance_corners::plants_within_tolerances(project, asked, reduced)?,
        usual_reading: open.usual_reading(p),
        known_absent: open.known_absent(),
        load_output: Some(load_output(&plant)),
        sampling: sampling(asked, modelled)?,
        control_limit: match p.amplifier.has_limit() {
            true => ControlLimit::OfDrive,
            false => ControlLimit::OfConverter,
        },
        noise_rms: reading.noise_rms,
        reading_step: open.known_step(p),
        holding_v: modelled.linear.equilibrium.control_v,
        demand_step: motions.map_or(0.0, |procedure| procedure.step.rate_rad_s),
        margins: margins(project),
        may_stiffen_modes: asked.may_stiffen_modes(),
        position_gain: asked.specification.position_gain,
        asked_rad_s: asked_bandwidth(project, asked),
        heave: opposed.and_then(|m| motion(&m.heave, &p.sensors.platform_accelerometer, modelled)),
        pitch: opposed.and_then(|m| motion(&m.pitch, &p.sensors.platform_gyro, modelled)),
        plant,
    })
}

/// Returns the output that is the load's motion where the sensor measures something else: that of the hub, or of the tip where the hub's own is
/// measured.
fn load_output(plant: &DesignPlant) -> usize {
    match plant.weighted_plant().rate {
        LinearPlant::HUB_RATE => LinearPlant::TIP_RATE,
        _ => LinearPlant::HUB_RATE,
    }
}

/// Returns the plant with gravity's gradient, and with dry friction at rest if there is any.
fn plants_beside(
    modelled: &PlantModel,
    plant: &DesignPlant,
    with_gravity: DesignPlant,
) -> Result<Vec<DesignPlant>, PipelineError> {
    let mut beside = vec![with_gravity];
    if modelled.parameters.has_dry_friction() {
        let [motor, pivot] = rest_impedances(&modelled.plant)?;
        let at_rest = FrictionLinearisation::Impedances { motor, pivot };
        beside.push(with_angles_and_friction(modelled, plant, at_rest)?);
    }
    Ok(beside)
}

/// Returns the plant with the hub's angles among its states: gravity's gradient, the spring and their
/// instability act.
pub(crate) fn with_angles(
    project: &Project,
    modelled: &PlantModel,
    plant: &DesignPlant,
) -> Result<DesignPlant, PipelineError> {
    with_angles_and_friction(modelled, plant, project.model.friction)
}

fn with_angles_and_friction(
    modelled: &PlantModel,
    plant: &DesignPlant,
    friction: FrictionLinearisation,
) -> Result<DesignPlant, PipelineError> {
    let angles = match modelled.plant.angles() {
        Angles::Position => Angles::Position,
        _ => Angles::Keep,
    };
    let whole = modelled.plant.linearise(&modelled.linear.equilibrium, friction, angles)?;
    Ok(DesignPlant { system: whole.system, rate: whole.measured, ..plant.clone() })
}

/// Returns the usual margins, or those that the project requires if they are larger, with [`MARGINS_TO_SPARE`] to spare.
fn margins(project: &Project) -> RequiredMargins {
    let mut margins = RequiredMargins::default();
    let requirements = project.verify.iter().flat_map(|asked| &asked.requirements);
    for requirement in requirements {
        match (requirement.figure, requirement.limit) {
            (PerformanceFigure::Loop(LoopFigure::GainMargin), Limit::AtLeast(db)) => {
                margins.gain_db = margins.gain_db.max(db + MARGINS_TO_SPARE * db.abs());
            }
            (PerformanceFigure::Loop(LoopFigure::PhaseMargin), Limit::AtLeast(deg)) => {
                margins.phase_deg = margins.phase_deg.max(deg + MARGINS_TO_SPARE * deg.abs());
            }
            (PerformanceFigure::Loop(LoopFigure::MaxSensitivity), Limit::AtMost(ms)) => {
                margins.max_sensitivity =
                    margins.max_sensitivity.min(1.0 + (ms - 1.0) * (1.0 - MARGINS_TO_SPARE));
            }
            (PerformanceFigure::Loop(LoopFigure::MaxComplementary), Limit::AtMost(mt)) => {
                margins.max_complementary =
                    margins.max_complementary.min(mt - MARGINS_TO_SPARE * (mt - 1.0).max(0.0));
            }
            (PerformanceFigure::Step(_, StepFigure::Overshoot), Limit::AtMost(percent)) => {
                margins.overshoot = margins.overshoot.min(0.01 * (1.0 - MARGINS_TO_SPARE) * percent);
            }
            (PerformanceFigure::Loop(LoopFigure::DiskMargin), Limit::AtLeast(radius)) => {
                margins.disk = margins.disk.max((1.0 + MARGINS_TO_SPARE) * radius);
            }
            (PerformanceFigure::Loop(LoopFigure::DelayMargin), Limit::AtLeast(seconds)) => {
                margins.delay_s = margins.delay_s.max((1.0 + MARGINS_TO_SPARE) * seconds);
            }
            _ => {}
        }
    }
    margins
}

/// Returns the highest bandwidth that is asked for: by a key of its own, or by a requirement on the crossover, below which the gain first falls to 1.
fn asked_bandwidth(project: &Project, asked: &DesignRequest) -> Option<f64> {
    let requirements = project.verify.iter().flat_map(|asked| &asked.requirements);
    let crossovers = requirements.filter_map(|requirement| match (requirement.figure, requirement.limit) {
        (PerformanceFigure::Loop(LoopFigure::Crossover), Limit::AtMost(hz)) => Some(TAU * hz),
        _ => None,
    });
    asked.bandwidth_rad_s.into_iter().chain(crossovers).reduce(f64::min)
}

/// Returns a sine that the project expects as a spectrum of the same RMS up to twice its frequency; `None` if no sensor
/// reads it or it does not move.
fn motion(expected: &Sine, sensor: &Sensor, modelled: &PlantModel) -> Option<ExpectedMotion> {
    let (amplitude, period_s) = (expected.amplitude.abs(), modelled.parameters.interface.sample_period_s);
    if sensor.gain == 0.0 || amplitude == 0.0 || expected.frequency_hz <= 0.0 {
        return None;
    }
    let natural = round_digits(2.0 * TAU * expected.frequency_hz);
    // White noise of unit density through K w^2 / (s^2 + 2 z w s + w^2) has the mean square K^2 w / (4 z).
    let gain = round_digits(amplitude / SQRT_2 * (4.0 * GENERATOR_DAMPING / natural).sqrt());
    let height = natural * (1.0 - GENERATOR_DAMPING * GENERATOR_DAMPING).sqrt();
    let pole = C64::new(-GENERATOR_DAMPING * natural, height);
    let generator = Weight::ZeroPoleGain {
        zeros: Vec::new(),
        poles: vec![pole, pole.conj()],
        gain: gain * natural * natural,
    };
    let noise_rms = if sensor.noise_rms > 0.0 { sensor.noise_rms } else { UNKNOWN_NOISE * amplitude };
    Some(ExpectedMotion { generator, noise: noise_rms * noise_rms * period_s })
}

/// Four significant digits, as a person would write them.
fn round_digits(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Resolutions or RMS noises of the reading that a step of the demand is at least.
const SEEN_STEPS: f64 = 10.0;
/// Damping ratio of the spectrum of an expected motion: level up to its corner, without a peak.
const GENERATOR_DAMPING: f64 = 0.7;
/// Noise of a base sensor that states none, over the amplitude that it reads: a sensor of ten bits.
const UNKNOWN_NOISE: f64 = 1e-3;

/// A first design as plain data.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstDesignResult {
    /// Bandwidth that was reached (lowest frequency at which the loop's gain falls to 1), rad/s.
    pub bandwidth_rad_s: f64,
    /// Bandwidth that was asked for, rad/s.
    pub asked_rad_s: Option<f64>,
    /// The limits of it: what raises the bandwidth most when it alone is lifted, or, if none does, those of which the loop uses up nearly all.
    pub limited_by: Vec<LimitKind>,
    /// Every limit with the highest bandwidth that it alone would allow, and the bandwidth without it.
    pub limits: Vec<LimitRow>,
    /// The margins that the loop had to keep.
    pub required: RequiredMarginsResult,
    /// Sample period of the controller, s.
    pub sample_period_s: f64,
    /// The unknown values that lowered the ceiling.
    pub unknown: Vec<Unknown>,
    /// Gain margin, dB.
    pub gain_margin_db: f64,
    /// Phase margin, degrees.
    pub phase_margin_deg: f64,
    /// Largest sensitivity.
    pub max_sensitivity: f64,
    /// Largest sensitivity with every lightly damped mode off by 15 %.
    pub max_sensitivity_modes_shifted: f64,
    /// The sampled loops that were judged, broken at the control: that of the plant, then those of the plants with shifted modes.
    pub loops: Vec<SystemResult>,
    /// Feedforwards that could not be had, with the reason.
    pub left_out: Vec<DesignFinding>,
}

/// Margins that a loop must keep.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RequiredMarginsResult {
    /// Smallest gain margin either way, dB.
    pub gain_margin_db: f64,
    /// Smallest phase margin, degrees.
    pub phase_margin_deg: f64,
    /// Largest sensitivity.
    pub max_sensitivity: f64,
}

/// A limit of the bandwidth: its kind, or the name of it, which a result file has.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LimitRow<Limit = LimitKind> {
    /// The limit.
    pub limit: Limit,
    /// The highest bandwidth that it alone would allow, rad/s; absent if it allows every one that was looked at.
    pub bandwidth_rad_s: Option<f64>,
    /// That over the bandwidth that was reached.
    pub over_reached: Option<f64>,
    /// The share of what the limit allows that the chosen loop uses up: of the margin, sensitivity or control that comes nearest; absent if that is not known.
    pub used: Option<f64>,
    /// The bandwidth if this limit alone were lifted, rad/s; absent if it would be no higher.
    pub lifted_rad_s: Option<f64>,
    /// The sampled loop, broken at the control, that has the highest bandwidth with the limit kept; absent if a formula tells it.
    pub shown_by: Option<SystemResult>,
    /// The sampled loop that has the bandwidth with the limit lifted; absent if it would be no higher.
    pub lifted_shown_by: Option<SystemResult>,
}

impl LimitRow {
    /// Returns whether the limit alone allows more than is reached, and yet is one that raises the bandwidth if it is lifted.
    pub fn allows_more(&self) -> bool {
        self.lifted_rad_s.is_some() && self.over_reached.is_some_and(|over| over > ALLOWS_MORE)
    }

    /// Returns the row with the name of its limit.
    pub fn name_limit<Name>(&self, name: impl Fn(LimitKind) -> Name) -> LimitRow<Name> {
        LimitRow {
            limit: name(self.limit),
            bandwidth_rad_s: self.bandwidth_rad_s,
            over_reached: self.over_reached,
            used: self.used,
            lifted_rad_s: self.lifted_rad_s,
            shown_by: self.shown_by.clone(),
            lifted_shown_by: self.lifted_shown_by.clone(),
        }
    }
}

impl FirstDesignResult {
    /// Returns the bandwidth that was asked for, if it is missed by more than rounding.
    pub fn missed_rad_s(&self) -> Option<f64> {
        let is_met = self.limited_by.contains(&LimitKind::Asked);
        self.asked_rad_s.filter(|asked| !is_met && *asked > self.bandwidth_rad_s)
    }

    /// Returns the bandwidth without a limit over that which was reached; `None` if lifting the limit alone raises nothing.
    pub fn gain_of_lifting(&self, limit: &LimitRow) -> Option<f64> {
        Some(limit.lifted_rad_s? / self.bandwidth_rad_s)
    }
}

impl From<&FirstDesign> for FirstDesignResult {
    fn from(first: &FirstDesign) -> Self {
        let (found, judged) = (&first.bandwidth, &first.judgement);
        let row = |(limit, loops): (&counterpoise_synth::BandwidthLimit, &LimitLoops)| {
            let told = |system: &StateSpace| {
                SystemResult::new("loop", system, &["control_v"], &["returned_control_v"])
            };
            let bandwidth_rad_s = Some(limit.bandwidth_rad_s).filter(|rate| rate.is_finite());
            let over_reached = bandwidth_rad_s.map(|rate| rate / found.bandwidth_rad_s);
            let lifted_rad_s = limit.lifted_rad_s;
            LimitRow {
                limit: limit.kind,
                bandwidth_rad_s,
                over_reached,
                used: limit.used.filter(|used| used.is_finite()),
                lifted_rad_s,
                shown_by: loops.allowed.as_ref().map(told),
                lifted_shown_by: loops.lifted.as_ref().map(told),
            }
        };
        Self {
            bandwidth_rad_s: found.bandwidth_rad_s,
            asked_rad_s: found.asked_rad_s,
            limited_by: found.limited_by.clone(),
            limits: found.limits.iter().zip(&first.shown_by).map(row).collect(),
            required: RequiredMarginsResult {
                gain_margin_db: first.required.gain_db,
                phase_margin_deg: first.required.phase_deg,
                max_sensitivity: first.required.max_sensitivity,
            },
            sample_period_s: first.sample_period_s,
            unknown: found.unknown.clone(),
            gain_margin_db: judged.gain_margin_db,
            phase_margin_deg: judged.phase_margin_deg,
            max_sensitivity: judged.max_sensitivity,
            max_sensitivity_modes_shifted: judged.shifted_sensitivity,
            loops: first
                .loops
                .iter()
                .map(|system| SystemResult::new("loop", system, &["control_v"], &["returned_control_v"]))
                .collect(),
            left_out: first.left_out.clone(),
        }
    }
}
