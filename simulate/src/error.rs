//! What can be wrong with a simulation.

/// Every way in which a simulation can be refused or end early.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The mechanism was refused.
    #[error(transparent)]
    Models(#[from] counterpoise_models::Error),
    /// A linear-systems operation failed.
    #[error(transparent)]
    Lti(#[from] counterpoise_lti::Error),
    /// A number outside its range.
    #[error("{what} = {value}: {allowed}")]
    Range {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A list whose length does not fit.
    #[error("{what} has {found} entries where {expected} are needed")]
    Length {
        /// Which list.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many are needed.
        expected: usize,
    },
    /// A recording without a channel that is needed.
    #[error("the recording has no {channel}")]
    NoChannel {
        /// Which channel.
        channel: &'static str,
    },
    /// The run asked for more steps than it was allowed.
    #[error("the motion asks for more than {steps} steps until {time_s} s")]
    Effort {
        /// When.
        time_s: f64,
        /// How many were allowed until the end.
        steps: usize,
    },
    /// The state grew beyond all bounds.
    #[error("the motion diverged at {time_s} s")]
    Diverged {
        /// When.
        time_s: f64,
    },
}
