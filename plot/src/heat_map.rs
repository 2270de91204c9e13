//! Coloured cells as data.

use ndarray::Array2;

/// Rows and columns of shares, each a coloured cell with its number in per cent.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatMap {
    /// Meaning of the colour; it stands beside the scale of colours.
    pub meaning: String,
    /// Meaning of a framed cell.
    pub frame_meaning: String,
    /// Heading over the names of the rows.
    pub heading: String,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// The rows, from top to bottom.
    pub rows: Vec<HeatRow>,
    /// Shares from 0 to 1, one row of the array for each row and one column for each column; a cell that is not finite has a
    /// dash in place of its number.
    pub shares: Array2<f64>,
    /// Cells with a frame: row and column.
    pub framed: Vec<(usize, usize)>,
}

/// The name of a row, and what stands in place of its cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HeatRow {
    /// Name.
    pub name: String,
    /// Text on grey that covers the cells of a row without values; `None` shows the cells.
    pub cover: Option<String>,
}

impl HeatMap {
    /// Returns the share of a cell, limited to 0 .. 1; `None` if none is known.
    pub fn share(&self, row: usize, column: usize) -> Option<f64> {
        self.shares.get((row, column)).filter(|share| share.is_finite()).map(|share| share.clamp(0.0, 1.0))
    }
}
