//! Designs of one project in one table: its own controller, the joint optimum, tuned fixed structures and the H2 feedback with tuned weights, all with the same feedforwards
//! and friction observers, the tuned ones under the limits that the own controller reaches and under further ones.

use counterpoise_controller::Controller;
use counterpoise_lti::StateSpace;
use counterpoise_project::Project;
use counterpoise_project::resolve::fixed_structure::{TuningObjective, TuningOptions};
use counterpoise_project::resolve::synthesis::DesignRequest;
use counterpoise_simulate::Simulator;
use counterpoise_synth::tuning::{feedback_path, measure_loop};
use counterpoise_synth::{
    Assembly, BestLoopTask, Block, BlockKind, Disturbance, FixedStructure, LoopLimits, Reference,
    Specification, SynthesisMethod, TuningSubject, best_loop, sampled_plant,
};
use counterpoise_verify::signals::rms;
use counterpoise_verify::{Arrangement, Experiment, Procedure, Source, nonlinear_runs};
use serde::Serialize;

use crate::exchange::{RunHistory, RunSignal, SystemResult, UnitValue};
use crate::tuning::{
    BlockResult, LoopMeasuresResult, MeasuredLoops, TuningGround, WeightsResult, block_results,
    own_procedure, put_in_place, tune_feedback, tuning_ground, weights_result,
};
use crate::{
    PipelineError, PipelineStage, PlantModel, ProjectIdentity, ReducedPlant, SynthesisedDesign, World,
    build_plant_model, reduce_plant, run_observed, synthesise,
};

/// Every design of a project in one table.
#[derive(Debug)]
pub struct DesignTable {
    /// Name of the mechanism.
    pub name: String,
    /// Hash of the project.
    pub hash: String,
    /// The quantity that the loops control, and in which units their figures are.
    pub loops: MeasuredLoops,
    /// Objective of the tuned structures.
    pub objective: TableObjective,
    /// Motion that the last nonlinear run has.
    pub motion: TableMotion,
    /// The disturbance of the linear loop: frequency in rad/s and power of each line at the output without feedback, in the square of the
    /// unit of what the loop controls.
    pub disturbance: Vec<[f64; 2]>,
    /// RMS of the white noise of a reading.
    pub reading_noise: UnitValue<f64>,
    /// The sampled plant of every loop, from the control to the reading.
    pub systems: Vec<SystemResult>,
    /// The designs, the project's own first.
    pub rows: Vec<DesignRow>,
}

/// What the tuned structures of a table make least.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TableObjective {
    /// What the loop controls, under the motion of the table.
    Motion,
    /// The RMS of |S| in a band, rad/s.
    Band([f64; 2]),
}

/// The motion under which the designs of a table are simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableMotion {
    /// The project's own motion.
    Own,
    /// The sines of the procedure, because the project has no motion of its own.
    Sines,
}

/// Why a row has no controller.
#[derive(Debug)]
pub enum DesignFailure {
    /// The design or its simulation failed.
    Design(PipelineError),
    /// The best linear feedback was not found.
    BestLoop(counterpoise_synth::Error),
}

/// A design with its figures. Why there is no controller is an error, or a sentence about it, which a result file has.
#[derive(Debug, Serialize)]
pub struct DesignRow<Reason = DesignFailure> {
    /// Name of the design.
    pub name: String,
    /// The limits that it was tuned under; absent if it was not tuned.
    pub limits: Option<LimitsResult>,
    /// States of the feedback; of the whole controller if it is one path.
    pub order: usize,
    /// Linear figures of the feedback loop; absent if there is no controller.
    pub linear: Option<LoopMeasuresResult>,
    /// RMS of |S| over 0.2 to 2 Hz, even over the logarithm of frequency.
    pub rejection: Option<f64>,
    /// Figures of the nonlinear closed loop.
    pub nonlinear: Option<RunFigures>,
    /// The runs that they were measured on; empty unless they were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub histories: Vec<RunHistory>,
    /// The sampled feedback, from the error to the control: with the plant of the table, the loop of the linear figures.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub systems: Vec<SystemResult>,
    /// The blocks of a tuned structure.
    pub blocks: Vec<BlockResult>,
    /// The weights of a tuned H2 feedback.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub weights: Option<WeightsResult>,
    /// By how much the worst limit is missed, relative to it.
    pub missed: f64,
    /// Accuracy of the bound, for the row of the best linear feedback.
    pub bound: Option<BoundResult>,
    /// Why there is no controller.
    pub why: Option<Reason>,
}

