//! Recordings of a round against what was predicted and what is required.

use counterpoise_project::Project;
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::replay::reading_floor;
use counterpoise_verify::measure::{Value, history_figures};
use counterpoise_verify::{
    Arrangement, Experiment, History, Limit, Model, PerformanceFigure, Quantity, Requirement, RestFigure,
    TriangleFigure, Verdict, Verification,
};

use super::run_plan::PlannedRun;
use crate::DesignStages;
use crate::tolerance::BAND_SHARE;

/// A recording against its prediction.
#[derive(Debug, Clone, PartialEq)]
pub struct RunJudgement {
    /// Each channel that was predicted and recorded.
    pub channels: Vec<ChannelJudgement>,
}

/// A channel of a recording against its prediction.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelJudgement {
    /// The channel.
    pub channel: Channel,
    /// RMS of what was recorded; `None` if nothing was.
    pub recorded_rms: Option<f64>,
    /// RMS of what was recorded less what was predicted; `None` if nothing was.
    pub error_rms: Option<f64>,
    /// Share of the samples outside the predicted band.
    pub outside: f64,
}

impl RunJudgement {
    /// Returns whether a channel left its predicted band.
    pub fn leaves_band(&self) -> bool {
        self.channels.iter().any(|channel| channel.outside > BAND_SHARE)
    }
}

/// Compares a recording with its prediction.
pub fn judge_run(run: &PlannedRun, recording: &Recording) -> RunJudgement {
    let judge = |predicted: &super::PredictedChannel| {
        let recorded = recording.samples(predicted.channel)?;
        let count = recorded.len().min(predicted.values.len());
        let rms = |values: &mut dyn Iterator<Item = f64>| {
            let squares: Vec<f64> =
                values.filter(|value| value.is_finite()).map(|value| value * value).collect();
            (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
        };
        let is_outside = |k: &usize| {
            let value = recorded[*k];
            value.is_nan() || value < predicted.low[*k] || value > predicted.high[*k]
        };
        Some(ChannelJudgement {
            channel: predicted.channel,
            recorded_rms: rms(&mut recorded[..count].iter().copied()),
            error_rms: rms(&mut (0..count).map(|k| recorded[k] - predicted.values[k])),
            outside: (0..count).filter(is_outside).count() as f64 / count.max(1) as f64,
        })
    };
    RunJudgement { channels: run.predicted.iter().filter_map(judge).collect() }
}

/// The evidence for a required figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FigureSource {
    /// A recording of the machine.
    Recording,
    /// The model alone: no experiment on a machine shows the figure.
    Model,
    /// The model alone, because the experiment that shows the figure was left out, or the recording does not show it.
    NotShown,
}

/// The outcome of a requirement on the machine.
#[derive(Debug, Clone, PartialEq)]
pub struct MachineVerdict {
    /// The figure.
    pub figure: PerformanceFigure,
    /// Its limit.
    pub limit: Limit,
    /// The evidence.
    pub source: FigureSource,
    /// Its value on the model; `None` if it has none.
    pub predicted: Option<f64>,
    /// Its value in the recordings; `None` if no recording shows it.
    pub measured: Option<f64>,
}

impl MachineVerdict {
    /// Returns whether the requirement holds by what shows it.
    pub fn holds(&self) -> bool {
        let value = match self.source {
            FigureSource::Recording => self.measured,
            FigureSource::Model | FigureSource::NotShown => self.predicted,
        };
        value.is_some_and(|value| matches!(self.limit.judge(value), Verdict::Holds { .. }))
    }
}

/// A run with its recording.
#[derive(Debug, Clone)]
pub struct RecordedRun {
    /// The run.
    pub run: PlannedRun,
    /// The recording.
    pub recording: Recording,
}

/// Judges the project's requirements by the recordings of a round, and by the model where no experiment shows a figure.
pub fn judge_requirements(
    project: &Project,
    stages: &DesignStages,
    recorded: &[RecordedRun],
) -> Vec<MachineVerdict> {
    let requirements = project.verify.iter().flat_map(|asked| &asked.requirements);
    let verification = stages.verified.verification();
    let settle_s = stages.procedure.settle_s;
    requirements.map(|requirement| judge(requirement, project, verification, settle_s, recorded)).collect()
}

fn judge(
    requirement: &Requirement,
    project: &Project,
    verification: &Verification,
    settle_s: f64,
    recorded: &[RecordedRun],
) -> MachineVerdict {
    let figure = requirement.figure;
    let measure_shown = || {
        let experiment = Experiment::from_figure(figure);
        let shown = recorded.iter().find(|recorded| recorded.run.experiment == Some(experiment));
        shown.and_then(|recorded| measure(figure, experiment, &recorded.recording, project, settle_s))
    };
    let (source, measured) = match shows_in_recording(figure) {
        false => (FigureSource::Model, None),
        true => measure_shown()
            .map_or((FigureSource::NotShown, None), |value| (FigureSource::Recording, Some(value))),
    };
    MachineVerdict {
        figure,
        limit: requirement.limit,
        source,
        predicted: verification.value(figure),
        measured,
    }
}

/// Returns whether the sensors of a machine show a figure of a run with the whole controller.
fn shows_in_recording(figure: PerformanceFigure) -> bool {
    match figure {
        PerformanceFigure::Step(model, _) | PerformanceFigure::Triangle(model, _) => {
            model == Model::Nonlinear
        }
        PerformanceFigure::Rest(_) => true,
        PerformanceFigure::Disturbance(model, _, arrangement, quantity) => {
            let is_read = !matches!(
                quantity,
                Quantity::TipRms | Quantity::TipPeak | Quantity::CurrentPeak | Quantity::GearOpen
            );
            model == Model::Nonlinear && arrangement == Arrangement::Compensated && is_read
        }
        PerformanceFigure::Loop(_)
        | PerformanceFigure::Rejection { .. }
        | PerformanceFigure::Sight(_)
        | PerformanceFigure::Certificate(_) => false,
    }
}

fn measure(
    figure: PerformanceFigure,
    experiment: Experiment,
    recording: &Recording,
    project: &Project,
    settle_s: f64,
) -> Option<f64> {
    let history = History::of_recording(experiment, recording, project.plant.sensors.measured)?;
    let history = if experiment == Experiment::Step { history.from_time(settle_s) } else { history };
    let measured = history_figures(&history, settle_s).into_iter().find(|found| found.figure == figure)?;
    match measured.value {
        Value::Is(value) => Some(without_noise(figure, value, project)),
        Value::Absent { .. } => None,
    }
}

/// Returns an RMS of the hub's motion without the noise that the sensor's data sheet states: the reading is the motion and the noise.
fn without_noise(figure: PerformanceFigure, value: f64, project: &Project) -> f64 {
    let is_rms = match figure {
        PerformanceFigure::Rest(figure) => figure == RestFigure::HubRms,
        PerformanceFigure::Triangle(_, figure) => figure == TriangleFigure::ErrorRms,
        PerformanceFigure::Disturbance(.., quantity) => quantity == Quantity::HubRms,
        PerformanceFigure::Step(..)
        | PerformanceFigure::Loop(_)
        | PerformanceFigure::Rejection { .. }
        | PerformanceFigure::Sight(_)
        | PerformanceFigure::Certificate(_) => false,
    };
    if !is_rms {
        return value;
    }
    let plant = &project.plant;
    let noise = reading_floor(&plant.sensors.hub_gyro, &plant.interface);
    (value * value - noise * noise).max(0.0).sqrt()
}
