//! The errors of a request to this crate.

/// Every way in which a request to this crate can be refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Matrices whose sizes do not make a system, or two systems whose signals do not fit.
    #[error("{what}: {found:?} does not fit {expected:?}")]
    Shape {
        /// The matrix or connection.
        what: &'static str,
        /// The shape that was given.
        found: (usize, usize),
        /// The shape that was needed.
        expected: (usize, usize),
    },
    /// An entry that is NaN or infinite.
    #[error("{what} holds a number that is not finite")]
    NotFinite {
        /// The matrix.
        what: &'static str,
    },
    /// Two systems on different timebases, or an operation that needs the other kind of time.
    #[error("{what}: timebase {found} where {expected} is needed")]
    Timebase {
        /// The operation.
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
        /// The connection.
        what: &'static str,
        /// Reciprocal condition number of the loop matrix.
        rcond: f64,
    },
    /// A signal that no block drives, or that two blocks drive.
    #[error("signal '{name}' {problem}{hint}")]
    Signal {
        /// The signal's name.
        name: String,
        /// Description of the error.
        problem: &'static str,
        /// ", did you mean ...", or nothing.
        hint: String,
    },
    /// A system with one input and one output is needed.
    #[error("{what} needs one input and one output, not {inputs} and {outputs}")]
    NotSiso {
        /// The operation.
        what: &'static str,
        /// Number of inputs that was given.
        inputs: usize,
        /// Number of outputs that was given.
        outputs: usize,
    },
    /// The question has no finite answer because of a pole.
    #[error("{what}: pole {re:.6e} {im:+.6e}i {problem}")]
    Pole {
        /// The operation.
        what: &'static str,
        /// Real part of the pole.
        re: f64,
        /// Imaginary part of the pole.
        im: f64,
        /// Why it is in the way.
        problem: &'static str,
    },
    /// More zeros than poles, complex roots without their conjugates, or a leading coefficient of zero.
    #[error("{what}: {problem}")]
    Rational {
        /// The operation.
        what: &'static str,
        /// Description of the error.
        problem: &'static str,
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
    /// A descriptor system whose constraints leave variables undetermined.
    #[error("s E - A is singular for every s: {equations} of its equations say nothing about the variables")]
    SingularPencil {
        /// Number of equations that are left over.
        equations: usize,
    },
    /// A descriptor system that differentiates its input.
    #[error(
        "output {output} contains derivative {derivative} of input {input} (both counted from 0): no proper system has this transfer function"
    )]
    Improper {
        /// The output, counted from 0.
        output: usize,
        /// The input, counted from 0.
        input: usize,
        /// Order of the derivative.
        derivative: usize,
    },
    /// An iteration that reached its limit without its tolerance.
    #[error("{what} did not converge in {iterations} iterations (last change {change:.1e})")]
    NotConverged {
        /// The iteration.
        what: &'static str,
        /// Number of steps that were taken.
        iterations: usize,
        /// The last relative change.
        change: f64,
    },
    /// A matrix computation was refused.
    #[error("{what}: {source}")]
    Matrix {
        /// The operation.
        what: &'static str,
        /// The reason.
        source: counterpoise_linalg::Error,
    },
}

/// Says which operation a refused matrix computation belonged to.
pub(crate) trait OperationContext<T> {
    /// Returns the same result, with the operation's name in its error.
    fn with_operation(self, what: &'static str) -> Result<T, Error>;
}

impl<T> OperationContext<T> for Result<T, counterpoise_linalg::Error> {
    fn with_operation(self, what: &'static str) -> Result<T, Error> {
        self.map_err(|source| Error::Matrix { what, source })
    }
}
