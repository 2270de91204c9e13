//! H-infinity control of a generalised plant by two Riccati equations and a search for the smallest bound.

use counterpoise_lti::linalg::{
    Outcome as Solution, care_g, inverse, singular_values, svd, sym_eigen, sym_eigenvalues,
};
use counterpoise_lti::{C64, Mat, StateSpace, Timebase, linfnorm, poles};

use crate::cause::Cause;
use crate::finding::{Finding, Part};
use crate::generalised::{Blocks, Generalised, around_direct_path};
use crate::h2syn::h2syn;
use crate::{Error, Outcome};

/// An H-infinity controller with its certificates.
#[derive(Debug, Clone, PartialEq)]
pub struct HInfinity {
    /// u = K y.
    pub controller: StateSpace,
    /// The bound at which the controller was made.
    pub bound: f64,
    /// The norm that the assembled loop really has, at most `bound` (1 + [`VERIFIED`]): the figure to quote.
    pub achieved_norm: f64,
    /// Frequency of the peak, rad/s.
    pub peak_rad_s: f64,
    /// The largest bound that was found not to be reachable: the optimum lies between the two.
    pub unreachable: f64,
    /// Poles of the assembled loop.
    pub closed_loop: Vec<C64>,
    /// Bounds that were tried.
    pub trials: usize,
}

/// The norm of the assembled loop may exceed the bound by this, relatively: the accuracy of the norm itself.
pub const VERIFIED: f64 = 1e-6;
/// Relative accuracy of the norms of candidate loops.
const NORM_TOLERANCE: f64 = 1e-9;
/// By how much the norm that was found is rounded up, so that the claim is not below what is reached.
const ROUNDED_UP: f64 = 1e-7;
/// X and Y count as indefinite below minus this, relatively. A loose test: the loop itself is looked at afterwards.
const INDEFINITE: f64 = 1e-7;
/// By how much a bound is first raised whose loop does not keep it.
const FIRST_RAISE: f64 = 1e-3;
/// Bounds tried at most, upward and in the bisection.
const MOST_TRIALS: usize = 80;

/// The controller whose H-infinity norm from w to z is within a factor (1 + tolerance) of the smallest
///
/// ```text
///     X, Y from H-infinity Riccati equations at the bound g;  X >= 0, Y >= 0, rho(XY) < g^2
/// ```
///
/// and the central controller of Glover and Doyle (Zhou, Doyle, Glover, Robust and Optimal Control, theorem 17.1), D11
/// of any kind. The smallest bound is found by a guarded secant on ln rho(XY) - 2 ln g. The answer is then looked at
/// afresh: the assembled loop must be stable and its norm must keep the bound, or the bound is raised until it does. The
/// claim is thus never below what is reached.
///
/// # Errors
/// [`Error::Range`] for a tolerance that is not positive, [`Error`] where a decomposition fails. A plant that breaks a
/// condition is [`Outcome::Infeasible`] and says which.
pub fn hinfsyn(plant: &Generalised, tolerance: f64) -> Result<Outcome<HInfinity>, Error> {
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(Error::Range { what: "tolerance", value: tolerance, allowed: "positive" });
    }
    if let Outcome::Infeasible(findings) = plant.regular()? {
        return Ok(Outcome::Infeasible(findings));
    }
    let normal = Normal::of(plant)?;
    let low = End { bound: normal.lower_bound()?, margin: None };
    let mut search = Search { plant, normal: &normal, low, high: None, trials: 0 };
    search.upward()?;
    if search.high.is_none()
        && let Some(findings) = obstacle(plant)?
    {
        return Ok(Outcome::Infeasible(findings));
    }
    search.narrow(tolerance)?;
    search.verified()
}

/// The mode in the way where no bound is kept: as the bound grows the equations become those of H2, which name it.
fn obstacle(plant: &Generalised) -> Result<Option<Vec<Finding>>, Error> {
    let mut limit = plant.clone();
    let system = &mut limit.system;
    let (p, m) = (system.outputs() - plant.measurements, system.inputs() - plant.controls);
    system.D.set_block(0, 0, &Mat::zeros(p, m));
    Ok(match h2syn(&limit)? {
        Outcome::Infeasible(findings) => Some(findings),
        Outcome::Solved(_) => None,
    })
}

/// A bound with ln rho(XY) - 2 ln g there, where X and Y exist.
#[derive(Clone, Copy)]
struct End {
    bound: f64,
    margin: Option<f64>,
}

struct Search<'a> {
    plant: &'a Generalised,
    normal: &'a Normal,
    low: End,
    high: Option<End>,
    trials: usize,
}

