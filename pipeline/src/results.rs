//! Results as plain data: what `--json` prints, and what another program reads.
//!
//! A result without statements serialises as it is. One with statements (findings, verdicts, conditions) holds them as they were found, and the
//! crate `report` writes it with sentences in their places.

mod balance;
mod certificate;
mod complete_design;
mod robustness;
mod two_axes;

use std::collections::BTreeMap;

use counterpoise_lti::StateSpace;
use counterpoise_models::Parameters;
use counterpoise_models::plant::LinearPlant;
use counterpoise_project::Assumption;
use counterpoise_reduce::Warning;
use counterpoise_simulate::replay::{ChannelFit, Divergence, ReplayMode};
use counterpoise_synth::{DesignFinding, DisturbanceChannel, Part, Specification, Weight};
use counterpoise_verify::Verification;
use serde::Serialize;

use crate::exchange::controller_file::PathResult;
use crate::exchange::error_budget::{ErrorBudgetResult, SightProcedureResult};
use crate::exchange::systems::{StoredController, controllers_of_design, stored_frequencies_hz};
use crate::exchange::verification_data::{history_results, response_results};
use crate::exchange::{
    BalanceResult, DesignSignals, HistoryResult, ResponseResult, SCHEMA, StructureResult, SystemResult,
    TargetsResult, TransferFunctionResult, VerifiedLoop,
};
use crate::recordings::{ReplayedRecording, channel_label};
use crate::studies::assumptions::AssumptionEffect;
use crate::tolerance::ROUNDED_POLE;
pub use certificate::CertificateResult;
pub use robustness::{AdviceResult, RobustnessResult};
pub use two_axes::{JointColumn, JointFigureResult, JointHistoryResult, JointResult, JointVerdictResult};

use crate::plant_views::FrictionView;
use crate::studies::accuracy::Accuracy;
use crate::studies::adaptation_trials::AdaptationTrials;
use crate::{
    CompletedDesign, DemandedRate, PlantModel, ReducedPlant, SynthesisedDesign, TraverseDesign, TwoAxisStudy,
};

/// A complex number as real and imaginary part.
pub type ComplexPair = [f64; 2];

/// The plant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelResult {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// Name of the machine.
    pub name: String,
    /// Order of the linear plant.
    pub order: usize,
    /// The name of each state.
    pub states: Vec<String>,
    /// Poles of the linear plant, rad/s.
    pub poles_rad_s: Vec<ComplexPair>,
    /// Control that holds the mechanism at its operating point, V.
    pub holding_v: f64,
    /// First moment of mass about the pivot, kg m.
    pub out_of_balance_kg_m: f64,
    /// The way in which the holding control is found.
    pub balance: BalanceResult,
    /// The linear plant.
    pub plant: SystemResult,
    /// Hub rate for each input.
    pub responses: Vec<ResponseResult>,
    /// The values that are assumed because the project file does not state it; empty unless the file's reader handed it in.
    pub assumptions: Vec<Assumption>,
    /// The loss or gain of the loop if an assumption is wrong by its usual range, the largest effect first; empty if there is no design.
    pub assumption_effects: Vec<AssumptionEffect>,
    /// The loop at the assumed values, from which effects are counted; absent if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub assumed_loop: Option<VerifiedLoop>,
    /// The finite elements of the structure with their modes; absent if it has none, or in the results of `design`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub structure: Option<StructureResult>,
    /// Friction at the motor and at the pivot; absent in the results of `design`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub frictions: Vec<FrictionView>,
    /// The simulator's own error; absent unless a report was asked for, which shows it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub accuracy: Vec<Accuracy>,
}

/// The reduction. The notes for the designer are warnings, or sentences about them, which a result file has.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReduceResult<Note = Warning> {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// Order before and after.
    pub order: [usize; 2],
    /// Values by which states were ranked.
    pub ranked: Vec<f64>,
    /// A priori bound on the largest error.
    pub bound: Option<f64>,
    /// Largest error as measured, and its frequency in rad/s.
    pub error: Option<ComplexPair>,
    /// The notes for the designer.
    pub warnings: Vec<Note>,
    /// The plant before the reduction.
    pub plant_before: SystemResult,
    /// The reduced plant.
    pub plant: SystemResult,
    /// Hub rate for each input.
    pub responses: Vec<ResponseResult>,
}

