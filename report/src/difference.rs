//! Two verifications side by side, as a section.

use crate::wording::figures::describe_figure;
use counterpoise_pipeline::RedesignComparison;
use counterpoise_verify::Verification;
use counterpoise_verify::difference::FigureChange;

use crate::tolerance::{LEAST_SHOWN_CHANGE, LEAST_SHOWN_DIFFERENCE, SAME_FIGURE};
use crate::{
    Headline, OutcomeTone, ProvenanceEntry, Report, ReportCell, ReportColumn, ReportSection, ReportTable,
};

/// Returns the report of what changed in a project's figures from an earlier one.
pub fn changes_report(machine: &str, before: &str, command: &str, changes: &[FigureChange]) -> Report {
    let turned = |found| {
        changes.iter().filter(|change| change.has_changed_verdict() && change.holds == Some(found)).count()
    };
    let tone = match (turned(true), turned(false)) {
        (_, 1..) => OutcomeTone::Bad,
        (1.., _) => OutcomeTone::Good,
        _ => OutcomeTone::Neutral,
    };
    Report {
        title: format!("Changes of {machine}"),
        subtitle: "the figures of two verifications side by side".to_owned(),
        headline: Headline { tone, text: summarise_changes(before, changes), detail: String::new() },
        tiles: Vec::new(),
        verdicts: ReportTable::new("", &[]),
        glance: Vec::new(),
        sections: vec![changes_section(before, changes)],
        provenance: vec![
            ProvenanceEntry::new("version", env!("CARGO_PKG_VERSION")),
            ProvenanceEntry::new("command", command),
        ],
    }
}

/// Returns every figure that changed, those whose verdict turned first.
pub fn changes_section(before: &str, changes: &[FigureChange]) -> ReportSection {
    let columns = [
        ReportColumn::Text("figure"),
        ReportColumn::Number("before"),
        ReportColumn::Number("after"),
        ReportColumn::Number("change"),
        ReportColumn::Text("requirement"),
    ];
    let mut table = ReportTable::new("", &columns);
    let mut moved: Vec<&FigureChange> = changes.iter().filter(|change| has_changed(change)).collect();
    moved.sort_by_key(|change| (!change.has_changed_verdict(), change.holds.is_none()));
    table.rows = moved.iter().map(|change| row(change)).collect();
    let same = changes.len() - moved.len();
    ReportSection::new("Before and after")
        .with_text(format!("Before: {before}. {} figures changed, {same} did not.", moved.len()))
        .with_table(table)
}

/// Returns the difference in one line: verdicts that turned, and how many figures changed.
pub fn summarise_changes(before: &str, changes: &[FigureChange]) -> String {
    let way = |found| {
        changes.iter().filter(|change| change.has_changed_verdict() && change.holds == Some(found)).count()
    };
    let figures = changes.iter().filter(|change| has_changed(change)).count();
    let turned = match (way(true), way(false)) {
        (0, 0) => "no verdict turned".to_owned(),
        (better, 0) => format!("now holds what did not: {better}"),
        (0, worse) => format!("no longer holds: {worse}"),
        (better, worse) => format!("now holds what did not: {better}, no longer holds: {worse}"),
    };
    format!("Against {before}: {turned}; {figures} of {} figures changed.", changes.len())
}

/// Returns what an improved model means for the controller that was designed on the one before.
pub fn consequence_section(found: &RedesignComparison) -> ReportSection {
    let counted = |v: &Verification| {
        let (hold, fail, _) = v.counts();
        format!("{hold} requirements hold, {fail} fail")
    };
    let anew = match &found.redesigned {
        Some(redesigned) => format!("Redesigned on the improved model: {}.", counted(redesigned)),
        None => "Redesigned on the improved model: the weights give no controller.".to_owned(),
    };
    let text = format!(
        "The controller designed on the model as it was: {} there, {} on the improved model. {anew}",
        counted(&found.before),
        counted(&found.kept)
    );
    let table = changes_section("the model as it was", &found.changes);
    ReportSection { heading: "What it means for the controller".to_owned(), ..table }.with_text(text)
}

