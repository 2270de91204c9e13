//! Results as plain data that serialises: what `--json` prints, and what another program reads.

mod balance;
mod certificate;
mod complete_design;
mod robustness;
mod two_axes;

use std::collections::BTreeMap;

use crate::wording::figures::describe_unmeasured;
use counterpoise_lti::StateSpace;
use counterpoise_models::plant::LinearPlant;
use counterpoise_project::Assumption;
use counterpoise_reduce::Warning;
use counterpoise_simulate::replay::{ChannelFit, Divergence, ReplayMode};
use counterpoise_synth::{DesignFinding, Specification, Weight};
use counterpoise_verify::{Value, Verdict, Verification};
use serde::Serialize;

use crate::exchange::controller_file::PathResult;
use crate::exchange::error_budget::{ErrorBudgetResult, SightProcedureResult};
use crate::exchange::systems::{StoredController, controllers_of_design, stored_frequencies_hz};
use crate::exchange::verification_data::{history_results, response_results, verified_loop};
use crate::exchange::{
    BalanceResult, HistoryResult, ResponseResult, SCHEMA, StructureResult, SystemResult, TargetsResult,
    TransferFunctionResult, VerifiedLoop,
};
use crate::recordings::ReplayedRecording;
use crate::studies::assumptions::AssumptionEffect;
use crate::tolerance::ROUNDED_POLE;
use crate::wording::design_findings::describe_part;
pub use certificate::CertificateResult;
pub use complete_design::ResultContents;
pub use robustness::{AdviceResult, RobustnessResult};
pub use two_axes::{JointColumn, JointFigureResult, JointHistoryResult, JointResult, JointVerdictResult};

use crate::certificates::Certificate;
use crate::plant_views::FrictionView;
use crate::studies::accuracy::Accuracy;
use crate::studies::adaptation_trials::AdaptationTrials;
use crate::studies::comparison::DesignComparison;
use crate::wording::acceptance::AcceptanceSource;
use crate::wording::certificates::describe_certified_quantity;
use crate::wording::serialisation::{write_demanded_rate, write_design_findings, write_reduction_warnings};
use crate::{
    CompletedDesign, DemandedRate, PipelineError, PlantModel, ReducedPlant, SynthesisedDesign, TwoAxisStudy,
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

/// The reduction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReduceResult {
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
    /// The notes for the designer; serialised as sentences.
    #[serde(serialize_with = "write_reduction_warnings")]
    pub warnings: Vec<Warning>,
    /// The plant before the reduction.
    pub plant_before: SystemResult,
    /// The reduced plant.
    pub plant: SystemResult,
    /// Hub rate for each input.
    pub responses: Vec<ResponseResult>,
}

/// The design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SynthResult {
    /// Name and version of the schema.
    pub schema: &'static str,
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
    /// The costs of the parts.
    pub costs: Vec<CostResult>,
    /// The largest rate that a loop of position demands, and why, serialised as a sentence; absent for a loop of rate.
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "write_demanded_rate")]
    pub demanded_rate: Option<DemandedRate>,
    /// The notes for the designer; serialised as sentences.
    #[serde(serialize_with = "write_design_findings")]
    pub warnings: Vec<DesignFinding>,
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

/// The cost of a part of the design: the mean square of its weighted signals.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CostResult {
    /// The part.
    pub part: String,
    /// As its equations predict it.
    pub predicted: Option<f64>,
    /// As the assembled loop of this part has it.
    pub achieved: Option<f64>,
}

/// A figure with its value.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FigureResult {
    /// Key, as in a project file.
    pub figure: String,
    /// Value; `None` if it could not be measured.
    pub value: Option<f64>,
    /// Unit.
    pub unit: &'static str,
    /// The basis: linear, or nonlinear with its amplitude.
    pub basis: String,
}

/// A requirement with its verdict.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VerdictResult {
    /// Key of the figure.
    pub figure: String,
    /// The basis of the figure: linear, or nonlinear with its amplitude.
    pub basis: String,
    /// `holds`, `fails` or `not applicable`.
    pub verdict: &'static str,
    /// Value.
    pub value: Option<f64>,
    /// Limit.
    pub limit: Option<f64>,
    /// `at least` or `at most`.
    pub limit_side: &'static str,
    /// Why it is not applicable.
    pub why: Option<String>,
    /// The origin of the requirement, as the project file states it; empty if it does not.
    pub source: String,
    /// The run that judged it.
    pub judged_by: String,
    /// The test on the machine that would.
    pub acceptance_test: String,
}

