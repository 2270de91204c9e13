//! What `counterpoise identify` prints of an identified mechanism.

use counterpoise_diagnose::identification::Estimate;
use counterpoise_pipeline::recordings::AxisUnits;

use super::add_line;
use crate::tolerance::LEAST_WITH_THREE_DECIMALS;
use crate::wording::identification::{AmplifierText, IdentificationText};

/// Returns the lines on an identified mechanism, a quantity each.
pub fn identification_lines(found: &IdentificationText, units: &AxisUnits) -> Vec<String> {
    let mut lines = Vec::new();
    add_mechanism(&mut lines, found, units);
    lines
}

fn add_mechanism(lines: &mut Vec<String>, found: &IdentificationText, units: &AxisUnits) {
    add_line!(lines, "{:<28} {:>12}   {:^25} {:>12}  unit", "", "identified", "95 % interval", "project");
    for (state, balance) in found.balances.iter().enumerate() {
        let of = |name: &str| match state {
            0 => name.to_owned(),
            _ => format!("{name}, other state"),
        };
        add_estimate(lines, &of("out-of-balance"), &balance.out_of_balance_kg_m, units.moment);
        add_estimate(lines, &of("inertia"), &balance.inertia_kg_m2, units.inertia);
    }
    add_estimate(lines, "Coulomb friction, total", &found.coulomb_nm, units.torque);
    add_estimate(lines, "viscous friction, total", &found.viscous_nm_s_rad, units.viscous);
    match &found.breakaway_nm {
        Some(breakaway) => add_estimate(lines, "highest after a reversal", breakaway, units.torque),
        None => add_line!(lines, "highest friction after a reversal: too few reversals"),
    }
    for (name, estimate, unit) in found.sensor_errors() {
        add_estimate(lines, name, &estimate, unit);
    }
    let l = &found.lobes;
    add_line!(
        lines,
        "u against rate: offset {} V, step {} V, slope {} {}, width {} V per {}/s^2",
        figure(l.offset_v),
        figure(l.step_v),
        figure(l.slope_v_s_rad),
        units.slope,
        figure(l.width_v_s2_rad),
        units.position
    );
    let left = if found.residual_nm >= LEAST_WITH_THREE_DECIMALS {
        format!("{:.2}", found.residual_nm)
    } else {
        figure(found.residual_nm)
    };
    add_line!(lines, "left over: {left} {} RMS, of {:.1} s of sliding", units.torque, found.sliding_s);
    add_amplifier(lines, &found.amplifier);
    found.notes.iter().for_each(|note| add_line!(lines, "note: {note}"));
}

fn add_estimate(lines: &mut Vec<String>, name: &str, e: &Estimate, unit: &str) {
    if !e.is_known() {
        return;
    }
    let [low, high] = e.ci95.map(figure);
    let before = if e.before.is_finite() { figure(e.before) } else { "-".to_owned() };
    add_line!(lines, "{name:<28} {:>12}   [{low:>10}, {high:>10}] {before:>12}  {unit}", figure(e.value));
}

/// Returns a number with three decimals, or with three digits if those say nothing.
fn figure(value: f64) -> String {
    if value == 0.0 || value.abs() >= LEAST_WITH_THREE_DECIMALS {
        return format!("{value:.3}");
    }
    format!("{value:.2e}")
}

fn add_amplifier(lines: &mut Vec<String>, found: &AmplifierText) {
    match found {
        AmplifierText::Curve { .. } => add_line!(lines, "amplifier: its gain curve is not the project's"),
        AmplifierText::AsInProject { .. } => add_line!(lines, "amplifier: its gain curve is the project's"),
        AmplifierText::NotIdentifiable { why } => add_line!(lines, "amplifier: not identifiable: {why}"),
    }
    for q in found.points() {
        add_line!(
            lines,
            "  {:6.3} V  {:7.3} A  [{:7.3}, {:7.3}]  project {:7.3} A  scatter {:.4} A",
            q.input_v,
            q.current_a,
            q.ci95_a[0],
            q.ci95_a[1],
            q.linear_a,
            q.scatter_a
        );
    }
}
