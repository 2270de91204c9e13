//! The changes that meet a requirement that fails, in words.

use counterpoise_pipeline::studies::advice::{TriedChange, WeightAdvice, WeightSensitivity};
use counterpoise_plot::number::short_number;
use counterpoise_verify::{PerformanceFigure, StepFigure};

use crate::wording::figures::describe_figure;
use crate::{ReportCell, ReportColumn, ReportSection, ReportTable};

/// Returns the advice for each failing requirement in a line.
pub fn advice_lines(all: &[WeightAdvice]) -> Vec<String> {
    all.iter().map(line).collect()
}

fn line(advice: &WeightAdvice) -> String {
    let meets = advice.change.as_ref().is_some_and(|change| change.holds);
    match advice.requirement.figure {
        PerformanceFigure::Step(_, StepFigure::Overshoot) if !meets => {
            format!("{}; {PREFILTER}", change_in_words(advice))
        }
        _ => change_in_words(advice),
    }
}

/// What lowers an overshoot that no weight does: a loop of position with an integrator overshoots at any bandwidth.
const PREFILTER: &str = "a filter of the demand ([synth.prefilter], with a pole below the bandwidth) lowers the overshoot and leaves the loop as it is";

fn change_in_words(advice: &WeightAdvice) -> String {
    let (name, unit) = (name(advice), advice.unit());
    let Some(change) = &advice.change else {
        return format!("{name}: no single weight of the design moves it");
    };
    let then = format!("then {} {unit}, {}", short_number(change.value), margin(change));
    if change.holds {
        format!("to meet {name}: {} ({then})", words(change))
    } else {
        format!("{name}: no single weight meets it within a factor of 3; nearest: {} ({then})", words(change))
    }
}

fn name(advice: &WeightAdvice) -> String {
    describe_figure(advice.requirement.figure, advice.controlled)
}

fn words(change: &TriedChange) -> String {
    let percent = 100.0 * (change.factor - 1.0).abs();
    let verb = if change.factor > 1.0 { "raise" } else { "lower" };
    format!("{verb} `{}` by {percent:.0} %", change.key)
}

fn margin(change: &TriedChange) -> String {
    let size = short_number(change.gain_margin_db.abs());
    if change.gain_margin_db < 0.0 {
        format!("costs {size} dB of gain margin")
    } else {
        format!("gains {size} dB of gain margin")
    }
}

/// Returns the section of a report; `None` if nothing fails.
pub fn advice_section(all: &[WeightAdvice]) -> Option<ReportSection> {
    if all.is_empty() {
        return None;
    }
    let mut section = ReportSection::new("What to change").with_text(
        "Each weight was changed by 5 %, the controller designed again and the figure measured again. The change that is advised was \
         made and measured.",
    );
    for line in advice_lines(all) {
        section = section.with_text(format!("{}{}.", line[..1].to_uppercase(), &line[1..]));
    }
    let columns = [
        ReportColumn::Text("requirement"),
        ReportColumn::Text("weight"),
        ReportColumn::Number("change of the figure per factor e"),
    ];
    let mut table = ReportTable::new("Sensitivities", &columns);
    for advice in all {
        for WeightSensitivity { key, per_factor_e: slope, .. } in &advice.sensitivities {
            let name = name(advice);
            table.rows.push(vec![ReportCell::text(name), ReportCell::text(*key), ReportCell::number(*slope)]);
        }
    }
    Some(section.with_table(table))
}