impl DesignRow {
    /// Returns the row with what `describe` says of the reason.
    pub fn map_reason<Said>(self, describe: impl Fn(&DesignFailure) -> Said) -> DesignRow<Said> {
        DesignRow {
            name: self.name,
            limits: self.limits,
            order: self.order,
            linear: self.linear,
            rejection: self.rejection,
            nonlinear: self.nonlinear,
            histories: self.histories,
            systems: self.systems,
            blocks: self.blocks,
            weights: self.weights,
            missed: self.missed,
            bound: self.bound,
            why: self.why.as_ref().map(describe),
        }
    }
}

/// Gap of a bound of the best linear feedback.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundGap {
    /// By how much the value exceeds the dual bound of the basis, percent of that.
    pub above_dual_percent: f64,
    /// By how much the value with half of the basis exceeds the value, percent of that; `None` if half the basis keeps no such limits.
    pub half_basis_percent: Option<f64>,
}

impl<Reason> DesignRow<Reason> {
    /// Returns how far the bound is known; `None` if the row is no bound.
    pub fn bound_gap(&self) -> Option<BoundGap> {
        let (bound, value) = (self.bound.as_ref()?, self.linear.as_ref()?.disturbed.residual);
        Some(BoundGap {
            above_dual_percent: 100.0 * (value / bound.lower_bound - 1.0),
            half_basis_percent: bound.half_basis.map(|half| 100.0 * (half / value - 1.0)),
        })
    }
}

/// Bound of the best linear feedback, with its accuracy.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BoundResult {
    /// No feedback in the basis leaves less on the program's grid: in the unit of what the loop controls, or as a share of 1 over a band.
    pub lower_bound: f64,
    /// Value with half of the basis.
    pub half_basis: Option<f64>,
    /// Functions of the basis.
    pub basis: usize,
    /// Frequencies on which the limits were verified.
    pub frequencies: usize,
}

/// The limits of a tuning as plain data; those that ask for nothing are absent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LimitsResult {
    /// Largest |S|.
    pub max_sensitivity: Option<f64>,
    /// Largest |T|.
    pub max_complementary: Option<f64>,
    /// Largest RMS control for noise of unit RMS, V s/rad.
    pub noise_gain: Option<f64>,
    /// Largest |KS|, V s/rad.
    pub control_peak: Option<f64>,
    /// Smallest gain margin, dB.
    pub gain_margin_db: Option<f64>,
    /// Smallest phase margin, degrees.
    pub phase_margin_deg: Option<f64>,
    /// Smallest delay margin, s.
    pub delay_margin_s: Option<f64>,
    /// Slowest decay of a pole, rad/s.
    pub decay_rad_s: Option<f64>,
}

/// Figures of the nonlinear closed loop: RMS values after the procedure's settling time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RunFigures {
    /// Controlled quantity less the demand after a step of the demand.
    #[serde(flatten)]
    pub step: UnitValue<f64>,
    /// Response of the controlled quantity to the sines of heave and pitch together.
    #[serde(flatten)]
    pub sines: UnitValue<f64>,
    /// The same under the project's own motion; absent without one.
    #[serde(flatten)]
    pub motion: UnitValue<Option<f64>>,
    /// The same at rest.
    #[serde(flatten)]
    pub rest: UnitValue<f64>,
    /// Control about its mean under the own motion, or under the sines, V.
    pub control_v: f64,
}

