//! Gramians, as matrices and as factors, and the Hankel values.

use crate::error::OperationContext;
use crate::roots::{boundary, is_stable_pole, poles};
use crate::tolerance::{FADED_OUTPUT, MAGNIFIED_GRAMIAN, PRECISE_SIZE, SUSPECT_POLE};
use crate::{C64, Error, Mat, StateSpace, Timebase};
use counterpoise_linalg as linalg;

/// Returns the controllability Gramian P: `A P + P A' + B B' = 0`, or `A P A' - P + B B' = 0`.
///
/// # Errors
/// [`Error::Pole`] for a system that is not stable.
pub fn ctrb_gramian(g: &StateSpace) -> Result<Mat, Error> {
    let L = ctrb_factor(g)?;
    Ok(&L * &L.t())
}

/// Returns the observability Gramian Q: `A' Q + Q A + C' C = 0`, or `A' Q A - Q + C' C = 0`.
///
/// # Errors
/// [`Error::Pole`] for a system that is not stable.
pub fn obsv_gramian(g: &StateSpace) -> Result<Mat, Error> {
    ctrb_gramian(&g.dual())
}

/// Returns L with P = L L', by Hammarling's method: small Hankel values keep their digits, which a Gramian itself loses.
///
/// # Errors
/// [`Error::Pole`] for a system that is not stable.
pub fn ctrb_factor(g: &StateSpace) -> Result<Mat, Error> {
    let factor = match g.timebase {
        Timebase::Continuous => linalg::lyap_factor(&g.A, &g.B),
        Timebase::Discrete { .. } => linalg::dlyap_factor(&g.A, &g.B),
    };
    match factor {
        Err(linalg::Error::NotStable { .. }) => Err(instability_error("Gramian", g)?),
        other => other.with_operation("Gramian"),
    }
}

/// Returns L with Q = L L'; as [`ctrb_factor`].
///
/// # Errors
/// [`Error::Pole`] for a system that is not stable.
pub fn obsv_factor(g: &StateSpace) -> Result<Mat, Error> {
    ctrb_factor(&g.dual())
}

/// Returns both factors, of P and of Q, from one Schur form; those of a system with up to 32 states whose modes beside the boundary of stability
/// have lost digits, from equations solved in 32 digits.
///
/// # Errors
/// [`Error::Pole`] for a system that is not stable.
pub fn gramian_factors(g: &StateSpace) -> Result<(Mat, Mat), Error> {
    let factors = match g.timebase {
        Timebase::Continuous => linalg::lyap_factors(&g.A, &g.B, &g.C),
        Timebase::Discrete { .. } => linalg::dlyap_factors(&g.A, &g.B, &g.C),
    };
    match factors {
        Err(linalg::Error::NotStable { eigenvalue, .. }) => {
            let precise = if is_lightly_damped(g, eigenvalue)? { precise_factors(g)? } else { None };
            precise.map_or_else(|| Err(instability_error("Gramians", g)?), Ok)
        }
        other => {
            let (R, L) = other.with_operation("Gramians")?;
            let is_magnified = is_magnified(g, &R, &g.B) || is_magnified(g, &L, &g.C);
            let precise = if is_magnified || is_faded(g, &L.t(), &R) { precise_factors(g)? } else { None };
            Ok(precise.unwrap_or((R, L)))
        }
    }
}

/// Returns the factors of both Gramians from equations solved in 32 digits; `None` if these say that the system is not stable.
fn precise_factors(g: &StateSpace) -> Result<Option<(Mat, Mat)>, Error> {
    linalg::precise_gramian_factors(&g.A, &g.B, &g.C, boundary(g.timebase)).with_operation("Gramians")
}

/// Returns whether a Gramian of a small system is so much larger than the data that its modes beside the boundary have lost digits.
pub(crate) fn is_magnified(g: &StateSpace, factor: &Mat, data: &Mat) -> bool {
    let size = if g.timebase == Timebase::Continuous { g.A.norm_fro() } else { 1.0 };
    g.order() <= PRECISE_SIZE
        && factor.norm_fro().powi(2) * size > MAGNIFIED_GRAMIAN * data.norm_fro().powi(2)
}

/// Returns whether what rows `C` see of the states of a small system, whose Gramian has the factor `R`, is so small beside the states in the units in which the factor was
/// computed, as at the end of a chain, that rounding errors of the other states have cost it digits.
pub(crate) fn is_faded(g: &StateSpace, C: &Mat, R: &Mat) -> bool {
    let balanced = if g.order() <= PRECISE_SIZE { linalg::balance(&g.A).ok() } else { None };
    let Some(linalg::BalancedMatrix { scale: d, .. }) = balanced else { return false };
    let size = |M: &Mat, power: i32| {
        Mat::from_fn(M.nrows(), M.ncols(), |i, j| M[(i, j)] * d[i].powi(power)).norm_fro()
    };
    (C * R).norm_fro() <= FADED_OUTPUT * size(&C.t(), 1) * size(R, -1)
}

/// Returns whether an eigenvalue of a small system that is not stable in doubles is not on the boundary of stability as far as the entries of A can tell,
/// so that only its rounding may have moved it there.
pub(crate) fn is_lightly_damped(g: &StateSpace, eigenvalue: C64) -> Result<bool, Error> {
    let boundary = boundary(g.timebase);
    let is_near = boundary.excess(eigenvalue).abs() <= SUSPECT_POLE * g.A.norm_fro().max(eigenvalue.norm());
    if g.order() > PRECISE_SIZE || !is_near {
        return Ok(false);
    }
    Ok(linalg::boundary_eigenvalues(&g.A, boundary).with_operation("Gramians")?.is_empty())
}

/// Returns the Hankel values, largest first: the square roots of the eigenvalues of P Q, from the factors.
///
/// # Errors
/// [`Error::Pole`] for a system that is not stable.
pub fn hankel_values(g: &StateSpace) -> Result<Vec<f64>, Error> {
    let (R, L) = gramian_factors(g)?;
    linalg::singular_values(&(&L.t() * &R)).with_operation("Hankel values")
}

/// Returns the Hankel norm, the largest Hankel value.
///
/// # Errors
/// [`Error::Pole`] for a system that is not stable.
pub fn hankelnorm(g: &StateSpace) -> Result<f64, Error> {
    Ok(hankel_values(g)?.first().copied().unwrap_or(0.0))
}

/// Returns the error that names the least stable pole.
fn instability_error(what: &'static str, g: &StateSpace) -> Result<Error, Error> {
    let poles = poles(g)?;
    let outside = poles.iter().filter(|&&p| !is_stable_pole(p, g.timebase));
    let worst = outside.max_by(|a, b| a.re.total_cmp(&b.re)).or(poles.last()).copied().unwrap_or_default();
    Ok(Error::Pole { what, re: worst.re, im: worst.im, problem: "is not inside the region of stability" })
}
