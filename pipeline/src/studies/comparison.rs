//! A design compared: other methods with the same figures, what a lower order costs, the tip beside the hub, other states of
//! balance, and a plant with modes that the design neglects.

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{StateSpace, Timebase, feedback, poles, series};
use counterpoise_models::plant::LinearPlant;
use counterpoise_synth::alternatives::generalised_plant;
use counterpoise_synth::{
    Alternative, Design, DesignFinding, DesignPlant, DisturbanceChannel, FeedbackWeights, Figures,
    JointOptimum, LightModes, Part, Reference, Refusal, ResidualChoice, SampledLoop, ScheduleEntry,
    SourceCost, SynthesisMethod, Weight, attempt, check_sampled_loop, design_alternative, discretise,
    error_at, figure_systems, sampled_loop_figures, total_cost,
};
use serde::Serialize;

use super::cost_basis::{CostBasis, cost_basis, feedback_basis};
use super::tuned_pi::TunedPiRow;
use crate::exchange::systems::controllers_of_design;
use crate::exchange::{DesignSignals, SystemResult, TransferFunctionResult};
use crate::synth::design_plant;
use crate::synth::schedule::{BalanceRow, balance_rows};
use crate::tolerance::DRIFTING_POLE;
use crate::{PipelineError, PlantModel, SynthesisedDesign, build_plant_model, finite_elements_of};
use counterpoise_project::Project;
use counterpoise_project::file::NamedChoice;
use counterpoise_project::resolve::synthesis::DesignRequest;

/// A design compared with its alternatives.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignComparison {
    /// The feedback as built, and further methods.
    pub methods: Vec<MethodRow>,
    /// Cost of a lower order of the feedback.
    pub lowered: Option<LoweredRow>,
    /// Hub and tip under each expected disturbance.
    pub motions: Vec<MotionRow>,
    /// States of balance.
    pub balance: Vec<BalanceRow>,
    /// Data from which they are computed, row by row.
    pub balance_basis: Vec<BalanceBasis>,
    /// The loop on the structure with the modes that the design does not know.
    pub spillover: Option<Spillover>,
    /// Cost of the assembled loop, all parts acting together; absent if another method made the feedback.
    pub total_cost: Option<TotalCostResult>,
    /// A PI with a lag, tuned under the design's own limits; absent if the weights were chosen or tuned.
    pub tuned_pi: Option<TunedPiRow>,
}

/// A state of balance: its own design, and the nominal one on its plant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BalanceBasis {
    /// Feedback and feedforwards that were designed for it, in continuous time.
    pub controllers: Vec<SystemResult>,
    /// The nominal design on its plant.
    pub nominal: CostBasis,
    /// Own design.
    pub redesign: CostBasis,
}

/// The cost of the assembled loop, each source of disturbance under its own part's weights.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TotalCostResult<Source = CostSource> {
    /// The sum over the parts.
    pub total: f64,
    /// Feedback first.
    pub parts: Vec<PartCostRow<Source>>,
    /// Data from which the cost and the motions are computed; absent for one joint problem.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub basis: Option<CostBasis>,
}

/// The part of a loop to which a share of its cost belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CostSource {
    /// A part of the design with its own disturbances.
    Part(Part),
    /// The gain from the hub's sensor, in a joint design.
    HubSensor,
    /// The gain from the sensor of a disturbance, in a joint design.
    DisturbanceSensor(DisturbanceChannel),
}

/// The cost of one part's disturbances in the assembled loop.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartCostRow<Source = CostSource> {
    /// The part, or its name.
    pub part: Source,
    /// Mean square of its weighted signals.
    pub cost: f64,
    /// Relative change of the total for a relative change of the part's gain.
    pub slope: f64,
    /// The gain that makes the total smallest, the other parts kept.
    pub best_gain: Option<f64>,
    /// By how much that lowers the total, %.
    pub gained_percent: Option<f64>,
}

impl TotalCostResult {
    /// Returns the result with the name of each part.
    pub fn name_parts<Name>(&self, name: impl Fn(CostSource) -> Name) -> TotalCostResult<Name> {
        let row = |row: &PartCostRow| PartCostRow {
            part: name(row.part),
            cost: row.cost,
            slope: row.slope,
            best_gain: row.best_gain,
            gained_percent: row.gained_percent,
        };
        TotalCostResult {
            total: self.total,
            parts: self.parts.iter().map(row).collect(),
            basis: self.basis.clone(),
        }
    }
}

