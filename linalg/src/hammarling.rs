//! Lyapunov equations solved for a factor of the solution, so that it stays positive semidefinite.
//!
//! Sources: Hammarling, IMA J. Numer. Anal. 2 (1982); Sorensen and Zhou, J. Appl. Math. 2003, for the form used here:
//! after each block of columns the right-hand side is updated by a term of its rank, no factor is ever recomputed. The
//! continuous equation stays real, the sampled one goes through complex triangular form.

use crate::balance::BalancedMatrix;
use crate::boundary::Boundary;
use crate::dense::qr_r;
use crate::error::{Error, check_range, check_shape, check_square};
use crate::hammarling_leaf;
use crate::kernel::vectorised;
use crate::lyapunov::{inconsistency, solve_consistently};
use crate::mat::{C64, CMat, Mat};
use crate::schur::{DiagonalBlock, Schur, blocks, schur};
use crate::spectrum::Spectrum;
use crate::sylvester::Kind;

/// Returns the lower triangular factor `L`, `P = L L'`, of the solution of `A P + P A' + B B' = 0`; `A` n x n stable, `B` n x m.
///
/// Method: balancing, real Schur form, Hammarling's recursion; the small Hankel values of a balanced truncation need
/// this factor rather than `P`.
///
/// # Errors
/// Wrong shapes, entries that are not finite, or [`Error::NotStable`] with the eigenvalue.
pub fn lyap_factor(A: &Mat, B: &Mat) -> Result<Mat, Error> {
    factor(A, B, Kind::Continuous)
}

/// Returns the lower triangular factor `L`, `P = L L'`, of the solution of `A P A' - P + B B' = 0`; every eigenvalue of `A` must
/// be inside the unit circle. Method and errors as for [`lyap_factor`].
///
/// # Errors
/// Wrong shapes, entries that are not finite, or [`Error::NotStable`] with the eigenvalue.
pub fn dlyap_factor(A: &Mat, B: &Mat) -> Result<Mat, Error> {
    factor(A, B, Kind::Discrete)
}

/// Returns the factors of both Gramians from one Schur form, `P = R R'` and `Q = L L'`: `A P + P A' + B B' = 0` and
/// `A' Q + Q A + C' C = 0`. They are square, not triangular. Method and errors as for [`lyap_factor`].
///
/// # Errors
/// Wrong shapes, entries that are not finite, or [`Error::NotStable`] with the eigenvalue.
pub fn lyap_factors(A: &Mat, B: &Mat, C: &Mat) -> Result<(Mat, Mat), Error> {
    both_factors(A, B, C, Kind::Continuous)
}

/// Returns the factors of both Gramians from one Schur form: `A P A' - P + B B' = 0` and `A' Q A - Q + C' C = 0`; as
/// [`lyap_factors`].
///
/// # Errors
/// Wrong shapes, entries that are not finite, or [`Error::NotStable`] with the eigenvalue.
pub fn dlyap_factors(A: &Mat, B: &Mat, C: &Mat) -> Result<(Mat, Mat), Error> {
    both_factors(A, B, C, Kind::Discrete)
}

/// Returns a square factor `L`, `P = L L'`, as [`lyap_factor`] but not triangular: enough for the trace of `C P C'`.
///
/// # Errors
/// As for [`lyap_factor`].
pub fn lyap_square_factor(A: &Mat, B: &Mat) -> Result<Mat, Error> {
    square_factor(A, B, Kind::Continuous)
}

/// Returns a square factor `L`, `P = L L'`, as [`dlyap_factor`] but not triangular.
///
/// # Errors
/// As for [`dlyap_factor`].
pub fn dlyap_square_factor(A: &Mat, B: &Mat) -> Result<Mat, Error> {
    square_factor(A, B, Kind::Discrete)
}

fn factor(A: &Mat, B: &Mat, kind: Kind) -> Result<Mat, Error> {
    let square = square_factor(A, B, kind)?;
    Ok(qr_r(&square.t())?.t())
}

fn square_factor(A: &Mat, B: &Mat, kind: Kind) -> Result<Mat, Error> {
    check_square("A", A)?;
    let solve = |balanced| BalancedSchur::of(balanced, kind)?.gramian_factor(B);
    solve_consistently(A, solve, |R: &Mat| factor_inconsistency(A, B, R, kind))
}

fn both_factors(A: &Mat, B: &Mat, C: &Mat, kind: Kind) -> Result<(Mat, Mat), Error> {
    check_square("A", A)?;
    let solve = |balanced| {
        let form = BalancedSchur::of(balanced, kind)?;
        Ok((form.gramian_factor(B)?, form.output_in_basis(C)?))
    };
    let measure = |(R, L): &(Mat, Mat)| {
        factor_inconsistency(A, B, R, kind).max(factor_inconsistency(&A.t(), &C.t(), L, kind))
    };
    solve_consistently(A, solve, measure)
}

