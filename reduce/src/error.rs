//! The errors of a request to this crate.

use counterpoise_linalg as linalg;

/// Every way in which a reduction can be refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The system itself was refused.
    #[error(transparent)]
    System(#[from] counterpoise_lti::Error),
    /// A matrix computation was refused.
    #[error("{what}: {source}")]
    Matrix {
        /// The step.
        what: &'static str,
        /// The reason.
        source: linalg::Error,
    },
    /// Fewer states were asked for than poles that must be kept.
    #[error("order {wanted} is below the {kept} poles on or beyond the border of stability, which are kept")]
    Order {
        /// The order asked for.
        wanted: usize,
        /// Number of poles that are kept.
        kept: usize,
    },
    /// More states were asked for than carry anything above rounding.
    #[error(
        "order {wanted} is above the {largest} states whose Hankel values stand above rounding: ask for at most {largest}"
    )]
    Rounding {
        /// The order asked for.
        wanted: usize,
        /// Number of Hankel values above rounding.
        largest: usize,
    },
    /// A number outside what the operation is defined for.
    #[error("{what} = {value} must be {allowed}")]
    Range {
        /// The argument.
        what: &'static str,
        /// The value given.
        value: f64,
        /// Allowed values.
        allowed: &'static str,
    },
    /// Matrices or degrees of freedom that do not fit together.
    #[error("{what}: {found:?} does not fit {expected:?}")]
    Shape {
        /// Name of the item.
        what: &'static str,
        /// The shape that was given.
        found: (usize, usize),
        /// The shape that was needed.
        expected: (usize, usize),
    },
    /// A weight or a loop that must be stable is not.
    #[error("{what} has the pole {re:.4e} {im:+.4e}i: a stable one is needed")]
    Unstable {
        /// The system.
        what: &'static str,
        /// Real part of the pole.
        re: f64,
        /// Imaginary part of the pole.
        im: f64,
    },
}

/// Says which step a refused matrix computation belonged to.
pub(crate) trait StepContext<T> {
    /// Returns the same result, with the step's name in its error.
    fn with_step(self, what: &'static str) -> Result<T, Error>;
}

impl<T> StepContext<T> for Result<T, linalg::Error> {
    fn with_step(self, what: &'static str) -> Result<T, Error> {
        self.map_err(|source| Error::Matrix { what, source })
    }
}
