//! Charts over the rounds of a commissioning: predicted against measured, and what is left of the tolerances.

use counterpoise_models::ControlledQuantity;
use counterpoise_pipeline::commission::RoundSummary;
use counterpoise_report::wording::figures::describe_figure;
use counterpoise_verify::PerformanceFigure;

use crate::charts::chart::{Chart, LineDash};
use crate::theme::WindowTheme;

/// Half of the length that stands for a round on the axis.
const HALF: f64 = 0.3;
/// Requirements whose figures are drawn, at most.
const MOST: usize = 5;

/// Returns a chart for each requirement, and one of the tolerances.
pub fn charts(theme: &WindowTheme, rounds: &[RoundSummary], controlled: ControlledQuantity) -> Vec<Chart> {
    let figures = rounds.first().map_or(&[][..], |round| round.requirements.as_slice());
    let mut all: Vec<Chart> =
        figures.iter().take(MOST).map(|one| requirement_chart(theme, rounds, &one.figure)).collect();
    for (chart, one) in all.iter_mut().zip(figures) {
        chart.title = figure_name(&one.figure, controlled);
    }
    all.extend(tolerance_chart(theme, rounds));
    for chart in &mut all {
        chart.range[0] = Some((0.5, rounds.len().max(2) as f64 + 0.5));
    }
    all
}

/// Returns the name of a figure, of which a result has the key.
pub fn figure_name(key: &str, controlled: ControlledQuantity) -> String {
    let figure = PerformanceFigure::from_key_in(controlled, key);
    figure.map_or_else(|_| key.replace('_', " "), |figure| describe_figure(figure, controlled))
}

/// Returns a level for each round that has a value.
fn levels(rounds: &[RoundSummary], value: impl Fn(&RoundSummary) -> Option<f64>) -> Vec<[f64; 2]> {
    let level = |round: &RoundSummary| {
        let (at, y) = (round.round as f64, value(round).unwrap_or(f64::NAN));
        [[at - HALF, y], [at + HALF, y], [f64::NAN, f64::NAN]]
    };
    rounds.iter().flat_map(level).collect()
}

fn requirement_chart(theme: &WindowTheme, rounds: &[RoundSummary], figure: &str) -> Chart {
    let of = |round: &RoundSummary| round.requirements.iter().find(|one| one.figure == figure).cloned();
    let measured = levels(rounds, |round| of(round)?.measured);
    let predicted = levels(rounds, |round| of(round)?.predicted);
    let mut chart = Chart::new(figure, "round", "")
        .with_path("predicted", theme.weak, LineDash::Dashed, predicted)
        .with_path("measured", theme.accent, LineDash::Solid, measured);
    chart.levels.extend(rounds.first().and_then(of).map(|one| one.limit));
    chart.range[1] = Some((0.0, 1.15 * highest(&chart)));
    chart
}

/// Returns the highest level and limit of a chart.
fn highest(chart: &Chart) -> f64 {
    let points = chart.curves.iter().flat_map(|curve| curve.points.all().into_owned());
    points
        .map(|point| point[1])
        .filter(|y| y.is_finite())
        .chain(chart.levels.iter().copied())
        .fold(0.0, f64::max)
}

/// Returns what is left of each tolerance, in percent of the value; `None` if no value has one.
fn tolerance_chart(theme: &WindowTheme, rounds: &[RoundSummary]) -> Option<Chart> {
    let values = &rounds.iter().find(|round| !round.values.is_empty())?.values;
    let mut chart = Chart::new("tolerances that are left", "round", "percent");
    for (k, value) in values.iter().enumerate() {
        let left = levels(rounds, |round| {
            let found = round.values.iter().find(|one| one.key == value.key)?;
            Some(100.0 * found.half_width_after / found.after.abs().max(f64::MIN_POSITIVE))
        });
        let name = value.key.rsplit('.').next().unwrap_or(&value.key).replace('_', " ");
        chart = chart.with_path(&name, theme.curves[k % theme.curves.len()], LineDash::Solid, left);
    }
    let before = values.iter().map(|value| 100.0 * value.half_width_before / value.before.abs());
    chart
        .levels
        .extend(before.fold(None, |most: Option<f64>, one| Some(most.map_or(one, |most| most.max(one)))));
    chart.range[1] = Some((0.0, 1.15 * highest(&chart)));
    Some(chart)
}
