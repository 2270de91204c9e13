//! A design beside its alternatives, as sections of a report: methods side by side, a lower order, hub and tip, the controllers
//! over the out-of-balance, the modes that the design neglects.

use counterpoise_models::ControlledQuantity;
use counterpoise_pipeline::design_views::{ControllerFamily, FrequencyResponse};
use counterpoise_pipeline::studies::comparison::{
    DesignComparison, LoopFigures, LoweredRow, MethodRow, MotionRow, Spillover,
};
use counterpoise_pipeline::synth::schedule::BalanceRow;

use crate::bode::{BodeCurve, PhasePanel, bode_figure, response_curve};
use crate::designs::noise_gain_column;
use crate::{Cell, Column, Section, Table};
use counterpoise_plot::number::short_number;
use counterpoise_plot::{Colour, Dash, Figure};

/// Returns the sections; none for what a project does not ask for.
pub fn alternatives_sections(
    found: &DesignComparison,
    families: &[ControllerFamily],
    controlled: ControlledQuantity,
) -> Vec<Section> {
    let mut all = Vec::new();
    if found.methods.len() > 1 {
        all.push(methods(&found.methods, controlled));
    }
    all.extend(found.lowered.as_ref().map(|row| lowered_section(row, controlled)));
    if !found.motions.is_empty() {
        all.push(motions(&found.motions, controlled));
    }
    if found.balance.len() > 1 {
        all.push(balance(families, &found.balance, controlled));
    }
    all.extend(found.spillover.as_ref().map(spillover));
    all
}

fn figure_columns(controlled: ControlledQuantity) -> [Column; 7] {
    [
        Column::Number("gain margin [dB]"),
        Column::Number("phase margin [deg]"),
        Column::Number("Ms"),
        Column::Number("crossover [rad/s]"),
        Column::Number("overshoot [%]"),
        Column::Number("|S|, 0.2 to 2 Hz"),
        Column::Number(noise_gain_column(controlled)),
    ]
}

fn figure_cells(f: &LoopFigures) -> Vec<Cell> {
    let values = [
        f.gain_margin_db,
        f.phase_margin_deg,
        f.max_sensitivity,
        f.crossover_rad_s,
        f.overshoot_percent,
        f.rejection,
        f.noise_gain,
    ];
    values.into_iter().map(Cell::number).collect()
}

fn methods(rows: &[MethodRow], controlled: ControlledQuantity) -> Section {
    let mut columns = vec![
        Column::Text("method"),
        Column::Text("integral action"),
        Column::Number("order"),
        Column::Number("norm"),
    ];
    columns.extend(figure_columns(controlled));
    let mut table = Table::new("The same plant and weights; figures of the sampled loop", &columns);
    for row in rows {
        let norm = row.norm.map_or(Cell::text(""), Cell::number);
        let integral = if row.integral { "yes" } else { "no" };
        let mut cells =
            vec![Cell::text(&row.method), Cell::text(integral), Cell::text(row.order.to_string()), norm];
        match &row.figures {
            Some(found) => cells.extend(figure_cells(found)),
            None => cells.extend(figure_columns(controlled).map(|_| Cell::text("-"))),
        }
        table.rows.push(cells);
    }
    let why = |row: &MethodRow| row.why.as_ref().map(|why| format!("{}: no controller: {why}", row.method));
    let section = Section::new("Methods of the feedback, side by side").listing(table);
    rows.iter().filter_map(why).fold(section, |section, line| section.saying(line))
}

fn lowered_section(row: &LoweredRow, controlled: ControlledQuantity) -> Section {
    let mut columns = vec![Column::Text("feedback"), Column::Number("order")];
    columns.extend(figure_columns(controlled));
    let mut table = Table::new("", &columns);
    for (name, order, figures) in
        [("as designed", row.order[0], &row.before), ("lowered", row.order[1], &row.after)]
    {
        let mut cells = vec![Cell::text(name), Cell::text(order.to_string())];
        cells.extend(figure_cells(figures));
        table.rows.push(cells);
    }
    Section::new("A feedback of lower order")
        .saying(format!(
            "Reduced by frequency-weighted balancing; the closed loop changes by {} % at most.",
            short_number(100.0 * row.loop_change)
        ))
        .listing(table)
}

