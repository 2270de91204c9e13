//! The rounds of a commissioning as plain data: what was predicted, measured, found and decided.

use counterpoise_diagnose::library::Effect;
use counterpoise_project::Project;
use serde::{Deserialize, Serialize};

use super::acceptance::{FigureSource, MachineVerdict, RunJudgement};
use super::run_plan::PlannedRun;
use super::update::ModelUpdate;
use crate::DesignStages;
use crate::tolerance::{ACCEPTANCE_MARGIN, CHANGED_TOLERANCE};

/// A round.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RoundSummary {
    /// Its number, from 1.
    pub round: usize,
    /// Hash of the controller that ran.
    pub controller_hash: String,
    /// Highest frequency at which the gain of its loop on the model is 1, rad/s.
    pub crossover_rad_s: Option<f64>,
    /// Its gain margin on the model, dB.
    pub gain_margin_db: Option<f64>,
    /// Each experiment.
    pub runs: Vec<RunSummary>,
    /// Experiments that were left out because the model predicts that they leave the limits.
    pub left_out: Vec<String>,
    /// Each requirement.
    pub requirements: Vec<RequirementSummary>,
    /// Each value that is known within a tolerance.
    pub values: Vec<ValueSummary>,
    /// Largest residual of a channel over its noise floor, with the model at the start of the round.
    pub residual_before: Option<f64>,
    /// The same with the updated model.
    pub residual_after: Option<f64>,
    /// The effects that were added to the model because no value explains it.
    pub findings: Vec<FindingSummary>,
    /// `true` if the updated model explains the recordings.
    pub is_explained: bool,
    /// Why the commissioning ends with this round; `None` if it goes on.
    pub stop: Option<StopReason>,
}

/// Returns the time that a machine ran in the experiments of rounds, s.
pub fn machine_time_s(rounds: &[RoundSummary]) -> f64 {
    rounds.iter().flat_map(|round| &round.runs).map(|run| run.duration_s).sum()
}

/// An experiment of a round.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunSummary {
    /// Its name.
    pub name: String,
    /// Its duration, s.
    pub duration_s: f64,
    /// Each channel, recorded against predicted.
    pub channels: Vec<ChannelSummary>,
    /// `true` if a channel left its predicted band.
    pub leaves_band: bool,
}

/// A channel of an experiment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChannelSummary {
    /// Its name in recordings.
    pub channel: String,
    /// RMS of what was recorded.
    pub recorded_rms: Option<f64>,
    /// RMS of what was recorded less what was predicted.
    pub error_rms: Option<f64>,
    /// Share of the samples outside the predicted band.
    pub outside: f64,
}

/// A requirement in a round.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RequirementSummary {
    /// Key of the figure.
    pub figure: String,
    /// The limit.
    pub limit: f64,
    /// On which side of it the figure holds: `at least` or `at most`.
    pub side: String,
    /// On the model.
    pub predicted: Option<f64>,
    /// On the machine; `None` if no experiment shows it.
    pub measured: Option<f64>,
    /// `true` if it holds, by the recording where there is one and by the model otherwise.
    pub holds: bool,
}

/// A value with a tolerance in a round.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ValueSummary {
    /// Its key.
    pub key: String,
    /// Unit of the key.
    pub unit: String,
    /// At the start of the round.
    pub before: f64,
    /// Half-width of its tolerance then.
    pub half_width_before: f64,
    /// After it.
    pub after: f64,
    /// The rest of the tolerance.
    pub half_width_after: f64,
}

/// An effect that was added to the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FindingSummary {
    /// The component.
    pub component: String,
    /// The effect.
    pub effect: String,
    /// Its fitted values.
    pub values: Vec<EffectValue>,
    /// Other effects that the recordings cannot tell from it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub equivalents: Vec<EquivalentEffect>,
}

/// An effect that explains the recordings as well as the one that was added.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct EquivalentEffect {
    /// Component.
    pub component: String,
    /// Effect.
    pub effect: String,
}

impl EquivalentEffect {
    fn of(effect: &Effect) -> Self {
        Self { component: effect.component.to_string(), effect: effect.effect.to_string() }
    }
}

/// A fitted value of an effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectValue {
    /// Its name.
    pub name: String,
    /// The value.
    pub value: f64,
    /// Its unit; empty for a pure number.
    pub unit: String,
}

/// Why a commissioning ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "reason", rename_all = "kebab-case")]
pub enum StopReason {
    /// Every requirement holds on the machine, with a margin.
    RequirementsMet,
    /// The project requires nothing, and its model explains the recordings.
    ModelExplains,
    /// The model explains the recordings, and no design of this kind meets these requirements on it.
    BeyondDesign {
        /// Keys of the figures.
        figures: Vec<String>,
    },
    /// The experiments within the limits change neither model nor tolerances any more, and these requirements are missed on the machine.
    NothingToLearn {
        /// Keys of the figures.
        figures: Vec<String>,
    },
    /// The machine stopped before the end of an experiment.
    Aborted {
        /// The experiment.
        run: String,
        /// The message of the machine.
        why: String,
    },
    /// No experiment keeps the limits, by the model's own prediction.
    NoExperiment,
    /// The rounds that were asked for are over.
    RoundsOver,
}