/// Input of a comparison of designs.
#[derive(Debug, Clone, Default)]
pub struct ComparisonRequest {
    /// Limits under which the structures are tuned besides those of the own controller.
    pub further: Vec<LoopLimits>,
    /// Whether the runs are kept that the nonlinear figures are measured on.
    pub keeps_histories: bool,
}

/// The band of [`DesignRow::rejection`], rad/s: 0.2 to 2 Hz.
const BAND_RAD_S: [f64; 2] = [1.26, 12.6];

/// Name of the structure that every design is compared with.
pub(super) const TUNED_PI: &str = "tuned PI with a lag";

/// Returns the structures that are tuned, with their names.
pub(super) fn structures() -> Vec<(&'static str, FixedStructure)> {
    use BlockKind::{Lead, LowPass, Notch, ProportionalIntegral};
    let notches = [ProportionalIntegral, Lead, Notch, Notch, LowPass];
    vec![(TUNED_PI, pi_with_lag()), ("tuned PI + lead + 2 notches", open_blocks(&notches))]
}

/// Returns a PI with a lag whose parameters are open.
pub(super) fn pi_with_lag() -> FixedStructure {
    open_blocks(&[BlockKind::ProportionalIntegral, BlockKind::LowPass])
}

fn open_blocks(kinds: &[BlockKind]) -> FixedStructure {
    FixedStructure { blocks: kinds.iter().map(|kind| Block::open(*kind)).collect() }
}

/// Designs and simulates every row.
///
/// # Errors
/// Those of the plant and of the project's own design. Another design that does not exist is a row that says why.
pub fn design_table(
    project: &Project,
    request: &ComparisonRequest,
    world: &dyn World,
) -> Result<DesignTable, PipelineError> {
    let modelled = build_plant_model(project)?;
    let reduced = reduce_plant(project, &modelled)?;
    let asked = project.synth.clone().unwrap_or_default();
    let wanted = asked.options.tuning.clone().unwrap_or_default();
    let ground = tuning_ground(project, &modelled, &reduced, &wanted, world)?;
    let identity = ProjectIdentity::of(project, world);
    let builder = RowBuilder {
        project,
        modelled: &modelled,
        reduced: &reduced,
        ground: &ground,
        plant: sampled_plant(&ground.plants[0], &ground.sampling)?,
        world,
        procedure: own_procedure(project, world)?,
        keeps_histories: request.keeps_histories,
    };
    let own_name = own_name(&asked);
    let own = builder.row(&own_name, project)?;
    let mut rows = vec![own];
    rows.extend(variants(&asked).into_iter().map(|(name, synthesis)| builder.attempted_row(name, synthesis)));
    let mut limits: Vec<LoopLimits> = rows[0].linear.iter().map(|found| limits_of(found, &wanted)).collect();
    let decay_rad_s = limits.first().map_or(0.0, |limits| limits.decay_rad_s);
    limits.extend(asked.options.tuning.iter().map(|tuning| tuning.limits));
    limits.extend(request.further.iter().map(|limits| LoopLimits { decay_rad_s, ..*limits }));
    let weights = [three_part(&asked)];
    let count = rows.len() + limits.len() * (structures().len() + weights.len() + 1);
    let report = |rows: &[DesignRow]| world.pool().progress("comparing designs", rows.len(), count);
    for limits in limits {
        for (name, structure) in structures() {
            report(&rows);
            let subject = TuningSubject::Structure(&structure);
            rows.push(builder.tuned_row(name, subject, &TuningOptions { limits, ..wanted.clone() }));
        }
        report(&rows);
        rows.extend(weights.iter().map(|from| {
            let subject = TuningSubject::Weights(from);
            builder.tuned_row(TUNED_WEIGHTS, subject, &TuningOptions { limits, ..wanted.clone() })
        }));
        report(&rows);
        rows.push(builder.best_loop_row(limits, &wanted));
    }
    let controlled = project.plant.controlled_quantity();
    let motion = if builder.procedure.road.is_some() { TableMotion::Own } else { TableMotion::Sines };
    let objective = match ground.objective {
        TuningObjective::Motion => TableObjective::Motion,
        TuningObjective::Band => TableObjective::Band(wanted.band_rad_s),
    };
    let Disturbance { lines: disturbance, reading_noise_rad_s } = ground.disturbance.clone();
    let reading_noise = UnitValue::new("reading_noise", controlled, reading_noise_rad_s);
    let systems = vec![SystemResult::of_plant(&builder.plant, controlled)];
    let (name, hash) = (identity.name, identity.hash);
    let loops = ground.measured_loops(controlled);
    Ok(DesignTable { name, hash, loops, objective, motion, disturbance, reading_noise, systems, rows })
}

