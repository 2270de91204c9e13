//! Lyapunov and Riccati equations of a descriptor system `E x' = A x + B u` with a regular `E`.
//!
//! `E` is eliminated, the standard equation is solved, and the solution is corrected with residuals of the original equation in
//! twice the working precision, so that what the elimination cost is won back. An `E` that is singular to working precision only because the units of
//! equations or states differ is scaled by powers of two first.

use crate::decomposition::{power_of_two, rcond_one};
use crate::dense::solve;
use crate::error::{Error, check_range, check_shape, check_square};
use crate::extended_precision::{ExtendedMatrix, exact_product};
use crate::lyapunov::{dlyap, lyap};
use crate::mat::Mat;
use crate::riccati::{Outcome, Riccati, care, dare};
use crate::sylvester::Kind;
use crate::tolerance::{EPS, EQUILIBRATION_SWEEPS, GENERALISED_REFINEMENTS};

/// Solves `A X E' + E X A' + Q = 0`; all n x n, `E` regular.
///
/// A unique solution exists if and only if no two eigenvalues of the pencil `A - s E` sum to zero.
///
/// # Errors
/// As for [`lyap`], and [`Error::Singular`] for an `E` that is singular to working precision: a descriptor system of higher index has
/// to be reduced first.
pub fn glyap(A: &Mat, E: &Mat, Q: &Mat) -> Result<Mat, Error> {
    lyapunov(A, E, Q, Kind::Continuous)
}

/// Solves `A X A' - E X E' + Q = 0`; all n x n, `E` regular.
///
/// A unique solution exists if and only if no product of two eigenvalues of the pencil `A - z E` is 1.
///
/// # Errors
/// As for [`glyap`].
pub fn gdlyap(A: &Mat, E: &Mat, Q: &Mat) -> Result<Mat, Error> {
    lyapunov(A, E, Q, Kind::Discrete)
}

fn lyapunov(A: &Mat, E: &Mat, Q: &Mat, kind: Kind) -> Result<Mat, Error> {
    check_square("A", A)?;
    check_shape("E", E, A.nrows(), A.ncols())?;
    check_shape("Q", Q, A.nrows(), A.ncols())?;
    if let Some(units) = Equilibration::of_regular(E)? {
        let (A, E) = (units.scale(A), units.scale(E));
        let X = lyapunov(&A, &E, &scale_by(&units.rows, Q, &units.rows), kind)?;
        return check_range(
            "the solution of the Lyapunov equation",
            scale_by(&units.columns, &X, &units.columns),
        );
    }
    let reduced = solve(E, A)?;
    let standard = |Q: &Mat| -> Result<Mat, Error> {
        let right = solve(E, &solve(E, Q)?.t())?.t();
        match kind {
            Kind::Continuous => lyap(&reduced, &right),
            Kind::Discrete => dlyap(&reduced, &right),
        }
    };
    let mut X = ExtendedMatrix::from(standard(Q)?);
    let mut last = f64::INFINITY;
    for _ in 0..GENERALISED_REFINEMENTS {
        let step = standard(&residual(A, E, Q, &X, kind))?;
        let size = step.norm_fro();
        // A correction that does not shrink is rounding of the elimination: the solution is as good as it gets.
        if size >= 0.5 * last || size.is_nan() || last.is_nan() {
            break;
        }
        X = X.add(&step.into());
        last = size;
        if size <= EPS * X.high.norm_fro() {
            break;
        }
    }
    Ok(X.to_double())
}

/// The left-hand side of the equation at `X`.
fn residual(A: &Mat, E: &Mat, Q: &Mat, X: &ExtendedMatrix, kind: Kind) -> Mat {
    let times = |left: &Mat, right: &Mat| {
        ExtendedMatrix::from(left.clone()).times(&X.times(&ExtendedMatrix::from(right.t())))
    };
    let sum = match kind {
        Kind::Continuous => times(A, E).add(&times(E, A)),
        Kind::Discrete => times(A, A).add(&times(E, E).neg()),
    };
    sum.add(&Q.clone().into()).to_double()
}

/// Powers of two by which the equations, the rows of `E`, and the states, its columns, are multiplied.
struct Equilibration {
    rows: Vec<f64>,
    columns: Vec<f64>,
}

impl Equilibration {
    /// Returns the units in which `E` is regular; `None` if it is in its own.
    ///
    /// # Errors
    /// [`Error::Singular`] if it is singular in those, too.
    fn of_regular(E: &Mat) -> Result<Option<Self>, Error> {
        let is_singular = |rcond: f64| rcond <= EPS || rcond.is_nan();
        if E.nrows() == 0 || !is_singular(rcond_one(E)) {
            return Ok(None);
        }
        let units = Self::equilibrate(E);
        let rcond = rcond_one(&units.scale(E));
        if is_singular(rcond) { Err(Error::Singular { what: "E", rcond }) } else { Ok(Some(units)) }
    }