impl ReduceResult {
    /// Returns the result with what `describe` says of each warning.
    pub fn map_warnings<Said>(self, describe: impl Fn(&Warning) -> Said) -> ReduceResult<Said> {
        ReduceResult {
            schema: self.schema,
            order: self.order,
            ranked: self.ranked,
            bound: self.bound,
            error: self.error,
            warnings: self.warnings.iter().map(describe).collect(),
            plant_before: self.plant_before,
            plant: self.plant,
            responses: self.responses,
        }
    }
}

/// The design.
#[derive(Debug, Clone, PartialEq)]
pub struct SynthResult {
    /// Its figures.
    pub figures: SynthFigures,
    /// The costs of the parts.
    pub costs: Vec<CostResult>,
    /// The largest rate that a loop of position demands, and why; `None` for a loop of rate.
    pub demanded_rate: Option<DemandedRate>,
    /// The notes for the designer.
    pub warnings: Vec<DesignFinding>,
    /// Its systems.
    pub systems: SynthSystems,
}

/// The figures of a design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SynthFigures {
    /// Order of the design plant with sensors and delay.
    pub plant_order: usize,
    /// States of each path of the sampled controller.
    pub path_orders: BTreeMap<String, usize>,
    /// Poles of the closed sampled loop, in the z-plane.
    pub closed_loop_poles: Vec<ComplexPair>,
    /// Largest modulus of those poles.
    pub largest_pole_modulus: f64,
    /// Largest relative difference between a cost as predicted and as computed on the assembled loop.
    pub cost_difference: Option<f64>,
}

/// The systems of a design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SynthSystems {
    /// The design plant with sensor and delay: the measured rate, then every true output.
    pub design_plant: Option<SystemResult>,
    /// The weights.
    pub weights: Vec<TransferFunctionResult>,
    /// The controllers of the design in continuous time.
    pub controllers: Vec<SystemResult>,
    /// The paths of the sampled controller.
    pub paths: Vec<PathResult>,
    /// The sampled loop on the design plant, broken at the control: 1 + L is the return difference.
    pub sampled_loop: SystemResult,
    /// Responses of the controllers and of the sampled loop.
    pub responses: Vec<ResponseResult>,
}

/// The cost of a part of the design, or of what bears its name: the mean square of its weighted signals.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CostResult<Of = CostedPart> {
    /// The part.
    pub part: Of,
    /// As its equations predict it.
    pub predicted: Option<f64>,
    /// As the assembled loop of this part has it.
    pub achieved: Option<f64>,
}

/// A part of a design that has a cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CostedPart {
    /// The feedback in continuous time.
    Feedback,
    /// A feedforward in continuous time.
    Feedforward(DisturbanceChannel),
    /// The joint problem of all paths in continuous time.
    Joint,
    /// A part in sampled time.
    Sampled(Part),
}

/// What a result file says of a verification beside its figures and verdicts.
#[derive(Debug, Clone, PartialEq)]
pub struct VerifyResult {
    /// `true` if no requirement fails, the loop is stable and nothing that was asked beside that is refused.
    pub passes: bool,
    /// The studies beside the figures.
    pub studies: VerificationStudies,
    /// The traverse axis alone, and both axes together; `None` if the project has no traverse axis.
    pub two_axes: Option<TwoAxesResult>,
    /// The data of the figures.
    pub data: VerificationData,
}

/// The studies of a verified loop beside its figures.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VerificationStudies {
    /// Stability in every regime; absent if it was not asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub certificate: Option<CertificateResult>,
    /// Trials of the project's adaptation; absent if it has none or they were not asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adaptation_trials: Option<AdaptationTrials>,
    /// The options by which the line of sight is judged; absent if it was not asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sight_procedure: Option<SightProcedureResult>,
    /// The contributions to the error of the line of sight; absent if it was not asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_budget: Option<ErrorBudgetResult>,
}

