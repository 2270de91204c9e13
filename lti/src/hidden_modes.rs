//! Modes on the boundary of stability that the response of a system does not contain: no input reaches them, or no output sees them.

use std::f64::consts::TAU;

use crate::components::components;
use crate::error::OperationContext;
use crate::roots::poles_on_boundary;
use crate::tolerance::{
    ABSENT_RESIDUE, CONTOUR_POINTS, CONTOUR_RADIUS, MOST_HIDDEN_MODES, NEAR_CENTRE, SAME_BOUNDARY_POLE,
};
use crate::{C64, Error, Mat, StateSpace, Timebase};
use counterpoise_linalg::{self as linalg, Schur, StateRealisation};

/// Returns the system without its modes on the boundary of stability if the response contains none of them; `None` if it contains one, or if the
/// modes are too close to others to be told apart. The system is balanced.
///
/// A mode is absent from the response if the moments of the response over a circle about its pole, of which the first is the residue, vanish
/// beside the response on the circle, entry by entry. The response is computed with residuals in twice the working precision, and the circle is
/// small beside the distance of the other poles, so that a residue is found of 1e-18 of what the other poles contribute: a mode counts as absent if
/// the entries of the system, taken as exact, say so.
///
/// # Errors
/// [`Error::Matrix`] if the Schur form cannot be computed.
pub(crate) fn without_hidden_modes(g: &StateSpace) -> Result<Option<StateSpace>, Error> {
    let mut form = linalg::schur(&g.A).with_operation("modes on the boundary")?;
    let all = form.eigenvalues();
    let centres: Vec<C64> = poles_on_boundary(g)?.into_iter().flat_map(|p| [p, p.conj()]).collect();
    let size = all.iter().map(|pole| pole.norm()).fold(1.0, f64::max);
    let is_apart =
        |pole: C64| centres.iter().all(|centre| (pole - centre).norm() > SAME_BOUNDARY_POLE * size);
    let (kept, hidden): (Vec<C64>, Vec<C64>) = all.iter().partition(|&&pole| is_apart(pole));
    if hidden.is_empty() || hidden.len() > MOST_HIDDEN_MODES {
        return Ok(None);
    }
    for &centre in centres.iter().filter(|centre| centre.im >= 0.0) {
        if !is_absent(g, centre, &kept, &hidden) {
            return Ok(None);
        }
    }
    let count = form.reorder(is_apart).with_operation("modes on the boundary")?;
    leading_part(g, &form, count).map(Some)
}

/// Returns whether a pole that can be read off A, that of a state that acts on no state that acts on it, is exactly on the boundary of stability. An
/// eigenvalue iteration on the whole of A leaves a rounding error of it, on either side.
pub(crate) fn has_lone_boundary_pole(g: &StateSpace) -> bool {
    let is_candidate = |i: usize| match g.timebase {
        Timebase::Continuous => g.A[(i, i)] == 0.0,
        Timebase::Discrete { .. } => g.A[(i, i)].abs() == 1.0,
    };
    (0..g.order()).any(is_candidate)
        && components(&g.A).iter().any(|group| group.len() == 1 && is_candidate(group[0]))
}

/// Returns whether the response contains no mode at a centre, where `hidden` are the poles near any centre and `kept` the others.
fn is_absent(g: &StateSpace, centre: C64, kept: &[C64], hidden: &[C64]) -> bool {
    let distance = |pole: &C64| (pole - centre).norm();
    let mut far: Vec<f64> = kept.iter().map(distance).collect();
    let largest = kept.iter().chain(hidden).map(|pole| pole.norm()).fold(0.0, f64::max);
    far.extend(hidden.iter().map(distance).filter(|&d| d > SAME_BOUNDARY_POLE * largest.max(1.0)));
    let nearest = far.iter().copied().fold(f64::INFINITY, f64::min);
    let radius = CONTOUR_RADIUS * if nearest.is_finite() { nearest } else { largest.max(1.0) };
    let spread = hidden.iter().map(distance).filter(|&d| d < nearest).fold(0.0, f64::max);
    if spread > NEAR_CENTRE * radius {
        return false;
    }
    let system = StateRealisation { A: &g.A, B: &g.B, C: &g.C, D: &g.D };
    let turns: Vec<C64> =
        (0..CONTOUR_POINTS).map(|k| C64::from_polar(1.0, TAU * k as f64 / CONTOUR_POINTS as f64)).collect();
    let responses: Result<Vec<_>, _> =
        turns.iter().map(|turn| linalg::refined_transfer(system, centre + turn * radius)).collect();
    let Ok(responses) = responses else { return false };
    let count = hidden.len() as i32;
    (0..g.outputs()).all(|i| {
        (0..g.inputs()).all(|j| {
            let largest = responses.iter().map(|H| H[(i, j)].norm()).fold(0.0, f64::max);
            let moment = |power: i32| -> C64 {
                responses.iter().zip(&turns).map(|(H, turn)| H[(i, j)] * turn.powi(power)).sum()
            };
            let limit = ABSENT_RESIDUE * largest * CONTOUR_POINTS as f64;
            (1..=count).all(|power| moment(power).norm() <= limit)
        })
    })
}

/// Returns the part of a system that belongs to the first `count` states of its Schur form, the others decoupled from it.
fn leading_part(g: &StateSpace, form: &Schur, count: usize) -> Result<StateSpace, Error> {
    let (n, m, p) = (g.order(), g.inputs(), g.outputs());
    let rest = n - count;
    let (T11, T22) = (form.T.block(0, 0, count, count), form.T.block(count, count, rest, rest));
    let X = if count == 0 {
        Mat::zeros(0, rest)
    } else {
        let coupling = -form.T.block(0, count, count, rest);
        linalg::sylvester(&T11, &-T22, &coupling).with_operation("modes on the boundary")?
    };
    let (B, C) = (&form.U.t() * &g.B, &g.C * &form.U);
    let B1 = &B.block(0, 0, count, m) - &(&X * &B.block(count, 0, rest, m));
    StateSpace::new(T11, B1, C.block(0, 0, p, count), g.D.clone(), g.timebase)
}