    /// Returns the units in which the largest entry of each row and column is near one (D. Ruiz, A scaling algorithm to equilibrate both rows and
    /// columns norms in matrices, Rutherford Appleton Laboratory 2001).
    fn equilibrate(E: &Mat) -> Self {
        let n = E.nrows();
        let mut units = Self { rows: vec![1.0; n], columns: vec![1.0; n] };
        let factor = |largest: f64| if largest > 0.0 { power_of_two(1.0 / largest.sqrt()) } else { 1.0 };
        for _ in 0..EQUILIBRATION_SWEEPS {
            let M = units.scale(E).map(f64::abs);
            for k in 0..n {
                units.rows[k] *= factor((0..n).map(|j| M[(k, j)]).fold(0.0, f64::max));
                units.columns[k] *= factor(M.column(k).iter().copied().fold(0.0, f64::max));
            }
        }
        units
    }

    fn scale(&self, M: &Mat) -> Mat {
        scale_by(&self.rows, M, &self.columns)
    }

    /// Returns a solution of the scaled Riccati equation in the caller's units.
    fn restore(&self, mut found: Riccati) -> Riccati {
        found.X = scale_by(&self.rows, &found.X, &self.rows);
        found.F = Mat::from_fn(found.F.nrows(), found.F.ncols(), |i, j| found.F[(i, j)] / self.columns[j]);
        let certificate = &mut found.certificate;
        certificate.data_error = scale_by(&self.rows, &certificate.data_error, &self.rows);
        certificate.scale.iter_mut().zip(&self.rows).for_each(|(d, row)| *d /= row);
        found
    }
}

/// Entry (i, j) times `left[i] right[j]`.
fn scale_by(left: &[f64], M: &Mat, right: &[f64]) -> Mat {
    Mat::from_fn(M.nrows(), M.ncols(), |i, j| left[i] * M[(i, j)] * right[j])
}

/// The weights of a quadratic cost on the state `x` and the input `u`: `x'Qx + u'Ru + 2 x'Su`.
#[derive(Clone, Copy, Debug)]
pub struct CostWeights<'a> {
    /// n x n, symmetric.
    pub Q: &'a Mat,
    /// m x m, symmetric.
    pub R: &'a Mat,
    /// n x m, if there is one.
    pub S: Option<&'a Mat>,
}

/// Solves `A'XE + E'XA - (E'XB + S) R^-1 (B'XE + S') + Q = 0` for the stabilising `X`: the pencil `A - B F - s E` is stable with
/// `F = R^-1 (B'XE + S')`. Shapes as for [`care`]; `E` n x n, regular.
///
/// The certificate's residual, terms and forward error are those of this equation; its other figures are those of the equation
/// with `E` eliminated.
///
/// # Errors
/// As for [`care`], and [`Error::Singular`] for a singular `E`.
pub fn gcare(A: &Mat, E: &Mat, B: &Mat, weights: &CostWeights) -> Result<Outcome<Riccati>, Error> {
    riccati(A, E, B, weights, Kind::Continuous)
}

/// Solves `A'XA - E'XE - (A'XB + S) (R + B'XB)^-1 (B'XA + S') + Q = 0` for the stabilising `X`: the pencil `A - B F - z E` is stable
/// with `F = (R + B'XB)^-1 (B'XA + S')`. Shapes as for [`dare`]; `E` n x n, regular.
///
/// # Errors
/// As for [`gcare`].
pub fn gdare(A: &Mat, E: &Mat, B: &Mat, weights: &CostWeights) -> Result<Outcome<Riccati>, Error> {
    riccati(A, E, B, weights, Kind::Discrete)
}

