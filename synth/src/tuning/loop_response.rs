//! The loop of one plant on the grid, and the rows that are read from it.

use counterpoise_linalg::C64;

/// A number with its slopes in the open parameters.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    pub value: f64,
    pub slope: Vec<f64>,
}

/// The loop of one plant on the grid.
pub(crate) struct TuningResponse<'a> {
    pub rates: &'a [f64],
    pub L: Vec<C64>,
    pub S: Vec<C64>,
    /// |KS|.
    pub effort: Vec<f64>,
    /// Slopes of ln K in the open parameters, at each frequency.
    pub slopes: &'a [Vec<C64>],
}
