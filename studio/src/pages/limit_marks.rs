//! The limit of the selected requirement, drawn into the charts from which its figure is read.

use counterpoise_verify::{
    HistoryColumn, Limit, LoopFigure, PerformanceFigure, Quantity, Requirement, Source, StepFigure,
    Verification,
};

use crate::charts::chart::Chart;
use crate::number_format::format_short;
use crate::view::StudioView;

/// Returns the selected requirement.
pub fn selected_requirement<'a>(view: &StudioView, found: &'a Verification) -> Option<&'a Requirement> {
    let last = found.verdicts.len().saturating_sub(1);
    found.verdicts.get(view.requirement.min(last)).map(|(requirement, _)| requirement)
}

/// Marks the limit of the selected requirement in a chart over time if it limits the column that this chart shows.
pub fn mark_history_limit(view: &StudioView, found: &Verification, column: HistoryColumn, chart: &mut Chart) {
    let Some(requirement) = selected_requirement(view, found) else { return };
    let limit = requirement.limit.value();
    let mut both = |value: f64| chart.levels.extend([value, -value]);
    match (requirement.figure, column) {
        (PerformanceFigure::Disturbance(_, _, _, Quantity::HubPeak), HistoryColumn::HubRate)
        | (PerformanceFigure::Disturbance(_, _, _, Quantity::TipPeak), HistoryColumn::TipRate) => {
            both(view.units.display_unit(requirement.figure.unit(found.controlled_quantity())).factor * limit)
        }
        (PerformanceFigure::Disturbance(_, _, _, Quantity::CurrentPeak), HistoryColumn::Current)
        | (PerformanceFigure::Disturbance(_, _, _, Quantity::ControlPeak), HistoryColumn::Control)
        | (PerformanceFigure::Step(_, StepFigure::ControlPeak), HistoryColumn::Control) => both(limit),
        (PerformanceFigure::Step(model, StepFigure::Overshoot), HistoryColumn::HubRate) => {
            let factor = view.units.display_unit(found.controlled_quantity().unit()).factor;
            chart.levels.push(factor * found.highest_allowed_rad_s(model, limit));
        }
        (
            PerformanceFigure::Step(
                _,
                StepFigure::RiseTime | StepFigure::PeakTime | StepFigure::SettlingTime,
            ),
            HistoryColumn::HubRate,
        ) => {
            chart.add_mark(limit, "limit");
        }
        _ => {}
    }
}

/// Marks the limit of a disturbance rejection in its chart.
pub fn mark_rejection_limit(view: &StudioView, found: &Verification, shown: Source, chart: &mut Chart) {
    if let Some(Requirement {
        figure: PerformanceFigure::Rejection { source, frequency_hz, .. }, limit, ..
    }) = selected_requirement(view, found)
        && *source == shown
    {
        let (rate, at) = (std::f64::consts::TAU * frequency_hz, limit.value());
        chart.levels.push(view.units.display_gain(10f64.powf(at / 20.0)));
        chart.add_mark(view.units.display_frequency(rate), format!("limit {} dB", format_short(at)));
    }
}

/// Marks the limit of a sensitivity in the chart of both sensitivities.
pub fn mark_sensitivity_limit(view: &StudioView, found: &Verification, chart: &mut Chart) {
    let figure = selected_requirement(view, found).map(|r| (r.figure, r.limit));
    if let Some((
        PerformanceFigure::Loop(LoopFigure::MaxSensitivity | LoopFigure::MaxComplementary),
        Limit::AtMost(most) | Limit::AtLeast(most),
    )) = figure
    {
        chart.levels.push(view.units.display_gain(most));
    }
}