/// The data from which the figures of a verification can be recomputed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VerificationData {
    /// The systems that the linear figures are measured on.
    #[serde(flatten)]
    pub measured_on: VerifiedLoop,
    /// Frequency responses.
    pub responses: Vec<ResponseResult>,
    /// Time histories of every experiment; absent unless they were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub histories: Vec<HistoryResult>,
}

/// The traverse axis alone, and both axes together.
#[derive(Debug, Clone, PartialEq)]
pub struct TwoAxesResult {
    /// Name of the traverse axis' machine.
    pub name: String,
    /// `true` if no requirement of the traverse axis or of both axes fails.
    pub passes: bool,
    /// The verification of the traverse axis alone.
    pub traverse: Box<VerifyResult>,
    /// Both axes together.
    pub joint: JointResult,
}

impl From<&TwoAxisStudy> for TwoAxesResult {
    fn from(study: &TwoAxisStudy) -> Self {
        let TraverseDesign { project, verified, .. } = &study.traverse;
        Self {
            name: project.plant.name.clone(),
            passes: study.passes(),
            traverse: Box::new(VerifyResult::new(verified.verification(), study.traverse_loop.clone())),
            joint: (&study.joint).into(),
        }
    }
}

impl TwoAxesResult {
    /// Leaves out the time histories.
    pub fn leave_histories_out(&mut self) {
        self.traverse.leave_histories_out();
        self.joint.histories.clear();
    }
}

impl VerifyResult {
    /// Leaves out the time histories, those of the certificate's motions, and those of the adaptation's trials.
    pub fn leave_histories_out(&mut self) {
        self.data.histories.clear();
        self.studies.certificate.iter_mut().for_each(CertificateResult::leave_histories_out);
        self.studies.adaptation_trials.iter_mut().for_each(|trials| trials.histories.clear());
        self.two_axes.iter_mut().for_each(TwoAxesResult::leave_histories_out);
    }

    /// Returns the result with both axes verified together: requirements that they do not meet are not met.
    pub fn with_two_axes(self, two_axes: Option<TwoAxesResult>) -> Self {
        let failed = two_axes.as_ref().is_some_and(|both| !both.passes);
        Self { passes: self.passes && !failed, two_axes, ..self }
    }

    /// Returns the result with the trials of the adaptation: a method that they refuse does not pass.
    pub fn with_adaptation(self, adaptation_trials: Option<AdaptationTrials>) -> Self {
        let refused = adaptation_trials.as_ref().is_some_and(|tried| !tried.refused.is_empty());
        let studies = VerificationStudies { adaptation_trials, ..self.studies };
        Self { passes: self.passes && !refused, studies, ..self }
    }
}

/// A whole design.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignResult {
    /// The plant.
    pub model: ModelResult,
    /// The reduction.
    pub reduce: ReduceResult,
    /// The design.
    pub synth: SynthResult,
    /// The verification.
    pub verify: VerifyResult,
    /// The controller in every kind of numbers.
    pub targets: TargetsResult,
}

/// Fit of one channel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ChannelResult {
    /// RMS error.
    pub rms_error: f64,
    /// The residual of a perfect model under noise and quantisation, RMS.
    pub floor: f64,
    /// RMS error over the noise floor; not part of the JSON, whose reader divides.
    #[serde(skip)]
    pub residual_over_floor: f64,
    /// Variance accounted for, percent.
    pub vaf: f64,
}

/// Fit of one recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordingResult {
    /// File.
    pub file: String,
    /// Channels.
    pub channels: BTreeMap<&'static str, ChannelResult>,
    /// `free`: over its whole length; `windows`: over short horizons, each from a state of its own.
    pub followed: &'static str,
    /// Length of a window, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window_s: Option<f64>,
    /// The residuals of the replay over the whole length, where the recording was followed over windows.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub free: BTreeMap<&'static str, ChannelResult>,
    /// The divergence of two runs of the model itself over the whole length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub parting: Option<PartingResult>,
    /// The remarks about the recording itself.
    pub remarks: Vec<String>,
}