fn riccati(A: &Mat, E: &Mat, B: &Mat, weights: &CostWeights, kind: Kind) -> Result<Outcome<Riccati>, Error> {
    check_square("A", A)?;
    check_shape("E", E, A.nrows(), A.ncols())?;
    check_shape("Q", weights.Q, A.nrows(), A.ncols())?;
    let equation = GeneralisedEquation { A, E, B, weights, kind };
    if let Some(units) = Equilibration::of_regular(E)? {
        let ones = vec![1.0; B.ncols()];
        let Q = scale_by(&units.columns, weights.Q, &units.columns);
        let S = weights.S.map(|S| scale_by(&units.columns, S, &ones));
        let weights = CostWeights { Q: &Q, R: weights.R, S: S.as_ref() };
        let answer =
            riccati(&units.scale(A), &units.scale(E), &scale_by(&units.rows, B, &ones), &weights, kind)?;
        return answer.try_map(|found| equation.certify_solution(units.restore(found)));
    }
    let from_right = |M: &Mat| -> Result<Mat, Error> { Ok(solve(&E.t(), &M.t())?.t()) };
    let reduced = from_right(A)?;
    let Q = solve(&E.t(), &from_right(weights.Q)?)?.symmetric_part();
    let S = weights.S.map(|S| solve(&E.t(), S)).transpose()?;
    let answer = match kind {
        Kind::Continuous => care(&reduced, B, &Q, weights.R, S.as_ref())?,
        Kind::Discrete => dare(&reduced, B, &Q, weights.R, S.as_ref())?,
    };
    answer.try_map(|found| equation.refine_solution(found))
}

struct GeneralisedEquation<'a> {
    A: &'a Mat,
    E: &'a Mat,
    B: &'a Mat,
    weights: &'a CostWeights<'a>,
    kind: Kind,
}

/// The equation at an approximation.
struct Approximation {
    gain: Mat,
    closed: Mat,
    residual: Mat,
    terms: f64,
}