impl Search<'_> {
    /// Raises the bound until one seems reachable.
    fn upward(&mut self) -> Result<(), Error> {
        let mut bound = if self.low.bound > 0.0 { 2.0 * self.low.bound } else { self.normal.guess() };
        while self.high.is_none() && self.trials < MOST_TRIALS {
            self.attempt(bound)?;
            bound *= 4.0;
        }
        Ok(())
    }

    /// Brings the ends together to the tolerance.
    fn narrow(&mut self, tolerance: f64) -> Result<(), Error> {
        while let Some(high) = self.high {
            let close = high.bound <= self.low.bound * (1.0 + tolerance);
            if close || high.bound < f64::MIN_POSITIVE.sqrt() || self.trials >= MOST_TRIALS {
                return Ok(());
            }
            self.attempt(between(self.low, high, tolerance))?;
        }
        Ok(())
    }

    fn attempt(&mut self, bound: f64) -> Result<(), Error> {
        self.trials += 1;
        let margin = self.normal.margin(bound)?;
        let end = End { bound, margin };
        match margin {
            Some(margin) if margin < 0.0 => self.high = Some(end),
            _ => self.low = end,
        }
        Ok(())
    }

    /// The controller at the upper end, or at the first bound above it whose loop keeps it.
    fn verified(mut self) -> Result<Outcome<HInfinity>, Error> {
        let mut bound = self.high.map_or(self.low.bound, |high| high.bound);
        let mut raise = FIRST_RAISE;
        while self.high.is_some() && self.trials < 2 * MOST_TRIALS {
            self.trials += 1;
            if let Some(K) = self.normal.central(bound)?
                && let Some(answer) = self.verify(K, bound)?
            {
                return Ok(Outcome::Solved(answer));
            }
            bound *= 1.0 + raise;
            raise = (2.0 * raise).min(1.0);
        }
        let cause = Cause::NoBoundReached { largest: bound };
        Ok(Outcome::Infeasible(vec![Finding::refusal(Part::Generalised, cause)]))
    }

    /// The controller with its certificates, if its loop is stable and keeps the bound.
    fn verify(&self, K: StateSpace, bound: f64) -> Result<Option<HInfinity>, Error> {
        let closed = self.plant.close(&K)?;
        let closed_loop = poles(&closed)?;
        if closed_loop.iter().any(|pole| pole.re >= 0.0) {
            return Ok(None);
        }
        let peak = linfnorm(&closed, NORM_TOLERANCE)?;
        if peak.value > bound * (1.0 + VERIFIED) {
            return Ok(None);
        }
        Ok(Some(HInfinity {
            controller: K,
            bound,
            achieved_norm: peak.value * (1.0 + ROUNDED_UP),
            peak_rad_s: peak.rate_rad_s,
            unreachable: self.low.bound,
            closed_loop,
            trials: self.trials,
        }))
    }
}

/// A bound strictly between two ends: by the secant where both margins are known, else the middle; never nearer to an
/// end than half the tolerance, so that the ends meet.
fn between(low: End, high: End, tolerance: f64) -> f64 {
    if low.bound <= 0.0 {
        return 0.1 * high.bound;
    }
    let (a, b) = (low.bound.ln(), high.bound.ln());
    let middle = 0.5 * (a + b);
    let guess = match (low.margin, high.margin) {
        (Some(above), Some(below)) if above.is_finite() && below.is_finite() => {
            b - below * (b - a) / (below - above)
        }
        _ => middle,
    };
    let guard = (0.5 * tolerance).min(0.25 * (b - a));
    guess.clamp(a + guard, b - guard).exp()
}

/// The plant in the form D12 = \[0; I\], D21 = \[0 I\], by rotations of w and z and scalings of u and y.
struct Normal {
    P: Blocks,
    /// u = U u_normal.
    U: Mat,
    /// y_normal = Y y.
    Y: Mat,
}

impl Normal {
    fn of(plant: &Generalised) -> Result<Self, Error> {
        let P = plant.blocks();
        let (z, U) = rotation(&P.D12)?;
        let (w, Y) = rotation(&P.D21.t())?;
        let Y = Y.t();
        let wt = w.t();
        Ok(Self {
            P: Blocks {
                B1: &P.B1 * &wt,
                B2: &P.B2 * &U,
                C1: &z * &P.C1,
                C2: &Y * &P.C2,
                D11: &z * &(&P.D11 * &wt),
                D12: &z * &(&P.D12 * &U),
                D21: &Y * &(&P.D21 * &wt),
                D22: P.D22,
                A: P.A,
                scale: P.scale,
                origins: P.origins,
            },
            U,
            Y,
        })
    }