/// How far the solution with a factor `R` is from fitting the equation with `B B'`.
fn factor_inconsistency(A: &Mat, B: &Mat, R: &Mat, kind: Kind) -> f64 {
    inconsistency(A, &(B * &B.t()), &(R * &R.t()), kind)
}

/// A stable matrix, balanced (`A = D Ab D^-1`), in Schur form `Ab = U T U'`.
struct BalancedSchur {
    scale: Vec<f64>,
    form: Schur,
    kind: Kind,
}

impl BalancedSchur {
    fn of(balanced: BalancedMatrix, kind: Kind) -> Result<Self, Error> {
        let form = schur(&balanced.A)?;
        check_stable(&form, kind)?;
        let spectrum = Spectrum::from_form(balanced.A, form, balanced.scale);
        let found = spectrum.eigenvalues_on_boundary(kind.into()).pop();
        if let Some(eigenvalue) = found {
            return Err(Error::NotStable { what: "A", eigenvalue });
        }
        let (form, scale) = spectrum.into_form();
        Ok(Self { scale, form, kind })
    }

    /// A square factor of the solution of the equation with `A` and `B B'`.
    fn gramian_factor(&self, B: &Mat) -> Result<Mat, Error> {
        check_shape("B", B, self.scale.len(), B.ncols())?;
        let scaled = Mat::from_fn(B.nrows(), B.ncols(), |i, j| B[(i, j)] / self.scale[i]);
        let inner = inner(&self.form.T, &narrow(&(self.form.U.t() * &scaled))?, self.kind)?;
        check_range("the factor of a Gramian", self.outer(&inner, |i| self.scale[i]))
    }

    /// A square factor of the solution of the equation with `A'` and `C' C`: its triangular form is `T'` with rows and
    /// columns in reverse.
    fn output_in_basis(&self, C: &Mat) -> Result<Mat, Error> {
        let n = self.scale.len();
        check_shape("C", C, C.nrows(), n)?;
        let scaled = Mat::from_fn(n, C.nrows(), |i, j| C[(j, i)] * self.scale[i]);
        let reduced = narrow(&(self.form.U.t() * &scaled))?;
        let T = Mat::from_fn(n, n, |i, j| self.form.T[(n - 1 - j, n - 1 - i)]);
        let inner = inner(&T, &upside_down(&reduced), self.kind)?;
        check_range("the factor of a Gramian", self.outer(&upside_down(&inner), |i| 1.0 / self.scale[i]))
    }

    /// `diag(scale) U inner`
    fn outer(&self, inner: &Mat, scale: impl Fn(usize) -> f64) -> Mat {
        let mut whole = &self.form.U * inner;
        for j in 0..whole.ncols() {
            whole.column_mut(j).iter_mut().enumerate().for_each(|(i, e)| *e *= scale(i));
        }
        whole
    }
}

/// A real square factor of the solution of the equation with a quasi-triangular `T`.
fn inner(T: &Mat, B: &Mat, kind: Kind) -> Result<Mat, Error> {
    match kind {
        Kind::Continuous => Ok(hammarling_leaf::triangular_factor(T, B)),
        Kind::Discrete => {
            let (T, turns) = complex_form(T);
            let mut B = B.to_complex();
            turns.iter().for_each(|turn| turn.inverse().rows(&mut B));
            let mut R = triangular_factor(&T, &B);
            turns.iter().for_each(|turn| turn.rows(&mut R));
            let parts = R.map(|e| e.re).hstack(&R.map(|e| e.im));
            Ok(qr_r(&parts.t())?.t())
        }
    }
}

fn check_stable(form: &Schur, kind: Kind) -> Result<(), Error> {
    match form.eigenvalues().into_iter().find(|&l| excess(l, kind) >= 0.0) {
        Some(eigenvalue) => Err(Error::NotStable { what: "A", eigenvalue }),
        None => Ok(()),
    }
}

/// Returns how far an eigenvalue lies beyond the boundary of stability.
fn excess(eigenvalue: C64, kind: Kind) -> f64 {
    match kind {
        Kind::Continuous => Boundary::ImaginaryAxis.excess(eigenvalue),
        Kind::Discrete => Boundary::UnitCircle.excess(eigenvalue),
    }
}

/// As many columns as rows at most, with the same `B B'`.
fn narrow(B: &Mat) -> Result<Mat, Error> {
    if B.ncols() <= B.nrows() { Ok(B.clone()) } else { Ok(qr_r(&B.t())?.t()) }
}

/// The rows in reverse order.
fn upside_down(M: &Mat) -> Mat {
    let mut out = M.clone();
    (0..M.ncols()).for_each(|j| out.column_mut(j).reverse());
    out
}

/// The unitary `[x -conj(y); y conj(x)]` in rows and columns `k`, `k + 1`.
struct Turn {
    k: usize,
    x: C64,
    y: C64,
}

