//! The printed lines on weights that were chosen.

use counterpoise_host::projects::ProjectOnDisk;
use counterpoise_pipeline::FirstDesignResult;
use counterpoise_pipeline::first_design::unknown_key;
use counterpoise_report::terminal::first_design::{FirstDesignWords, first_design_lines};

use crate::output;

/// Prints the bandwidth of the chosen weights with what limits it; nothing if the file states its weights.
pub fn print_first_design(loaded: &ProjectOnDisk) {
    let Some(first) = &loaded.first_design else { return };
    let project = &loaded.project;
    let words = FirstDesignWords {
        step: project.verify.as_ref().map(|verify| verify.procedure.step.rate_rad_s),
        unit: project.controlled_unit(),
        key_of: &|fact| unknown_key(project, fact),
    };
    output::print_lines(&first_design_lines(&FirstDesignResult::from(first), &words));
}