impl GeneralisedEquation<'_> {
    /// The solution after Newton steps on the original equation, with its certificate.
    fn refine_solution(&self, mut found: Riccati) -> Result<Riccati, Error> {
        let mut X = ExtendedMatrix::from(found.X.clone());
        let mut last = f64::INFINITY;
        let mut at = self.at(&X)?;
        for _ in 0..GENERALISED_REFINEMENTS {
            // A closed loop on the boundary within rounding has no Newton step: the solution stays as it is.
            let Ok(step) = self.step(&at) else { break };
            let size = step.norm_fro();
            if size >= 0.5 * last || size.is_nan() || last.is_nan() {
                break;
            }
            X = X.add(&step.into());
            at = self.at(&X)?;
            last = size;
            if size <= EPS * X.high.norm_fro() {
                break;
            }
        }
        found.X = X.to_double().symmetric_part();
        found.F = at.gain;
        self.certify_solution(found)
    }

    /// The solution with the certificate's residual and error computed from it.
    fn certify_solution(&self, mut found: Riccati) -> Result<Riccati, Error> {
        let at = self.at(&found.X.clone().into())?;
        let certificate = &mut found.certificate;
        certificate.residual_norm = at.residual.norm_fro();
        certificate.term_norm = at.terms;
        certificate.relative_residual = certificate.residual_norm / at.terms.max(f64::MIN_POSITIVE);
        if let Ok(step) = self.step(&at) {
            certificate.forward_error = step.map(f64::abs);
        }
        certificate.bound_unknown();
        found.X = check_range("the solution of the Riccati equation", found.X)?;
        found.F = check_range("the gain of the Riccati equation", found.F)?;
        Ok(found)
    }

    /// The Newton step: the solution of the closed loop's Lyapunov equation.
    fn step(&self, at: &Approximation) -> Result<Mat, Error> {
        let step = match self.kind {
            Kind::Continuous => glyap(&at.closed.t(), &self.E.t(), &at.residual)?,
            Kind::Discrete => gdlyap(&at.closed.t(), &self.E.t(), &at.residual)?,
        };
        Ok(step.symmetric_part())
    }

    /// Gain, closed loop and residual at `X`; the residual as a completed square, which needs no inverse in more than working precision.
    fn at(&self, X: &ExtendedMatrix) -> Result<Approximation, Error> {
        let (A, E, B) = (self.A, self.E, self.B);
        let CostWeights { Q, R, S } = *self.weights;
        let BX = ExtendedMatrix::from(B.t()).times(X);
        let (moved, weight) = match self.kind {
            Kind::Continuous => (BX.times(&E.clone().into()), R.clone()),
            Kind::Discrete => {
                (BX.times(&A.clone().into()), BX.times(&B.clone().into()).add(&R.clone().into()).to_double())
            }
        };
        let right = S.map_or_else(|| moved.to_double(), |S| moved.add(&S.t().into()).to_double());
        let gain = solve(&weight, &right)?;
        let closed = exact_product(B, &gain).neg().add(&A.clone().into());
        let square = ExtendedMatrix::from(gain.t()).times(&exact_product(R, &gain));
        let mut sum = ExtendedMatrix::from(Q.clone()).add(&square);
        if let Some(S) = S {
            let cross = exact_product(S, &gain).neg();
            sum = sum.add(&cross).add(&cross.t());
        }
        let terms = Q.norm_fro() + 2.0 * (gain.t() * &right).norm_fro();
        let XE = X.times(&E.clone().into());
        let (first, size) = match self.kind {
            Kind::Continuous => {
                let half = closed.t().times(&XE);
                (half.add(&half.t()), 2.0 * (A.t() * &XE.high).norm_fro())
            }
            Kind::Discrete => {
                let held = ExtendedMatrix::from(E.t()).times(&XE);
                let moved = closed.t().times(&X.times(&closed));
                let size = (A.t() * &X.high * A).norm_fro() + held.high.norm_fro();
                (moved.add(&held.neg()), size)
            }
        };
        let residual = sum.add(&first).to_double().symmetric_part();
        Ok(Approximation { gain, closed: closed.to_double(), residual, terms: terms + size })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn data() -> (Mat, Mat, Mat) {
        let entry = |i: usize, j: usize| ((7 * i + 3 * j + i * j) % 11) as f64 / 4.0 - 1.2;
        let A = Mat::from_fn(5, 5, |i, j| entry(i, j) - if i == j { 6.0 } else { 0.0 });
        let E = Mat::from_fn(5, 5, |i, j| 0.2 * entry(j, i + 1) + if i == j { 2.0 } else { 0.0 });
        (A, E, Mat::from_fn(5, 2, |i, j| entry(i + j, 2 * j)))
    }

    #[test]
    fn lyapunov_equations_with_a_mass_matrix_are_satisfied() {
        let (A, E, B) = data();
        let Q = &B * &B.t();
        let X = glyap(&A, &E, &Q).unwrap();
        let left = &A * &(&X * &E.t());
        assert!((&left + &left.t() + &Q).norm_max() < 1e-14);
        let slow = A.scale(0.1);
        let X = gdlyap(&slow, &E, &Q).unwrap();
        let left = &(&slow * &(&X * &slow.t())) - &(&E * &(&X * &E.t()));
        assert!((left + &Q).norm_max() < 1e-14);
        assert!(matches!(glyap(&A, &Mat::zeros(5, 5), &Q), Err(Error::Singular { .. })));
    }

    #[test]
    fn riccati_equations_with_a_mass_matrix_are_satisfied() {
        let (A, E, B) = data();
        let (Q, R) = (Mat::eye(5), Mat::diag(&[1.0, 0.3]));
        let S = B.scale(0.1);
        let weights = CostWeights { Q: &Q, R: &R, S: Some(&S) };
        for answer in [gcare(&A, &E, &B, &weights).unwrap(), gdare(&A, &E, &B, &weights).unwrap()] {
            let found = answer.solution().unwrap();
            assert!(found.certificate.relative_residual < 1e-15, "{:?}", found.certificate);
            assert!(found.certificate.forward_error.norm_max() < 1e-14 * found.X.norm_max());
        }
        // Units over thirty decades in which E is singular to working precision, but for which the solutions are the same.
        let units = |step: usize| -> Vec<f64> {
            (0..5).map(|k| f64::from(((k * step) % 5) as i32 * 26 - 52).exp2()).collect()
        };
        let (rows, columns, ones) = (units(2), units(3), vec![1.0; 2]);
        let (scaled, mass) = (scale_by(&rows, &A, &columns), scale_by(&rows, &E, &columns));
        let (B1, S1) = (scale_by(&rows, &B, &ones), scale_by(&columns, &S, &ones));
        let weights1 = CostWeights { Q: &scale_by(&columns, &Q, &columns), R: &R, S: Some(&S1) };
        assert!(rcond_one(&mass) < EPS);
        for solver in [gcare, gdare] {
            let plain = solver(&A, &E, &B, &weights).unwrap().solution().unwrap();
            let found = solver(&scaled, &mass, &B1, &weights1).unwrap().solution().unwrap();
            assert!((scale_by(&rows, &found.X, &rows) - &plain.X).norm_max() < 1e-14 * plain.X.norm_max());
            assert!((scale_by(&ones, &plain.F, &columns) - &found.F).norm_max() < 1e-14 * found.F.norm_max());
        }
        let Y = glyap(&scaled, &mass, &scale_by(&rows, &Q, &rows)).unwrap();
        let plain = glyap(&A, &E, &Q).unwrap();
        assert!((scale_by(&columns, &Y, &columns) - &plain).norm_max() < 1e-14 * plain.norm_max());
        // E = I is the standard equation.
        let plain = care(&A, &B, &Q, &R, Some(&S)).unwrap().solution().unwrap();
        let same = gcare(&A, &Mat::eye(5), &B, &weights).unwrap().solution().unwrap();
        assert!((plain.F - same.F).norm_max() < 1e-14);
    }
}
