//! Lyapunov equations solved for a factor of the solution, so that it stays positive semidefinite.
//!
//! Sources: Hammarling, IMA J. Numer. Anal. 2 (1982); Sorensen and Zhou, J. Appl. Math. 2003, for the form used here:
//! after each column the right-hand side is updated by one rank-one term, no factor is ever recomputed.

use crate::dense::qr_r;
use crate::error::{Error, check_shape, check_square};
use crate::kernel::vectorised;
use crate::mat::{C64, CMat, Mat};
use crate::schur::{Schur, blocks, schur};
use crate::sylvester::Kind;

/// The lower triangular factor `L`, `P = L L'`, of the solution of `A P + P A' + B B' = 0`; `A` n x n stable, `B` n x m.
///
/// Method: balancing, real Schur form made complex triangular, Hammarling's recursion; the small Hankel values of a
/// balanced truncation need this factor rather than `P`.
///
/// # Errors
/// Wrong shapes, entries that are not finite, or [`Error::NotStable`] with the eigenvalue.
pub fn lyap_factor(A: &Mat, B: &Mat) -> Result<Mat, Error> {
    factor(A, B, Kind::Continuous)
}

/// The lower triangular factor `L`, `P = L L'`, of the solution of `A P A' - P + B B' = 0`; every eigenvalue of `A` must
/// be inside the unit circle. Method and errors as for [`lyap_factor`].
///
/// # Errors
/// Wrong shapes, entries that are not finite, or [`Error::NotStable`] with the eigenvalue.
pub fn dlyap_factor(A: &Mat, B: &Mat) -> Result<Mat, Error> {
    factor(A, B, Kind::Discrete)
}

/// The factors of both Gramians from one Schur form: `A P + P A' + B B' = 0` and `A' Q + Q A + C' C = 0`, each lower
/// triangular. Method and errors as for [`lyap_factor`].
///
/// # Errors
/// Wrong shapes, entries that are not finite, or [`Error::NotStable`] with the eigenvalue.
pub fn lyap_factors(A: &Mat, B: &Mat, C: &Mat) -> Result<(Mat, Mat), Error> {
    let form = Prepared::of(A, Kind::Continuous)?;
    Ok((form.reached(B)?, form.seen(C)?))
}

/// The factors of both Gramians from one Schur form: `A P A' - P + B B' = 0` and `A' Q A - Q + C' C = 0`; as
/// [`lyap_factors`].
///
/// # Errors
/// Wrong shapes, entries that are not finite, or [`Error::NotStable`] with the eigenvalue.
pub fn dlyap_factors(A: &Mat, B: &Mat, C: &Mat) -> Result<(Mat, Mat), Error> {
    let form = Prepared::of(A, Kind::Discrete)?;
    Ok((form.reached(B)?, form.seen(C)?))
}

fn factor(A: &Mat, B: &Mat, kind: Kind) -> Result<Mat, Error> {
    Prepared::of(A, kind)?.reached(B)
}

/// A stable matrix, balanced (`A = D Ab D^-1`), in Schur form `Ab = U (Z T Z^H) U'`; `Z` turns complex pairs only.
struct Prepared {
    scale: Vec<f64>,
    U: Mat,
    turns: Vec<Turn>,
    T: CMat,
    kind: Kind,
}

impl Prepared {
    fn of(A: &Mat, kind: Kind) -> Result<Self, Error> {
        check_square("A", A)?;
        let balanced = crate::balance::balance(A)?;
        let form = schur(&balanced.A)?;
        check_stable(&form, kind)?;
        let (T, turns) = complex_form(&form);
        Ok(Self { scale: balanced.scale, U: form.U, turns, T, kind })
    }

    /// The factor of the equation with `A` and `B B'`.
    fn reached(&self, B: &Mat) -> Result<Mat, Error> {
        check_shape("B", B, (self.U.nrows(), B.ncols()))?;
        let scaled = Mat::from_fn(B.nrows(), B.ncols(), |i, j| B[(i, j)] / self.scale[i]);
        let reduced = narrow(&(self.U.t() * &scaled))?;
        let mut R = triangular_factor(&self.T, &self.turned_back(&reduced), self.kind);
        self.turns.iter().for_each(|turn| turn.rows(&mut R));
        self.lower(&R, |i| self.scale[i])
    }

    /// The factor of the equation with `A'` and `C' C`: its triangular form is `T^H` with rows and columns in reverse.
    fn seen(&self, C: &Mat) -> Result<Mat, Error> {
        let n = self.U.nrows();
        check_shape("C", C, (C.nrows(), n))?;
        let scaled = Mat::from_fn(n, C.nrows(), |i, j| C[(j, i)] * self.scale[i]);
        let reduced = narrow(&(self.U.t() * &scaled))?;
        let T = CMat::from_fn(n, n, |i, j| self.T[(n - 1 - j, n - 1 - i)].conj());
        let R = triangular_factor(&T, &upside_down(&self.turned_back(&reduced)), self.kind);
        let mut R = upside_down(&R);
        self.turns.iter().for_each(|turn| turn.rows(&mut R));
        self.lower(&R, |i| 1.0 / self.scale[i])
    }

