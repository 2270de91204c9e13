//! What `counterpoise synth` prints of a design: its orders and costs, and its comparison with alternatives.

use counterpoise_pipeline::SynthesisStudy;
use counterpoise_pipeline::studies::comparison::{DesignComparison, LoopFigures, MethodRow};
use counterpoise_plot::number::short_number;

use super::add_line;
use crate::results::SynthText;
use crate::wording::certificates::total_cost_lines;
use crate::wording::design_findings::describe_design_findings;
use crate::wording::figures::{describe_modulus, drop_small_sign};
use crate::wording::schedule::{describe_conditions, describe_law};
use crate::wording::tuned_pi::describe_tuned_pi;
use crate::wording::weights::describe_weights;

/// Returns the lines on a design: its weights, its orders and costs, and the comparison with its alternatives.
pub fn synthesis_lines(study: &SynthesisStudy, result: &SynthText) -> Vec<String> {
    let mut lines = describe_weights(&study.asked);
    add_design(&mut lines, result);
    add_comparison(&mut lines, study);
    lines
}

fn add_design(lines: &mut Vec<String>, result: &SynthText) {
    let figures = &result.figures;
    add_line!(lines);
    add_line!(lines, "design plant of order {}", figures.plant_order);
    figures.path_orders.iter().for_each(|(name, order)| add_line!(lines, "{name}: order {order}"));
    let largest = figures.largest_pole_modulus;
    add_line!(
        lines,
        "closed sampled loop: {} poles, largest modulus {}",
        figures.closed_loop_poles.len(),
        describe_modulus(largest)
    );
    if let Some(difference) = figures.cost_difference {
        add_line!(lines, "predicted cost and cost of the assembled loop differ by {difference:.1e}");
    }
    result.demanded_rate.iter().for_each(|limit| add_line!(lines, "{limit}"));
    result.warnings.iter().for_each(|w| add_line!(lines, "warning: {w}"));
}

/// Adds the comparison of a design with its alternatives.
fn add_comparison(lines: &mut Vec<String>, study: &SynthesisStudy) {
    let (beside, gain_unit) = (&study.comparison, study.synthesised.controlled.gain_unit());
    add_methods(lines, &beside.methods, gain_unit);
    if let Some(row) = &beside.lowered {
        add_line!(lines);
        add_line!(
            lines,
            "feedback of order {} lowered to {} by frequency-weighted balancing:",
            row.order[0],
            row.order[1]
        );
        add_line!(lines, "  the closed loop changes by {} % at most", short_number(100.0 * row.loop_change));
        for (name, found) in [("before", &row.before), ("after", &row.after)] {
            add_line!(lines, "  {name:8}{}", figures_line(found, gain_unit));
        }
    }
    add_motions(lines, study);
    add_total_cost(lines, beside);
    add_balance(lines, study);
    if let Some(found) = &beside.spillover {
        let says = if found.largest_pole < 1.0 { "stable" } else { "NOT STABLE" };
        let (modes, order, pole) = (found.modes, found.order, found.largest_pole);
        add_line!(lines);
        let pole = describe_modulus(pole);
        add_line!(lines, "on the beam with {modes} modes (order {order}): {says}, largest modulus {pole}");
    }
}

fn add_methods(lines: &mut Vec<String>, rows: &[MethodRow], gain_unit: &str) {
    if rows.len() < 2 {
        return;
    }
    add_line!(lines);
    add_line!(lines, "methods of the feedback, the same plant and weights, figures of the sampled loop:");
    for row in rows {
        let kind = if row.integral { "integral" } else { "no integral" };
        let norm = row.norm.map_or(String::new(), |norm| format!(", norm {norm:.4}"));
        add_line!(lines, "  {}, {kind}: order {}{norm}", row.method, row.order);
        match (&row.figures, &row.why) {
            (Some(found), _) => add_line!(lines, "    {}", figures_line(found, gain_unit)),
            (None, Some(why)) => add_line!(lines, "    no controller: {}", describe_design_findings(why)),
            (None, None) => {}
        }
    }
}

pub(super) fn figures_line(f: &LoopFigures, gain_unit: &str) -> String {
    format!(
        "margins {:.1} dB, {:.1} deg; Ms {:.3}; crossover {:.1} rad/s; overshoot {:.1} %; |S| {:.3}; noise gain {} {gain_unit}",
        f.gain_margin_db,
        f.phase_margin_deg,
        f.max_sensitivity,
        f.crossover_rad_s,
        f.overshoot_percent,
        f.rejection,
        short_number(f.noise_gain)
    )
}

/// Adds what the expected motions leave. In a loop of torque or current the tip moves by another quantity, which stands in the report.
fn add_motions(lines: &mut Vec<String>, study: &SynthesisStudy) {
    let (rows, controlled) = (&study.comparison.motions, study.synthesised.controlled);
    if rows.is_empty() {
        return;
    }
    add_line!(lines);
    add_line!(
        lines,
        "RMS {} under the expected motion, feedback alone -> with feedforward, {}",
        controlled.short_name(),
        controlled.milli_unit()
    );
    for row in rows {
        let pair = |[alone, both]: [f64; 2]| {
            let shown = |value: f64| short_number(1e3 * value);
            format!("{} -> {}", shown(alone), shown(both))
        };
        let tip = if controlled.motion() == controlled {
            format!("   tip {:>20}", pair(row.tip_rad_s))
        } else {
            String::new()
        };
        add_line!(lines, "  {:8} hub {:>20}{tip}", row.disturbance, pair(row.hub_rad_s));
    }
}

fn add_total_cost(lines: &mut Vec<String>, beside: &DesignComparison) {
    let cost = total_cost_lines(beside.total_cost.as_ref());
    if !cost.is_empty() {
        lines.push(String::new());
        lines.extend(cost);
    }
    if let Some(text) = beside.tuned_pi.as_ref().and_then(describe_tuned_pi) {
        add_line!(lines);
        add_line!(lines, "advice: {text}");
    }
}

fn add_balance(lines: &mut Vec<String>, study: &SynthesisStudy) {
    let (beside, controlled) = (&study.comparison, study.synthesised.controlled);
    if beside.balance.is_empty() {
        return;
    }
    add_line!(lines);
    add_line!(
        lines,
        "over out-of-balance: change of each controller from 0.1 to 20 Hz, lowest .. highest, dB,"
    );
    add_line!(
        lines,
        "and RMS {} under the expected heave, {}: nominal controllers | gain law | redesign",
        controlled.name(),
        controlled.milli_unit()
    );
    for row in &beside.balance {
        let range =
            |[low, high]: [f64; 2]| format!("{:+.2} .. {:+.2}", drop_small_sign(low), drop_small_sign(high));
        let change = |db: Option<[f64; 2]>| db.map_or("none".to_owned(), range);
        let error = |value: Option<f64>| value.map_or("-".to_owned(), |rate| format!("{:.3}", 1e3 * rate));
        add_line!(lines, "  {} ({:.2} kg m)", row.name, row.out_of_balance_kg_m);
        add_line!(
            lines,
            "    feedback {}; heave {}; pitch {}",
            range(row.feedback_db),
            change(row.heave_db),
            change(row.pitch_db)
        );
        add_line!(
            lines,
            "    error {} | {} | {}",
            error(row.error_before_rad_s),
            error(row.error_gain_law_rad_s),
            error(row.error_after_rad_s)
        );
        add_line!(lines, "    {}", describe_conditions(&row.conditions));
        add_line!(lines, "    {}", describe_law(&row.law));
    }
}