impl Turn {
    fn inverse(&self) -> Self {
        Self { k: self.k, x: self.x.conj(), y: -self.y }
    }

    /// `Z M`
    fn rows(&self, M: &mut CMat) {
        let (k, x, y) = (self.k, self.x, self.y);
        for j in 0..M.ncols() {
            let (p, q) = (M[(k, j)], M[(k + 1, j)]);
            (M[(k, j)], M[(k + 1, j)]) = (x * p - y.conj() * q, y * p + x.conj() * q);
        }
    }

    /// `M Z` in the first `rows` rows.
    fn columns(&self, M: &mut CMat, rows: usize) {
        let (k, x, y) = (self.k, self.x, self.y);
        for i in 0..rows {
            let (p, q) = (M[(i, k)], M[(i, k + 1)]);
            (M[(i, k)], M[(i, k + 1)]) = (p * x + q * y, q * x.conj() - p * y.conj());
        }
    }
}

/// The complex triangular form of a real Schur form and the turns that make up the unitary `Z` with `T_real = Z T Z^H`.
fn complex_form(form: &Mat) -> (CMat, Vec<Turn>) {
    let mut T = form.to_complex();
    let mut turns = Vec::new();
    for DiagonalBlock { start: k, size } in blocks(form) {
        if size == 2 {
            let (a, b, c) = (form[(k, k)], form[(k, k + 1)], form[(k + 1, k)]);
            let omega = (b.abs() * c.abs()).sqrt();
            // Eigenvector [b; j omega] of [a b; c a] for a + j omega.
            let norm = b.hypot(omega);
            let (x, y) = (C64::new(b / norm, 0.0), C64::new(0.0, omega / norm));
            let turn = Turn { k, x, y };
            turn.inverse().rows(&mut T);
            turn.columns(&mut T, k + 2);
            T[(k, k)] = C64::new(a, omega);
            T[(k + 1, k + 1)] = C64::new(a, -omega);
            T[(k + 1, k)] = C64::new(0.0, 0.0);
            turns.push(turn);
        }
    }
    (T, turns)
}

vectorised! {
    /// The upper triangular `R` with `P = R R^H` of the sampled equation, from the last column to the first.
    fn triangular_factor<'a>(T: &'a CMat, B: &'a CMat) -> CMat {
        let n = T.nrows();
        let mut B = B.clone();
        let mut R = CMat::zeros(n, n);
        for k in (0..n).rev() {
            let modulus = T[(k, k)].norm();
            let row: Vec<C64> = B.row_vec(k);
            let size = row.iter().map(|e| e.norm_sqr()).sum::<f64>().sqrt();
            let gain = ((1.0 - modulus) * (1.0 + modulus)).sqrt();
            R[(k, k)] = C64::new(size / gain, 0.0);
            if size == 0.0 {
                continue;
            }
            let u: Vec<C64> = row.iter().map(|e| e.conj() / size).collect();
            discrete_column(T, &mut B, &mut R, k, &u, gain);
        }
        R
    }
}

/// `B1 u` for the rows above `k`.
#[inline(always)]
fn project(B: &CMat, u: &[C64], k: usize) -> Vec<C64> {
    let mut sum = vec![C64::new(0.0, 0.0); k];
    for (j, &factor) in u.iter().enumerate() {
        sum.iter_mut().zip(B.column(j)).for_each(|(s, &b)| *s += b * factor);
    }
    sum
}

/// `(I - conj(l) T1) r = conj(l) t rho + gain B1 u`; with `v = T1 r + t rho`, `B1 += (gain v - l B1 u - B1 u) u^H`.
#[inline(always)]
fn discrete_column(T: &CMat, B: &mut CMat, R: &mut CMat, k: usize, u: &[C64], gain: f64) {
    let (lambda, rho) = (T[(k, k)], R[(k, k)].re);
    let forced = project(B, u, k);
    let mut r: Vec<C64> = (0..k).map(|i| lambda.conj() * T[(i, k)] * rho + forced[i] * gain).collect();
    for i in (0..k).rev() {
        r[i] /= C64::new(1.0, 0.0) - lambda.conj() * T[(i, i)];
        let factor = r[i] * lambda.conj();
        r[..i].iter_mut().zip(T.column(i)).for_each(|(x, &t)| *x += t * factor);
    }
    let mut v: Vec<C64> = (0..k).map(|i| T[(i, k)] * rho).collect();
    for (i, &factor) in r.iter().enumerate() {
        v[..=i].iter_mut().zip(T.column(i)).for_each(|(x, &t)| *x += t * factor);
    }
    for (j, &uj) in u.iter().enumerate() {
        let step = |i: usize| (v[i] * gain - forced[i] * (lambda + 1.0)) * uj.conj();
        B.column_mut(j)[..k].iter_mut().enumerate().for_each(|(i, b)| *b += step(i));
    }
    R.column_mut(k)[..k].copy_from_slice(&r);
}
