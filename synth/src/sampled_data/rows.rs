//! A system that is built from its signals.

use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};

use crate::Error;

/// Signals as rows on \[states; inputs\] of a system that is being built.
pub(super) struct Rows {
    sizes: Vec<usize>,
    width: usize,
    inputs: usize,
}

impl Rows {
    pub fn new(sizes: &[usize], inputs: usize) -> Self {
        Self { sizes: sizes.to_vec(), width: sizes.iter().sum::<usize>() + inputs, inputs }
    }

    pub fn state(&self, index: usize) -> Mat {
        let first: usize = self.sizes[..index].iter().sum();
        Mat::from_fn(self.sizes[index], self.width, |i, j| if j == first + i { 1.0 } else { 0.0 })
    }

    pub fn input(&self, index: usize) -> Mat {
        let at = self.width - self.inputs + index;
        Mat::from_fn(1, self.width, |_, j| if j == at { 1.0 } else { 0.0 })
    }

    pub fn system(&self, next: &Mat, outputs: &Mat, period_s: f64) -> Result<StateSpace, Error> {
        let (n, m) = (self.width - self.inputs, self.inputs);
        let split = |rows: &Mat| (rows.block(0, 0, rows.nrows(), n), rows.block(0, n, rows.nrows(), m));
        let ((A, B), (C, D)) = (split(next), split(outputs));
        Ok(StateSpace::new(A, B, C, D, Timebase::Discrete { period_s })?)
    }
}
