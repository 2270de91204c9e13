//! What can be wrong with a request to this crate.

/// Every way in which a request to this crate can be refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Matrices whose sizes do not make a system, or two systems whose signals do not fit.
    #[error("{what}: {found:?} does not fit {expected:?}")]
    Shape {
        /// Which matrix or connection.
        what: &'static str,
        /// The shape that was given.
        found: (usize, usize),
        /// The shape that was needed.
        expected: (usize, usize),
    },
    /// An entry that is NaN or infinite.
    #[error("{what} holds a number that is not finite")]
    NotFinite {
        /// Which matrix.
        what: &'static str,
    },
    /// Two systems on different timebases, or an operation that needs the other kind of time.
    #[error("{what}: timebase {found} where {expected} is needed")]
    Timebase {
        /// Which operation.
        what: &'static str,
        /// The timebase that was given.
        found: String,
        /// The timebase that was needed.
        expected: String,
    },
    /// A sample period that is not a positive number.
    #[error("sample period {period_s} s: it must be positive and finite")]
    Period {
        /// The period that was given, in seconds.
        period_s: f64,
    },
    /// A loop closed around a direct path that has no unique solution.
    #[error("{what}: the algebraic loop is singular (reciprocal condition {rcond:.1e})")]
    AlgebraicLoop {
        /// Which connection.
        what: &'static str,
        /// Reciprocal condition number of the loop matrix.
        rcond: f64,
    },
}