impl RoundSummary {
    /// Begins the summary of a round with its design.
    pub fn begin(round: usize, controller_hash: &str, stages: &DesignStages) -> Self {
        let verification = stages.verified.verification();
        let figure = |figure| verification.value(counterpoise_verify::PerformanceFigure::Loop(figure));
        Self {
            round,
            controller_hash: controller_hash.to_owned(),
            crossover_rad_s: figure(counterpoise_verify::LoopFigure::Crossover)
                .map(|hertz| std::f64::consts::TAU * hertz),
            gain_margin_db: figure(counterpoise_verify::LoopFigure::GainMargin),
            runs: Vec::new(),
            left_out: Vec::new(),
            requirements: Vec::new(),
            values: Vec::new(),
            residual_before: None,
            residual_after: None,
            findings: Vec::new(),
            is_explained: false,
            stop: None,
        }
    }

    /// Adds an experiment with what was recorded of it.
    pub fn add_run(&mut self, run: &PlannedRun, judgement: &RunJudgement) {
        let channels = judgement.channels.iter().map(|channel| ChannelSummary {
            channel: channel.channel.name().to_owned(),
            recorded_rms: channel.recorded_rms,
            error_rms: channel.error_rms,
            outside: channel.outside,
        });
        self.runs.push(RunSummary {
            name: run.name.to_owned(),
            duration_s: run.request.demand.len() as f64 * run.request.sample_period_s,
            channels: channels.collect(),
            leaves_band: judgement.leaves_band(),
        });
    }

    /// Adds the verdicts on the requirements of a project.
    pub fn add_verdicts(&mut self, project: &Project, verdicts: &[MachineVerdict]) {
        let controlled = project.plant.controlled_quantity();
        let summary = |verdict: &MachineVerdict| RequirementSummary {
            figure: verdict.figure.key_in(controlled),
            limit: verdict.limit.value(),
            side: verdict.limit.side().to_owned(),
            predicted: verdict.predicted,
            measured: verdict.measured,
            holds: verdict.holds(),
        };
        self.requirements.extend(verdicts.iter().map(summary));
    }

    /// Adds the updated model.
    pub fn add_update(&mut self, update: &ModelUpdate) {
        self.residual_before = Some(update.posterior.residual_before);
        self.residual_after = Some(update.residual);
        let value = |value: &super::FittedValue| ValueSummary {
            key: value.key.clone(),
            unit: value.unit.to_owned(),
            before: value.value_before,
            half_width_before: value.half_width_before,
            after: value.value,
            half_width_after: value.half_width,
        };
        self.values.extend(update.posterior.values.iter().map(value));
        self.findings.extend(update.posterior.effects.iter().map(|valued| {
            FindingSummary {
                component: valued.effect.component.to_string(),
                effect: valued.effect.effect.to_string(),
                equivalents: valued
                    .equivalents
                    .iter()
                    .map(|other| EquivalentEffect::of(other.effect))
                    .collect(),
                values: valued
                    .effect
                    .parameters
                    .iter()
                    .zip(&valued.values)
                    .map(|(parameter, value)| EffectValue {
                        name: parameter.name.to_owned(),
                        value: *value,
                        unit: parameter.unit.to_owned(),
                    })
                    .collect(),
            }
        }));
        self.is_explained = update.explains();
    }

    /// Returns the keys of the required figures that do not hold.
    pub fn missed_figures(&self) -> Vec<String> {
        let missed = self.requirements.iter().filter(|requirement| !requirement.holds);
        missed.map(|requirement| requirement.figure.clone()).collect()
    }
}

/// Returns why a commissioning ends before its model is updated, if it does: every requirement holds with a margin, and a recording shows one of them. A figure that a
/// recording could have shown and none does counts by the model only if all runs stayed within their predictions.
pub fn stop_before_update(verdicts: &[MachineVerdict], runs: &[RunSummary]) -> Option<StopReason> {
    let leaves_band = runs.iter().any(|run| run.leaves_band);
    let with_margin = |verdict: &MachineVerdict| {
        let value = verdict.measured.or(verdict.predicted);
        let room = value.map(|value| verdict.limit.distance_to_limit(value));
        let needed = match verdict.source {
            FigureSource::NotShown if leaves_band => return false,
            FigureSource::Recording => ACCEPTANCE_MARGIN * verdict.limit.value().abs(),
            FigureSource::Model | FigureSource::NotShown => 0.0,
        };
        room.is_some_and(|room| room >= needed)
    };
    let is_shown = verdicts.iter().any(|verdict| verdict.source == FigureSource::Recording);
    (is_shown && verdicts.iter().all(with_margin)).then_some(StopReason::RequirementsMet)
}

/// Returns why a commissioning ends after its model was updated, if it does.
pub fn stop_after_update(
    before: &Project,
    update: &ModelUpdate,
    verdicts: &[MachineVerdict],
    summary: &RoundSummary,
) -> Option<StopReason> {
    if verdicts.is_empty() {
        return update.explains().then_some(StopReason::ModelExplains);
    }
    if is_changed(before, update) {
        return None;
    }
    let figures = summary.missed_figures();
    let is_missed_on_model = |verdict: &&MachineVerdict| {
        verdict.predicted.is_some_and(|value| verdict.limit.distance_to_limit(value) < 0.0)
    };
    let by_model = verdicts.iter().filter(is_missed_on_model).count();
    Some(match update.explains() && by_model > 0 {
        true => StopReason::BeyondDesign { figures },
        false => StopReason::NothingToLearn { figures },
    })
}

/// Returns whether an update changes the model, or what is known of it, by more than the fit resolves.
fn is_changed(before: &Project, update: &ModelUpdate) -> bool {
    let is_found = !update.posterior.effects.is_empty() && update.project.plant != before.plant;
    let moves = update.posterior.values.iter().any(|value| {
        let shrinks = value.half_width < (1.0 - CHANGED_TOLERANCE) * value.half_width_before;
        let shifts = (value.value - value.value_before).abs() > value.half_width;
        shrinks || shifts
    });
    is_found || moves
}