/// The divergence of two runs of one model that differ in noise and in the unknown part of their initial state.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PartingResult {
    /// The channel in which they diverge most.
    pub channel: &'static str,
    /// RMS of their difference over the channel's floor.
    pub floors: f64,
}

/// Fits of all recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReplayResult {
    /// Recordings.
    pub recordings: Vec<RecordingResult>,
}

impl ReplayResult {
    /// Returns the result with the channels named as a machine's recordings show them, for people; programs read the names that they have here.
    #[must_use]
    pub fn label_channels(&self, plant: &Parameters) -> Self {
        let named = |channels: &BTreeMap<&'static str, ChannelResult>| {
            channels.iter().map(|(name, fit)| (channel_label(plant, name), *fit)).collect()
        };
        let one = |recording: &RecordingResult| RecordingResult {
            channels: named(&recording.channels),
            free: named(&recording.free),
            parting: recording
                .parting
                .map(|found| PartingResult { channel: channel_label(plant, found.channel), ..found }),
            ..recording.clone()
        };
        Self { recordings: self.recordings.iter().map(one).collect() }
    }
}

/// A pole as a natural frequency and a damping ratio.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoleFigures {
    /// Its modulus over 2 pi, Hz.
    pub frequency_hz: f64,
    /// Minus its real part over its modulus; 0 for a pole at the origin, which has none of either sign.
    pub damping_ratio: f64,
}

impl ModelResult {
    /// Returns each real pole and the upper one of each pair, in order. What is no more than the rounding of the quickest pole lies at the
    /// origin.
    pub fn pole_figures(&self) -> Vec<PoleFigures> {
        let size = |pole: &ComplexPair| pole[0].hypot(pole[1]);
        let rounding = ROUNDED_POLE * self.poles_rad_s.iter().map(size).fold(0.0, f64::max);
        let figures = |pole: &ComplexPair| match size(pole) {
            size if size <= rounding => PoleFigures { frequency_hz: 0.0, damping_ratio: 0.0 },
            size => {
                PoleFigures { frequency_hz: size / std::f64::consts::TAU, damping_ratio: -pole[0] / size }
            }
        };
        self.poles_rad_s.iter().filter(|pole| pole[1] >= 0.0).map(figures).collect()
    }
}

impl From<&PlantModel> for ModelResult {
    fn from(modelled: &PlantModel) -> Self {
        let linear = &modelled.linear;
        let states = linear.state_names.iter().map(String::as_str);
        Self {
            schema: SCHEMA,
            plant: plant("linear plant", &linear.system, &linear.output_names).with_states(states),
            responses: plant_responses(&linear.system, &linear.output_names),
            name: modelled.parameters.name.clone(),
            order: linear.system.order(),
            states: linear.state_names.clone(),
            poles_rad_s: pairs(&counterpoise_lti::poles(&linear.system).unwrap_or_default()),
            holding_v: linear.equilibrium.control_v,
            out_of_balance_kg_m: modelled.plant.body().out_of_balance_kg_m,
            assumptions: Vec::new(),
            assumption_effects: Vec::new(),
            assumed_loop: None,
            structure: None,
            frictions: Vec::new(),
            accuracy: Vec::new(),
            balance: BalanceResult::of(&modelled.plant, linear),
        }
    }
}

impl From<&ReducedPlant> for ReduceResult {
    fn from(reduced: &ReducedPlant) -> Self {
        Self {
            schema: SCHEMA,
            plant_before: plant("linear plant", &reduced.before, &reduced.output_names),
            plant: plant("reduced plant", &reduced.system, &reduced.output_names),
            responses: plant_responses(&reduced.system, &reduced.output_names),
            order: [reduced.order_before(), reduced.system.order()],
            ranked: reduced.ranked.clone(),
            bound: reduced.bound,
            error: reduced.error.map(|(value, rate)| [value, rate]),
            warnings: reduced.warnings.clone(),
        }
    }
}

