//! The runs of the adaptation in words.

use counterpoise_pipeline::studies::adapt::RunKind;

/// Describes what happens in a run.
pub fn describe_run(kind: RunKind) -> &'static str {
    match kind {
        RunKind::Default => "default out-of-balance, no adaptation",
        RunKind::OneChange => "one change, no adaptation",
        RunKind::OneChangeAdaptedLate => "one change, adaptation from 0.7 of the run",
        RunKind::OneChangeAdapted => "one change, adaptation from 0.03 of the run",
        RunKind::SeveralChanges => "several changes, no adaptation",
        RunKind::SeveralChangesAdapted => "several changes, adaptation",
        RunKind::OneChangeNonlinear => "one change, adaptation, nonlinear amplifier",
        RunKind::SeveralChangesNonlinear => "several changes, adaptation, nonlinear amplifier",
    }
}
