//! The printed lines on weights that were chosen.

use counterpoise_host::projects::ProjectOnDisk;
use counterpoise_pipeline::FirstDesignResult;
use counterpoise_pipeline::first_design::{LimitRow, falls_short};

use counterpoise_synth::{FirstDesign, LimitKind, Unknown};

use crate::output::say;
use counterpoise_plot::number::short_number;
use counterpoise_report::first_design::{WHERE_OPEN_VALUES_STAND, describe_limitation};
use counterpoise_report::wording::design_findings::{
    describe_design_finding, describe_limit, describe_unknown,
};

/// Prints the bandwidth of the chosen weights with what limits it; nothing if the file states its weights.
pub fn print_first_design(loaded: &ProjectOnDisk) {
    let Some(first) = &loaded.first_design else { return };
    let result = FirstDesignResult::from(first);
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
    result.limits.iter().for_each(print_limit);
    print_step(loaded, first);
    if first.bandwidth.limited_by.contains(&LimitKind::UsualRanges) {
        say!("  {WHERE_OPEN_VALUES_STAND}");
    }
    for fact in &result.unknown {
        say!("  not known, and lowers the ceiling by 3 dB: {}", describe_unknown(*fact));
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

fn print_limit(row: &LimitRow) {
    let limit = describe_limit(row.limit);
    let without = row.lifted_rad_s.map(|rate| format!("; without it {} rad/s", short_number(rate)));
    let without = without.unwrap_or_default();
    match (row.bandwidth_rad_s, row.over_reached) {
        (Some(rate), Some(over)) => {
            let over = match short_number(over) {
                same if same == "1" => "which is reached".to_owned(),
                more => format!("{more} times what is reached"),
            };
            let alone = if row.allows_more() { " to loops that miss others" } else { "" };
            say!("  {limit:26} allows {:>9} rad/s{alone}, {over}{without}", short_number(rate));
        }
        _ => say!("  {limit:26} allows every bandwidth that was looked at{without}"),
    }
}
