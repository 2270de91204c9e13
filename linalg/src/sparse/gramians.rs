//! Low-rank factors of the Gramians of a large damped structure `M x'' + D x' + K x = F u`, `y = P x + V x'`.
//!
//! Method: the alternating directions implicit iteration (ADI) in its residual form with complex shifts in pairs (Benner, Kuerschner and
//! Saak, Numer. Algorithms 62 (2013) 225; for structures, Math. Comput. Model. Dyn. Syst. 19 (2013) 593). Both Gramians take the same shifts, and
//! so the same factors of `s^2 M + s D + K`. Shifts are the poles that contribute most to what remains, in the style of the dominant poles of Rommes and
//! Martins (IEEE Trans. Power Syst. 21 (2006) 1218), within a subspace that grows with the iteration.

use super::modes::{ProgressObserver, StageProgress};
use super::pencil::{QuadraticPencil, ShiftedPencil};
use super::ritz::{RitzBasis, Weights};
use crate::decomposition::svd;
use crate::dense::transpose_times;
use crate::error::Error;
use crate::mat::{C64, CMat, Mat};

/// Steps without a contribution after which the iteration ends: shifts are chosen by what a subspace knows, so one alone may deceive.
const IDLE_STEPS: usize = 2;

/// Inputs and outputs of a structure.
#[derive(Debug, Clone, Copy)]
pub struct StructurePorts<'a> {
    /// Directions of the input forces, n x m.
    pub F: &'a Mat,
    /// Output rows of the positions, p x n.
    pub P: &'a Mat,
    /// Output rows of the velocities, p x n.
    pub V: &'a Mat,
}

/// Accuracy at which the iteration ends.
#[derive(Debug, Clone, Copy)]
pub struct GramianAccuracy {
    /// A step whose columns are below this share of the factor contributes nothing.
    pub contribution: f64,
    /// Largest number of factorisations.
    pub steps: usize,
}

/// Factors of the Gramians `Z Z'` in the state (position, velocity), 2n x k, and how good they are.
#[derive(Debug, Clone, PartialEq)]
pub struct LowRankGramians {
    /// Factor of the reachability Gramian.
    pub reachability: Mat,
    /// Factor of the observability Gramian of the generalised equation, in which the velocities belong to `M`.
    pub observability: Mat,
    /// The share of the factors that the last step contributed: above the accuracy if the steps did not suffice.
    pub last_contribution: f64,
    /// The shifts, one of each pair.
    pub shifts: Vec<C64>,
}

/// Directions that balance a structure: `left' E right = diag(values)` with `E = diag(I, M)`.
#[derive(Debug, Clone, PartialEq)]
pub struct BalancedDirections {
    /// Hankel values, largest first. The factors hold parts of the Gramians, so the values lie below the true ones.
    pub values: Vec<f64>,
    /// Directions of the states.
    pub right: Mat,
    /// Directions of the equations.
    pub left: Mat,
}

impl LowRankGramians {
    /// Returns the Hankel values and the directions that belong to them.
    ///
    /// # Errors
    /// [`Error::NoConvergence`] of the singular value decomposition.
    pub fn balanced_directions(&self, pencil: &QuadraticPencil) -> Result<BalancedDirections, Error> {
        let carried = times_e(pencil, &self.reachability);
        let parts = svd(&transpose_times(&self.observability, &carried)?)?;
        let count = parts.s.len();
        let first = |A: &Mat| A.block(0, 0, A.nrows(), count);
        let right = &self.reachability * &first(&parts.V);
        let left = &self.observability * &first(&parts.U);
        Ok(BalancedDirections { values: parts.s, right, left })
    }
}

/// Returns low-rank factors of both Gramians of a structure that is held and damped.
///
/// # Errors
/// [`Error::Shape`] for ports that do not fit, [`Error::NotStable`] if a mode is not damped, [`Error::Singular`] if the structure is not
/// held, [`Error::TooLarge`], or [`Error::Cancelled`].
pub fn low_rank_gramians(
    pencil: &QuadraticPencil,
    ports: &StructurePorts,
    accuracy: GramianAccuracy,
    watch: &mut ProgressObserver,
) -> Result<LowRankGramians, Error> {
    check(pencil, ports)?;
    let mut reach = Iterate::new(Mat::zeros(ports.F.nrows(), ports.F.ncols()), ports.F.clone());
    let mut observe = Iterate::new(ports.P.t(), ports.V.t());
    let static_factors = pencil.at(C64::new(0.0, 0.0), "static shapes of the structure", watch)?;
    let loads = ports.F.hstack(&ports.P.t()).hstack(&ports.V.t());
    let mut basis = RitzBasis::of_static_shapes(pencil, &static_factors, &loads)?;
    drop(static_factors);
    let (mut shifts, mut idle, mut last) = (Vec::new(), 0, f64::INFINITY);
    while shifts.len() < accuracy.steps && idle < IDLE_STEPS {
        let weights = Weights {
            reach_position: &reach.upper,
            reach_force: &reach.lower,
            observe_position: &observe.upper,
            observe_force: &observe.lower,
        };
        let Some(shift) = basis.next_shift(pencil, &weights)? else { break };
        let stage = "balancing the structure";
        if watch(StageProgress { stage, done: shifts.len(), of: accuracy.steps }).is_break() {
            return Err(Error::Cancelled { what: stage });
        }
        let shifted = pencil.at(-shift, stage, watch)?;
        let (of_reach, of_observe) = solutions(pencil, &shifted, -shift, &reach, &observe)?;
        drop(shifted);
        basis.extend(pencil, &[&of_reach.upper, &of_observe.lower])?;
        last = reach.take(pencil, shift, &of_reach).max(observe.take(pencil, shift, &of_observe));
        idle = if last <= accuracy.contribution { idle + 1 } else { 0 };
        shifts.push(shift);
    }
    Ok(LowRankGramians {
        reachability: reach.factor(),
        observability: observe.factor(),
        last_contribution: last,
        shifts,
    })
}

