//! The error budget of the line of sight in words: what the error is, and what it is made of.

use counterpoise_pipeline::sight_views::SightView;
use counterpoise_plot::number::short_number;
use counterpoise_verify::{ErrorBudget, PerformanceFigure, SightFigure, Verification};

use crate::error_budget_figures::sight_figure;
use crate::{ReportCell, ReportColumn, ReportSection, ReportTable};

/// Microradians in a radian.
const MICRO: f64 = 1e6;

/// Millimetres in a metre, as a factor of a spatial frequency.
const PER_MILLIMETRE: f64 = 1e-3;

/// Returns the section on the line of sight, with its spectra at each place; `None` if the verification did not ask for it.
pub fn budget_section(found: &Verification, views: &[SightView]) -> Option<ReportSection> {
    let budget = found.error_budget.as_ref()?;
    let settled = format!("The figures are read from {} s on.", found.evidence.procedure.sight_settle_s());
    let start =
        ReportSection::new("Line of sight").with_text(summary(budget, exposure_s(found))).with_text(settled);
    let section = purposes(found)
        .into_iter()
        .fold(start, ReportSection::with_text)
        .with_text(
            "Shares come from runs in which the sources are switched on one after the other, in one order and in the opposite one; they add up to \
             the mean square of the run with all of them. A negative share belongs to a source that reduces the error of the others.",
        )
        .with_text(superposition(budget))
        .with_text(linear(budget))
        .with_text(
            "The linear loop takes the recorded motion, the densities of noise and converters, and the torques that friction, backlash and ripple \
             have in the simulation as disturbances from outside. Where it differs from the simulation, the source depends on the motion: friction \
             takes from the pitching base what it also disturbs.",
        );
    let section = spread(budget).into_iter().fold(section, ReportSection::with_text);
    Some(section.with_figures(views.iter().map(sight_figure)).with_table(table(budget)))
}

/// Returns the line of sight in lines, for a terminal; none if the verification did not ask for it.
pub fn budget_lines(found: &Verification) -> Vec<String> {
    let mut purposes = purposes(found);
    let Some(budget) = &found.error_budget else { return purposes };
    let share = |one: &counterpoise_verify::Contribution| {
        let hub = place(SightFigure::Hub);
        let percent = budget.share_percent(one, hub);
        // a share just below zero is written as zero, without a sign
        let percent = (10.0 * percent).round() / 10.0 + 0.0;
        let linear = match &one.linear {
            Some(linear) => format!("{:.1} urad in the linear loop", MICRO * linear.rad[hub]),
            None => "no place in the linear loop".to_owned(),
        };
        format!(
            "{}: {percent:.1} % of the mean square, {:.1} urad alone, {linear}",
            one.source.name(),
            MICRO * one.alone_rad[hub]
        )
    };
    let mut lines = vec![summary(budget, exposure_s(found)), superposition(budget), linear(budget)];
    lines.extend(spread(budget));
    lines.append(&mut purposes);
    lines.extend(budget.contributions.iter().map(share));
    lines
}

/// Returns what the error of the line of sight means to a gunner and to an observer, as far as the verification asks for it.
fn purposes(found: &Verification) -> Vec<String> {
    let sight = found.evidence.procedure.line_of_sight.unwrap_or_default();
    let value = |figure| found.value(PerformanceFigure::Sight(figure));
    let mut all = Vec::new();
    let fired = [SightFigure::Coincidence, SightFigure::Wait, SightFigure::Hit].map(value);
    if let (Some(asked), [Some(inside), Some(wait_s), Some(hit)]) = (sight.coincidence, fired) {
        all.push(format!(
            "The hub is within the coincidence window of {:.0} urad during {:.1} % of the time; a trigger waits {wait_s:.3} s on the average. A shot \
             that leaves the tip {} s later hits a target of +/- {:.0} urad with a probability of {hit:.3}.",
            MICRO * asked.window_rad,
            100.0 * inside,
            asked.delay_s,
            MICRO * asked.target_rad
        ));
    }
    let lost = [SightFigure::HubTransferLoss, SightFigure::TipTransferLoss].map(value);
    if let (Some(optics), [Some(hub), Some(tip)]) = (sight.optics, lost) {
        all.push(format!(
            "At {} periods a millimetre and a focal length of {} m, motion during an exposure takes {:.2} % of the modulation of the image at the \
             hub and {:.2} % at the tip.",
            PER_MILLIMETRE * optics.spatial_frequency_m,
            optics.focal_length_m,
            100.0 * hub,
            100.0 * tip
        ));
    }
    all
}

