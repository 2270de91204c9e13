//! A road under the left and the right wheels: how alike the two tracks are, and how the body rolls.
//!
//! The surface is taken as isotropic, so that two tracks at a distance t, both of density G(n) = c n^-2, have the coherence function
//!
//! ```text
//!     g(n) = x K_1(x),      x = 2 pi n t
//! ```
//!
//! with Bessel's modified function K_1 (K. Kamash and J. Robson, The application of isotropy in road surface modelling, Journal of Sound and
//! Vibration 57, 1978). Their mean has the density G (1 + g)/2, half of their difference G (1 - g)/2, and the two are uncorrelated.
//! In a vehicle with equal sides the mean moves heave and pitch alone, and the difference roll alone.

use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};

use super::vehicle::{Sides, Vehicle};
use crate::Error;

/// Returns x K_1(x) from K_1(x) = integral of exp(-x cosh t) cosh t over t >= 0 by the trapezoidal rule, whose error falls faster than
/// any power of its step for this integrand.
pub fn coherence_function(x: f64) -> f64 {
    const STEP: f64 = 0.05;
    if x <= 0.0 {
        return 1.0;
    }
    // beyond, exp(-x cosh t) is below 1e-17 of its start
    let last = (1.0 + 40.0 / x).acosh();
    let count = (last / STEP).ceil() as usize;
    let value = |t: f64| (-x * (t.cosh() - 1.0)).exp() * t.cosh();
    let sum: f64 = 0.5 + (1..=count).map(|k| value(STEP * k as f64)).sum::<f64>();
    x * (-x).exp() * STEP * sum
}

/// Half the differences of the road's heights at front and rear axle (m) to roll rate (left side up, rad/s) and roll acceleration.
///
/// ```text
///     I phi'' = s b (d_f + d_r - 2 b phi) + c b (d_f' + d_r' - 2 b phi'),    b = t / 2
///     m d''   = s (b phi - d) + c (b phi' - d') + k (r - d)                  at each axle
/// ```
///
/// # Errors
/// Those of the state-space system.
pub(super) fn roll_dynamics(v: Vehicle, sides: Sides) -> Result<StateSpace, Error> {
    let b = 0.5 * sides.track_m;
    let (s, c, m) = (v.suspension_n_m, v.damping_n_s_m, v.axle_mass_kg);
    // roll, then half the difference of the wheels' heights at front and rear, then their rates
    let force = |coefficient: f64| {
        let body = coefficient * b / sides.roll_inertia_kg_m2;
        [
            [-2.0 * b * body, body, body],
            [coefficient * b / m, -coefficient / m, 0.0],
            [coefficient * b / m, 0.0, -coefficient / m],
        ]
    };
    let (springs, dampers, tyre) = (force(s), force(c), v.tyre_n_m / m);
    let A = Mat::from_fn(6, 6, |i, j| match (i, j) {
        (0..3, 3..) if j == i + 3 => 1.0,
        (0..3, _) => 0.0,
        (_, 0..3) => springs[i - 3][j] - if i - 3 == j && j > 0 { tyre } else { 0.0 },
        _ => dampers[i - 3][j - 3],
    });
    let B = Mat::from_fn(6, 2, |i, j| if i == 4 + j { tyre } else { 0.0 });
    let C = Mat::from_fn(2, 6, |i, j| match (i, j) {
        (0, 3) => 1.0,
        (0, _) => 0.0,
        _ => A[(3, j)],
    });
    Ok(StateSpace::new(A, B, C, Mat::zeros(2, 2), Timebase::Continuous)?)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use counterpoise_lti::{Response, dcgain, poles};

    #[test]
    fn the_coherence_function_is_bessels() {
        // x K_1(x) by Abramowitz and Stegun, Handbook of Mathematical Functions, table 9.8
        for (x, expected) in
            [(0.1, 0.985_384_478_1), (1.0, 0.601_907_230_2), (2.0, 0.279_731_763_6), (5.0, 0.020_223_067)]
        {
            assert!((coherence_function(x) - expected).abs() < 1e-8, "{x}: {}", coherence_function(x));
        }
        assert!((coherence_function(1e-9) - 1.0).abs() < 1e-9);
        assert!(coherence_function(800.0) >= 0.0);
    }

    #[test]
    fn a_body_on_tilted_ground_leans_with_it() {
        let sides = Sides { track_m: 2.2, roll_inertia_kg_m2: 9_000.0, pivot_height_m: 1.0 };
        let g = roll_dynamics(Vehicle::HEAVY, sides).unwrap();
        assert!(poles(&g).unwrap().iter().all(|pole| pole.re < 0.0));
        assert!(dcgain(&g).unwrap().norm_max() < 1e-9, "ground at rest turns nothing");
        // slowly: roll rate over the rate of the ground's tilt, both axles together
        let slow = 0.01;
        let at = Response::of(&g).unwrap().at(slow).unwrap();
        let roll = (at[(0, 0)] + at[(0, 1)]) / (counterpoise_linalg::C64::new(0.0, slow));
        assert!((roll.re - 2.0 / sides.track_m).abs() < 1e-3, "{roll}");
    }
}
