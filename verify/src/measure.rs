//! Figures read from margins and time histories.

use counterpoise_lti::{GainChange, Margins};

use crate::history::{Experiment, History};
use crate::signals::statistics::subtract_mean;
use crate::signals::{StepFigures, mean, peak, rms, step_figures};
use crate::{
    LoopFigure, MissingReason, Model, PerformanceFigure, Quantity, RestFigure, Source, StepFigure,
    TriangleFigure,
};

/// Value of a figure.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number in the figure's unit; infinite if the figure has no bound (a loop that diverges, a margin without limit).
    Is(f64),
    /// There is no such number.
    Absent {
        /// Why.
        why: MissingReason,
    },
}

/// A figure with its value.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredFigure {
    /// Figure.
    pub figure: PerformanceFigure,
    /// Value.
    pub value: Value,
}

impl Value {
    fn of(number: Option<f64>, why: MissingReason) -> Self {
        number.filter(|v| !v.is_nan()).map_or(Value::Absent { why }, Value::Is)
    }
}

/// Returns the margins of the loop broken at the plant's input, and the pole radius of the closed loop. An unstable loop has no
/// margins: each is 0, and the sensitivities are infinite.
pub fn loop_figures(margins: &Margins, pole_radius: f64) -> Vec<MeasuredFigure> {
    let stable = pole_radius < 1.0;
    let margin = |value: f64| if stable { value } else { 0.0 };
    let peak = |value: f64| if stable { value } else { f64::INFINITY };
    let smallest = |change: GainChange| {
        let those = margins.gain.iter().filter(|gain| gain.change == change);
        those.map(|gain| gain.db.abs()).fold(f64::INFINITY, f64::min)
    };
    let phase = margins.phase.iter().map(|phase| phase.deg.abs()).fold(f64::INFINITY, f64::min);
    let crossover =
        margins.phase.iter().map(|phase| phase.rate_rad_s).fold(0.0, f64::max) / std::f64::consts::TAU;
    let all = [
        (LoopFigure::GainMargin, margin(smallest(GainChange::Increase))),
        (LoopFigure::GainReductionMargin, margin(smallest(GainChange::Decrease))),
        (LoopFigure::PhaseMargin, margin(phase)),
        (LoopFigure::DelayMargin, margin(margins.delay_s)),
        (LoopFigure::DiskMargin, margin(margins.disk.alpha)),
        (LoopFigure::MaxSensitivity, peak(margins.ms.value)),
        (LoopFigure::MaxComplementary, peak(margins.mt.value)),
        (LoopFigure::PoleRadius, pole_radius),
        (LoopFigure::Crossover, crossover),
    ];
    all.into_iter()
        .map(|(figure, value)| MeasuredFigure {
            figure: PerformanceFigure::Loop(figure),
            value: Value::Is(value),
        })
        .collect()
}

/// Returns the figures of a time history. Statistics of a disturbance start at `settle_s`; those of a rest at half time.
pub fn history_figures(history: &History, settle_s: f64) -> Vec<MeasuredFigure> {
    match history.experiment {
        Experiment::Step => step_of(history),
        Experiment::Triangle => triangle_of(history, settle_s),
        Experiment::Disturbance(..) => disturbance_of(history, settle_s),
        Experiment::Rest => rest_of(history),
    }
}

/// Returns the same figures of a history that does not exist because the loop diverges: all infinite.
pub fn infinite_figures(model: Model, experiment: Experiment) -> Vec<MeasuredFigure> {
    let all = PerformanceFigure::all().into_iter().filter(|figure| match (figure, experiment) {
        (PerformanceFigure::Step(m, _), Experiment::Step)
        | (PerformanceFigure::Triangle(m, _), Experiment::Triangle) => *m == model,
        (PerformanceFigure::Disturbance(m, source, arrangement, _), Experiment::Disturbance(s, a)) => {
            (*m, *source, *arrangement) == (model, s, a)
        }
        (PerformanceFigure::Rest(_), Experiment::Rest) => model == Model::Nonlinear,
        _ => false,
    });
    all.map(|figure| MeasuredFigure { figure, value: Value::Is(f64::INFINITY) }).collect()
}

fn step_of(history: &History) -> Vec<MeasuredFigure> {
    let demand = history.demand_rad_s().last().copied().unwrap_or(0.0);
    let found = step_figures(history.time_s(), history.hub_rate_rad_s(), demand);
    let control = peak(history.control_v());
    let all: Vec<(StepFigure, Value)> = match found {
        Ok(found) => step_values(&found, control),
        Err(error) => {
            vec![(StepFigure::Overshoot, Value::Absent { why: MissingReason::StepResponse(Box::new(error)) })]
        }
    };
    all.into_iter()
        .map(|(figure, value)| MeasuredFigure {
            figure: PerformanceFigure::Step(history.model, figure),
            value,
        })
        .collect()
}

