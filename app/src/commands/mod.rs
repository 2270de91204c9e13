//! The commands: each loads what it needs, calls the road, prints, and says by its exit code how it went.

pub mod adapt;
pub mod claims;
pub mod design;
pub mod diagnose;
pub mod export;
pub mod fra;
pub mod identify;
pub mod model;
pub mod new;
pub mod pages;
pub mod replay;
pub mod stages;
pub mod structure;
pub mod studio;
pub mod sweep;
pub mod synth;
pub mod verify;

use std::process::ExitCode;

use anyhow::Result;

/// What a command returns.
pub type Done = Result<ExitCode>;

/// 0 where all verdicts hold, 1 where some fail.
pub fn verdict_code(passes: bool) -> ExitCode {
    if passes { ExitCode::SUCCESS } else { ExitCode::from(1) }
}
