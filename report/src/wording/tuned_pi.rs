//! A design beside a tuned PI with a lag, in words.

use counterpoise_pipeline::studies::tuned_pi::TunedPiRow;
use counterpoise_plot::number::short_number;
use counterpoise_project::TuningObjective;

use crate::designs::{block_words, limits_words, shown_residual};
use crate::tolerance::PI_WORTH_A_WORD;

/// Returns what a PI that was tuned under a design's own limits leaves in the linear loop; `None` if it leaves hardly less than the design.
pub fn describe_tuned_pi(row: &TunedPiRow) -> Option<String> {
    if row.missed > 0.0 || row.improvement() < PI_WORTH_A_WORD {
        return None;
    }
    let (own, tuned) = (&row.own.disturbed, &row.tuned.disturbed);
    let (quantity, unit) = match own.objective {
        TuningObjective::Motion => (
            format!("residual {} under the expected motion", own.controlled.name()),
            format!(" {}", own.controlled.milli_unit()),
        ),
        TuningObjective::Band => ("RMS of S in the band".to_owned(), String::new()),
    };
    Some(format!(
        "a PI with a lag tuned under this design's own limits ({}) makes the {quantity} {}{unit} in the linear loop, {} % less than this design's {}: {}. `weights = \"tune\"` in [synth.tune] tunes \
         the weights of this design for it, and `counterpoise compare` simulates all of them",
        limits_words(&row.limits),
        short_number(shown_residual(tuned)),
        short_number(100.0 * row.improvement()),
        short_number(shown_residual(own)),
        row.blocks.iter().map(block_words).collect::<Vec<_>>().join(" ")
    ))
}
