//! Why a simulation is refused or ends early.

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
    #[error("{what} is {value}: it must be {allowed}")]
    Range {
        /// The number.
        what: &'static str,
        /// Value.
        value: f64,
        /// The allowed range, as a phrase that follows "must be".
        allowed: &'static str,
    },
    /// A list whose length does not fit.
    #[error("{what} has {found} entries, but {expected} are needed")]
    Length {
        /// The list.
        what: &'static str,
        /// Number of its items.
        found: usize,
        /// Number of items that is needed.
        expected: usize,
    },
    /// A recording without a channel that is needed.
    #[error("the recording has no {channel}, which this replay needs")]
    NoChannel {
        /// The channel.
        channel: &'static str,
    },
    /// The run asked for more steps than it was allowed.
    #[error(
        "the simulation stopped at {time_s} s: it needed more than the {steps} steps that are allowed for the run"
    )]
    Effort {
        /// When.
        time_s: f64,
        /// Number that was allowed until the end.
        steps: usize,
    },
    /// The state grew beyond all bounds.
    #[error("the motion diverged at {time_s} s: a state is no longer a finite number")]
    Diverged {
        /// When.
        time_s: f64,
    },
}
