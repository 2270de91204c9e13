//! The equation solved with 32 digits, for problems that doubles do not decide.
//!
//! Method: structured doubling, then Newton's method, each step a Lyapunov equation ([`crate::smith`]). Nothing but products
//! and LU factors is needed, so that states whose units differ by many decades keep their digits.
//! Sources: Kleinman, IEEE TAC 13 (1968) 114; doubling as in [`super::doubling`].

use crate::long_matrix::LongMatrix;
use crate::mat::Mat;
use crate::schur::eigenvalues;
use crate::smith::{lyapunov, mean_modulus, power_of_two};
use crate::sylvester::Kind;
use crate::tolerance::{
    PRECISE_CONVERGED, PRECISE_DOUBLINGS, PRECISE_FLOOR, PRECISE_NEWTON_STEPS, PRECISE_SETTLED,
};

use super::scaling::{Problem, ScaledProblem, scale};

/// The equation near an approximation `X`.
pub(super) struct LinearisedEquation {
    pub(super) residual: LongMatrix,
    pub(super) closed: LongMatrix,
    pub(super) gain: LongMatrix,
}

/// The data that this method needs of an equation.
pub(super) trait PreciseEquation {
    /// Returns residual, closed loop and gain at `X`; `None` if a weight is singular.
    fn linearise(&self, X: &LongMatrix) -> Option<LinearisedEquation>;
    /// Returns the equation without input as `A`, `G`, `Q`, for `X - shift I`; `None` if a weight is singular.
    fn fold_shift(&self, shift: f64) -> Option<[LongMatrix; 3]>;
    /// Returns the sum of the moduli of all products in the residual at `X` with the gain `K`: what a change of every entry of the data by a
    /// share e may change the residual by, over e.
    fn moduli(&self, K: &Mat, X: &Mat) -> Mat;
    /// The shifts worth trying.
    fn shifts(&self) -> Vec<f64>;
    /// Returns which of the two equations it is.
    fn kind(&self) -> Kind;
}

/// A solution in 32 digits with the figures of its certificate.
pub(super) struct Solution {
    pub(super) X: LongMatrix,
    pub(super) gain: LongMatrix,
    pub(super) closed: LongMatrix,
    /// The last Newton step: an estimate of the error that is left.
    pub(super) last_step: Mat,
    pub(super) inverse_norms: InverseNorms,
    /// `L^-1` of the moduli of the residual's products.
    pub(super) data_change: Mat,
    pub(super) steps: usize,
}

/// Norms of what the inverse of the Lyapunov operator `L` of the closed loop returns.
#[derive(Clone, Copy)]
pub(super) struct InverseNorms {
    /// `norm(L^-1(I))`
    pub(super) of_identity: f64,
    /// `norm(L^-1(X^2))`
    pub(super) of_square: f64,
}

/// Solves the equation, from `start` if that leads to the stabilising solution, else from the doubling's approximations.
pub(super) fn solve(equation: &impl PreciseEquation, start: Option<&Mat>) -> Option<Solution> {
    let given = start.and_then(|X| refine(equation, LongMatrix::from(X)));
    given
        .or_else(|| equation.shifts().into_iter().find_map(|shift| approximations(equation, shift)))
        .or_else(|| refine(equation, stabilising_start(equation)?))
}

/// A start whose closed loop is stable, of the continuous equation with `G >= 0`: `X = Z^-1`, where
/// `(A + b I) Z + Z (A + b I)' = 2 G` and `b` exceeds the norm of `A`.
///
/// Source: Bass; see Kleinman, or Armstrong, IEEE TAC 20 (1975) 153.
fn stabilising_start(equation: &impl PreciseEquation) -> Option<LongMatrix> {
    if equation.kind() == Kind::Discrete {
        return None;
    }
    let [A, G, _] = equation.fold_shift(0.0)?;
    let n = A.high.nrows();
    let shift = LongMatrix::identity(n, power_of_two(2.0 * A.high.norm_fro().max(f64::MIN_POSITIVE)));
    let [Z] = lyapunov(&A.plus(&shift).t().scale(-1.0), [G.scale(2.0)], Kind::Continuous)?;
    Some(Z.solve(&LongMatrix::identity(n, 1.0))?.symmetric_part())
}

/// The solution from the doubling's approximations of the equation shifted by `shift`.
fn approximations(equation: &impl PreciseEquation, shift: f64) -> Option<Solution> {
    let data = equation.fold_shift(shift)?;
    let n = data[0].high.nrows();
    let (units, d) = common_units(Problem { A: data[0].round(), G: data[1].round(), Q: data[2].round() });
    let (d, back) = (&d, d.iter().map(|d| 1.0 / d).collect::<Vec<_>>());
    let [A, G, Q] = [data[0].rescale(&back, d), data[1].rescale(&back, &back), data[2].rescale(d, d)];
    let offset = LongMatrix::identity(n, shift);
    let finish = |Z: LongMatrix| refine(equation, Z.rescale(&back, &back).plus(&offset));
    match equation.kind() {
        Kind::Discrete => double([A, G, Q]).and_then(finish),
        Kind::Continuous => {
            let transformed = |gamma: f64| cayley(&A, &G, &Q, gamma).and_then(double).and_then(finish);
            parameters(&units).into_iter().find_map(transformed)
        }
    }
}

/// The problem in units in which `G` and `Q` are of one size, and each state is scaled; with the factor of each state.
fn common_units(mut problem: Problem) -> (Problem, Vec<f64>) {
    let ratio = (problem.G.norm_fro() / problem.Q.norm_fro()).sqrt().sqrt();
    let factor = if ratio.is_normal() { power_of_two(ratio) } else { 1.0 };
    problem.G = problem.G.scale(1.0 / (factor * factor));
    problem.Q = problem.Q.scale(factor * factor);
    let ScaledProblem { problem, scale } = scale(problem);
    (problem, scale.iter().map(|d| d * factor).collect())
}

