//! The components and regimes of the residuals of the simulation, in sentences.

use counterpoise_diagnose::findings::answer::Pattern;
use counterpoise_diagnose::findings::localisation_chart::{LocalisationChart, SearchAgreement};
use counterpoise_diagnose::localisation::error_map::MapCell;
use counterpoise_diagnose::localisation::trend::{Extent, Repetition, Trend, TrendForm};

/// Describes what a function of a regime variable looks like.
pub fn describe_trend(trend: Trend) -> String {
    match trend {
        Trend::Simple { form, extent } => {
            let form = match form {
                TrendForm::Constant => "the same throughout",
                TrendForm::Proportional => "in proportion to it",
                TrendForm::Odd => "odd in it",
                TrendForm::Even => "even in it",
            };
            match extent {
                Some(extent) => format!("{form}, {}", describe_extent(extent)),
                None => form.to_owned(),
            }
        }
        Trend::Periodic { repetition: None } => "it repeats".to_owned(),
        Trend::Periodic { repetition: Some(repetition) } => describe_repetition(repetition),
    }
}

fn describe_repetition(repetition: Repetition) -> String {
    match repetition {
        Repetition::Along { period, half_width, extent } => {
            let unit = after_number(extent.unit);
            format!("it repeats every {period:.4} +/- {half_width:.4}{unit}, {}", describe_extent(extent))
        }
        Repetition::InTime { period_s, half_width_s } => {
            format!("it repeats every {period_s:.4} +/- {half_width_s:.4} s")
        }
        Repetition::WithMotorTurn { order } => format!("it repeats every 1/{order:.0} turn of the motor"),
    }
}

fn describe_extent(extent: Extent) -> String {
    format!("over {:.3} to {:.3}{}", extent.low, extent.high, after_number(extent.unit))
}

/// Returns a unit as it is written after a number.
fn after_number(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// Describes what a mismatch depends on.
pub(super) fn describe_pattern(pattern: Option<&Pattern>) -> String {
    let Some(pattern) = pattern else { return "along none of the variables that were tried".to_owned() };
    let share = 100.0 * pattern.explained;
    let trend = pattern.trend.map_or_else(String::new, |trend| format!("; {}", describe_trend(trend)));
    format!(
        "with {}: an error that follows it explains {share:.0} % of what can be explained{trend}",
        pattern.regime
    )
}

/// Describes a chart in a few sentences.
pub fn describe_chart(chart: &LocalisationChart) -> String {
    let agreement = match chart.agreement {
        SearchAgreement::Agrees => "",
        SearchAgreement::FoundNothing => {
            " The search identified no effect: what shows here is too small for one."
        }
        SearchAgreement::FoundAnother => {
            " The search then identified an effect of another cell (ringed): the equations of torque and motion are simpler than the simulator, and its fits decide."
        }
    };
    format!("{}{agreement}", describe_best_cell(chart))
}

fn describe_best_cell(chart: &LocalisationChart) -> String {
    let Some(best) = &chart.best else {
        return "No cell stands out: an error at any component, along any of these variables, explains no more than noise alone may. \
                The residual of the equations of torque and motion is noise."
            .to_owned();
    };
    let words = |name: &str| name.replace('_', " ");
    let alike = match chart.likeliest.split_last() {
        Some((last, some)) if !some.is_empty() => {
            let some: Vec<String> = some.iter().map(|component| words(component.name())).collect();
            format!(
                "The equations of torque and motion cannot separate {} and {}; the fits in the simulator may.",
                some.join(", "),
                words(last.name())
            )
        }
        _ => "An error at any other component explains clearly less.".to_owned(),
    };
    let MapCell { component, regime, explained, log_likelihood_gain, trend } = best;
    let trend = trend.map_or_else(String::new, |trend| format!(" ({})", describe_trend(trend)));
    format!(
        "The best cell, {} along {regime}{trend}, raises the log-likelihood of held-out data by {log_likelihood_gain:.0}: {:.0} % of what a perfect \
         explanation would. {alike}",
        words(component.name()),
        100.0 * explained
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trends_are_described_with_their_extent() {
        let extent = Extent { low: -1.0, high: 1.0, unit: "N m" };
        let odd = Trend::Simple { form: TrendForm::Odd, extent: Some(extent) };
        assert_eq!(describe_trend(odd), "odd in it, over -1.000 to 1.000 N m");
        let along = Repetition::Along { period: 0.31, half_width: 0.001, extent };
        let periodic = Trend::Periodic { repetition: Some(along) };
        let text = "it repeats every 0.3100 +/- 0.0010 N m, over -1.000 to 1.000 N m";
        assert_eq!(describe_trend(periodic), text);
        assert_eq!(describe_trend(periodic.without_numbers()), "it repeats");
    }
}
