//! A plant with the states of its weights: the full-information problem that feedback and feedforward share.

use counterpoise_linalg::Mat;
use counterpoise_lti::StateSpace;

/// A single-control plant between an error weight and an inverse control weight
///
/// ```text
///     x_p' = A x_p + B u        u    = C_u x_u + D_u v     x_u' = A_u x_u + B_u v
///     e    = - C x_p            z1   = C_e x_e + D_e e     x_e' = A_e x_e + B_e e
///     z2   = v                  z3   = M x_p
/// ```
pub(crate) struct AugmentedPlant {
    /// Plant state matrix, n x n.
    pub A: Mat,
    /// Control column, n x 1.
    pub B: Mat,
    /// Row of the signal whose negative is the error, 1 x n.
    pub C: Mat,
    /// Further weighted outputs, q x n.
    pub further: Mat,
    /// Error weight.
    pub error: StateSpace,
    /// Inverse control weight.
    pub control: StateSpace,
}

impl AugmentedPlant {
    /// Orders of plant, error weight and inverse control weight.
    pub fn sizes(&self) -> (usize, usize, usize) {
        (self.A.nrows(), self.error.order(), self.control.order())
    }

    /// Returns n + e + u.
    pub fn order(&self) -> usize {
        let (n, e, u) = self.sizes();
        n + e + u
    }

    /// Returns the state matrix on \[x_p; x_e; x_u\].
    pub fn state(&self) -> Mat {
        let (n, e, u) = self.sizes();
        let (E, U) = (&self.error, &self.control);
        Mat::from_blocks(&[
            &[&self.A, &Mat::zeros(n, e), &(&self.B * &U.C)],
            &[&-(&E.B * &self.C), &E.A, &Mat::zeros(e, u)],
            &[&Mat::zeros(u, n), &Mat::zeros(u, e), &U.A],
        ])
    }

    /// Returns the column of v.
    pub fn input(&self) -> Mat {
        let (_, e, _) = self.sizes();
        Mat::from_blocks(&[&[&(&self.B * &self.control.D)], &[&Mat::zeros(e, 1)], &[&self.control.B]])
    }

    /// Returns the rows of z1 and z3 (z2 is v).
    pub fn output(&self) -> Mat {
        let (_, e, u) = self.sizes();
        let q = self.further.nrows();
        Mat::from_blocks(&[
            &[&-(&self.error.D * &self.C), &self.error.C, &Mat::zeros(1, u)],
            &[&self.further, &Mat::zeros(q, e), &Mat::zeros(q, u)],
        ])
    }

    /// Returns the row of u: C_u x_u + D_u v with v = `v` times the state (and whatever follows it).
    pub fn control_row(&self, v: &Mat) -> Mat {
        let (n, e, u) = self.sizes();
        let mut row = Mat::zeros(1, v.ncols());
        row.set_block(0, n + e, &self.control.C);
        debug_assert!(v.ncols() >= n + e + u);
        &row + &(&self.control.D * v)
    }
}