/// The feedback of one method with its figures. Why there is no controller are findings, or a sentence about them, which a result file has.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodRow<Reason = Vec<DesignFinding>> {
    /// Method.
    pub method: String,
    /// `true` if the error weight integrates.
    pub integral: bool,
    /// States of the feedback.
    pub order: usize,
    /// Norm that it reached.
    pub norm: Option<f64>,
    /// Figures of the sampled loop; `None` if there is no controller.
    pub figures: Option<LoopFigures>,
    /// The systems that these figures are measured on: the loop broken at the control, the plant from the held control, the controller.
    pub systems: Vec<SystemResult>,
    /// Why there is none.
    pub why: Option<Reason>,
    /// Data from which order and norm are computed; absent if there is no controller, or for a fixed structure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub problem: Option<MethodProblem>,
}

impl MethodRow {
    /// Returns the row with what `describe` says of the reason.
    pub fn map_reason<Said>(&self, describe: impl Fn(&[DesignFinding]) -> Said) -> MethodRow<Said> {
        MethodRow {
            method: self.method.clone(),
            integral: self.integral,
            order: self.order,
            norm: self.norm,
            figures: self.figures,
            systems: self.systems.clone(),
            why: self.why.as_deref().map(describe),
            problem: self.problem.clone(),
        }
    }
}

/// The continuous problem that a method solved, with its answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodProblem {
    /// The feedback from demand and measured rate to the control.
    pub feedback: SystemResult,
    /// The error weight.
    pub error_weight: TransferFunctionResult,
    /// The control weight.
    pub control_weight: TransferFunctionResult,
    /// The textbook's plant from (noises, weighted control) to (weighted error, weighted control, error), if the method solves it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub generalised: Option<SystemResult>,
    /// Controller from the error to the weighted control: the norm is that of the loop of these two.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on_generalised: Option<SystemResult>,
    /// Data of the cost of the three-part feedback: the norm is its root.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub basis: Option<CostBasis>,
}

/// Figures of a sampled loop.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LoopFigures {
    /// Gain margin, dB.
    pub gain_margin_db: f64,
    /// Phase margin, degrees.
    pub phase_margin_deg: f64,
    /// Largest sensitivity.
    pub max_sensitivity: f64,
    /// Crossover, rad/s.
    pub crossover_rad_s: f64,
    /// Overshoot of a step, %.
    pub overshoot_percent: f64,
    /// RMS of |S| over 0.2 to 2 Hz.
    pub rejection: f64,
    /// RMS control for unit noise, V s/rad.
    pub noise_gain: f64,
}

/// Cost of a lower order of the feedback.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LoweredRow {
    /// States before and after.
    pub order: [usize; 2],
    /// Largest change of the complementary sensitivity.
    pub loop_change: f64,
    /// Figures before.
    pub before: LoopFigures,
    /// Figures after.
    pub after: LoopFigures,
    /// The systems that the figures before are measured on, and those after, as in a row of a method.
    pub systems: [Vec<SystemResult>; 2],
    /// The closed loop in continuous time from the demand to the measured rate, before and after.
    pub closed_loops: [SystemResult; 2],
}

/// RMS rates under an expected disturbance, rad/s.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MotionRow {
    /// Disturbance.
    pub disturbance: &'static str,
    /// Hub with feedback alone, and with the feedforward.
    pub hub_rad_s: [f64; 2],
    /// Tip with feedback alone, and with the feedforward.
    pub tip_rad_s: [f64; 2],
}

/// The loop on the structure with more modes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spillover {
    /// Modes of the structure.
    pub modes: usize,
    /// Order of that plant.
    pub order: usize,
    /// Largest modulus of the loop's poles there.
    pub largest_pole: f64,
    /// These poles, in the z-plane; empty if the loop is not stable.
    pub poles: Vec<[f64; 2]>,
    /// The sampled loop there, broken at the control; absent if it is not stable.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sampled_loop: Option<SystemResult>,
}