/// Name of the H2 feedback whose weights were tuned.
const TUNED_WEIGHTS: &str = "H2, weights tuned";

/// Returns the specification from which weights are tuned: the project's, its parts put together by
/// `simple-add`.
pub(super) fn three_part(asked: &DesignRequest) -> Specification {
    let mut specification = asked.specification.clone();
    if specification.assembly == Assembly::Joint {
        specification.assembly = Assembly::SimpleAdd;
    }
    specification.reference = Reference::Error;
    specification
}

pub(super) fn own_name(asked: &DesignRequest) -> String {
    match (asked.options.fixed_feedback_name(), asked.specification.assembly, asked.options.method) {
        (Some(name), ..) => format!("own: {name}"),
        (_, Assembly::Joint, _) => "own: joint optimum".to_owned(),
        (_, _, SynthesisMethod::ThreePart) => "own: three-part H2".to_owned(),
        (_, _, SynthesisMethod::JointH2) => "own: textbook H2".to_owned(),
        (_, _, SynthesisMethod::LqgLtr) => "own: LQG/LTR".to_owned(),
        (_, _, SynthesisMethod::HInfinity) => "own: H-infinity".to_owned(),
    }
}

/// Returns the equal limits of a tuned structure: the figures that the own controller reaches. Its decay is among them, because a slow
/// pole costs little under a motion and shows in every step.
pub(super) fn limits_of(own: &LoopMeasuresResult, wanted: &TuningOptions) -> LoopLimits {
    LoopLimits {
        max_sensitivity: own.max_sensitivity,
        max_complementary: own.max_complementary,
        noise_gain: own.noise_gain,
        control_peak: own.control_peak,
        decay_rad_s: own.decay_rad_s.max(0.0),
        damping: wanted.limits.damping,
        ..LoopLimits::default()
    }
}

/// Returns the methods that the project did not choose: the three-part H2 design, and the joint optimum.
pub(super) fn variants(asked: &DesignRequest) -> Vec<(&'static str, DesignRequest)> {
    let mut plain = asked.clone();
    plain.options.remove_fixed_feedback();
    plain.options.tuning = None;
    plain.options.method = SynthesisMethod::ThreePart;
    let mut all = Vec::new();
    let is_plain =
        asked.options.fixed_feedback_name().is_none() && asked.options.method == SynthesisMethod::ThreePart;
    if !is_plain || asked.specification.assembly == Assembly::Joint {
        let mut three_part = plain.clone();
        three_part.specification.assembly = Assembly::SimpleAdd;
        all.push(("three-part H2", three_part));
    }
    if asked.specification.assembly != Assembly::Joint {
        plain.specification.assembly = Assembly::Joint;
        plain.options.controller_order = None;
        plain.options.schedule = None;
        all.push(("joint optimum", plain));
    }
    all
}

/// The common inputs of every row.
struct RowBuilder<'a> {
    project: &'a Project,
    modelled: &'a PlantModel,
    reduced: &'a ReducedPlant,
    ground: &'a TuningGround,
    /// The sampled nominal plant, from the control to the reading.
    plant: StateSpace,
    world: &'a dyn World,
    procedure: Procedure,
    keeps_histories: bool,
}

/// The nonlinear closed loop of a design.
struct DesignRuns {
    figures: RunFigures,
    histories: Vec<RunHistory>,
}

