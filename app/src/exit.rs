//! The exit codes that a command returns to the shell.

use anyhow::Result;

/// Exit code of a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExitStatus(pub u8);

impl ExitStatus {
    /// All verdicts hold.
    pub const SUCCESS: Self = Self(0);
    /// Some verdicts fail.
    pub const VERDICTS_FAIL: Self = Self(1);
    /// The input cannot be used.
    pub const BAD_INPUT: Self = Self(2);
}

/// Result of a command: its exit status or an error.
pub type CommandResult = Result<ExitStatus>;

/// Returns 0 if all verdicts hold, 1 if some fail.
pub fn verdict_code(verdicts: impl IntoIterator<Item = bool>) -> ExitStatus {
    if verdicts.into_iter().all(|holds| holds) { ExitStatus::SUCCESS } else { ExitStatus::VERDICTS_FAIL }
}