fn motions(rows: &[MotionRow], controlled: ControlledQuantity) -> Section {
    let columns = [
        Column::Text("expected motion"),
        Column::Number("hub, feedback alone"),
        Column::Number("hub, with feedforward"),
        Column::Number("tip, feedback alone"),
        Column::Number("tip, with feedforward"),
    ];
    let tip = controlled.motion();
    let of_tip = if tip == controlled {
        String::new()
    } else {
        format!(", and {} of the tip, {}", tip.short_name(), tip.milli_unit())
    };
    let caption =
        format!("RMS {} on the design plant, {}{of_tip}", controlled.short_name(), controlled.milli_unit());
    let mut table = Table::new(&caption, &columns);
    for row in rows {
        let mut cells = vec![Cell::text(row.disturbance)];
        cells.extend(row.hub_rad_s.iter().chain(&row.tip_rad_s).map(|rate| Cell::number(1e3 * rate)));
        table.rows.push(cells);
    }
    Section::new("Hub and tip").listing(table)
}

/// Returns the controllers over the states of balance.
fn balance(families: &[ControllerFamily], rows: &[BalanceRow], controlled: ControlledQuantity) -> Section {
    let section = Section::new("Over the out-of-balance")
        .saying("Each state of balance has its own full design; curves that cannot be distinguished lie on each other.")
        .with_figures(families.iter().map(family));
    section.listing(changes(rows, controlled)).listing(laws(rows))
}

/// Returns the response of a controller in every state of balance.
fn family(family: &ControllerFamily) -> Figure {
    let colours = Colour::CYCLE;
    let one = |(k, response): (usize, &FrequencyResponse)| BodeCurve {
        dash: [Dash::Solid, Dash::Dashed][k / colours.len() % 2],
        ..response_curve(response, colours[k % colours.len()])
    };
    let curves: Vec<BodeCurve> = family.curves.iter().enumerate().map(one).collect();
    let title = format!("{} over the out-of-balance", family.name);
    bode_figure(&title, family.unit, &curves, PhasePanel::Hidden, Vec::new())
}

fn changes(rows: &[BalanceRow], controlled: ControlledQuantity) -> Table {
    let columns = [
        Column::Text("state"),
        Column::Number("out-of-balance [kg m]"),
        Column::Number("feedback [dB]"),
        Column::Number("heave [dB]"),
        Column::Number("pitch [dB]"),
        Column::Number("old controllers"),
        Column::Number("gain law"),
        Column::Number("redesign"),
    ];
    let caption = format!(
        "Change of each controller from 0.1 to 20 Hz, lowest to highest, and RMS {} under the expected heave, {}",
        controlled.name(),
        controlled.milli_unit()
    );
    let mut table = Table::new(&caption, &columns);
    let range = |[low, high]: [f64; 2]| format!("{:+.2} to {:+.2}", tidy(low), tidy(high));
    let change = |db: Option<[f64; 2]>| Cell::text(db.map_or("-".to_owned(), range));
    let error = |rate: Option<f64>| rate.map_or(Cell::text("-"), |rate| Cell::number(1e3 * rate));
    for row in rows {
        table.rows.push(vec![
            Cell::text(&row.name),
            Cell::number(row.out_of_balance_kg_m),
            Cell::text(range(row.feedback_db)),
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
fn laws(rows: &[BalanceRow]) -> Table {
    let columns = [
        Column::Text("state"),
        Column::Text("heave feedforward"),
        Column::Text("conditions of the gain law"),
    ];
    let mut table = Table::new("What follows for the heave feedforward, and why", &columns);
    for row in rows {
        table.rows.push(vec![Cell::text(&row.name), Cell::text(&row.law), Cell::text(&row.conditions)]);
    }
    table
}

/// Without the sign of a zero that is shown.
fn tidy(db: f64) -> f64 {
    if db.abs() < 5e-3 { 0.0 } else { db }
}

fn spillover(found: &Spillover) -> Section {
    let says = if found.largest_pole < 1.0 { "stable" } else { "NOT STABLE" };
    Section::new("Modes that the design does not know").saying(format!(
        "On the finite elements with {} flexible modes (order {}) the sampled loop is {says}: its largest pole has the modulus {}.",
        found.modes,
        found.order,
        short_number(found.largest_pole)
    ))
}