impl RowBuilder<'_> {
    fn row(&self, name: &str, project: &Project) -> Result<DesignRow, PipelineError> {
        let made = run_observed(self.world, PipelineStage::Synthesise, || {
            synthesise(project, self.modelled, self.reduced)
        })?;
        self.judge_design(name, &made)
    }

    /// Returns the row of a synthesis in place of the project's, or the reason why there is none.
    fn attempted_row(&self, name: &str, synthesis: DesignRequest) -> DesignRow {
        let project = Project { synth: Some(synthesis), ..self.project.clone() };
        self.row(name, &project).unwrap_or_else(|why| blank_row(name, Some(DesignFailure::Design(why))))
    }

    fn tuned_row(&self, name: &str, subject: TuningSubject<'_>, wanted: &TuningOptions) -> DesignRow {
        let made = run_observed(self.world, PipelineStage::Synthesise, || {
            let (tuned, _) = tune_feedback(subject, self.ground, wanted)?;
            let mut synthesis = self.project.synth.clone().unwrap_or_default();
            synthesis.options.remove_fixed_feedback();
            put_in_place(&tuned.feedback, &mut synthesis);
            synthesis.options.method = SynthesisMethod::ThreePart;
            synthesis.options.controller_order = None;
            if synthesis.specification.assembly == Assembly::Joint {
                synthesis.specification.assembly = Assembly::SimpleAdd;
            }
            synthesis.specification.reference = Reference::Error;
            let project = Project { synth: Some(synthesis), ..self.project.clone() };
            Ok::<_, PipelineError>((tuned, synthesise(&project, self.modelled, self.reduced)?))
        });
        let row = made.and_then(|(tuned, made)| {
            let row = self.judge_design(name, &made)?;
            let (blocks, weights) = (block_results(&tuned.structure()), weights_result(&tuned.feedback));
            Ok(DesignRow { blocks, weights, missed: tuned.missed, ..row })
        });
        let row = row.unwrap_or_else(|why| blank_row(name, Some(DesignFailure::Design(why))));
        DesignRow { limits: Some(LimitsResult::from(&wanted.limits)), ..row }
    }

    /// Returns the row of the best that a linear feedback can do: no controller, and no simulation.
    fn best_loop_row(&self, limits: LoopLimits, wanted: &TuningOptions) -> DesignRow {
        let ground = self.ground;
        let task = BestLoopTask {
            plant: &ground.plants[0],
            sampling: &ground.sampling,
            disturbance: &ground.disturbance,
            limits,
        };
        let name = "best linear feedback";
        let row = match run_observed(self.world, PipelineStage::Synthesise, || best_loop(&task)) {
            Err(why) => blank_row(name, Some(DesignFailure::BestLoop(why))),
            Ok(found) => {
                let is_band = ground.objective == TuningObjective::Band && wanted.band_rad_s == BAND_RAD_S;
                let bound = BoundResult {
                    lower_bound: found.lower_bound_rad_s,
                    half_basis: found.half_basis_rad_s,
                    basis: found.basis,
                    frequencies: found.frequencies,
                };
                let linear = Some(LoopMeasuresResult::of_bound(
                    &found,
                    self.ground.measured_loops(self.project.plant.controlled_quantity()),
                ));
                let rejection = is_band.then_some(found.residual_rad_s);
                DesignRow { linear, rejection, bound: Some(bound), ..blank_row(name, None) }
            }
        };
        DesignRow { limits: Some(LimitsResult::from(&limits)), ..row }
    }

    /// Returns the figures of a design on the linear plant and in the nonlinear closed loop.
    fn judge_design(&self, name: &str, made: &SynthesisedDesign) -> Result<DesignRow, PipelineError> {
        let controller = &made.sampled.controller;
        let feedback = feedback_path(controller, &self.ground.sampling)?;
        let on = |disturbance: &Disturbance| measure_loop(&self.plant, &feedback, disturbance);
        let linear = on(&self.ground.disturbance)?;
        let rejection = on(&Disturbance::of_band(BAND_RAD_S))?.residual_rad_s;
        let controlled = self.project.plant.controlled_quantity();
        let runs = run_observed(self.world, PipelineStage::Verify, || self.run(controller))?;
        let order = match &made.design.joint {
            Some(joint) => joint.controller.order(),
            None => made.design.feedback_controller().order(),
        };
        Ok(DesignRow {
            order,
            linear: Some(LoopMeasuresResult::of(&linear, self.ground.measured_loops(controlled))),
            rejection: Some(rejection),
            nonlinear: Some(runs.figures),
            histories: runs.histories,
            systems: vec![SystemResult::of_feedback("feedback", &feedback, controlled)],
            ..blank_row(name, None)
        })
    }

    fn run(&self, controller: &Controller) -> Result<DesignRuns, PipelineError> {
        let mut simulator = Simulator::new(&self.modelled.plant)?;
        let controlled = self.project.plant.controlled_quantity();
        let period_s = controller.sample_period_s();
        let mut histories = Vec::new();
        let mut run = |name: &str, experiment: Experiment| -> Result<[f64; 2], PipelineError> {
            let history =
                nonlinear_runs::run_history(&mut simulator, controller, &self.procedure, experiment)?;
            let history = match experiment {
                Experiment::Step => history,
                _ => history.from_time(self.procedure.settle_s),
            };
            let pairs = history.hub_rate_rad_s().iter().zip(history.demand_rad_s());
            let error: Vec<f64> = pairs.map(|(y, r)| y - r).collect();
            let mean = history.control_v().iter().sum::<f64>() / history.control_v().len().max(1) as f64;
            let control: Vec<f64> = history.control_v().iter().map(|u| u - mean).collect();
            let figures = [rms(&error), rms(&control)];
            if self.keeps_histories {
                let error = RunSignal::new(controlled.key_of("error"), error);
                let control = RunSignal::new("control_v", history.control_v());
                histories.push(RunHistory::new(name, period_s, [error, control]));
            }
            Ok(figures)
        };
        let under = |source: Source| Experiment::Disturbance(source, Arrangement::Compensated);
        let sines = run("sines", under(Source::Both))?;
        let motion = match self.procedure.road {
            Some(_) => Some(run("motion", under(Source::Road))?),
            None => None,
        };
        let (step, rest) = (run("step", Experiment::Step)?, run("rest", Experiment::Rest)?);
        let figures = RunFigures {
            step: UnitValue::new("step", controlled, step[0]),
            sines: UnitValue::new("sines", controlled, sines[0]),
            motion: UnitValue::new("motion", controlled, motion.map(|found| found[0])),
            rest: UnitValue::new("rest", controlled, rest[0]),
            control_v: motion.unwrap_or(sines)[1],
        };
        Ok(DesignRuns { figures, histories })
    }
}

fn blank_row(name: &str, why: Option<DesignFailure>) -> DesignRow {
    DesignRow {
        name: name.to_owned(),
        limits: None,
        order: 0,
        linear: None,
        rejection: None,
        nonlinear: None,
        histories: Vec::new(),
        systems: Vec::new(),
        blocks: Vec::new(),
        weights: None,
        missed: 0.0,
        bound: None,
        why,
    }
}

impl From<&LoopLimits> for LimitsResult {
    fn from(limits: &LoopLimits) -> Self {
        let asked = |limit: f64| Some(limit).filter(|limit| limit.is_finite() && *limit > 0.0);
        Self {
            max_sensitivity: asked(limits.max_sensitivity),
            max_complementary: asked(limits.max_complementary),
            noise_gain: asked(limits.noise_gain),
            control_peak: asked(limits.control_peak),
            gain_margin_db: asked(limits.gain_margin_db),
            phase_margin_deg: asked(limits.phase_margin_deg),
            delay_margin_s: asked(limits.delay_margin_s),
            decay_rad_s: asked(limits.decay_rad_s),
        }
    }
}