/// Returns whether a figure changed at all.
pub fn has_changed(change: &FigureChange) -> bool {
    change.has_changed_verdict()
        || change.relative_change().is_none_or(|part| part.abs() > SAME_FIGURE)
            && change.before != change.after
}

/// Returns the verdict's way, in words.
pub fn classify_change(change: &FigureChange) -> (OutcomeTone, &'static str) {
    match (change.held, change.holds) {
        (Some(true), Some(false)) => (OutcomeTone::Bad, "no longer holds"),
        (Some(false), Some(true)) => (OutcomeTone::Good, "now holds"),
        (_, Some(true)) => (OutcomeTone::Good, "holds"),
        (_, Some(false)) => (OutcomeTone::Bad, "fails"),
        _ => (OutcomeTone::Neutral, ""),
    }
}

/// Returns the change as a person reads it: percent, or the difference where a figure is in decibels or
/// degrees.
pub fn describe_size(change: &FigureChange) -> String {
    let Some(difference) = change.difference() else { return "\u{2013}".to_owned() };
    match change.unit() {
        unit @ ("dB" | "deg" | "%") if difference.abs() < LEAST_SHOWN_DIFFERENCE => {
            format!("under 0.01 {unit}")
        }
        unit @ ("dB" | "deg" | "%") => format!("{:+.2} {unit}", difference),
        _ if change.relative_change().is_some_and(|part| part.abs() < LEAST_SHOWN_CHANGE) => {
            "under 0.1 %".to_owned()
        }
        _ => format!("{:+.1} %", 100.0 * change.relative_change().unwrap_or(f64::NAN)),
    }
}

fn row(change: &FigureChange) -> Vec<ReportCell> {
    let number = |value: Option<f64>| value.map_or_else(|| ReportCell::text("\u{2013}"), ReportCell::number);
    let (tone, word) = classify_change(change);
    let unit = change.unit();
    let name = if unit.is_empty() {
        describe_figure(change.figure, change.controlled)
    } else {
        format!("{} [{unit}]", describe_figure(change.figure, change.controlled))
    };
    let requirement =
        if word.is_empty() { ReportCell::text("") } else { ReportCell::Verdict(tone, word.to_owned()) };
    vec![
        ReportCell::text(name),
        number(change.before),
        number(change.after),
        ReportCell::text(describe_size(change).replace('-', "\u{2212}")),
        requirement,
    ]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use counterpoise_verify::PerformanceFigure;

    use super::*;

    fn change(before: f64, after: f64, verdicts: [bool; 2]) -> FigureChange {
        let figure = PerformanceFigure::from_key("gain_margin_db").unwrap();
        let [held, holds] = verdicts.map(Some);
        let controlled = counterpoise_models::ControlledQuantity::RATE;
        FigureChange { figure, controlled, before: Some(before), after: Some(after), held, holds }
    }

    #[test]
    fn the_headline_counts_verdicts_that_turned_either_way() {
        let all = [
            change(14.0, 9.0, [true, false]),
            change(8.0, 14.0, [false, true]),
            change(8.0, 8.0, [true, true]),
        ];
        let told = summarise_changes("before.toml", &all);
        assert!(told.contains("now holds what did not: 1, no longer holds: 1; 2 of 3 figures"), "{told}");
        assert!(summarise_changes("x", &all[2..]).contains("no verdict turned; 0 of 1"), "nothing changed");
    }

    #[test]
    fn a_change_too_small_to_print_is_not_printed_as_minus_nothing() {
        assert_eq!(describe_size(&change(14.0, 13.999, [true, true])), "under 0.01 dB");
        assert_eq!(describe_size(&change(14.0, 13.5, [true, true])), "-0.50 dB");
    }
}
