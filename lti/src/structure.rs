//! A flexible structure recognised and taken apart into its modes.
//!
//! Assembled in physical coordinates, the low modes of a structure are differences of large stiffnesses: a solver that is
//! backward stable loses as many digits as the squares of highest and lowest frequency are apart. Where A is that of
//!
//! ```text
//!   w' = a v,   v' = -K w - G v,    K exactly symmetric, G diagonal in the modes of K
//! ```
//!
//! the modes are computed instead, each frequency from its Rayleigh quotient in twice the working precision.

use crate::error::OperationContext;
use crate::tolerance::UNCOUPLED;
use crate::{Error, Mat, StateSpace, Timebase};
use counterpoise_linalg as linalg;

/// Structures below this size gain nothing.
const SMALLEST: usize = 4;

/// Returns the system in modal coordinates, with blocks \[0 w; -w -g\] on the diagonal, or `None` if it is no such structure.
///
/// # Errors
/// [`Error::Matrix`] if the symmetric eigenproblem fails.
pub(crate) fn modes(g: &StateSpace) -> Result<Option<StateSpace>, Error> {
    let n = g.order();
    if n < SMALLEST || g.timebase != Timebase::Continuous {
        return Ok(None);
    }
    let Some(pairs) = pairs(&g.A) else { return Ok(None) };
    let positions: Vec<usize> = pairs.iter().map(|pair| pair.0).collect();
    let speeds: Vec<usize> = pairs.iter().map(|pair| pair.1).collect();
    let rate = Mat::diag(&pairs.iter().map(|&(p, v)| g.A[(p, v)]).collect::<Vec<f64>>());
    let K = -(&g.A.select(&speeds, &positions) * &rate);
    if K != K.t() || is_diagonal(&K) {
        return Ok(None);
    }
    let (_, X) = linalg::sym_eigen(&K).with_operation("modes")?;
    let G = -(&X.t() * &(&g.A.select(&speeds, &speeds) * &X));
    let least = UNCOUPLED * G.norm_max();
    let coupled = |i: usize, j: usize| i != j && G[(i, j)].abs() > least;
    if (0..n / 2).any(|j| (0..n / 2).any(|i| coupled(i, j))) {
        return Ok(None);
    }
    let squares: Vec<f64> = (0..n / 2).map(|k| rayleigh(&K, X.column(k))).collect();
    let modal = ModalForm { X, squares, damping: G.diagonal(), rate };
    modal.system(g, &positions, &speeds).map(Some)
}

/// Modal coordinates already: the blocks as they are given hold more digits than any that are computed.
fn is_diagonal(K: &Mat) -> bool {
    (0..K.ncols()).all(|j| K.column(j).iter().enumerate().all(|(i, &k)| i == j || k == 0.0))
}

/// (position, speed) of each coordinate: a position's row holds nothing but the rate at its own speed.
fn pairs(A: &Mat) -> Option<Vec<(usize, usize)>> {
    let n = A.nrows();
    let mut count = vec![0; n];
    let mut last = vec![0; n];
    for j in 0..n {
        for (i, _) in A.column(j).iter().enumerate().filter(|(_, a)| **a != 0.0) {
            count[i] += 1;
            last[i] = j;
        }
    }
    let half = n / 2;
    let positions: Vec<usize> = (0..half).collect();
    let simple = |i: &usize| count[*i] == 1 && last[*i] >= half;
    let pairs: Vec<(usize, usize)> = positions.into_iter().filter(simple).map(|i| (i, last[i])).collect();
    let mut speeds: Vec<usize> = pairs.iter().map(|pair| pair.1).collect();
    speeds.sort_unstable();
    speeds.dedup();
    (2 * speeds.len() == n && pairs.len() == half).then_some(pairs)
}

struct ModalForm {
    X: Mat,
    squares: Vec<f64>,
    damping: Vec<f64>,
    rate: Mat,
}

impl ModalForm {
    fn system(&self, g: &StateSpace, positions: &[usize], speeds: &[usize]) -> Result<StateSpace, Error> {
        let count = self.squares.len();
        let inputs: Vec<usize> = (0..g.inputs()).collect();
        let outputs: Vec<usize> = (0..g.outputs()).collect();
        // Positions are w = inv(rate) p = X q, speeds X r.
        let slow = Mat::diag(&self.rate.diagonal().iter().map(|a| 1.0 / a).collect::<Vec<f64>>());
        let Bq = &self.X.t() * &(&slow * &g.B.select(positions, &inputs));
        let Br = &self.X.t() * &g.B.select(speeds, &inputs);
        let Cq = &g.C.select(&outputs, positions) * &(&self.rate * &self.X);
        let Cr = &g.C.select(&outputs, speeds) * &self.X;
        let n = 2 * count;
        let mut A = Mat::zeros(n, n);
        let (mut B, mut C) = (Mat::zeros(n, inputs.len()), Mat::zeros(outputs.len(), n));
        for k in 0..count {
            let square = self.squares[k];
            let w = if square > 0.0 { square.sqrt() } else { 1.0 };
            let (q, r) = (2 * k, 2 * k + 1);
            (A[(q, r)], A[(r, q)], A[(r, r)]) = (w, -square / w, -self.damping[k]);
            inputs.iter().for_each(|&j| (B[(q, j)], B[(r, j)]) = (w * Bq[(k, j)], Br[(k, j)]));
            outputs.iter().for_each(|&i| (C[(i, q)], C[(i, r)]) = (Cq[(i, k)] / w, Cr[(i, k)]));
        }
        StateSpace::new(A, B, C, g.D.clone(), g.timebase)
    }
}

