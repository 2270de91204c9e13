//! Lyapunov equations, continuous and discrete, solved for the whole matrix.

use crate::balance::{BalancedMatrix, balance_all, balance_beside_own_rates};
use crate::boundary::Boundary;
use crate::dense::{LARGE_SYMMETRIC, largest_share, symmetric_product, view};
use crate::error::{Error, check_range, check_shape, check_square};
use crate::lyapunov_leaf;
use crate::mat::{C64, Mat};
use crate::schur::{Schur, schur};
use crate::stein_leaf;
use crate::sylvester::{Kind, check_spectra, splitting_row};
use crate::tolerance::{CONSISTENT, CORRECTED_STATES, DOUBTFUL_SEPARATION, MAGNIFIED};

mod singular_equations;

/// Solves `A X + X A' + Q = 0`; all n x n. `X` is symmetric where `Q` is, and positive semidefinite where `A` is stable
/// and `Q` is positive semidefinite.
///
/// A unique solution exists if and only if no two eigenvalues of `A` sum to zero (stable `A`: always).
/// Method: balancing by powers of two, one real Schur form, Bartels and Stewart by recursive blocks; a solution that may
/// consist of rounding errors, and one of a small equation that is larger than the data, is refined with residuals in twice the working precision.
/// Cost about 32 n^3.
///
/// # Errors
/// Returns an error if shapes do not fit or an entry is not finite, and [`Error::CommonEigenvalue`] if rounding the entries of
/// `A` may make two eigenvalues sum to zero.
pub fn lyap(A: &Mat, Q: &Mat) -> Result<Mat, Error> {
    solve(A, Q, Kind::Continuous)
}

/// Solves `A X A' - X + Q = 0`; all n x n. Symmetry and definiteness as for [`lyap`].
///
/// A unique solution exists if and only if no product of two eigenvalues of `A` is 1 (all moduli below 1: always).
/// Method, cost and errors as for [`lyap`].
///
/// # Errors
/// Wrong shapes, entries that are not finite, or [`Error::CommonEigenvalue`].
pub fn dlyap(A: &Mat, Q: &Mat) -> Result<Mat, Error> {
    solve(A, Q, Kind::Discrete)
}

/// Returns an estimate of the separation of the equation of [`lyap`]: the smallest `norm(A X + X A') / norm(X)` (Frobenius).
///
/// Rounding `A` by a share e changes the solution by about `2 e norm(A) / separation`, relatively. Method: power iteration on
/// the inverse of the operator and of its adjoint, so that the estimate is never too small and seldom too large by much.
///
/// # Errors
/// Returns an error if `A` is not square or not finite, or [`Error::CommonEigenvalue`] if the separation is zero.
pub fn lyap_separation(A: &Mat) -> Result<f64, Error> {
    separation(A, Kind::Continuous)
}

/// Returns the same estimate for the equation of [`dlyap`]: the smallest `norm(A X A' - X) / norm(X)`.
///
/// # Errors
/// As for [`lyap_separation`].
pub fn dlyap_separation(A: &Mat) -> Result<f64, Error> {
    separation(A, Kind::Discrete)
}

/// Steps of the power iteration that estimates a separation.
const POWER_STEPS: usize = 3;

fn separation(A: &Mat, kind: Kind) -> Result<f64, Error> {
    check_square("A", A)?;
    let form = schur(A)?;
    let adjoint = Operator::new(transpose_form(&form), kind)?;
    let operator = Operator::new(form, kind)?;
    let mut X = Mat::eye(A.nrows());
    let mut gain = 0.0_f64;
    for _ in 0..POWER_STEPS {
        X = X.scale(1.0 / X.norm_fro().max(f64::MIN_POSITIVE));
        let forward = operator.solve_general(&X);
        gain = gain.max(forward.norm_fro());
        X = adjoint.solve_general(&forward);
    }
    if gain.is_finite() { Ok(1.0 / gain) } else { Err(Error::OutOfRange { what: "the separation" }) }
}

