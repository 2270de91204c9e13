//! Rows of derivatives: one row a quantity, one column a direction.

/// Columns that are worked on at a time: what a register of AVX2 holds.
const LANES: usize = 4;

/// Derivatives of several quantities along all directions, row by row.
#[derive(Debug, Clone, Default)]
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
        &self.data.as_slice()[row * self.width..(row + 1) * self.width]
    }

    /// Returns the derivatives of a quantity, to be changed.
    #[inline(always)]
    pub fn row_mut(&mut self, row: usize) -> &mut [f64] {
        &mut self.data.as_mut_slice()[row * self.width..(row + 1) * self.width]
    }

    /// Sets everything to 0.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.data.fill(0.0);
    }

    /// Adds a multiple of a row of another block; columns beyond the narrower of both stay as they are.
    #[inline(always)]
    pub fn add(&mut self, row: usize, factor: f64, other: &[f64]) {
        add_multiple(self.row_mut(row), factor, other);
    }

    /// Adds the sum of the first rows, each with its factor, to a row that is no wider.
    #[inline(always)]
    pub fn combine(&self, factors: &[f64], out: &mut [f64]) {
        self.combine_from(0, factors, out);
    }

    /// Adds the sum of the rows from one on, each with its factor, to a row that is no wider.
    #[inline(always)]
    pub fn combine_from(&self, first: usize, factors: &[f64], out: &mut [f64]) {
        let (rows, stride) = (self.data.as_chunks::<LANES>().0, self.width / LANES);
        let rows = &rows[first * stride..(first + factors.len()) * stride];
        let out = out.as_chunks_mut::<LANES>().0;
        let mut place = 0;
        while out.len() - place >= 4 {
            combine_columns::<4>(rows, stride, place, factors, out);
            place += 4;
        }
        if out.len() - place >= 2 {
            combine_columns::<2>(rows, stride, place, factors, out);
            place += 2;
        }
        if out.len() > place {
            combine_columns::<1>(rows, stride, place, factors, out);
        }
    }

    /// Replaces the first two rows by combinations of both.
    #[inline(always)]
    pub fn transform_pair(&mut self, first: [f64; 2], second: [f64; 2]) {
        let (a, b) = self.data.split_at_mut(self.width);
        for k in 0..self.width {
            let (one, other) = (a[k], b[k]);
            a[k] = first[0] * one + first[1] * other;
            b[k] = second[0] * one + second[1] * other;
        }
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
        for entry in self.row_mut(row) {
            *entry *= factor;
        }
    }
}

/// Adds the sum of rows, each with its factor, in a few neighbouring columns, which stay in registers meanwhile.
#[inline(always)]
fn combine_columns<const COUNT: usize>(
    rows: &[[f64; LANES]],
    stride: usize,
    place: usize,
    factors: &[f64],
    out: &mut [[f64; LANES]],
) {
    // loops over places, not iterators: an iterator's own functions are compiled without the widest registers unless they are inlined
    let mut sum = [[0.0; LANES]; COUNT];
    sum.copy_from_slice(&out[place..place + COUNT]);
    for (row, factor) in factors.iter().enumerate() {
        let x = &rows[row * stride + place..row * stride + place + COUNT];
        for k in 0..COUNT {
            for lane in 0..LANES {
                sum[k][lane] += factor * x[k][lane];
            }
        }
    }
    out[place..place + COUNT].copy_from_slice(&sum);
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
    let (out, x) = (out.as_chunks_mut::<LANES>().0, x.as_chunks::<LANES>().0);
    let count = out.len().min(x.len());
    let (out, x) = (&mut out[..count], &x[..count]);
    for k in 0..count {
        for lane in 0..LANES {
            out[k][lane] += factor * x[k][lane];
        }
    }
}
