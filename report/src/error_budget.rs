//! The error budget of the line of sight in words: what the error is, and what it is made of.

use counterpoise_verify::{ErrorBudget, SightFigure, Verification};

use crate::{Cell, Column, Section, Table};

/// Microradians in a radian.
const MICRO: f64 = 1e6;

/// Returns the section on the line of sight; `None` if the verification did not ask for it.
pub fn section(found: &Verification) -> Option<Section> {
    let budget = found.error_budget.as_ref()?;
    let section = Section::new("Line of sight")
        .saying(summary(budget, exposure_s(found)))
        .saying(
            "Shares come from runs in which the sources are switched on one after the other, in one order and in the opposite one; they add up to \
             the mean square of the run with all of them. A negative share belongs to a source that reduces the error of the others.",
        )
        .saying(superposition(budget));
    Some(section.listing(table(budget)))
}

/// Returns the line of sight in lines, for a terminal; none if the verification did not ask for it.
pub fn lines(found: &Verification) -> Vec<String> {
    let Some(budget) = &found.error_budget else { return Vec::new() };
    let total = total_square(budget, SightFigure::Hub);
    let share = |one: &counterpoise_verify::Contribution| {
        let hub = place(SightFigure::Hub);
        let percent = if total > 0.0 { 100.0 * one.share_rad2[hub] / total } else { 0.0 };
        format!(
            "{}: {percent:.1} % of the mean square, {:.1} urad alone",
            one.source.name(),
            MICRO * one.alone_rad[hub]
        )
    };
    let mut lines = vec![summary(budget, exposure_s(found)), superposition(budget)];
    lines.extend(budget.contributions.iter().map(share));
    lines
}

fn exposure_s(found: &Verification) -> f64 {
    found.evidence.procedure.line_of_sight.unwrap_or_default().exposure_s
}

fn place(figure: SightFigure) -> usize {
    SightFigure::ALL.iter().position(|one| *one == figure).unwrap_or(0)
}

fn total_square(budget: &ErrorBudget, figure: SightFigure) -> f64 {
    budget.total_rad[place(figure)].powi(2)
}

fn summary(budget: &ErrorBudget, exposure_s: f64) -> String {
    let of = |figure| MICRO * budget.total_rad[place(figure)];
    format!(
        "On the nonlinear plant in motion the line of sight has an RMS of {:.1} urad at the hub and {:.1} urad at the tip; the jitter within \
         {exposure_s} s is {:.2} and {:.2} urad.",
        of(SightFigure::Hub),
        of(SightFigure::Tip),
        of(SightFigure::HubJitter),
        of(SightFigure::TipJitter)
    )
}

fn superposition(budget: &ErrorBudget) -> String {
    let hub = place(SightFigure::Hub);
    format!(
        "The shares add up to {:.1} urad at the hub. Each source alone, superposed as if the loop were linear, would make {:.1} urad.",
        MICRO * budget.sum_rad()[hub],
        MICRO * budget.superposed_rad()[hub]
    )
}

fn table(budget: &ErrorBudget) -> Table {
    let columns = [
        Column::Text("source"),
        Column::Number("share of the mean square, hub [%]"),
        Column::Number("alone, hub [urad]"),
        Column::Number("share of the jitter's, hub [%]"),
        Column::Number("alone, jitter, hub [urad]"),
        Column::Number("share of the mean square, tip [%]"),
        Column::Number("alone, tip [urad]"),
    ];
    let mut table = Table::new("Error budget of the line of sight", &columns);
    for one in &budget.contributions {
        let mut row = vec![Cell::text(one.source.name())];
        for figure in [SightFigure::Hub, SightFigure::HubJitter, SightFigure::Tip] {
            let (at, total) = (place(figure), total_square(budget, figure));
            row.push(Cell::number(if total > 0.0 { 100.0 * one.share_rad2[at] / total } else { 0.0 }));
            row.push(Cell::number(MICRO * one.alone_rad[at]));
        }
        table.rows.push(row);
    }
    table
}