/// Returns the trace of `C P C'` for the solution `P` of `A P + P A' + B B' = 0`, or of `A P A' - P + B B' = 0` if the boundary of stability is the unit
/// circle: the square of an H2 norm. `A` n x n stable, `B` n x m, `C` p x n. The solution is refined with residuals in twice the working precision, or computed in
/// 32 digits if that does not settle and n is at most 64, so that lightly damped modes keep their digits; `None` if neither settles, or if
/// `A` is not stable in doubles and not in 32 digits.
///
/// # Errors
/// Wrong shapes, or entries that are not finite.
pub fn refined_square_norm(A: &Mat, B: &Mat, C: &Mat, boundary: Boundary) -> Result<Option<f64>, Error> {
    let BalancedSystem { A, B, C, .. } = BalancedSystem::of(A, B, C)?;
    let (form, kind) = (schur(&A)?, boundary.kind());
    let is_stable = form.eigenvalues().into_iter().all(|l| boundary.excess(l) < 0.0);
    match Operator::new(form, kind) {
        Ok(operator) if is_stable => Ok(singular_equations::refined_trace(&operator, &A, [&B, &C])),
        _ => Ok(singular_equations::precise_trace(&A, [&B, &C], kind)),
    }
}

/// Returns lower triangular factors of both Gramians, `P = R R'` and `Q = L L'`, of the equations of [`lyap_factors`](crate::lyap_factors) or, if the
/// boundary of stability is the unit circle, of [`dlyap_factors`](crate::dlyap_factors). `A` n x n, `B` n x m, `C` p x n. Equations and factors are computed in 32 digits, so that lightly
/// damped modes keep their digits; `None` if `A` is not stable in 32 digits or n is above 64.
///
/// # Errors
/// Wrong shapes, or entries that are not finite.
pub fn precise_gramian_factors(
    A: &Mat,
    B: &Mat,
    C: &Mat,
    boundary: Boundary,
) -> Result<Option<(Mat, Mat)>, Error> {
    let BalancedSystem { A, B, C, scale: d } = BalancedSystem::of(A, B, C)?;
    let factors = singular_equations::precise_factors(&A, [&B, &C], boundary.kind());
    let Some([R, L]) = factors else { return Ok(None) };
    let R = Mat::from_fn(R.nrows(), R.ncols(), |i, j| R[(i, j)] * d[i]);
    let L = Mat::from_fn(L.nrows(), L.ncols(), |i, j| L[(i, j)] / d[i]);
    Ok(Some((check_range("the factor of a Gramian", R)?, check_range("the factor of a Gramian", L)?)))
}

/// A system whose state is scaled by `D`: `D^-1 A D`, `D^-1 B`, `C D`.
struct BalancedSystem {
    A: Mat,
    B: Mat,
    C: Mat,
    /// The diagonal of `D`.
    scale: Vec<f64>,
}

impl BalancedSystem {
    /// Balances a system. `A` n x n, `B` n x m, `C` p x n.
    fn of(A: &Mat, B: &Mat, C: &Mat) -> Result<Self, Error> {
        check_square("A", A)?;
        check_shape("B", B, A.nrows(), B.ncols())?;
        check_shape("C", C, C.nrows(), A.ncols())?;
        let BalancedMatrix { A, scale } = balance_all(A)?;
        let B = Mat::from_fn(B.nrows(), B.ncols(), |i, j| B[(i, j)] / scale[i]);
        let C = Mat::from_fn(C.nrows(), C.ncols(), |i, j| C[(i, j)] * scale[j]);
        Ok(Self { A, B, C, scale })
    }
}

fn solve(A: &Mat, Q: &Mat, kind: Kind) -> Result<Mat, Error> {
    check_square("A", A)?;
    check_shape("Q", Q, A.nrows(), A.ncols())?;
    let measure = |X: &Mat| inconsistency(A, Q, X, kind);
    let X = solve_consistently(A, |balanced| solve_balanced(balanced, Q, kind), measure)?;
    check_range("the solution of the Lyapunov equation", X)
}