fn check(pencil: &QuadraticPencil, ports: &StructurePorts) -> Result<(), Error> {
    let (n, m, p) = (pencil.K.nrows(), ports.F.ncols(), ports.P.nrows());
    for (what, matrix, (needed_rows, needed_cols)) in
        [("F", ports.F, (n, m)), ("P", ports.P, (p, n)), ("V", ports.V, (p, n))]
    {
        let (rows, cols) = matrix.shape();
        if (rows, cols) != (needed_rows, needed_cols) {
            return Err(Error::Shape { what, rows, cols, needed_rows, needed_cols });
        }
        crate::error::check_finite(what, matrix)?;
    }
    Ok(())
}

/// The two halves of solutions with the shifted first-order form.
struct Halves {
    upper: CMat,
    lower: CMat,
}

/// The solutions `(A - s E)^-1 W` and `(A - s E)'^-1 W` for what remains of both equations, with `A = [0 I; -K -D]` and `E = diag(I, M)`.
fn solutions(
    pencil: &QuadraticPencil,
    shifted: &ShiftedPencil,
    s: C64,
    reach: &Iterate,
    observe: &Iterate,
) -> Result<(Halves, Halves), Error> {
    let moved = |X: &CMat| damping_product(pencil, s, X);
    let (position, force) = (reach.upper.to_complex(), reach.lower.to_complex());
    let (dual_position, dual_force) = (observe.upper.to_complex(), observe.lower.to_complex());
    let of_reach = -&(&force + &moved(&position));
    let of_observe = -&(&dual_force.scale(s) + &dual_position);
    let (n, m, p) = (force.nrows(), force.ncols(), dual_force.ncols());
    let both = shifted.solve(&of_reach.hstack(&of_observe))?;
    let upper = both.block(0, 0, n, m);
    let lower = &position + &upper.scale(s);
    let dual_lower = both.block(0, m, n, p);
    let dual_upper = &dual_force + &moved(&dual_lower);
    Ok((Halves { upper, lower }, Halves { upper: dual_upper, lower: dual_lower }))
}

/// `(D + s M) X`
fn damping_product(pencil: &QuadraticPencil, s: C64, X: &CMat) -> CMat {
    let (re, im) = (X.map(|x| x.re), X.map(|x| x.im));
    let join =
        |re: &Mat, im: &Mat| CMat::from_fn(re.nrows(), re.ncols(), |i, j| C64::new(re[(i, j)], im[(i, j)]));
    let of_damping = join(&pencil.D.times(&re), &pencil.D.times(&im));
    of_damping + join(&pencil.M.times(&re), &pencil.M.times(&im)).scale(s)
}

/// `diag(I, M) X`
fn times_e(pencil: &QuadraticPencil, X: &Mat) -> Mat {
    let (n, k) = (X.nrows() / 2, X.ncols());
    X.block(0, 0, n, k).vstack(&pencil.M.times(&X.block(n, 0, n, k)))
}

/// One of the two equations: what remains of its right-hand side, and the factor so far.
struct Iterate {
    upper: Mat,
    lower: Mat,
    columns: Vec<Mat>,
    /// Sum of the squares of the factor, positions and velocities apart.
    sizes: [f64; 2],
}

impl Iterate {
    fn new(upper: Mat, lower: Mat) -> Self {
        Self { upper, lower, columns: Vec::new(), sizes: [0.0; 2] }
    }

    /// Takes the solutions for a shift into the factor and subtracts them from what remains; returns the share that they contribute.
    fn take(&mut self, pencil: &QuadraticPencil, shift: C64, found: &Halves) -> f64 {
        let n = self.upper.nrows();
        let re = found.upper.map(|x| x.re).vstack(&found.lower.map(|x| x.re));
        let block = if shift.im == 0.0 {
            let step = re.scale((-2.0 * shift.re).sqrt());
            self.subtract(pencil, &re.scale(-2.0 * shift.re));
            step
        } else {
            let im = found.upper.map(|x| x.im).vstack(&found.lower.map(|x| x.im));
            let (gamma, delta) = (2.0 * (-shift.re).sqrt(), shift.re / shift.im);
            let sum = &re + &im.scale(delta);
            self.subtract(pencil, &sum.scale(gamma * gamma));
            sum.scale(gamma).hstack(&im.scale(gamma * (delta * delta + 1.0).sqrt()))
        };
        let mut share: f64 = 0.0;
        for (half, total) in self.sizes.iter_mut().enumerate() {
            let size = block.block(half * n, 0, n, block.ncols()).norm_fro();
            *total = total.hypot(size);
            share = share.max(if *total > 0.0 { size / *total } else { 0.0 });
        }
        self.columns.push(block);
        share
    }

    /// Adds `E X` to what remains.
    fn subtract(&mut self, pencil: &QuadraticPencil, X: &Mat) {
        let (n, k) = (self.upper.nrows(), X.ncols());
        self.upper += &X.block(0, 0, n, k);
        self.lower += &pencil.M.times(&X.block(n, 0, n, k));
    }

    /// The factor.
    fn factor(self) -> Mat {
        let n = 2 * self.upper.nrows();
        let count = self.columns.iter().map(Mat::ncols).sum();
        let mut out = Mat::zeros(n, count);
        let mut at = 0;
        for block in self.columns {
            out.set_block(0, at, &block);
            at += block.ncols();
        }
        out
    }
}