    /// `Z^H B`
    fn turned_back(&self, B: &Mat) -> CMat {
        let mut B = B.to_complex();
        self.turns.iter().for_each(|turn| turn.back().rows(&mut B));
        B
    }

    /// The real lower triangular factor of `S S^H`, `S = diag(scale) U inner`.
    fn lower(&self, inner: &CMat, scale: impl Fn(usize) -> f64) -> Result<Mat, Error> {
        let n = self.U.nrows();
        let parts = inner.map(|e| e.re).hstack(&inner.map(|e| e.im));
        let mut whole = &self.U * &parts;
        for j in 0..2 * n {
            whole.column_mut(j).iter_mut().enumerate().for_each(|(i, e)| *e *= scale(i));
        }
        Ok(qr_r(&whole.t())?.t())
    }
}

fn check_stable(form: &Schur, kind: Kind) -> Result<(), Error> {
    let unstable = |l: &C64| match kind {
        Kind::Continuous => l.re >= 0.0,
        Kind::Discrete => l.norm() >= 1.0,
    };
    match form.eigenvalues().into_iter().find(unstable) {
        Some(eigenvalue) => Err(Error::NotStable { what: "A", eigenvalue }),
        None => Ok(()),
    }
}

/// As many columns as rows at most, with the same `B B'`.
fn narrow(B: &Mat) -> Result<Mat, Error> {
    if B.ncols() <= B.nrows() { Ok(B.clone()) } else { Ok(qr_r(&B.t())?.t()) }
}

/// The rows in reverse order.
fn upside_down(M: &CMat) -> CMat {
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
    fn back(&self) -> Self {
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
fn complex_form(form: &Schur) -> (CMat, Vec<Turn>) {
    let mut T = form.T.to_complex();
    let mut turns = Vec::new();
    for (k, size) in blocks(&form.T) {
        if size == 2 {
            let (a, b, c) = (form.T[(k, k)], form.T[(k, k + 1)], form.T[(k + 1, k)]);
            let omega = (b.abs() * c.abs()).sqrt();
            // Eigenvector [b; j omega] of [a b; c a] for a + j omega.
            let norm = b.hypot(omega);
            let (x, y) = (C64::new(b / norm, 0.0), C64::new(0.0, omega / norm));
            let turn = Turn { k, x, y };
            turn.back().rows(&mut T);
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
    /// The upper triangular `R` with `P = R R^H`, from the last column to the first.
    fn triangular_factor<'a>(T: &'a CMat, B: &'a CMat, kind: Kind) -> CMat {
        let n = T.nrows();
        let mut B = B.clone();
        let mut R = CMat::zeros(n, n);
        for k in (0..n).rev() {
            let lambda = T[(k, k)];
            let row: Vec<C64> = B.row_vec(k);
            let size = row.iter().map(|e| e.norm_sqr()).sum::<f64>().sqrt();
            let gain = match kind {
                Kind::Continuous => (-2.0 * lambda.re).sqrt(),
                Kind::Discrete => ((1.0 - lambda.norm()) * (1.0 + lambda.norm())).sqrt(),
            };
            R[(k, k)] = C64::new(size / gain, 0.0);
            if size == 0.0 {
                continue;
            }
            let u: Vec<C64> = row.iter().map(|e| e.conj() / size).collect();
            match kind {
                Kind::Continuous => column(T, &mut B, &mut R, k, &u, gain),
                Kind::Discrete => discrete_column(T, &mut B, &mut R, k, &u, gain),
            }
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

/// `(T1 + conj(l) I) r = -(t rho + gain B1 u)`, then `B1 -= gain r u^H`.
#[inline(always)]
fn column(T: &CMat, B: &mut CMat, R: &mut CMat, k: usize, u: &[C64], gain: f64) {
    let (lambda, rho) = (T[(k, k)], R[(k, k)].re);
    let forced = project(B, u, k);
    let mut r: Vec<C64> = (0..k).map(|i| -(T[(i, k)] * rho + forced[i] * gain)).collect();
    for i in (0..k).rev() {
        r[i] /= T[(i, i)] + lambda.conj();
        let factor = r[i];
        r[..i].iter_mut().zip(T.column(i)).for_each(|(x, &t)| *x -= t * factor);
    }
    for (j, &uj) in u.iter().enumerate() {
        let factor = uj.conj() * gain;
        B.column_mut(j).iter_mut().zip(&r).for_each(|(b, &x)| *b -= x * factor);
    }
    R.column_mut(k)[..k].copy_from_slice(&r);
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
