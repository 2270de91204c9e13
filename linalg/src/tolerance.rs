//! The tolerances and iteration limits of the crate: all of them, all relative.

/// Unit roundoff times two: the distance from one to the next double.
pub const EPS: f64 = f64::EPSILON;

/// Largest relative difference from its transpose that an input still called symmetric may have.
pub const SYMMETRY: f64 = 1e-10;

/// A swap of two diagonal blocks of a Schur form may cost this much backward error, relative to the blocks.
pub const SWAP: f64 = 1e-13;

/// QR iterations allowed for each eigenvalue.
pub const QR_ITERATIONS: usize = 40;

/// Sweeps allowed to balance a matrix; each sweep lowers the norm, most matrices take three or four.
pub const BALANCE_SWEEPS: usize = 24;

/// A sweep of balancing must lower a row and column by this factor to count.
pub const BALANCE_GAIN: f64 = 0.95;

/// Newton steps allowed to refine a Riccati solution.
pub const NEWTON_STEPS: usize = 12;

/// Doubling or sign iterations allowed; quadratic convergence takes about twelve.
pub const DOUBLING_STEPS: usize = 60;

/// Relative residual above which a Riccati solution is refused.
pub const RICCATI_RESIDUAL: f64 = 1e-9;

/// A residual is rounding where it is below this times the norms of the data and of the solution: then the solution is
/// the best that doubles can hold.
pub const ROUNDING: f64 = 16.0 * EPS;
