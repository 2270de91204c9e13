//! What a command returns to the shell.

use anyhow::Result;

/// Exit code of a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Exit(pub u8);

impl Exit {
    /// All verdicts hold.
    pub const SUCCESS: Self = Self(0);
    /// Some verdicts fail.
    pub const VERDICTS_FAIL: Self = Self(1);
    /// The input cannot be used.
    pub const BAD_INPUT: Self = Self(2);
}

/// What a command returns.
pub type Done = Result<Exit>;

/// Returns 0 if all verdicts hold, 1 if some fail.
pub fn verdict_code(verdicts: impl IntoIterator<Item = bool>) -> Exit {
    if verdicts.into_iter().all(|holds| holds) { Exit::SUCCESS } else { Exit::VERDICTS_FAIL }
}
