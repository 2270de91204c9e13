//! A design beside its alternatives, as sections of a report: methods side by side, a lower order, hub and tip, the controllers
//! over the out-of-balance, the modes that the design neglects.

use counterpoise_models::ControlledQuantity;
use counterpoise_pipeline::design_views::{ControllerFamily, FrequencyResponse};
use counterpoise_pipeline::studies::comparison::{
    DesignComparison, LoopFigures, LoweredRow, MethodRow, MotionRow, Spillover,
};
use counterpoise_pipeline::synth::schedule::BalanceRow;

use crate::bode::{BodeCurve, PhasePanel, bode_figure};
use crate::designs::noise_gain_column;
use crate::wording::capitalise_first;
use crate::wording::design_findings::describe_design_findings;
use crate::wording::figures::{describe_modulus, drop_small_sign};
use crate::wording::schedule::{describe_conditions, describe_law};
use crate::wording::tuned_pi::describe_tuned_pi;
use crate::{ReportCell, ReportColumn, ReportSection, ReportTable};
use counterpoise_plot::number::short_number;
use counterpoise_plot::{Colour, Dash, Figure};

/// Returns the sections; none for what a project does not ask for.
pub fn alternatives_sections(
    found: &DesignComparison,
    families: &[ControllerFamily],
    controlled: ControlledQuantity,
) -> Vec<ReportSection> {
    let mut all = Vec::new();
    if found.methods.len() > 1 {
        all.push(methods(&found.methods, controlled));
    }
    all.extend(found.lowered.as_ref().map(|row| lowered_section(row, controlled)));
    if let Some(text) = found.tuned_pi.as_ref().and_then(describe_tuned_pi) {
        all.push(
            ReportSection::new("A tuned PI beside the design")
                .with_text(format!("{}.", capitalise_first(&text))),
        );
    }
    if !found.motions.is_empty() {
        all.push(motions(&found.motions, controlled));
    }
    if found.balance.len() > 1 {
        all.push(balance(families, &found.balance, controlled));
    }
    all.extend(found.spillover.as_ref().map(spillover));
    all
}

fn figure_columns(controlled: ControlledQuantity) -> [ReportColumn; 7] {
    [
        ReportColumn::Number("gain margin [dB]"),
        ReportColumn::Number("phase margin [deg]"),
        ReportColumn::Number("Ms"),
        ReportColumn::Number("crossover [rad/s]"),
        ReportColumn::Number("overshoot [%]"),
        ReportColumn::Number("|S|, 0.2 to 2 Hz"),
        ReportColumn::Number(noise_gain_column(controlled)),
    ]
}

fn figure_cells(f: &LoopFigures) -> Vec<ReportCell> {
    let values = [
        f.gain_margin_db,
        f.phase_margin_deg,
        f.max_sensitivity,
        f.crossover_rad_s,
        f.overshoot_percent,
        f.rejection,
        f.noise_gain,
    ];
    values.into_iter().map(ReportCell::number).collect()
}

fn methods(rows: &[MethodRow], controlled: ControlledQuantity) -> ReportSection {
    let mut columns = vec![
        ReportColumn::Text("method"),
        ReportColumn::Text("integral action"),
        ReportColumn::Number("order"),
        ReportColumn::Number("norm"),
    ];
    columns.extend(figure_columns(controlled));
    let mut table = ReportTable::new("The same plant and weights; figures of the sampled loop", &columns);
    for row in rows {
        let norm = row.norm.map_or(ReportCell::text(""), ReportCell::number);
        let integral = if row.integral { "yes" } else { "no" };
        let mut cells = vec![
            ReportCell::text(&row.method),
            ReportCell::text(integral),
            ReportCell::text(row.order.to_string()),
            norm,
        ];
        match &row.figures {
            Some(found) => cells.extend(figure_cells(found)),
            None => cells.extend(figure_columns(controlled).map(|_| ReportCell::text("-"))),
        }
        table.rows.push(cells);
    }
    let why = |row: &MethodRow| {
        let findings = describe_design_findings(row.why.as_ref()?);
        Some(format!("{}: no controller: {findings}", row.method))
    };
    let section = ReportSection::new("Methods of the feedback, side by side").with_table(table);
    rows.iter().filter_map(why).fold(section, |section, line| section.with_text(line))
}

fn lowered_section(row: &LoweredRow, controlled: ControlledQuantity) -> ReportSection {
    let mut columns = vec![ReportColumn::Text("feedback"), ReportColumn::Number("order")];
    columns.extend(figure_columns(controlled));
    let mut table = ReportTable::new("", &columns);
    for (name, order, figures) in
        [("as designed", row.order[0], &row.before), ("lowered", row.order[1], &row.after)]
    {
        let mut cells = vec![ReportCell::text(name), ReportCell::text(order.to_string())];
        cells.extend(figure_cells(figures));
        table.rows.push(cells);
    }
    ReportSection::new("A feedback of lower order")
        .with_text(format!(
            "Reduced by frequency-weighted balancing; the closed loop changes by {} % at most.",
            short_number(100.0 * row.loop_change)
        ))
        .with_table(table)
}

