//! Rows of derivatives: one row a quantity, one column a direction.

/// Columns that are worked on at a time: what a register of AVX2 holds.
const LANES: usize = 4;

/// Derivatives of several quantities along all directions, row by row.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    width: usize,
    data: Vec<f64>,
}

impl Block {
    /// Returns zeros; the width is that of [`pad_width`].
    pub fn new(rows: usize, width: usize) -> Self {
        Self { width, data: vec![0.0; rows * width] }
    }

    /// Returns the derivatives of a quantity.
    #[inline(always)]
    pub fn row(&self, row: usize) -> &[f64] {
        &self.data[row * self.width..(row + 1) * self.width]
    }

    /// Returns the derivatives of a quantity, to be changed.
    #[inline(always)]
    pub fn row_mut(&mut self, row: usize) -> &mut [f64] {
        &mut self.data[row * self.width..(row + 1) * self.width]
    }

    /// Sets everything to 0.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.data.fill(0.0);
    }

    /// Takes the values of another block of the same size.
    #[inline(always)]
    pub fn copy(&mut self, from: &Self) {
        self.data.copy_from_slice(&from.data);
    }

    /// Adds a multiple of a row of another block; columns beyond the narrower of both stay as they are.
    #[inline(always)]
    pub fn add(&mut self, row: usize, factor: f64, other: &[f64]) {
        add_multiple(self.row_mut(row), factor, other);
    }

    /// Exchanges two rows.
    #[inline(always)]
    pub fn swap_rows(&mut self, a: usize, b: usize) {
        if a != b {
            let (first, last) = (a.min(b), a.max(b));
            let (above, below) = self.data.split_at_mut(last * self.width);
            above[first * self.width..(first + 1) * self.width].swap_with_slice(&mut below[..self.width]);
        }
    }

    /// Adds a multiple of a row to another one.
    #[inline(always)]
    pub fn add_row(&mut self, to: usize, factor: f64, from: usize) {
        let width = self.width;
        let (above, below) = self.data.split_at_mut(to.max(from) * width);
        if to < from {
            add_multiple(&mut above[to * width..(to + 1) * width], factor, &below[..width]);
        } else {
            add_multiple(&mut below[..width], factor, &above[from * width..(from + 1) * width]);
        }
    }

    /// Multiplies a row by a factor.
    #[inline(always)]
    pub fn scale_row(&mut self, row: usize, factor: f64) {
        self.row_mut(row).iter_mut().for_each(|entry| *entry *= factor);
    }
}

/// Returns a number of directions padded to whole registers.
pub(crate) fn pad_width(directions: usize) -> usize {
    directions.next_multiple_of(LANES)
}

/// Computes out += factor x, as far as the shorter of both goes.
#[inline(always)]
pub(crate) fn add_multiple(out: &mut [f64], factor: f64, x: &[f64]) {
    if factor == 0.0 {
        return;
    }
    for (out, x) in out.chunks_exact_mut(LANES).zip(x.chunks_exact(LANES)) {
        for lane in 0..LANES {
            out[lane] += factor * x[lane];
        }
    }
}
