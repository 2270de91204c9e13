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

/// A matrix whose rows stand in groups of [`GROUP`], column by column within a group, so that a product with rows of derivatives works on a
/// group at a time.
#[derive(Debug, Clone, Default)]
pub(crate) struct GroupedMatrix {
    rows: usize,
    columns: usize,
    data: Vec<[f64; GROUP]>,
}

/// Rows of a group.
const GROUP: usize = 4;

impl GroupedMatrix {
    /// Returns a matrix of zeros.
    pub fn new(rows: usize, columns: usize) -> Self {
        Self { rows, columns, data: vec![[0.0; GROUP]; rows.div_ceil(GROUP) * columns] }
    }

    /// Sets an entry.
    #[inline(always)]
    pub fn set(&mut self, row: usize, column: usize, value: f64) {
        self.data[row / GROUP * self.columns + column][row % GROUP] = value;
    }

    /// Computes rows of `out` from one on: += the matrix times rows of `x` from one on. `out` has rows for whole groups.
    #[inline(always)]
    pub fn multiply_add(&self, x: &Block, first: usize, out: &mut Block, to: usize) {
        let stride = x.width / LANES;
        let from = &x.data.as_chunks::<LANES>().0[first * stride..(first + self.columns) * stride];
        let all = out.data.as_chunks_mut::<LANES>().0;
        for group in 0..self.rows.div_ceil(GROUP) {
            let factors = &self.data[group * self.columns..(group + 1) * self.columns];
            let rows = &mut all[(to + group * GROUP) * stride..(to + (group + 1) * GROUP) * stride];
            let mut place = 0;
            while place + 2 <= stride {
                multiply_tile::<2>(factors, from, stride, place, rows);
                place += 2;
            }
            if place < stride {
                multiply_tile::<1>(factors, from, stride, place, rows);
            }
        }
    }
}

/// Computes rows of `out`: += for each row the sum of `slopes` over its columns, each with its factor. `slopes` has a row of derivatives for each
/// entry of a matrix with rows for whole groups.
#[inline(always)]
pub(crate) fn add_entry_slopes(slopes: &Block, factors: &[f64], out: &mut Block) {
    let (stride, wide) = (slopes.width / LANES, out.width / LANES);
    let data = slopes.data.as_chunks::<LANES>().0;
    let all = out.data.as_chunks_mut::<LANES>().0;
    let group = GROUP * factors.len() * stride;
    for (index, data) in data.chunks_exact(group).enumerate() {
        let rows = &mut all[index * GROUP * wide..(index + 1) * GROUP * wide];
        for place in 0..stride {
            let mut sums = [[0.0; LANES]; GROUP];
            for row in 0..GROUP {
                sums[row] = rows[row * wide + place];
            }
            for column in 0..factors.len() {
                for row in 0..GROUP {
                    let x = data[(row * factors.len() + column) * stride + place];
                    for lane in 0..LANES {
                        sums[row][lane] += factors[column] * x[lane];
                    }
                }
            }
            for row in 0..GROUP {
                rows[row * wide + place] = sums[row];
            }
        }
    }
}

/// Works on a group of rows in a few columns, which stay in registers meanwhile.
#[inline(always)]
fn multiply_tile<const COUNT: usize>(
    factors: &[[f64; GROUP]],
    x: &[[f64; LANES]],
    stride: usize,
    place: usize,
    out: &mut [[f64; LANES]],
) {
    let mut sums = [[[0.0; LANES]; COUNT]; GROUP];
    for row in 0..GROUP {
        for k in 0..COUNT {
            sums[row][k] = out[row * stride + place + k];
        }
    }
    for column in 0..factors.len() {
        let factor = factors[column];
        for k in 0..COUNT {
            let x = x[column * stride + place + k];
            for row in 0..GROUP {
                for lane in 0..LANES {
                    sums[row][k][lane] += factor[row] * x[lane];
                }
            }
        }
    }
    for row in 0..GROUP {
        for k in 0..COUNT {
            out[row * stride + place + k] = sums[row][k];
        }
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
    let (out, x) = (out.as_chunks_mut::<LANES>().0, x.as_chunks::<LANES>().0);
    let count = out.len().min(x.len());
    let (out, x) = (&mut out[..count], &x[..count]);
    for k in 0..count {
        for lane in 0..LANES {
            out[k][lane] += factor * x[k][lane];
        }
    }
}