fn motions(rows: &[MotionRow], controlled: ControlledQuantity) -> ReportSection {
    let columns = [
        ReportColumn::Text("expected motion"),
        ReportColumn::Number("hub, feedback alone"),
        ReportColumn::Number("hub, with feedforward"),
        ReportColumn::Number("tip, feedback alone"),
        ReportColumn::Number("tip, with feedforward"),
    ];
    let tip = controlled.motion();
    let of_tip = if tip == controlled {
        String::new()
    } else {
        format!(", and {} of the tip, {}", tip.short_name(), tip.milli_unit())
    };
    let caption =
        format!("RMS {} on the design plant, {}{of_tip}", controlled.short_name(), controlled.milli_unit());
    let mut table = ReportTable::new(&caption, &columns);
    for row in rows {
        let mut cells = vec![ReportCell::text(row.disturbance)];
        cells.extend(row.hub_rad_s.iter().chain(&row.tip_rad_s).map(|rate| ReportCell::number(1e3 * rate)));
        table.rows.push(cells);
    }
    ReportSection::new("Hub and tip").with_table(table)
}

/// Returns the controllers over the states of balance.
fn balance(
    families: &[ControllerFamily],
    rows: &[BalanceRow],
    controlled: ControlledQuantity,
) -> ReportSection {
    let section = ReportSection::new("Over the out-of-balance")
        .with_text("Each state of balance has its own full design; curves that cannot be distinguished lie on each other.")
        .with_figures(families.iter().map(family));
    section.with_table(changes(rows, controlled)).with_table(laws(rows))
}

/// Returns the response of a controller in every state of balance.
fn family(family: &ControllerFamily) -> Figure {
    let colours = Colour::CYCLE;
    let one = |(k, response): (usize, &FrequencyResponse)| BodeCurve {
        dash: [Dash::Solid, Dash::Dashed][k / colours.len() % 2],
        ..BodeCurve::new(response.clone(), colours[k % colours.len()])
    };
    let curves: Vec<BodeCurve> = family.curves.iter().enumerate().map(one).collect();
    let title = format!("{} over the out-of-balance", family.name);
    bode_figure(&title, family.unit, &curves, PhasePanel::Hidden, Vec::new())
}

fn changes(rows: &[BalanceRow], controlled: ControlledQuantity) -> ReportTable {
    let columns = [
        ReportColumn::Text("state"),
        ReportColumn::Number("out-of-balance [kg m]"),
        ReportColumn::Number("feedback [dB]"),
        ReportColumn::Number("heave [dB]"),
        ReportColumn::Number("pitch [dB]"),
        ReportColumn::Number("old controllers"),
        ReportColumn::Number("gain law"),
        ReportColumn::Number("redesign"),
    ];
    let caption = format!(
        "Change of each controller from 0.1 to 20 Hz, lowest to highest, and RMS {} under the expected heave, {}",
        controlled.name(),
        controlled.milli_unit()
    );
    let mut table = ReportTable::new(&caption, &columns);
    let range =
        |[low, high]: [f64; 2]| format!("{:+.2} to {:+.2}", drop_small_sign(low), drop_small_sign(high));
    let change = |db: Option<[f64; 2]>| ReportCell::text(db.map_or("-".to_owned(), range));
    let error = |rate: Option<f64>| rate.map_or(ReportCell::text("-"), |rate| ReportCell::number(1e3 * rate));
    for row in rows {
        table.rows.push(vec![
            ReportCell::text(&row.name),
            ReportCell::number(row.out_of_balance_kg_m),
            ReportCell::text(range(row.feedback_db)),
            change(row.heave_db),
            change(row.pitch_db),
            error(row.error_before_rad_s),
            error(row.error_gain_law_rad_s),
            error(row.error_after_rad_s),
        ]);
    }
    table
}

/// Returns which conditions hold in every state of balance, and what follows.
fn laws(rows: &[BalanceRow]) -> ReportTable {
    let columns = [
        ReportColumn::Text("state"),
        ReportColumn::Text("heave feedforward"),
        ReportColumn::Text("conditions of the gain law"),
    ];
    let mut table = ReportTable::new("What follows for the heave feedforward, and why", &columns);
    for row in rows {
        table.rows.push(vec![
            ReportCell::text(&row.name),
            ReportCell::text(describe_law(&row.law)),
            ReportCell::text(describe_conditions(&row.conditions)),
        ]);
    }
    table
}

fn spillover(found: &Spillover) -> ReportSection {
    let says = if found.largest_pole < 1.0 { "stable" } else { "NOT STABLE" };
    ReportSection::new("Modes that the design does not know").with_text(format!(
        "On the finite elements with {} flexible modes (order {}) the sampled loop is {says}: its largest pole has the modulus {}.",
        found.modes,
        found.order,
        describe_modulus(found.largest_pole)
    ))
}
