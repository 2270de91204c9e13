//! Gramians, as matrices and as factors, and the Hankel values.

use crate::error::OperationContext;
use crate::roots::{is_stable_pole, poles};
use crate::{Error, Mat, StateSpace, Timebase};
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

/// Returns both factors, of P and of Q, from one Schur form.
///
/// # Errors
/// [`Error::Pole`] for a system that is not stable.
pub fn gramian_factors(g: &StateSpace) -> Result<(Mat, Mat), Error> {
    let factors = match g.timebase {
        Timebase::Continuous => linalg::lyap_factors(&g.A, &g.B, &g.C),
        Timebase::Discrete { .. } => linalg::dlyap_factors(&g.A, &g.B, &g.C),
    };
    match factors {
        Err(linalg::Error::NotStable { .. }) => Err(instability_error("Gramians", g)?),
        other => other.with_operation("Gramians"),
    }
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