/// Band over which |S| is averaged, rad/s: 0.2 to 2 Hz.
const BAND_RAD_S: [f64; 2] = [1.26, 12.6];
/// Corner to which poles of an error weight on the axis go in the variant without integral action, rad/s.
const CORNER_RAD_S: f64 = 0.5;
/// Flexible modes of the structure on which spillover is looked for, at most: more than a beam of 24 elements has.
const MODES: usize = 60;

/// Compares a design with other methods, a lower order, other states of balance, and a plant with more modes.
///
/// # Errors
/// Those of the plant and the design.
pub fn compare_designs(
    project: &Project,
    modelled: &PlantModel,
    made: &SynthesisedDesign,
    tuned_pi: Option<&TunedPiRow>,
) -> Result<DesignComparison, PipelineError> {
    let missing = PipelineError::Missing { section: "synth", needed_by: "the design" };
    let asked = project.synth.as_ref().ok_or(missing)?;
    Ok(DesignComparison {
        methods: methods(asked, made)?,
        lowered: lowered_row(made)?,
        motions: motions(&made.design)?,
        balance: balance_rows(&made.balance),
        balance_basis: balance_basis(&made.balance, signals_of(made))?,
        spillover: spillover(project, asked, modelled, made)?,
        total_cost: cost_of(made)?,
        tuned_pi: tuned_pi.cloned(),
    })
}

fn signals_of(made: &SynthesisedDesign) -> DesignSignals<'_> {
    DesignSignals { controlled: made.controlled, outputs: &made.output_names }
}

fn balance_basis(
    entries: &[ScheduleEntry],
    signals: DesignSignals,
) -> Result<Vec<BalanceBasis>, PipelineError> {
    let Some(base) = entries.first().map(|entry| &entry.design) else { return Ok(Vec::new()) };
    let basis = |entry: &ScheduleEntry| {
        let design = &entry.design;
        Ok(BalanceBasis {
            controllers: controllers_of_design(design, signals.controlled)
                .into_iter()
                .map(|controller| controller.result)
                .collect(),
            nominal: cost_basis(&Design { plant: design.plant.clone(), ..base.clone() }, signals)?,
            redesign: cost_basis(design, signals)?,
        })
    };
    entries.iter().map(basis).collect()
}

fn cost_of(made: &SynthesisedDesign) -> Result<Option<TotalCostResult>, PipelineError> {
    if made.design.substitute.is_some() {
        return Ok(None);
    }
    if let Some(joint) = &made.design.joint {
        return Ok(joint.cost.achieved.map(|total| joint_result(joint, total)));
    }
    let found = total_cost(&made.design)?;
    let row = |source: &SourceCost| PartCostRow {
        part: CostSource::Part(source.part),
        cost: source.cost,
        slope: source.slope,
        best_gain: source.best_gain,
        gained_percent: source.gained.map(|share| 100.0 * share),
    };
    let basis = Some(cost_basis(&made.design, signals_of(made))?);
    Ok(Some(TotalCostResult { total: found.total, parts: found.sources.iter().map(row).collect(), basis }))
}

/// Returns the cost of a joint design. It has one cost for all paths; its parts are the gains from its sensors.
fn joint_result(joint: &JointOptimum, total: f64) -> TotalCostResult {
    let channels = joint.channels.iter().map(|channel| CostSource::DisturbanceSensor(*channel));
    let sensors = std::iter::once(CostSource::HubSensor).chain(channels);
    let row = |(part, slope): (CostSource, &f64)| PartCostRow {
        part,
        cost: total,
        slope: *slope,
        best_gain: None,
        gained_percent: None,
    };
    TotalCostResult { total, parts: sensors.zip(&joint.slopes).map(row).collect(), basis: None }
}

/// Figures of a sampled loop with the systems that they are measured on.
struct MeasuredLoop {
    figures: LoopFigures,
    systems: Vec<SystemResult>,
}

fn measured_loop(made: &SynthesisedDesign, sampled: &SampledLoop) -> Result<MeasuredLoop, PipelineError> {
    let on = figure_systems(&made.design.plant, sampled, &made.sampling)?;
    let systems = vec![
        SystemResult::new("loop", &on.broken, &["control_v"], &["returned_control_v"]),
        SystemResult::new(
            "held_plant",
            &on.plant,
            &["control_v"],
            &["measured_rate_rad_s", "hub_rate_rad_s"],
        ),
        SystemResult::new(
            "controller",
            &on.controller,
            &["demand_rad_s", "measured_rate_rad_s"],
            &["control_v"],
        ),
    ];
    let systems = systems.into_iter().map(|system| system.of_loop(made.controlled)).collect();
    Ok(MeasuredLoop { figures: loop_figures(made, sampled)?, systems })
}

