//! The symplectic scaling of a Hamiltonian problem by powers of two: exact, and the cure of unscaled physical units.
//!
//! Source: the idea of Benner, Symplectic balancing of Hamiltonian matrices, SIAM J. Sci. Comput. 22 (2001).

use crate::balance::{squares, squares_of_column, squares_of_row};
use crate::heap::keep_freed_blocks;
use crate::mat::Mat;
use crate::tolerance::{BALANCE_GAIN, BALANCE_SWEEPS};

/// The data of `A'X + XA - XGX + Q = 0`, or of `X = A'X (I + G X)^-1 A + Q`.
#[derive(Clone)]
pub(super) struct Problem {
    pub(super) A: Mat,
    pub(super) G: Mat,
    pub(super) Q: Mat,
}

/// A problem in the state `x = D z`, and the diagonal of `D`.
pub(super) struct ScaledProblem {
    pub(super) problem: Problem,
    pub(super) scale: Vec<f64>,
}

/// Lowers the norm of the Hamiltonian matrix `[A -G; -Q -A']` state by state.
pub(super) fn scale(mut problem: Problem) -> ScaledProblem {
    let n = problem.A.nrows();
    keep_freed_blocks(n);
    let mut scale = vec![1.0; n];
    for _ in 0..BALANCE_SWEEPS {
        let before = all_shares(&problem);
        let candidates = (0..n).filter(|&i| before[i].best_factor().is_some());
        let changed = candidates.filter(|&i| rescale_state(&mut problem, &mut scale, i)).count();
        if changed == 0 {
            break;
        }
    }
    ScaledProblem { problem, scale }
}

impl ScaledProblem {
    /// The solution in the caller's units: `D^-1 Z D^-1`.
    pub(super) fn restore(&self, Z: &Mat) -> Mat {
        let inverse = self.inverse();
        rescale(Z, &inverse, &inverse)
    }

    /// The diagonal of `D^-1`.
    pub(super) fn inverse(&self) -> Vec<f64> {
        self.scale.iter().map(|d| 1.0 / d).collect()
    }
}

/// Entry (i, j) times `left[i] right[j]`, powers of two.
pub(super) fn rescale(M: &Mat, left: &[f64], right: &[f64]) -> Mat {
    Mat::from_fn(M.nrows(), M.ncols(), |i, j| left[i] * M[(i, j)] * right[j])
}

/// Scales state `i` of the present problem, where that still pays. Returns whether it did.
fn rescale_state(problem: &mut Problem, scale: &mut [f64], i: usize) -> bool {
    let Some(factor) = shares(problem, i).best_factor() else { return false };
    apply(&mut problem.A, i, 1.0 / factor, factor);
    apply(&mut problem.G, i, 1.0 / factor, 1.0 / factor);
    apply(&mut problem.Q, i, factor, factor);
    scale[i] *= factor;
    true
}

fn apply(M: &mut Mat, i: usize, row: f64, column: f64) {
    M.column_mut(i).iter_mut().for_each(|e| *e *= column);
    let n = M.nrows();
    M.as_mut_slice()[i..].iter_mut().step_by(n).for_each(|e| *e *= row);
}

/// The part of the squared norm that a state changes: `up d^2 + down / d^2 + q d^4 + g / d^4`.
struct Shares {
    up: f64,
    down: f64,
    q: f64,
    g: f64,
}

impl Shares {
    fn at(&self, d: f64) -> f64 {
        let square = d * d;
        self.up * square + self.down / square + self.q * square * square + self.g / (square * square)
    }

    /// The power of two that lowers the norm most, where it lowers it enough.
    fn best_factor(&self) -> Option<f64> {
        let (up, down) = (self.up + self.q, self.down + self.g);
        if up <= 0.0 || down <= 0.0 || !(up + down).is_finite() {
            return None;
        }
        let now = self.at(1.0);
        let mut factor = 1.0;
        for direction in [2.0, 0.5] {
            while self.at(factor * direction) < self.at(factor) {
                factor *= direction;
            }
        }
        (factor != 1.0 && self.at(factor) < BALANCE_GAIN * now).then_some(factor)
    }
}

fn all_shares(problem: &Problem) -> Vec<Shares> {
    let ((a_up, a_down), (q_up, _), (g_up, _)) =
        (squares(&problem.A), squares(&problem.Q), squares(&problem.G));
    let state = |i: usize| Shares {
        up: a_up[i] + q_up[i],
        down: a_down[i] + g_up[i],
        q: 0.5 * problem.Q[(i, i)].powi(2),
        g: 0.5 * problem.G[(i, i)].powi(2),
    };
    (0..problem.A.nrows()).map(state).collect()
}

fn shares(Problem { A, G, Q }: &Problem, i: usize) -> Shares {
    Shares {
        up: squares_of_column(A, i) + squares_of_column(Q, i),
        down: squares_of_row(A, i) + squares_of_column(G, i),
        q: 0.5 * Q[(i, i)] * Q[(i, i)],
        g: 0.5 * G[(i, i)] * G[(i, i)],
    }
}