/// The verification.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VerifyResult {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// `true` if no requirement fails and the loop is stable.
    pub passes: bool,
    /// Verdicts, in the order of the project file.
    pub verdicts: Vec<VerdictResult>,
    /// Every figure.
    pub figures: Vec<FigureResult>,
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
    /// The traverse axis alone, and both axes together; absent if the project has no traverse axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub two_axes: Option<TwoAxesResult>,
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
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TwoAxesResult {
    /// Name of the traverse axis' machine.
    pub name: String,
    /// `true` if no requirement of the traverse axis or of both axes fails.
    pub passes: bool,
    /// The verification of the traverse axis alone.
    pub traverse: Box<VerifyResult>,
    /// Both axes together.
    #[serde(flatten)]
    pub joint: JointResult,
}

impl TwoAxesResult {
    /// Returns the result of a study.
    ///
    /// # Errors
    /// Those of the traverse axis' linear loop.
    pub fn new(study: &TwoAxisStudy) -> Result<Self, PipelineError> {
        let design = &study.traverse;
        let (verified, plant) = (&design.verified, &design.modelled.plant);
        let measured_on = verified_loop(plant, verified.controller(), &design.procedure)?;
        Ok(Self {
            name: design.project.plant.name.clone(),
            passes: study.passes(),
            traverse: Box::new(VerifyResult::new(verified.verification(), measured_on)),
            joint: (&study.joint).into(),
        })
    }

    /// Leaves out the time histories.
    pub fn leave_histories_out(&mut self) {
        self.traverse.leave_histories_out();
        self.joint.histories.clear();
    }
}

impl VerifyResult {
    /// Leaves out the time histories, those of the certificate's motions, and those of the adaptation's trials.
    pub fn leave_histories_out(&mut self) {
        self.histories.clear();
        self.certificate.iter_mut().for_each(CertificateResult::leave_histories_out);
        self.adaptation_trials.iter_mut().for_each(|trials| trials.histories.clear());
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
        Self { passes: self.passes && !refused, adaptation_trials, ..self }
    }
}

/// A number that certifies a design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DesignCertificateResult {
    /// The quantity that was computed.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// `true` if it is within its limit.
    pub holds: bool,
}

/// A whole design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DesignResult {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// The plant.
    pub model: ModelResult,
    /// The reduction.
    pub reduce: ReduceResult,
    /// The design.
    pub synth: SynthResult,
    /// The verification.
    pub verify: VerifyResult,
    /// The demand of each weight, in words.
    pub weights_in_words: Vec<String>,
    /// Residuals, costs and poles that certify the design.
    pub certificates: Vec<DesignCertificateResult>,
    /// The design beside its alternatives.
    pub beside: DesignComparison,
    /// The controller in every kind of numbers.
    pub targets: TargetsResult,
    /// Names of the files of code.
    pub files: Vec<String>,
    /// Code that the project asks for and cannot have, with the reason.
    pub left_out: Vec<String>,
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
        let design_plant = made.design.plant.measured_plant().ok().map(|system| {
            let measured = controlled.named_signal("measured_rate_rad_s");
            let outputs: Vec<&str> = std::iter::once(measured.as_str())
                .chain(made.output_names.iter().map(String::as_str))
                .collect();
            SystemResult::new("design plant", &system, &LinearPlant::INPUTS, &outputs)
        });
        let broken = &made.sampled.loop_gain;
        Self {
            schema: SCHEMA,
            design_plant,
            weights: weights(&made.design.specification),
            paths: paths.iter().map(|path| PathResult::of(path).of_loop(controlled)).collect(),
            sampled_loop: SystemResult::new("sampled loop", broken, &["control_v"], &["returned_control_v"]),
            responses: controller_responses(&controllers, broken),
            controllers: controllers.into_iter().map(|controller| controller.result).collect(),
            plant_order: made.design.plant.measured_plant().map_or(0, |p| p.order()),
            path_orders: paths.iter().map(|p| (p.name.clone(), p.system.order())).collect(),
            closed_loop_poles: pairs(&made.sampled.closed_loop),
            largest_pole_modulus: made.sampled.closed_loop.iter().map(|pole| pole.norm()).fold(0.0, f64::max),
            cost_difference: [made.design.worst_cost_difference(), made.sampled.worst_cost_difference()]
                .into_iter()
                .flatten()
                .max_by(f64::total_cmp),
            costs: costs(made),
            demanded_rate: made.demanded_rate,
            warnings: made.warnings.clone(),
        }
    }
}

