//! What is printed of weights that were chosen.

use counterpoise_host::projects::Loaded;
use counterpoise_pipeline::FirstDesignResult;
use counterpoise_pipeline::first_design::{LimitRow, falls_short};

use crate::output::say;
use counterpoise_plot::number::short_number;
use counterpoise_report::first_design::describe_limitation;

/// Prints the bandwidth of the chosen weights with what limits it; nothing if the file states its weights.
pub fn print_first_design(loaded: &Loaded) {
    let Some(first) = &loaded.first_design else { return };
    let result = FirstDesignResult::from(first);
    say!(
        "the file states no weights: they are chosen for the highest bandwidth (where the loop's gain is last 1)"
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
    for fact in &result.unknown {
        say!("  not known, and lowers the ceiling by 3 dB: {fact}");
    }
    say!(
        "margins {:.1} dB, {:.1} deg, Ms {:.2}; Ms {:.2} with every lightly damped mode off by 15 %",
        result.gain_margin_db,
        result.phase_margin_deg,
        result.max_sensitivity,
        result.max_sensitivity_modes_shifted
    );
    result.left_out.iter().for_each(|reason| say!("no feedforward: {reason}"));
    say!("`counterpoise synth PROJECT --save FILE` writes the weights into the file");
    say!();
}

fn print_limit(row: &LimitRow) {
    let without = row.lifted_rad_s.map(|rate| format!("; without it {} rad/s", short_number(rate)));
    let without = without.unwrap_or_default();
    match (row.bandwidth_rad_s, row.over_reached) {
        (Some(rate), Some(over)) => {
            let (rate, over) = (short_number(rate), short_number(over));
            say!("  {:26} allows {rate:>9} rad/s, {over} times what is reached{without}", row.limit);
        }
        _ => say!("  {:26} allows every bandwidth that was looked at{without}", row.limit),
    }
}