fn loop_figures(made: &SynthesisedDesign, sampled: &SampledLoop) -> Result<LoopFigures, PipelineError> {
    let found: Figures = sampled_loop_figures(&made.design.plant, sampled, &made.sampling, BAND_RAD_S)?;
    Ok(LoopFigures {
        gain_margin_db: found.gain_margin_db,
        phase_margin_deg: found.phase_margin_deg,
        max_sensitivity: found.ms,
        crossover_rad_s: found.crossover_rad_s,
        overshoot_percent: 100.0 * found.overshoot,
        rejection: found.rejection,
        noise_gain: found.noise_gain,
    })
}

/// Returns the figures of the design with another feedback.
fn with_feedback(
    made: &SynthesisedDesign,
    controller: &StateSpace,
) -> Result<Result<MeasuredLoop, Refusal>, PipelineError> {
    let mut design =
        Design { substitute: Some(controller.clone()), heave: None, pitch: None, ..made.design.clone() };
    design.specification.reference = Reference::Error;
    Ok(match attempt(discretise(&design, &made.sampling))? {
        Ok(sampled) => Ok(measured_loop(made, &sampled)?),
        Err(refusal) => Err(refusal),
    })
}

/// Returns the feedback as built; with alternatives, each of them with the error weight and with that without integral
/// action.
fn methods(asked: &DesignRequest, made: &SynthesisedDesign) -> Result<Vec<MethodRow>, PipelineError> {
    let mut rows = vec![as_built(asked, made)?];
    if asked.options.alternatives.is_empty() {
        return Ok(rows);
    }
    let mut all = vec![asked.options.method];
    all.extend(asked.options.alternatives.iter().filter(|method| **method != asked.options.method));
    let weights = &asked.specification.feedback;
    let level = without_integral(&weights.error);
    let integrates = level != weights.error;
    for (variant, error) in [&weights.error, &level].into_iter().enumerate().take(1 + usize::from(integrates))
    {
        let weights = FeedbackWeights { error: error.clone(), ..weights.clone() };
        for &method in all.iter().skip(usize::from(variant == 0)) {
            let answer = attempt(design_alternative(&made.design.plant, &weights, method))?;
            let problem = answer.as_ref().ok().map(|found| problem(made, &weights, found)).transpose()?;
            let row = method_row(made, method, answer)?;
            rows.push(MethodRow { problem, integral: integrates && variant == 0, ..row });
        }
    }
    Ok(rows)
}

fn as_built(asked: &DesignRequest, made: &SynthesisedDesign) -> Result<MethodRow, PipelineError> {
    let norm = match &made.other {
        Some(other) => other.norm,
        // the cost that was solved for is that of the feedback before its order was lowered
        None if made.has_fixed_structure() || made.lowered.is_some() => None,
        None => made.design.feedback.cost.achieved.map(f64::sqrt),
    };
    let (method, integral) = if made.has_fixed_structure() {
        let name = asked.options.fixed_feedback_name().unwrap_or_default();
        (name, integrates(&made.design.feedback_controller())?)
    } else {
        let error = &asked.specification.feedback.error;
        (asked.options.method.name().to_owned(), without_integral(error) != *error)
    };
    let on = measured_loop(made, &made.sampled)?;
    let weights = &made.design.specification.feedback;
    let problem = match &made.other {
        Some(other) => Some(problem(made, weights, other)?),
        None if made.has_fixed_structure() => None,
        None if made.lowered.is_some() => {
            Some(three_part(made, weights, &made.design.feedback_controller())?)
        }
        None => Some(three_part(made, weights, &made.design.feedback.controller)?),
    };
    Ok(MethodRow {
        problem,
        method: format!("{method} (built)"),
        integral,
        order: made.design.feedback_controller().order(),
        norm,
        figures: Some(on.figures),
        systems: on.systems,
        why: None,
    })
}

