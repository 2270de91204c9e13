//! What commands print of weights that were chosen.

use std::f64::consts::TAU;

use counterpoise_pipeline::FirstDesignResult;
use counterpoise_plot::number::short_number;
use counterpoise_synth::{LimitKind, Unknown};

use super::add_line;
use crate::first_design::{WHERE_OPEN_VALUES_STAND, describe_limitation, describe_usual_noise};
use crate::wording::design_findings::{describe_design_finding, describe_limit, describe_unknown};

/// What is known to be absent by a value of 0.
const NONE_BY_0: [Unknown; 3] = [Unknown::Noise, Unknown::Sensor, Unknown::Delay];

/// What the lines say beside the result: the project's words for its step of the demand, and where values are stated.
pub struct FirstDesignWords<'w> {
    /// Step of the demand by which the design is verified; `None` if the project verifies nothing.
    pub step: Option<f64>,
    /// Unit of the controlled quantity.
    pub unit: &'w str,
    /// Returns the key of a value that is not known.
    pub key_of: &'w dyn Fn(Unknown) -> String,
}

/// Returns the lines on the bandwidth of the chosen weights with what limits it.
pub fn first_design_lines(found: &FirstDesignResult, words: &FirstDesignWords<'_>) -> Vec<String> {
    let mut all = Vec::new();
    let lines = &mut all;
    add_line!(
        lines,
        "the file states no weights: they are chosen for the highest bandwidth (where the loop's gain first falls to 1)"
    );
    add_line!(
        lines,
        "bandwidth {} rad/s ({} Hz), limited by: {}",
        short_number(found.bandwidth_rad_s),
        short_number(found.bandwidth_rad_s / TAU),
        describe_limitation(found)
    );
    if let Some(asked) = found.missed_rad_s() {
        add_line!(lines, "warning: {} rad/s are asked for and CANNOT BE REACHED", short_number(asked));
    }
    add_limits(lines, found);
    add_step(lines, found, words);
    if found.limited_by.contains(&LimitKind::UsualRanges) {
        add_line!(lines, "  {WHERE_OPEN_VALUES_STAND}");
    }
    if let Some(noise) = describe_usual_noise(found) {
        add_line!(lines, "  {noise}");
    }
    for fact in &found.unknown {
        let key = describe_key(*fact, (words.key_of)(*fact));
        add_line!(lines, "  not known, and lowers the ceiling by 3 dB: {} ({key})", describe_unknown(*fact));
    }
    add_line!(
        lines,
        "margins {:.1} dB, {:.1} deg, Ms {:.2}; Ms {:.2} with every lightly damped mode off by 15 %",
        found.gain_margin_db,
        found.phase_margin_deg,
        found.max_sensitivity,
        found.max_sensitivity_modes_shifted
    );
    let left_out = found.left_out.iter().map(describe_design_finding);
    left_out.for_each(|reason| add_line!(lines, "no feedforward: {reason}"));
    add_line!(lines, "`counterpoise synth PROJECT --save FILE` writes the weights into the file");
    add_line!(lines);
    all
}

fn describe_key(fact: Unknown, key: String) -> String {
    match fact {
        Unknown::Structure => format!("{key}; \"rigid\" if there is none"),
        _ if NONE_BY_0.contains(&fact) => format!("{key}; 0 if there is none"),
        _ => key,
    }
}

/// Adds which step of the demand the design counts or is verified by, and where it is stated.
fn add_step(lines: &mut Vec<String>, found: &FirstDesignResult, words: &FirstDesignWords<'_>) {
    let Some(step) = words.step else { return };
    let (unit, step) = (words.unit, short_number(step));
    if found.unknown.contains(&Unknown::Demand) {
        add_line!(
            lines,
            "  verified by a step of the demand of {step} {unit}, which the control's limit allows at once; verify.step.rate states another"
        );
    } else if found.limited_by.contains(&LimitKind::Control) {
        add_line!(
            lines,
            "  the control limit counts a step of the demand of {step} {unit}: set verify.step.rate to the largest that yours takes at once"
        );
    }
}

/// Adds how much of each limit the loop uses up, what the limit alone would allow, and the bandwidth without it.
fn add_limits(lines: &mut Vec<String>, found: &FirstDesignResult) {
    add_line!(lines, "  {:48} {:>9} {:>14} {:>14}", "limit", "loop uses", "allows alone", "without it");
    for row in &found.limits {
        let used = row.used.map_or_else(|| "-".to_owned(), |used| format!("{:.0} %", 100.0 * used));
        let rate = |value: Option<f64>, none: &str| {
            value.map_or_else(|| none.to_owned(), |rate| format!("{} rad/s", short_number(rate)))
        };
        let allows = rate(row.bandwidth_rad_s, "does not limit");
        let lifted = rate(row.lifted_rad_s, "no higher");
        add_line!(lines, "  {:48} {used:>9} {allows:>14} {lifted:>14}", describe_limit(row.limit));
    }
}