/// x'Kx / x'x in twice the working precision.
fn rayleigh(K: &Mat, x: &[f64]) -> f64 {
    let (mut energy, mut size) = (LongReal::default(), LongReal::default());
    for (j, &xj) in x.iter().enumerate() {
        let mut row = LongReal::default();
        for (&k, &xi) in K.column(j).iter().zip(x).filter(|(k, _)| **k != 0.0) {
            row.add_product(k, xi);
        }
        energy.add_product(row.high, xj);
        energy.low += row.low * xj;
        size.add_product(xj, xj);
    }
    let total = size.high + size.low;
    let quotient = (energy.high + energy.low) / total;
    // One step of correction for the rounding of the quotient: energy - quotient * size, exactly enough.
    let mut rest = energy;
    rest.add_product(-quotient, size.high);
    quotient + (rest.high + rest.low - quotient * size.low) / total
}

/// An unevaluated sum of two doubles (Dekker 1971).
#[derive(Debug, Clone, Copy, Default)]
struct LongReal {
    high: f64,
    low: f64,
}

impl LongReal {
    /// self += a b, with the rounding errors of product and sum kept.
    fn add_product(&mut self, a: f64, b: f64) {
        let product = a * b;
        let ((ah, al), (bh, bl)) = (halves(a), halves(b));
        let product_error = ((ah * bh - product) + ah * bl + al * bh) + al * bl;
        let sum = self.high + product;
        let back = sum - self.high;
        let sum_error = (self.high - (sum - back)) + (product - back);
        self.high = sum;
        self.low += product_error + sum_error;
    }
}

/// a as the sum of two numbers of 26 bits (Veltkamp).
fn halves(a: f64) -> (f64, f64) {
    const SPLITTER: f64 = 134_217_729.0;
    let scaled = SPLITTER * a;
    let high = scaled - (scaled - a);
    (high, a - high)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::poles;

    /// Returns a rod of n masses fixed at one end, modal damping `zeta`, in physical units.
    pub(crate) fn build_rod(n: usize, k: f64, zeta: f64) -> StateSpace {
        let K = Mat::from_fn(n, n, |i, j| match i.abs_diff(j) {
            0 if i + 1 == n => k,
            0 => 2.0 * k,
            1 => -k,
            _ => 0.0,
        });
        let (squares, X) = linalg::sym_eigen(&K).unwrap();
        let rates: Vec<f64> = squares.iter().map(|square| 2.0 * zeta * square.sqrt()).collect();
        let G = &X * &(&Mat::diag(&rates) * &X.t());
        let A = Mat::from_blocks(&[&[&Mat::zeros(n, n), &Mat::eye(n)], &[&-&K, &-&G]]);
        let (mut B, mut C) = (Mat::zeros(2 * n, 1), Mat::zeros(1, 2 * n));
        (B[(n, 0)], C[(0, n - 1)]) = (1.0, 1.0);
        StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap()
    }

    #[test]
    fn the_lowest_frequency_of_an_unscaled_rod_has_all_its_digits() {
        let (n, k) = (100, 1e9);
        let modal = modes(&build_rod(n, k, 0.005)).unwrap().unwrap();
        // 2 sqrt(k) sin((2j - 1) pi / (2 (2n + 1))).
        for j in 1..=n {
            let exact =
                2.0 * k.sqrt() * ((2 * j - 1) as f64 * std::f64::consts::PI / (4 * n + 2) as f64).sin();
            let found = modal.A[(2 * j - 2, 2 * j - 1)];
            assert!((found / exact - 1.0).abs() < 4e-16, "{j}: {found} {exact}");
        }
    }

    #[test]
    fn the_modal_system_is_the_same_system() {
        let g = build_rod(6, 1e4, 0.02);
        let modal = modes(&g).unwrap().unwrap();
        let (a, b) = (poles(&g).unwrap(), poles(&modal).unwrap());
        let far = |p: &crate::C64| b.iter().map(|q| (p - q).norm()).fold(f64::INFINITY, f64::min);
        assert!(a.iter().all(|p| far(p) < 1e-10 * p.norm()));
        let dense = |g: &StateSpace, s: crate::C64| {
            let n = g.order();
            let M = crate::CMat::eye(n).scale(s) - g.A.to_complex();
            (&g.C.to_complex() * &linalg::csolve(&M, &g.B.to_complex()).unwrap())[(0, 0)]
        };
        for rate in [3.0, 25.0, 190.0] {
            let s = crate::C64::new(0.0, rate);
            let (x, y) = (dense(&g, s), dense(&modal, s));
            assert!((x - y).norm() < 1e-11 * x.norm(), "{x} {y}");
        }
    }

    #[test]
    fn other_systems_are_left_alone() {
        let mut g = build_rod(6, 1e4, 0.02);
        g.A[(8, 9)] += 3.0;
        assert!(modes(&g).unwrap().is_none());
        let mut g = build_rod(6, 1e4, 0.02);
        g.A[(8, 1)] += 1e-9;
        assert!(modes(&g).unwrap().is_none());
    }
}