fn step_values(found: &StepFigures, control_peak_v: f64) -> Vec<(StepFigure, Value)> {
    let some = |number: f64| Value::of(Some(number), MissingReason::NotANumber);
    vec![
        (StepFigure::Overshoot, some(found.overshoot_percent)),
        (StepFigure::RiseTime, Value::of(found.rise_time_s, MissingReason::NoRise)),
        (StepFigure::PeakTime, Value::of(found.peak_time_s, MissingReason::NoPeak)),
        (
            StepFigure::SettlingTime,
            Value::of(found.settling_time_s.or(Some(f64::INFINITY)), MissingReason::NotANumber),
        ),
        (StepFigure::SteadyStateError, some(found.steady_state_error_percent)),
        (StepFigure::ControlPeak, some(control_peak_v)),
    ]
}

fn disturbance_of(history: &History, settle_s: f64) -> Vec<MeasuredFigure> {
    let Experiment::Disturbance(source, arrangement) = history.experiment else { return Vec::new() };
    let first = history.index_at(settle_s);
    let of = |column: &[f64], what: fn(&[f64]) -> f64| {
        let number = column.get(first..).filter(|part| !part.is_empty()).map(what);
        Value::of(number, MissingReason::NoSuchSignal)
    };
    let all = [
        (Quantity::HubRms, of(history.hub_rate_rad_s(), rms)),
        (Quantity::HubPeak, of(history.hub_rate_rad_s(), peak)),
        (Quantity::TipRms, of(history.tip_rate_rad_s(), rms)),
        (Quantity::TipPeak, of(history.tip_rate_rad_s(), peak)),
        (Quantity::ControlRms, of(history.control_v(), |part| rms(&subtract_mean(part)))),
        (Quantity::ControlPeak, of(history.control_v(), peak)),
        (Quantity::CurrentPeak, of(history.current_a(), peak)),
        (Quantity::TravelPeak, of(history.travel_rad(), peak)),
        (Quantity::GearOpen, of(history.contact(), |part| 1.0 - mean(part))),
        (Quantity::Rejection, rejection_of(history, source, first)),
    ];
    let figure = |quantity| PerformanceFigure::Disturbance(history.model, source, arrangement, quantity);
    all.into_iter().map(|(quantity, value)| MeasuredFigure { figure: figure(quantity), value }).collect()
}

/// RMS of the hub's rate over that of the platform's motion, dB.
fn rejection_of(history: &History, source: Source, first: usize) -> Value {
    let size = |column: &[f64]| column.get(first..).filter(|part| !part.is_empty()).map(rms);
    let ratio =
        size(history.hub_rate_rad_s()).zip(size(history.motion(source))).filter(|(_, moved)| *moved > 0.0);
    Value::of(ratio.map(|(hub, moved)| 20.0 * (hub / moved).log10()), MissingReason::PlatformStill)
}

fn triangle_of(history: &History, settle_s: f64) -> Vec<MeasuredFigure> {
    let first = history.index_at(settle_s).min(history.len());
    let error = &history.tracking_error_rad_s()[first..];
    let some = |number: f64| Value::of((!error.is_empty()).then_some(number), MissingReason::EmptyRecord);
    let all = [
        (TriangleFigure::ErrorRms, some(rms(error))),
        (TriangleFigure::ErrorPeak, some(peak(error))),
        (TriangleFigure::ControlPeak, some(peak(&history.control_v()[first..]))),
    ];
    let figure = |figure| PerformanceFigure::Triangle(history.model, figure);
    all.into_iter().map(|(one, value)| MeasuredFigure { figure: figure(one), value }).collect()
}

fn rest_of(history: &History) -> Vec<MeasuredFigure> {
    let half = history.len() / 2;
    let drift = history
        .travel_rad()
        .last()
        .zip(history.travel_rad().get(half))
        .map(|(end, start)| (end - start).abs());
    let all = [
        (RestFigure::HubRms, Value::Is(rms(&history.hub_rate_rad_s()[half..]))),
        (RestFigure::Drift, Value::of(drift, MissingReason::EmptyRecord)),
    ];
    all.into_iter()
        .map(|(figure, value)| MeasuredFigure { figure: PerformanceFigure::Rest(figure), value })
        .collect()
}