fn exposure_s(found: &Verification) -> f64 {
    found.evidence.procedure.line_of_sight.unwrap_or_default().exposure_s
}

fn place(figure: SightFigure) -> usize {
    SightFigure::ANGLES.iter().position(|one| *one == figure).unwrap_or(0)
}

fn summary(budget: &ErrorBudget, exposure_s: f64) -> String {
    let of = |figure| MICRO * budget.total_rad[place(figure)];
    format!(
        "On the nonlinear plant in motion the line of sight has an RMS of {:.1} urad at the hub and {:.1} urad at the tip; the jitter within \
         {exposure_s} s is {:.2} and {:.2} urad. The tip moves against the hub by {:.1} urad.",
        of(SightFigure::Hub),
        of(SightFigure::Tip),
        of(SightFigure::HubJitter),
        of(SightFigure::TipJitter),
        of(SightFigure::Bending)
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

fn linear(budget: &ErrorBudget) -> String {
    let hub = place(SightFigure::Hub);
    let made = format!(
        "The linear loop makes {:.1} urad of all sources at the hub",
        MICRO * budget.linear_rad()[hub]
    );
    match budget.linear_excess(hub) {
        None => format!("{made}."),
        Some(excess) => format!("{made}, {:+.1} % against the simulation.", 100.0 * excess),
    }
}

/// Returns below which frequencies most of the mean square at the hub lies; `None` if nothing moves.
fn spread(budget: &ErrorBudget) -> Option<String> {
    let [half, most] = [0.5, 0.9].map(|share| budget.frequency_below_hz(share));
    Some(format!(
        "Half of the mean square at the hub lies below {} Hz, nine tenths below {} Hz.",
        short_number(half?),
        short_number(most?)
    ))
}

fn table(budget: &ErrorBudget) -> ReportTable {
    let columns = [
        ReportColumn::Text("source"),
        ReportColumn::Number("share of the mean square, hub [%]"),
        ReportColumn::Number("alone, hub [urad]"),
        ReportColumn::Number("linear loop, hub [urad]"),
        ReportColumn::Number("linear loop less alone, hub [urad]"),
        ReportColumn::Number("share of the jitter's, hub [%]"),
        ReportColumn::Number("alone, jitter, hub [urad]"),
        ReportColumn::Number("share of the mean square, tip [%]"),
        ReportColumn::Number("alone, tip [urad]"),
        ReportColumn::Number("share of the mean square, tip against hub [%]"),
        ReportColumn::Number("alone, tip against hub [urad]"),
    ];
    let mut table = ReportTable::new("Error budget of the line of sight", &columns);
    for one in &budget.contributions {
        let mut row = vec![ReportCell::text(one.source.name())];
        for figure in [SightFigure::Hub, SightFigure::HubJitter, SightFigure::Tip, SightFigure::Bending] {
            let at = place(figure);
            row.push(ReportCell::number(budget.share_percent(one, at)));
            row.push(ReportCell::number(MICRO * one.alone_rad[at]));
            if figure == SightFigure::Hub {
                let linear = one.linear.as_ref().map(|linear| MICRO * linear.rad[at]);
                let less = one.linear_less_alone_rad().map(|less| MICRO * less[at]);
                row.extend(
                    [linear, less]
                        .map(|value| value.map_or_else(|| ReportCell::text("-"), ReportCell::number)),
                );
            }
        }
        table.rows.push(row);
    }
    table
}
