//! The errors of a request to this crate.

/// Every way in which a request to this crate can be refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A figure that does not exist.
    #[error("there is no figure '{key}'{hint}")]
    UnknownFigure {
        /// Requested key.
        key: String,
        /// ", did you mean ...", or nothing.
        hint: String,
    },
    /// A number outside what the operation is defined for.
    #[error("{what} = {value} must be {allowed}")]
    Range {
        /// The argument.
        what: &'static str,
        /// The value that was given.
        value: f64,
        /// Allowed values.
        allowed: &'static str,
    },
    /// Series that should be of one length, or long enough.
    #[error("{what}: {found} samples where {needed} are needed")]
    Length {
        /// The series.
        what: &'static str,
        /// Number of samples that were given.
        found: usize,
        /// Number that is needed.
        needed: usize,
    },
    /// A series that holds NaN or an infinite number.
    #[error("{what}[{index}] = {value} is not finite")]
    NotFinite {
        /// The series.
        what: &'static str,
        /// Where.
        index: usize,
        /// What.
        value: f64,
    },
    /// A linear-systems operation failed.
    #[error("linear loop: {0}")]
    Lti(#[from] counterpoise_lti::Error),
    /// The mechanism was refused.
    #[error("plant: {0}")]
    Models(#[from] counterpoise_models::Error),
    /// The controller was refused.
    #[error("controller: {0}")]
    Controller(#[from] counterpoise_controller::Error),
    /// The controller runs at another period than the mechanism's interface.
    #[error("the controller's sample period is {controller_s} s, the interface's {interface_s} s")]
    Period {
        /// The controller's, s.
        controller_s: f64,
        /// The interface's, s.
        interface_s: f64,
    },
    /// There is nothing to verify.
    #[error("a loop without a controller has no margins")]
    NoController,
    /// The simulator refused, or the motion diverged.
    #[error("simulation: {0}")]
    Simulate(#[from] counterpoise_simulate::Error),
}
