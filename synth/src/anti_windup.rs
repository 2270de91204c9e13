//! The way in which a controller's states follow the limited control.

use counterpoise_linalg as linalg;
use counterpoise_linalg::{Mat, dare};
use counterpoise_lti::StateSpace;
use counterpoise_lti::response::Response;

use crate::Error;

/// The gain g of x\[k+1\] = A x + B y + g (limited - unlimited control), as a filter's gain: A - g C is stable whatever A
/// is, and as quick as the loop itself.
///
/// While the limiter holds, the controller runs as x\[k+1\] = (A - g C) x + ...: g solves the filter equation of the
/// controller's states driven by its inputs, with the controller's gain at the loop's crossover as the noise.
pub(crate) fn anti_windup(path: &StateSpace, plant: &StateSpace) -> Result<Vec<f64>, Error> {
    let all: Vec<usize> = (0..path.inputs()).collect();
    anti_windup_of(path, plant, &all)
}

/// The same with some of the inputs as what drives the states. Of a cascade it is the error alone: that the state which holds the
/// reading before has another reading is no error, and the integral of the rate loop shall unwind as fast as that loop is.
pub(crate) fn anti_windup_of(
    path: &StateSpace,
    plant: &StateSpace,
    inputs: &[usize],
) -> Result<Vec<f64>, Error> {
    if path.order() == 0 {
        return Ok(Vec::new());
    }
    let driven = path.select(&[0], inputs);
    let gain = gain_at_crossover(path, &driven, plant)?;
    let R = Mat::eye(1).scale(gain * gain);
    let Q = &driven.B * &driven.B.t();
    match dare(&path.A.t(), &path.C.t(), &Q, &R, None)? {
        linalg::Outcome::Solved(solution) => Ok(solution.F.as_slice().to_vec()),
        linalg::Outcome::Infeasible(_) => Err(Error::System {
            what: "controller",
            problem: "a state that is not stable does not show in the control",
        }),
    }
}

/// Modulus of the largest gain of the path's driving inputs where the loop's gain last falls through 1 (or where the loop's gain is
/// largest, if it never exceeds 1).
fn gain_at_crossover(path: &StateSpace, driven: &StateSpace, plant: &StateSpace) -> Result<f64, Error> {
    let (path, driven, plant) = (Response::of(path)?, Response::of(driven)?, Response::of(plant)?);
    let mut at_peak = (0.0, 1.0);
    for k in (0..=120).rev() {
        let rate = 10f64.powf(-1.0 + 4.5 * f64::from(k) / 120.0);
        let (Ok(controller), Ok(response)) = (path.at(rate), plant.at(rate)) else { continue };
        let gain = driven.at(rate).map_or(0.0, |driven| driven.norm_max());
        let product = controller.norm_max() * response.norm_max();
        if product >= 1.0 {
            return Ok(gain);
        }
        if product > at_peak.0 {
            at_peak = (product, gain);
        }
    }
    Ok(at_peak.1)
}