impl From<&SynthesisedDesign> for SynthResult {
    fn from(made: &SynthesisedDesign) -> Self {
        let paths = &made.sampled.controller.parts().paths;
        let controlled = made.controlled;
        let controllers = controllers_of_design(&made.design, controlled);
        let signals = DesignSignals { controlled, outputs: &made.output_names };
        let design_plant = made.design.plant.measured_plant().ok();
        let design_plant = design_plant.map(|system| SystemResult::of_design_plant(&system, signals));
        let broken = &made.sampled.loop_gain;
        let systems = SynthSystems {
            design_plant,
            weights: weights(&made.design.specification),
            paths: paths.iter().map(|path| PathResult::of(path).of_loop(controlled)).collect(),
            sampled_loop: SystemResult::new("sampled loop", broken, &["control_v"], &["returned_control_v"]),
            responses: controller_responses(&controllers, broken),
            controllers: controllers.into_iter().map(|controller| controller.result).collect(),
        };
        let (demanded_rate, warnings) = (made.demanded_rate, made.warnings.clone());
        Self { figures: made.into(), costs: costs(made), demanded_rate, warnings, systems }
    }
}

impl From<&SynthesisedDesign> for SynthFigures {
    fn from(made: &SynthesisedDesign) -> Self {
        let paths = &made.sampled.controller.parts().paths;
        Self {
            plant_order: made.design.plant.measured_plant().map_or(0, |p| p.order()),
            path_orders: paths.iter().map(|p| (p.name.clone(), p.system.order())).collect(),
            closed_loop_poles: pairs(&made.sampled.closed_loop),
            largest_pole_modulus: made.sampled.closed_loop.iter().map(|pole| pole.norm()).fold(0.0, f64::max),
            cost_difference: [made.design.worst_cost_difference(), made.sampled.worst_cost_difference()]
                .into_iter()
                .flatten()
                .max_by(f64::total_cmp),
        }
    }
}

impl VerifyResult {
    /// Returns the result of a verification; `measured_on` is what its linear figures are measured on.
    pub fn new(found: &Verification, measured_on: VerifiedLoop) -> Self {
        Self {
            passes: found.passes(),
            studies: VerificationStudies {
                certificate: None,
                adaptation_trials: None,
                sight_procedure: SightProcedureResult::of(&found.evidence.procedure),
                error_budget: found.error_budget.as_ref().map(Into::into),
            },
            two_axes: None,
            data: VerificationData {
                measured_on,
                responses: response_results(found),
                histories: history_results(found),
            },
        }
    }

    /// Returns the result with the certificate of stability in every regime.
    pub fn with_certificate(self, certificate: Option<CertificateResult>) -> Self {
        Self { studies: VerificationStudies { certificate, ..self.studies }, ..self }
    }
}

impl DesignResult {
    /// Leaves out every time history.
    pub fn leave_histories_out(&mut self) {
        self.verify.leave_histories_out();
        self.targets.leave_histories_out();
    }
}

impl From<&CompletedDesign> for DesignResult {
    fn from(designed: &CompletedDesign) -> Self {
        let made = &designed.stages;
        let verify = VerifyResult::new(made.verified.verification(), designed.verified_loop.clone());
        Self {
            model: (&made.modelled).into(),
            reduce: (&made.reduced).into(),
            synth: (&made.synthesised).into(),
            verify: verify
                .with_certificate(Some((&made.stability).into()))
                .with_adaptation(designed.adaptation.clone()),
            targets: TargetsResult::of(&designed.targets, made.synthesised.controlled),
        }
    }
}

impl ReplayedRecording {
    /// Returns the fit of the recording; `remarks` are its remarks in sentences.
    pub fn result(&self, remarks: Vec<String>) -> RecordingResult {
        let (mode, window_s, free) = match &self.followed.mode {
            ReplayMode::Free => ("free", None, BTreeMap::new()),
            ReplayMode::Windowed { window_s, free } => ("windows", Some(*window_s), channels(free)),
        };
        let divergence = |p: Divergence| PartingResult { channel: p.channel.name(), floors: p.floors };
        RecordingResult {
            file: self.file.clone(),
            channels: channels(&self.followed.replay.channels),
            followed: mode,
            window_s,
            free,
            parting: self.followed.divergence.map(divergence),
            remarks,
        }
    }
}