/// Solves an equation with the balanced matrix; once more, balanced otherwise, if the first balancing may have magnified rounding errors and the
/// solution does not fit the data. `measure` is how far a solution is from fitting them ([`inconsistency`]).
pub(crate) fn solve_consistently<T>(
    A: &Mat,
    solve: impl Fn(BalancedMatrix) -> Result<T, Error>,
    measure: impl Fn(&T) -> f64,
) -> Result<T, Error> {
    let balanced = balance_all(A)?;
    if !balanced.is_wide() {
        return solve(balanced);
    }
    let first = solve(balanced);
    let distance = first.as_ref().map_or(f64::INFINITY, &measure);
    if distance <= CONSISTENT {
        return first;
    }
    match solve(balance_beside_own_rates(A)?) {
        Ok(second) if first.is_err() || measure(&second) < distance => Ok(second),
        _ => first,
    }
}

/// The largest entry of the equation's residual, each over the sum of the moduli of its terms.
pub(crate) fn inconsistency(A: &Mat, Q: &Mat, X: &Mat, kind: Kind) -> f64 {
    let terms = |A: &Mat, X: &Mat| match kind {
        Kind::Continuous => [A * X, X * &A.t()],
        Kind::Discrete => [A * X * &A.t(), -X],
    };
    let ([first, second], [large, larger]) = (terms(A, X), terms(&A.map(f64::abs), &X.map(f64::abs)));
    let (residual, size) = (first + second + Q, large + larger.map(f64::abs) + Q.map(f64::abs));
    largest_share(&residual, &size)
}

fn solve_balanced(balanced: BalancedMatrix, Q: &Mat, kind: Kind) -> Result<Mat, Error> {
    let BalancedMatrix { A, scale: d } = balanced;
    let inner = Mat::from_fn(Q.nrows(), Q.ncols(), |i, j| Q[(i, j)] / d[i] / d[j]);
    let operator = Operator::new(schur(&A)?, kind)?;
    let X = operator.solve_any(&inner);
    let X = match growth(&operator, &A, &inner, &X) {
        Growth::Doubtful => singular_equations::refine_or_refuse(operator, &A, &inner, X)?,
        Growth::Magnified if A.nrows() <= CORRECTED_STATES => {
            singular_equations::correct_once(&operator, &A, &inner, X)
        }
        Growth::Magnified | Growth::Benign => X,
    };
    Ok(Mat::from_fn(X.nrows(), X.ncols(), |i, j| X[(i, j)] * d[i] * d[j]))
}

/// The comparison of a solution with the data.
enum Growth {
    /// It is of their size.
    Benign,
    /// It is larger, and the rounding errors of its computation with it.
    Magnified,
    /// It may be one of rounding errors: two eigenvalues nearly meet, or it is far larger.
    Doubtful,
}

fn growth(operator: &Operator, A: &Mat, Q: &Mat, X: &Mat) -> Growth {
    let size = if operator.kind == Kind::Continuous { A.norm_fro() } else { 1.0 };
    let (grown, data) = (X.norm_fro() * size, Q.norm_fro());
    let gap = |(first, second)| operator.kind.gap(first, second);
    let nearest = || nearest_pair(&operator.form.eigenvalues(), operator.kind).map(gap);
    if grown > data / DOUBTFUL_SEPARATION || nearest() <= Some(DOUBTFUL_SEPARATION * size) {
        Growth::Doubtful
    } else if grown > MAGNIFIED * data {
        Growth::Magnified
    } else {
        Growth::Benign
    }
}

/// The two eigenvalues, or the one twice, that come nearest to making the equation singular.
fn nearest_pair(eigenvalues: &[C64], kind: Kind) -> Option<(C64, C64)> {
    let mut best: Option<(C64, C64)> = None;
    for (k, &first) in eigenvalues.iter().enumerate() {
        for &second in &eigenvalues[k..] {
            if best.is_none_or(|(a, b)| kind.gap(first, second) < kind.gap(a, b)) {
                best = Some((first, second));
            }
        }
    }
    best
}

