//! The limit of the chosen requirement, drawn where its figure is read from.

use counterpoise_verify::{
    Experiment, Figure, History, Limit, LoopFigure, Quantity, Requirement, Source, StepFigure, Verification,
};

use crate::chart::Chart;
use crate::view::View;

/// What a chart over time shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    /// The hub's rate.
    Hub,
    /// The control.
    Control,
    /// The motor's current.
    Current,
    /// The tip's rate.
    Tip,
}

/// The requirement that is chosen.
pub fn chosen<'a>(view: &View, found: &'a Verification) -> Option<&'a Requirement> {
    let last = found.verdicts.len().saturating_sub(1);
    found.verdicts.get(view.verdict.min(last)).map(|(requirement, _)| requirement)
}

/// Draws the limit of the chosen requirement into a chart over time, where it limits what is drawn there.
pub fn over_time(
    view: &View,
    found: &Verification,
    experiment: Experiment,
    signal: Signal,
    chart: &mut Chart,
) {
    let Some(requirement) = chosen(view, found) else { return };
    let limit = requirement.limit.value();
    let mut both = |value: f64| chart.levels.extend([value, -value]);
    match (requirement.figure, signal) {
        (Figure::Disturbance(_, _, _, Quantity::HubPeak), Signal::Hub)
        | (Figure::Disturbance(_, _, _, Quantity::TipPeak), Signal::Tip) => both(view.angular() * limit),
        (Figure::Disturbance(_, _, _, Quantity::CurrentPeak), Signal::Current)
        | (Figure::Disturbance(_, _, _, Quantity::ControlPeak), Signal::Control)
        | (Figure::Step(_, StepFigure::ControlPeak), Signal::Control) => both(limit),
        (Figure::Step(model, StepFigure::Overshoot), Signal::Hub) => {
            let demand = found.history(model, experiment).and_then(demanded).unwrap_or_default();
            chart.levels.push(view.angular() * demand * (1.0 + 0.01 * limit));
        }
        (
            Figure::Step(_, StepFigure::RiseTime | StepFigure::PeakTime | StepFigure::SettlingTime),
            Signal::Hub,
        ) => {
            chart.marks.push((limit, "limit".to_owned()));
        }
        _ => {}
    }
}

/// The demand that a step ends at, rad/s.
fn demanded(history: &History) -> Option<f64> {
    history.demand_rad_s.last().copied()
}

/// Draws the limit of a rejection into its chart.
pub fn of_rejection(view: &View, found: &Verification, of: Source, chart: &mut Chart) {
    if let Some(Requirement { figure: Figure::Rejection { source, frequency_hz, .. }, limit, .. }) =
        chosen(view, found)
        && *source == of
    {
        let (rate, at) = (std::f64::consts::TAU * frequency_hz, limit.value());
        chart.levels.push(view.level(10f64.powf(at / 20.0)));
        chart.marks.push((view.rate(rate), format!("limit {} dB", super::parts::short(at))));
    }
}

/// Draws the limit of a sensitivity into the chart of both.
pub fn of_sensitivity(view: &View, found: &Verification, chart: &mut Chart) {
    let figure = chosen(view, found).map(|r| (r.figure, r.limit));
    if let Some((
        Figure::Loop(LoopFigure::MaxSensitivity | LoopFigure::MaxComplementary),
        Limit::AtMost(most) | Limit::AtLeast(most),
    )) = figure
    {
        chart.levels.push(view.level(most));
    }
}
