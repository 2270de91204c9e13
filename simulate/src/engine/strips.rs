//! Matrices stored for one product after another with vectors.

use counterpoise_linalg::Mat;

/// Rows that are worked on at a time: eight independent chains of two lanes keep a plain SSE2 core busy.
const WIDE: usize = 16;
/// Rows of a last, narrower strip.
pub(crate) const NARROW: usize = 8;

/// A matrix stored in strips of 16 rows, and one of 8 at the end if that is enough, column by column within a strip.
#[derive(Debug, Clone)]
pub(crate) struct Strips {
    columns: usize,
    wide: Vec<f64>,
    narrow: Vec<f64>,
}

impl Strips {
    /// Stores a matrix; its rows are padded to a multiple of 8.
    pub fn new(M: &Mat) -> Self {
        let rows = pad_rows(M.nrows());
        let wide_rows = rows / WIDE * WIDE;
        let store = |from: usize, to: usize, lanes: usize| {
            let mut data = Vec::with_capacity((to - from) * M.ncols());
            for start in (from..to).step_by(lanes) {
                for j in 0..M.ncols() {
                    data.extend((start..start + lanes).map(|i| if i < M.nrows() { M[(i, j)] } else { 0.0 }));
                }
            }
            data
        };
        Self { columns: M.ncols(), wide: store(0, wide_rows, WIDE), narrow: store(wide_rows, rows, NARROW) }
    }

    /// Returns an entry of the matrix.
    pub fn entry(&self, row: usize, column: usize) -> f64 {
        let wide_rows = self.wide.len() / self.columns.max(1);
        let (data, row, lanes) =
            if row < wide_rows { (&self.wide, row, WIDE) } else { (&self.narrow, row - wide_rows, NARROW) };
        data[(row / lanes * self.columns + column) * lanes + row % lanes]
    }

    /// Computes out = start + M v, where `out` is as long as the padded rows; in the widest registers of the machine, with the
    /// same sums in the same order on every machine.
    #[inline]
    pub fn multiply_add(&self, v: &[f64], out: &mut [f64]) {
        pulp::Arch::new().dispatch(Product { M: self, v, out });
    }

    /// Computes what [`Strips::multiply_add`] does, in the registers of the function that it becomes part of.
    #[inline(always)]
    pub fn multiply_add_inline(&self, v: &[f64], out: &mut [f64]) {
        let v = &v[..self.columns];
        let (wide, narrow) = out.split_at_mut(self.wide.len() / self.columns.max(1));
        strips::<WIDE>(&self.wide, v, wide);
        strips::<NARROW>(&self.narrow, v, narrow);
    }
}

/// A product that is compiled for every width of registers.
struct Product<'a> {
    M: &'a Strips,
    v: &'a [f64],
    out: &'a mut [f64],
}

impl pulp::NullaryFnOnce for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.M.multiply_add_inline(self.v, self.out);
    }
}

/// Returns the rows padded to whole strips.
pub(crate) fn pad_rows(rows: usize) -> usize {
    rows.div_ceil(NARROW) * NARROW
}

#[inline(always)]
fn strips<const LANES: usize>(data: &[f64], v: &[f64], out: &mut [f64]) {
    if v.is_empty() {
        return;
    }
    for (strip, target) in data.chunks_exact(LANES * v.len()).zip(out.chunks_exact_mut(LANES)) {
        let mut sum = [0.0; LANES];
        sum.copy_from_slice(target);
        for (column, &factor) in strip.chunks_exact(LANES).zip(v) {
            for lane in 0..LANES {
                sum[lane] += column[lane] * factor;
            }
        }
        target.copy_from_slice(&sum);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_multiply_as_the_matrix_does() {
        for rows in [3, 8, 13, 16, 21, 40] {
            let M = Mat::from_fn(rows, 5, |i, j| (i * 5 + j) as f64 - 7.0);
            let v = [1.0, -2.0, 0.5, 3.0, 0.25];
            let mut out = vec![1.0; pad_rows(rows)];
            Strips::new(&M).multiply_add(&v, &mut out);
            let expected = &M * &Mat::col(&v);
            assert!((0..rows).all(|i| out[i] == expected[(i, 0)] + 1.0));
            let strips = Strips::new(&M);
            assert!((0..rows).all(|i| (0..5).all(|j| strips.entry(i, j) == M[(i, j)])));
        }
    }
}