fn channels(fits: &[ChannelFit]) -> BTreeMap<&'static str, ChannelResult> {
    let channel = |fit: &ChannelFit| {
        let result = ChannelResult {
            rms_error: fit.rms_error,
            floor: fit.floor,
            residual_over_floor: fit.residual_over_floor(),
            vaf: fit.vaf,
        };
        (fit.channel.name(), result)
    };
    fits.iter().map(channel).collect()
}

/// Returns a plant with the inputs and outputs of the linear plant.
fn plant(name: &str, system: &StateSpace, outputs: &[String]) -> SystemResult {
    let outputs: Vec<&str> = outputs.iter().map(String::as_str).collect();
    SystemResult::new(name, system, &LinearPlant::INPUTS, &outputs)
}

fn plant_responses(system: &StateSpace, outputs: &[String]) -> Vec<ResponseResult> {
    let hub = outputs.get(LinearPlant::HUB_RATE).map_or("", String::as_str);
    let hz = stored_frequencies_hz();
    let one = |(input, name): (usize, &str)| {
        let name = format!("{hub} over {name}");
        ResponseResult::of_system(&name, system, LinearPlant::HUB_RATE, input, &hz)
    };
    LinearPlant::INPUTS.into_iter().enumerate().filter_map(one).collect()
}

/// Returns the costs of every part that was designed in continuous and in sampled time.
fn costs(made: &SynthesisedDesign) -> Vec<CostResult> {
    let design = &made.design;
    let channels =
        [(DisturbanceChannel::Heave, &design.heave), (DisturbanceChannel::Pitch, &design.pitch)].into_iter();
    let feedforwards =
        channels.filter_map(|(channel, part)| Some((CostedPart::Feedforward(channel), part.as_ref()?.cost)));
    let joint = design.joint.iter().map(|joint| (CostedPart::Joint, joint.cost));
    let feedback = std::iter::once((CostedPart::Feedback, design.feedback.cost));
    let sampled = made.sampled.certified.iter().map(|part| (CostedPart::Sampled(part.part), part.cost));
    let result = |(part, cost): (CostedPart, counterpoise_synth::Cost)| CostResult {
        part,
        predicted: cost.predicted,
        achieved: cost.achieved,
    };
    feedback.chain(feedforwards).chain(joint).chain(sampled).map(result).collect()
}

/// Returns the weights of every part of the design.
fn weights(asked: &Specification) -> Vec<TransferFunctionResult> {
    let of = |name: &str, weight: &Weight| TransferFunctionResult::of(name, weight);
    let mut all =
        vec![of("feedback.error", &asked.feedback.error), of("feedback.control", &asked.feedback.control)];
    for (name, part) in [("heave", &asked.heave), ("pitch", &asked.pitch)] {
        let Some(part) = part else { continue };
        for (role, weight) in
            [("error", &part.error), ("control", &part.control), ("generator", &part.generator)]
        {
            all.push(of(&format!("{name}.{role}"), weight));
        }
    }
    all
}

fn controller_responses(controllers: &[StoredController], broken: &StateSpace) -> Vec<ResponseResult> {
    let hz = stored_frequencies_hz();
    let mut all = Vec::new();
    for StoredController { result, system } in controllers {
        for (input, signal) in result.inputs.iter().enumerate() {
            let name = format!("{} over {}", result.name, signal.name);
            all.extend(ResponseResult::of_system(&name, system, 0, input, &hz));
        }
    }
    all.extend(ResponseResult::of_system("sampled loop", broken, 0, 0, &hz));
    all
}

fn pairs(values: &[counterpoise_linalg::C64]) -> Vec<ComplexPair> {
    values.iter().map(|v| [v.re, v.im]).collect()
}
