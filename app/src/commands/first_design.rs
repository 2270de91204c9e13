//! The printed lines on weights that were chosen.

use counterpoise_host::projects::ProjectOnDisk;
use counterpoise_pipeline::FirstDesignResult;
use counterpoise_pipeline::first_design::{falls_short, unknown_key};

use counterpoise_synth::{FirstDesign, LimitKind, Unknown};

use crate::output::say;
use counterpoise_plot::number::short_number;
use counterpoise_report::first_design::{WHERE_OPEN_VALUES_STAND, describe_limitation, describe_usual_noise};
use counterpoise_report::wording::design_findings::{
    describe_design_finding, describe_limit, describe_unknown,
};

/// What is known to be absent by a value of 0.
const NONE_BY_0: [Unknown; 3] = [Unknown::Noise, Unknown::Sensor, Unknown::Delay];

/// Prints the bandwidth of the chosen weights with what limits it; nothing if the file states its weights.
pub fn print_first_design(loaded: &ProjectOnDisk) {
    let Some(first) = &loaded.first_design else { return };
    let result = FirstDesignResult::from(first);
    let key = |fact: Unknown| match unknown_key(&loaded.project, fact) {
        key if fact == Unknown::Structure => format!("{key}; \"rigid\" if there is none"),
        key if NONE_BY_0.contains(&fact) => format!("{key}; 0 if there is none"),
        key => key,
    };
    say!(
        "the file states no weights: they are chosen for the highest bandwidth (where the loop's gain first falls to 1)"
    );
    say!(
        "bandwidth {} rad/s ({} Hz), limited by: {}",
        short_number(result.bandwidth_rad_s),
        short_number(result.bandwidth_rad_s / std::f64::consts::TAU),
        describe_limitation(&result)
    );
    if let Some(asked) = result.asked_rad_s.filter(|_| falls_short(first)) {
        say!("warning: {} rad/s are asked for and CANNOT BE REACHED", short_number(asked));
    }
    print_limits(&result);
    print_step(loaded, first);
    if first.bandwidth.limited_by.contains(&LimitKind::UsualRanges) {
        say!("  {WHERE_OPEN_VALUES_STAND}");
    }
    if let Some(noise) = describe_usual_noise(&result) {
        say!("  {noise}");
    }
    for fact in &result.unknown {
        say!("  not known, and lowers the ceiling by 3 dB: {} ({})", describe_unknown(*fact), key(*fact));
    }
    say!(
        "margins {:.1} dB, {:.1} deg, Ms {:.2}; Ms {:.2} with every lightly damped mode off by 15 %",
        result.gain_margin_db,
        result.phase_margin_deg,
        result.max_sensitivity,
        result.max_sensitivity_modes_shifted
    );
    result.left_out.iter().for_each(|reason| say!("no feedforward: {}", describe_design_finding(reason)));
    say!("`counterpoise synth PROJECT --save FILE` writes the weights into the file");
    say!();
}

/// Prints which step of the demand the design counts or is verified by, and where it is stated.
fn print_step(loaded: &ProjectOnDisk, first: &FirstDesign) {
    let Some(verify) = &loaded.project.verify else { return };
    let (unit, step) = (loaded.project.controlled_unit(), short_number(verify.procedure.step.rate_rad_s));
    if first.bandwidth.unknown.contains(&Unknown::Demand) {
        say!(
            "  verified by a step of the demand of {step} {unit}, which the control's limit allows at once; verify.step.rate states another"
        );
    } else if first.bandwidth.limited_by.contains(&LimitKind::Control) {
        say!(
            "  the control limit counts a step of the demand of {step} {unit}: set verify.step.rate to the largest that yours takes at once"
        );
    }
}

/// Prints how much of each limit the loop uses up, what the limit alone would allow, and the bandwidth without it.
fn print_limits(first: &FirstDesignResult) {
    say!("  {:48} {:>9} {:>14} {:>14}", "limit", "loop uses", "allows alone", "without it");
    for row in &first.limits {
        let used = row.used.map_or_else(|| "-".to_owned(), |used| format!("{:.0} %", 100.0 * used));
        let rate = |value: Option<f64>, none: &str| {
            value.map_or_else(|| none.to_owned(), |rate| format!("{} rad/s", short_number(rate)))
        };
        let allows = rate(row.bandwidth_rad_s, "does not limit");
        let lifted = rate(row.lifted_rad_s, "no higher");
        say!("  {:48} {used:>9} {allows:>14} {lifted:>14}", describe_limit(row.limit));
    }
}