/// Returns the row of an alternative, but for what it solved and whether it integrates.
fn method_row(
    made: &SynthesisedDesign,
    method: SynthesisMethod,
    answer: Result<Alternative, Refusal>,
) -> Result<MethodRow, PipelineError> {
    let blank = MethodRow {
        method: method.name().to_owned(),
        integral: false,
        order: 0,
        norm: None,
        figures: None,
        systems: Vec::new(),
        why: None,
        problem: None,
    };
    Ok(match answer {
        Err(refusal) => MethodRow { why: Some(refusal.findings), ..blank },
        Ok(found) => {
            let row = MethodRow { order: found.controller.order(), norm: found.norm, ..blank };
            match with_feedback(made, &found.controller)? {
                Ok(on) => MethodRow { figures: Some(on.figures), systems: on.systems, ..row },
                Err(refusal) => MethodRow { why: Some(refusal.findings), ..row },
            }
        }
    })
}

/// Returns what an alternative solved.
fn problem(
    made: &SynthesisedDesign,
    weights: &FeedbackWeights,
    found: &Alternative,
) -> Result<MethodProblem, PipelineError> {
    let of_method = three_part(made, weights, &found.controller)?;
    if found.method == SynthesisMethod::ThreePart {
        return Ok(of_method);
    }
    let (error, weighted) = (["error"], ["weighted_control"]);
    let inner = &found.on_generalised;
    let plant = inner.as_ref().map(|_| generalised_plant(&made.design.plant, weights)).transpose()?;
    Ok(MethodProblem {
        generalised: plant.map(|plant| generalised_result(&plant.system, weights)),
        on_generalised: inner
            .as_ref()
            .map(|it| SystemResult::new("controller of the generalised plant", it, &error, &weighted)),
        basis: None,
        ..of_method
    })
}

/// Returns a generalised plant with its signals by name. Its disturbances and noise are white with a density of one, its last input and its second
/// output the control behind its weight.
fn generalised_result(system: &StateSpace, weights: &FeedbackWeights) -> SystemResult {
    let inputs = weights.disturbances.iter().map(|entry| match LinearPlant::INPUTS.get(entry.index) {
        Some(name) => format!("white_noise_of_{name}"),
        None => format!("white_noise_of_input_{}", entry.index),
    });
    let others = ["white_noise_of_the_control", "white_noise_of_the_measurement", "weighted_control"];
    let inputs = inputs.chain(others.map(str::to_owned)).collect::<Vec<_>>();
    let inputs: Vec<&str> = inputs.iter().map(String::as_str).collect();
    SystemResult::new("generalised plant", system, &inputs, &["weighted_error", "weighted_control", "error"])
        .without_units()
}

/// Returns what a three-part feedback solved.
fn three_part(
    made: &SynthesisedDesign,
    weights: &FeedbackWeights,
    feedback: &StateSpace,
) -> Result<MethodProblem, PipelineError> {
    let mut design = made.design.clone();
    design.specification.feedback = weights.clone();
    if weights.modes == LightModes::Stiffened {
        design.plant = design.plant.with_stiff_modes()?;
    }
    Ok(MethodProblem {
        feedback: SystemResult::new(
            "feedback",
            &feedback.select(&[0], &[0, 1]),
            &["demand_rad_s", "measured_rate_rad_s"],
            &["control_v"],
        )
        .of_loop(made.controlled),
        error_weight: TransferFunctionResult::of("feedback.error", &weights.error),
        control_weight: TransferFunctionResult::of("feedback.control", &weights.control),
        generalised: None,
        on_generalised: None,
        basis: Some(feedback_basis(&design, feedback, signals_of(made))?),
    })
}

/// Returns whether a continuous feedback holds an integral.
fn integrates(feedback: &StateSpace) -> Result<bool, PipelineError> {
    Ok(poles(feedback)?.iter().any(|pole| pole.norm() < DRIFTING_POLE))
}

/// Returns the weight with its poles on the axis moved to the left, its height above them kept.
fn without_integral(weight: &Weight) -> Weight {
    let rational = weight.rational();
    if rational.poles.iter().all(|pole| pole.re != 0.0) {
        return weight.clone();
    }
    let moved = |pole: &C64| if pole.re == 0.0 { pole - CORNER_RAD_S } else { *pole };
    let poles = rational.poles.iter().map(moved).collect();
    Weight::ZeroPoleGain { zeros: rational.zeros, poles, gain: rational.gain }
}

