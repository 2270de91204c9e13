//! What a command returns to the shell.

use std::process::ExitCode;

use anyhow::Result;

/// What a command returns.
pub type Done = Result<ExitCode>;

/// Returns 0 if all verdicts hold, 1 if some fail.
pub fn verdict_code(verdicts: impl IntoIterator<Item = bool>) -> ExitCode {
    if verdicts.into_iter().all(|holds| holds) { ExitCode::SUCCESS } else { ExitCode::from(1) }
}