    /// max(|[D1111 D1112]|, |[D1111; D1121]|): below it no bound can be reached.
    fn lower_bound(&self) -> Result<f64, Error> {
        let (z1, w1) = self.split();
        let D = &self.P.D11;
        let largest = |M: Mat| -> Result<f64, Error> {
            Ok(if M.norm_max() == 0.0 { 0.0 } else { singular_values(&M)?[0] })
        };
        Ok(largest(D.block(0, 0, z1, D.ncols()))?.max(largest(D.block(0, 0, D.nrows(), w1))?))
    }

    /// A bound to start from where D11 gives none.
    fn guess(&self) -> f64 {
        let size =
            (self.P.C1.norm_fro() * self.P.B1.norm_fro() / self.P.A.norm_fro().max(f64::MIN_POSITIVE)).sqrt();
        if size > 0.0 && size.is_finite() { size } else { 1.0 }
    }

    /// Rows of z and columns of w that neither control nor measurement noise touches.
    fn split(&self) -> (usize, usize) {
        (self.P.D12.nrows() - self.P.D12.ncols(), self.P.D21.ncols() - self.P.D21.nrows())
    }

    /// ln rho(XY) - 2 ln g at a bound, negative where it is reachable; `None` where X or Y does not exist or is indefinite.
    fn margin(&self, bound: f64) -> Result<Option<f64>, Error> {
        let Some((X, _)) = self.regulator(bound)? else { return Ok(None) };
        let Some((Y, _)) = self.filter(bound)? else { return Ok(None) };
        Ok(Some(spectral_radius(&(&Y * &X))?.ln() - 2.0 * bound.ln()))
    }

    /// The central controller at a bound; `None` where there is none.
    fn central(&self, bound: f64) -> Result<Option<StateSpace>, Error> {
        let Some((X, F)) = self.regulator(bound)? else { return Ok(None) };
        let Some((Y, L)) = self.filter(bound)? else { return Ok(None) };
        let Z = &Mat::eye(X.nrows()) - &(&Y * &X).scale(1.0 / (bound * bound));
        let Ok(Z) = inverse(&Z) else { return Ok(None) };
        self.assemble(bound, &F, &L, &Z)
    }

    /// X and F = -R^-1 (D1.'C1 + B'X), on all inputs.
    fn regulator(&self, bound: f64) -> Result<Option<(Mat, Mat)>, Error> {
        let P = &self.P;
        let (B, D) = (P.B1.hstack(&P.B2), P.D11.hstack(&P.D12));
        solve_indefinite(&P.A, &B, &P.C1, &D, (P.B1.ncols(), bound))
    }

    /// Y and L = -(B1 D.1' + Y C') R^-1, on all outputs: the same problem transposed.
    fn filter(&self, bound: f64) -> Result<Option<(Mat, Mat)>, Error> {
        let P = &self.P;
        let (C, D) = (P.C1.vstack(&P.C2), P.D11.vstack(&P.D21));
        let solved = solve_indefinite(&P.A.t(), &C.t(), &P.B1.t(), &D.t(), (P.C1.nrows(), bound))?;
        Ok(solved.map(|(Y, L)| (Y, L.t())))
    }

    fn assemble(&self, bound: f64, F: &Mat, L: &Mat, Z: &Mat) -> Result<Option<StateSpace>, Error> {
        let P = &self.P;
        let ((z1, w1), n) = (self.split(), P.A.nrows());
        let (m2, p2) = (P.B2.ncols(), P.C2.nrows());
        let Some(D) = DirectPaths::of(&P.D11, (z1, w1), bound)? else { return Ok(None) };
        let (F12, F2) = (F.block(w1, 0, p2, n), F.block(w1 + p2, 0, m2, n));
        let (L12, L2) = (L.block(0, z1, n, m2), L.block(0, z1 + m2, n, p2));
        let B = P.B1.hstack(&P.B2);
        let into = Z * &(&(&P.B2 + &L12) * &D.D12);
        let seen = -(&D.D21 * &(&P.C2 + &F12));
        let B1 = &(&into * &(&inverse(&D.D12)? * &D.D11)) - &(Z * &L2);
        let shaped = &inverse(&D.D21)? * &seen;
        let C1 = &F2 + &(&D.D11 * &shaped);
        let A = &(&P.A + &(&B * F)) + &(&B1 * &shaped);
        let K = StateSpace::new(
            A,
            &B1 * &self.Y,
            &self.U * &C1,
            &self.U * &(&D.D11 * &self.Y),
            Timebase::Continuous,
        );
        match K {
            Ok(K) => Ok(Some(around_direct_path(P.in_plant_states(K), &P.D22)?)),
            Err(_) => Ok(None),
        }
    }
}

/// The direct paths of the central controller.
struct DirectPaths {
    D11: Mat,
    D12: Mat,
    D21: Mat,
}