fn lowered_row(made: &SynthesisedDesign) -> Result<Option<LoweredRow>, PipelineError> {
    let Some(lowered) = &made.lowered else { return Ok(None) };
    let after = made.design.feedback_controller();
    let (Ok(before), Ok(now)) = (with_feedback(made, &lowered.before)?, with_feedback(made, &after)?) else {
        return Ok(None);
    };
    let seen = made.design.plant.measured_plant()?.select(&[0], &[made.design.plant.control]);
    let closed = |from_error: &StateSpace| {
        let unit = StateSpace::gain(Mat::eye(1), Timebase::Continuous)?;
        let system = feedback(&series(from_error, &seen)?, &unit)?;
        let (demand, measured) = (["demand_rad_s"], ["measured_rate_rad_s"]);
        Ok::<_, PipelineError>(
            SystemResult::new("closed loop", &system, &demand, &measured).of_loop(made.controlled),
        )
    };
    let reduced = &lowered.reduction.reduction.system;
    Ok(Some(LoweredRow {
        closed_loops: [closed(&lowered.before.select(&[0], &[0]))?, closed(reduced)?],
        order: [lowered.before.order(), after.order()],
        loop_change: lowered.reduction.closed_loop_error.value,
        before: before.figures,
        after: now.figures,
        systems: [before.systems, now.systems],
    }))
}

fn motions(design: &Design) -> Result<Vec<MotionRow>, PipelineError> {
    let mut rows = Vec::new();
    for (channel, disturbance) in [(DisturbanceChannel::Heave, "heave"), (DisturbanceChannel::Pitch, "pitch")]
    {
        if design.part(channel).is_none() {
            continue;
        }
        let at = |gain: f64, output: usize| {
            error_at(&design.plant, design, channel, ResidualChoice { gain, output })
        };
        let pair = |output: usize| Ok::<_, PipelineError>([at(0.0, output)?, at(1.0, output)?]);
        let (hub_rad_s, tip_rad_s) = (pair(LinearPlant::HUB_RATE)?, pair(LinearPlant::TIP_RATE)?);
        rows.push(MotionRow { disturbance, hub_rad_s, tip_rad_s });
    }
    Ok(rows)
}

/// Returns the sampled loop on the plant with every mode of the finite elements (the first [`MODES`] of larger structures);
/// `None` if the project has no beam.
fn spillover(
    project: &Project,
    asked: &DesignRequest,
    modelled: &PlantModel,
    made: &SynthesisedDesign,
) -> Result<Option<Spillover>, PipelineError> {
    let Some(structure) = finite_elements_of(project) else { return Ok(None) };
    let mut full = project.clone();
    full.model.structure = structure;
    full.model.modes = MODES.max(project.model.modes);
    let flexible = build_plant_model(&full)?;
    let modes = flexible.plant.body().modes.len();
    let unreduced = crate::reduce_plant(&Project { reduce: Default::default(), ..full }, &flexible)?;
    let plant: DesignPlant = design_plant(asked, modelled, &unreduced)?;
    let order = plant.system.order();
    let largest = |poles: &[C64]| poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    let pair = |pole: &C64| [pole.re, pole.im];
    let checked = attempt(check_sampled_loop(&plant, made.sampled.controller.clone(), &made.sampling))?;
    let sampled_loop = checked.as_ref().ok().map(|sampled| {
        SystemResult::new("sampled loop", &sampled.loop_gain, &["control_v"], &["returned_control_v"])
    });
    let (largest_pole, poles) = match checked {
        Ok(sampled) => (largest(&sampled.closed_loop), sampled.closed_loop.iter().map(pair).collect()),
        Err(refusal) => (
            refusal
                .findings
                .iter()
                .find_map(|finding| match finding.cause {
                    counterpoise_synth::Cause::Plant(counterpoise_synth::PlantCause::SampledUnstable {
                        pole,
                        ..
                    }) => Some(pole.norm()),
                    _ => None,
                })
                .unwrap_or(f64::INFINITY),
            Vec::new(),
        ),
    };
    Ok(Some(Spillover { modes, order, largest_pole, poles, sampled_loop }))
}