fn is_symmetric(Q: &Mat) -> bool {
    (0..Q.ncols()).all(|j| (0..j).all(|i| Q[(i, j)] == Q[(j, i)]))
}

/// A Lyapunov operator `X -> A X + X A'` or `X -> A X A' - X` that is inverted more than once.
pub(crate) struct Operator {
    /// `A = U T U'`
    pub(crate) form: Schur,
    kind: Kind,
}

impl Operator {
    /// The operator of the matrix with the given Schur form.
    pub(crate) fn new(form: Schur, kind: Kind) -> Result<Self, Error> {
        let eigenvalues = form.eigenvalues();
        check_spectra(&eigenvalues, &eigenvalues, kind)?;
        Ok(Self { form, kind })
    }

    /// Returns the largest real part, in discrete time the largest modulus, of an eigenvalue of the matrix.
    pub(crate) fn outermost_eigenvalue(&self) -> f64 {
        let of = |l: &C64| if self.kind == Kind::Continuous { l.re } else { l.norm() };
        self.form.eigenvalues().iter().map(of).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Returns what [`Operator::reach`] is at the boundary of stability.
    pub(crate) fn boundary(&self) -> f64 {
        if self.kind == Kind::Continuous { 0.0 } else { 1.0 }
    }

    /// `X` with `operator(X) + Q = 0` for a symmetric `Q`.
    pub(crate) fn solve(&self, Q: &Mat) -> Mat {
        let U = &self.form.U;
        if U.nrows() > LARGE_SYMMETRIC {
            let inner = self.solve_inner(&symmetric_product(view(U).transpose(), &(Q * U)));
            return symmetric_product(view(&(U * &inner)), &U.t());
        }
        let inner = self.solve_inner(&(U.t() * Q * U));
        U * &inner * U.t()
    }

    /// The same in the coordinates of the Schur form: `U'XU` for `U'QU`.
    pub(crate) fn solve_inner(&self, Q: &Mat) -> Mat {
        match self.kind {
            Kind::Continuous => solve_symmetric(&self.form.T, &-Q),
            Kind::Discrete => symmetric_discrete(&self.form.T, Q),
        }
    }

    /// `X` with `operator(X) + Q = 0`, symmetric if `Q` is.
    fn solve_any(&self, Q: &Mat) -> Mat {
        if is_symmetric(Q) { self.solve(Q).symmetric_part() } else { self.solve_general(Q) }
    }

    /// `X` with `operator(X) + Q = 0` for any `Q`.
    pub(crate) fn solve_general(&self, Q: &Mat) -> Mat {
        let U = &self.form.U;
        let inner = self.solve_inner_general(&(U.t() * Q * U));
        U * &inner * U.t()
    }

    fn solve_inner_general(&self, Q: &Mat) -> Mat {
        let T = &self.form.T;
        if self.kind == Kind::Continuous {
            return against_transpose(T, T, &-Q);
        }
        discrete(T, T, Q)
    }
}

/// `T X S' - X + Q = 0` for quasi-triangular `T` and `S`, the longer side cut in half until both are short.
fn discrete(T: &Mat, S: &Mat, Q: &Mat) -> Mat {
    let (m, n) = Q.shape();
    if m <= SMALL && n <= SMALL {
        let mut X = Q.clone();
        stein_leaf::solve(T, S, &mut X);
        return X;
    }
    if m >= n {
        let k = splitting_row(T);
        let lower = discrete(&T.block(k, k, m - k, m - k), S, &Q.block(k, 0, m - k, n));
        let rest = Q.block(0, 0, k, n) + &(&T.block(0, k, k, m - k) * &lower) * &S.t();
        return discrete(&T.block(0, 0, k, k), S, &rest).vstack(&lower);
    }
    let k = splitting_row(S);
    let right = discrete(T, &S.block(k, k, n - k, n - k), &Q.block(0, k, m, n - k));
    let rest = Q.block(0, 0, m, k) + T * &(&right * S.block(0, k, k, n - k).t());
    discrete(T, &S.block(0, 0, k, k), &rest).hstack(&right)
}

/// `T X T' - X + Q = 0` for symmetric `Q`, of which the upper blocks are read: half the work of the general equation.
fn symmetric_discrete(T: &Mat, Q: &Mat) -> Mat {
    let n = T.nrows();
    if n <= SMALL {
        let mut X = Q.clone();
        stein_leaf::solve_symmetric(T, &mut X);
        return X;
    }
    let k = splitting_row(T);
    let (T11, T12, T22) = (T.block(0, 0, k, k), T.block(0, k, k, n - k), T.block(k, k, n - k, n - k));
    let X22 = symmetric_discrete(&T22, &Q.block(k, k, n - k, n - k));
    let moved = &T12 * &X22;
    let X12 = discrete(&T11, &T22, &(Q.block(0, k, k, n - k) + &moved * T22.t()));
    // T12 X22 T12' + T11 X12 T12' + its transpose.
    let coupled = (&T11 * &X12 + moved.scale(0.5)) * T12.t();
    let X11 = symmetric_discrete(&T11, &(Q.block(0, 0, k, k) + (&coupled + &coupled.t())));
    Mat::from_blocks(&[&[&X11, &X12], &[&X12.t(), &X22]])
}

/// Sides up to this are solved block by block, larger ones by halves.
const SMALL: usize = 40;

/// `T X + X T' = C` for symmetric `C`, of which the upper blocks are read: half the work of the general equation.
fn solve_symmetric(T: &Mat, C: &Mat) -> Mat {
    let n = T.nrows();
    if n <= SMALL {
        let mut X = C.clone();
        lyapunov_leaf::solve_symmetric(T, &mut X);
        return X;
    }
    let k = splitting_row(T);
    let (T11, T12, T22) = (T.block(0, 0, k, k), T.block(0, k, k, n - k), T.block(k, k, n - k, n - k));
    let X22 = solve_symmetric(&T22, &C.block(k, k, n - k, n - k));
    let X12 = against_transpose(&T11, &T22, &(C.block(0, k, k, n - k) - &T12 * &X22));
    let coupled = &T12 * X12.t();
    let X11 = solve_symmetric(&T11, &(C.block(0, 0, k, k) - (&coupled + &coupled.t())));
    Mat::from_blocks(&[&[&X11, &X12], &[&X12.t(), &X22]])
}

/// `T X + X S' = C` for quasi-triangular `T` and `S`, the longer side cut in half until both are short.
fn against_transpose(T: &Mat, S: &Mat, C: &Mat) -> Mat {
    let (m, n) = C.shape();
    if m <= SMALL && n <= SMALL {
        let mut X = C.clone();
        lyapunov_leaf::solve(T, S, &mut X);
        return X;
    }
    if m >= n {
        let k = splitting_row(T);
        let lower = against_transpose(&T.block(k, k, m - k, m - k), S, &C.block(k, 0, m - k, n));
        let rest = C.block(0, 0, k, n) - &T.block(0, k, k, m - k) * &lower;
        return against_transpose(&T.block(0, 0, k, k), S, &rest).vstack(&lower);
    }
    let k = splitting_row(S);
    let right = against_transpose(T, &S.block(k, k, n - k, n - k), &C.block(0, k, m, n - k));
    let rest = C.block(0, 0, m, k) - &right * S.block(0, k, k, n - k).t();
    against_transpose(T, &S.block(0, 0, k, k), &rest).hstack(&right)
}

/// The Schur form of `A'`: rows, columns and blocks in reverse order.
pub(crate) fn transpose_form(form: &Schur) -> Schur {
    let n = form.T.nrows();
    let T = Mat::from_fn(n, n, |i, j| form.T[(n - 1 - j, n - 1 - i)]);
    let U = Mat::from_fn(n, n, |i, j| form.U[(i, n - 1 - j)]);
    Schur { T, U }
}