/// Parameters of the Cayley transform: the middle of the Hamiltonian's spectrum on the logarithmic scale, then others.
fn parameters(problem: &Problem) -> Vec<f64> {
    let Problem { A, G, Q } = problem;
    let size = A.norm_fro().max((G.norm_fro() * Q.norm_fro()).sqrt()).max(f64::MIN_POSITIVE);
    let middle = eigenvalues(&super::subspace::hamiltonian(problem))
        .map_or(size, |values| mean_modulus(&values, size));
    [1.0, 1.7, 0.3]
        .iter()
        .map(|factor| power_of_two(factor * middle))
        .chain([power_of_two(0.3 * size)])
        .collect()
}

/// The discrete equation with the same solution, by the Cayley transform with parameter `gamma`.
fn cayley(A: &LongMatrix, G: &LongMatrix, Q: &LongMatrix, gamma: f64) -> Option<[LongMatrix; 3]> {
    let n = A.high.nrows();
    let shifted = A.difference(&LongMatrix::identity(n, gamma));
    let forward = shifted.solve(&G.hstack(&LongMatrix::identity(n, 1.0)))?;
    let (AG, inverse) = (forward.columns(0, n), forward.columns(n, n));
    let W = shifted.t().plus(&Q.times(&AG));
    let right = W.solve(&Q.times(&inverse).hstack(&LongMatrix::identity(n, 1.0)))?;
    let W_inverse = right.columns(n, n);
    let turned = LongMatrix::identity(n, 1.0).plus(&W_inverse.t().scale(2.0 * gamma));
    let gain = AG.times(&W_inverse).scale(2.0 * gamma).symmetric_part();
    Some([turned, gain, right.columns(0, n).scale(2.0 * gamma).symmetric_part()])
}

/// Doubles `X = A'X (I + G X)^-1 A + Q` until `Q`, which tends to `X`, stands still.
fn double([mut A, mut G, mut Q]: [LongMatrix; 3]) -> Option<LongMatrix> {
    let n = A.high.nrows();
    for _ in 0..PRECISE_DOUBLINGS {
        let middle = LongMatrix::identity(n, 1.0).plus(&G.times(&Q));
        let solved = middle.solve(&A.hstack(&G))?;
        let (next, driven) = (solved.columns(0, n), solved.columns(n, n));
        let transposed = A.t();
        let step = transposed.times(&Q.times(&next)).symmetric_part();
        Q = Q.plus(&step);
        let change = relative_step(&step.high, &Q.high);
        if !change.is_finite() {
            return None;
        }
        if change < PRECISE_SETTLED || step.high.norm_fro() <= PRECISE_FLOOR * Q.high.norm_fro() {
            return Some(Q);
        }
        G = G.plus(&A.times(&driven).times(&transposed).symmetric_part());
        A = A.times(&next);
    }
    None
}

/// The largest entry of a step, each over the root of the diagonal entries of `X` that belong to it.
pub(super) fn relative_step(step: &Mat, X: &Mat) -> f64 {
    let roots: Vec<f64> = X.diagonal().iter().map(|x| x.abs().sqrt()).collect();
    let floor = PRECISE_FLOOR * X.norm_max();
    let mut worst = 0.0_f64;
    for j in 0..step.ncols() {
        for (i, e) in step.column(j).iter().enumerate().filter(|(_, e)| **e != 0.0) {
            let relative = e.abs() / (roots[i] * roots[j] + floor);
            worst = if relative > worst || relative.is_nan() { relative } else { worst };
        }
    }
    worst
}

/// Newton's method from an approximation whose closed loop is stable; `None` if it is not, or no step is small enough.
fn refine(equation: &impl PreciseEquation, mut X: LongMatrix) -> Option<Solution> {
    let mut size = f64::INFINITY;
    for steps in 1..=PRECISE_NEWTON_STEPS {
        let LinearisedEquation { residual, closed, gain } = equation.linearise(&X)?;
        let [step] = lyapunov(&closed, [residual], equation.kind())?;
        let step = step.symmetric_part();
        let relative = relative_step(&step.high, &X.high);
        if !relative.is_finite() {
            return None;
        }
        let stuck = relative > 0.5 * size && size < PRECISE_SETTLED;
        if stuck || relative < PRECISE_CONVERGED {
            let last = if stuck { size } else { relative };
            return (last < PRECISE_SETTLED).then(|| {
                let X = X.plus(&step);
                conclude(equation, X, gain, closed, step.high, steps)
            })?;
        }
        X = X.plus(&step);
        size = relative;
    }
    None
}

fn conclude(
    equation: &impl PreciseEquation,
    X: LongMatrix,
    gain: LongMatrix,
    closed: LongMatrix,
    last_step: Mat,
    steps: usize,
) -> Option<Solution> {
    let square = LongMatrix::from(&(&X.high * &X.high));
    let moduli = LongMatrix::from(&equation.moduli(&gain.high, &X.high));
    let identity = LongMatrix::identity(X.high.nrows(), 1.0);
    let [one, two, change] = lyapunov(&closed, [identity, square, moduli], equation.kind())?;
    let inverse_norms = InverseNorms { of_identity: one.high.norm_fro(), of_square: two.high.norm_fro() };
    Some(Solution { X, gain, closed, last_step, inverse_norms, data_change: change.high, steps })
}
