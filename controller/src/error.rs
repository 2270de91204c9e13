//! Why a controller is refused.

/// Error in the description of a controller.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A name that target code cannot carry, or that is used twice.
    #[error("name '{name}': {problem}")]
    Name {
        /// The name.
        name: String,
        /// Description of the error.
        problem: &'static str,
    },
    /// A number outside its range.
    #[error("{what} is {value}: it must be {allowed}")]
    Range {
        /// The name of the number.
        what: String,
        /// The value that was given.
        value: f64,
        /// Allowed values.
        allowed: &'static str,
    },
    /// A count that does not fit the system it belongs to.
    #[error("path '{path}' has {found} {what}, but needs {expected}")]
    Count {
        /// Name of the path.
        path: String,
        /// The name of what is counted.
        what: &'static str,
        /// The count that was given.
        found: usize,
        /// The count that is needed.
        expected: usize,
    },
    /// A system that is not sampled with the controller's period.
    #[error(
        "path '{path}' is {found}, but the controller's sample period is {period_s} s: both must be the same"
    )]
    Timebase {
        /// Name of the path.
        path: String,
        /// The timebase found.
        found: String,
        /// The controller's period, s.
        period_s: f64,
    },
    /// Points of a schedule that are not in increasing order.
    #[error("path '{path}': the schedule points {below:?}, {at} and {above:?} (kg m) must increase")]
    Schedule {
        /// Name of the path.
        path: String,
        /// Point below, kg m.
        below: Option<f64>,
        /// The path's own point, kg m.
        at: f64,
        /// Point above, kg m.
        above: Option<f64>,
    },
    /// A system that could not be built.
    #[error(transparent)]
    System(#[from] counterpoise_lti::Error),
    /// A matrix computation that failed.
    #[error("realisation: {0}")]
    Realisation(String),
}