impl VerifyResult {
    /// Returns the result of a verification; `measured_on` is what its linear figures are measured on.
    pub fn new(found: &Verification, measured_on: VerifiedLoop) -> Self {
        let controlled = found.controlled_quantity();
        let figures = found.figures.iter().map(|measured| FigureResult {
            figure: measured.figure.key_in(controlled),
            value: match measured.value {
                Value::Is(value) => Some(value),
                Value::Absent { .. } => None,
            },
            unit: measured.figure.unit(controlled),
            basis: found.acceptance(&measured.figure).basis,
        });
        let verdicts = found.verdicts.iter().map(|(requirement, verdict)| {
            let acceptance = found.acceptance(&requirement.figure);
            let (verdict, value, limit, why) = match verdict {
                Verdict::Holds { value, limit, .. } => ("holds", Some(*value), Some(limit.value()), None),
                Verdict::Fails { value, limit, .. } => ("fails", Some(*value), Some(limit.value()), None),
                Verdict::NotApplicable { why } => {
                    ("not applicable", None, None, Some(describe_unmeasured(why)))
                }
            };
            VerdictResult {
                figure: requirement.figure.key_in(controlled),
                basis: acceptance.basis,
                verdict,
                value,
                limit,
                limit_side: requirement.limit.side(),
                why,
                source: requirement.source.clone(),
                judged_by: acceptance.judged_by,
                acceptance_test: acceptance.test,
            }
        });
        Self {
            schema: SCHEMA,
            passes: found.passes(),
            verdicts: verdicts.collect(),
            figures: figures.collect(),
            measured_on,
            responses: response_results(found),
            histories: history_results(found),
            sight_procedure: SightProcedureResult::of(&found.evidence.procedure),
            error_budget: found.error_budget.as_ref().map(Into::into),
            certificate: None,
            two_axes: None,
            adaptation_trials: None,
        }
    }
}

impl From<&Certificate> for DesignCertificateResult {
    fn from(found: &Certificate) -> Self {
        Self { name: describe_certified_quantity(found.quantity), value: found.value, holds: found.holds }
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
        Self {
            schema: SCHEMA,
            model: (&made.modelled).into(),
            reduce: (&made.reduced).into(),
            synth: (&made.synthesised).into(),
            verify: VerifyResult {
                certificate: Some((&made.stability).into()),
                ..VerifyResult::new(made.verified.verification(), designed.verified_loop.clone())
            }
            .with_adaptation(designed.adaptation.clone()),
            weights_in_words: designed.weights.clone(),
            certificates: designed.certificates.iter().map(DesignCertificateResult::from).collect(),
            beside: designed.comparison.clone(),
            targets: TargetsResult::of(&designed.targets, made.synthesised.controlled),
            files: made.files.iter().map(|f| f.name.clone()).collect(),
            left_out: made.all_left_out().map(ToString::to_string).collect(),
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
    let feedforwards = [("heave", &design.heave), ("pitch", &design.pitch)].into_iter();
    let feedforwards = feedforwards.filter_map(|(name, part)| Some((name, part.as_ref()?.cost)));
    let joint = design.joint.iter().map(|joint| ("joint", joint.cost));
    let continuous = std::iter::once(("feedback", design.feedback.cost)).chain(feedforwards).chain(joint);
    let continuous = continuous.map(|(name, cost)| (name.to_owned(), cost));
    let sampled = made.sampled.certified.iter();
    let sampled = sampled.map(|part| (format!("{} in sampled time", describe_part(part.part)), part.cost));
    let result = |(part, cost): (String, counterpoise_synth::Cost)| CostResult {
        part,
        predicted: cost.predicted,
        achieved: cost.achieved,
    };
    continuous.chain(sampled).map(result).collect()
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