impl DirectPaths {
    fn of(D11: &Mat, (z1, w1): (usize, usize), bound: f64) -> Result<Option<Self>, Error> {
        let (m2, p2) = (D11.nrows() - z1, D11.ncols() - w1);
        let (D1111, D1112) = (D11.block(0, 0, z1, w1), D11.block(0, w1, z1, p2));
        let (D1121, D1122) = (D11.block(z1, 0, m2, w1), D11.block(z1, w1, m2, p2));
        let square = bound * bound;
        let left = &Mat::eye(z1).scale(square) - &(&D1111 * &D1111.t());
        let right = &Mat::eye(w1).scale(square) - &(&D1111.t() * &D1111);
        let (Some(left), Some(right)) = (invert(&left), invert(&right)) else { return Ok(None) };
        let first = -&(&(&D1121 * &(&D1111.t() * &(&left * &D1112))) + &D1122);
        let second = &Mat::eye(m2) - &(&D1121 * &(&right * &D1121.t()));
        let third = &Mat::eye(p2) - &(&D1112.t() * &(&left * &D1112));
        let (Some(D12), Some(D21)) = (root(&second)?, root(&third)?) else { return Ok(None) };
        Ok(Some(Self { D11: first, D12, D21 }))
    }
}

fn invert(M: &Mat) -> Option<Mat> {
    if M.nrows() == 0 { Some(M.clone()) } else { inverse(M).ok() }
}

/// The symmetric root of a positive definite matrix; `None` for another.
fn root(M: &Mat) -> Result<Option<Mat>, Error> {
    let (values, V) = sym_eigen(&M.symmetric_part())?;
    if values.iter().any(|value| *value <= 0.0) {
        return Ok(None);
    }
    let roots: Vec<f64> = values.iter().map(|value| value.sqrt()).collect();
    Ok(Some(&V * &(&Mat::diag(&roots) * &V.t())))
}

/// The stabilising X of A'X + XA + C'C - (XB + C'D) R^-1 (B'X + D'C) = 0, R = D'D - diag(g^2 I, 0), and
/// F = -R^-1 (D'C + B'X); `None` where there is none, or where it is indefinite.
fn solve_indefinite(
    A: &Mat,
    B: &Mat,
    C: &Mat,
    D: &Mat,
    (disturbed, bound): (usize, f64),
) -> Result<Option<(Mat, Mat)>, Error> {
    let mut R = &D.t() * D;
    for i in 0..disturbed {
        R[(i, i)] -= bound * bound;
    }
    let Ok(R_inverse) = inverse(&R) else { return Ok(None) };
    let cross = &D.t() * C;
    let folded = A - &(B * &(&R_inverse * &cross));
    let G = (B * &(&R_inverse * &B.t())).symmetric_part();
    let Q = (&(&C.t() * C) - &(&cross.t() * &(&R_inverse * &cross))).symmetric_part();
    let Solution::Solved(solution) = care_g(&folded, &G, &Q)? else { return Ok(None) };
    // What is negligible beside A in A - GX is rounding, whatever its sign.
    let negligible = INDEFINITE * folded.norm_fro() / G.norm_fro().max(f64::MIN_POSITIVE);
    let values = sym_eigenvalues(&solution.X.symmetric_part())?;
    let largest = values.iter().copied().fold(0.0, |a: f64, b| a.max(b.abs()));
    if values.iter().any(|value| *value < -(INDEFINITE * largest).max(negligible)) {
        return Ok(None);
    }
    let F = -&(&R_inverse * &(&cross + &(&B.t() * &solution.X)));
    Ok(Some((solution.X, F)))
}

/// z (orthogonal) and U with z D U = \[0; I\], for D of full column rank.
fn rotation(D: &Mat) -> Result<(Mat, Mat), Error> {
    let (rows, columns) = D.shape();
    let parts = svd(D)?;
    let full = full_basis(&parts.U, rows)?;
    let order: Vec<usize> = (columns..rows).chain(0..columns).collect();
    let all: Vec<usize> = (0..rows).collect();
    let z = full.select(&all, &order).t();
    let inverse: Vec<f64> = parts.s.iter().map(|value| 1.0 / value).collect();
    Ok((z, &parts.V * &Mat::diag(&inverse)))
}

/// The columns of U followed by an orthonormal basis of what they leave out.
fn full_basis(U: &Mat, rows: usize) -> Result<Mat, Error> {
    if U.ncols() == rows {
        return Ok(U.clone());
    }
    let columns = U.ncols();
    let rest = &Mat::eye(rows) - &(U * &U.t());
    let complement = svd(&rest)?.U;
    Ok(U.hstack(&complement.block(0, 0, rows, rows - columns)))
}

fn spectral_radius(M: &Mat) -> Result<f64, Error> {
    let values = counterpoise_lti::linalg::eigenvalues(M)?;
    Ok(values.iter().map(|value| value.norm()).fold(0.0, f64::max))
}
