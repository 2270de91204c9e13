//! The contributions to a loop's noise floor: the noise and the step of its reading, and what rounding keeps up.

use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, lft};
use counterpoise_models::QuantityKind;

use super::elements::{ElementLoop, Elements, Learning};
use super::floor::{ReadingNoise, Subject};
use crate::Error;
use crate::linear_loop::plant::port;
use crate::tolerance::{ROUNDED_STEP, RUN_S};

/// Returns what the noise floor of a case is made of.
///
/// # Errors
/// Those of the linear loop at rest, which a floor needs if the loop controls anything but a rate.
pub(super) fn reading_noise(subject: &Subject<'_>) -> Result<ReadingNoise, Error> {
    let parameters = subject.case.plant.parameters();
    let (sensor, interface) = (&parameters.sensors.hub_gyro, &parameters.interface);
    let is_rate = subject.controlled_quantity().kind == QuantityKind::Rate;
    Ok(ReadingNoise {
        white_rad_s: sensor.white_noise_rms(interface.sample_period_s),
        step_rad_s: interface.reading_step(sensor),
        rounding: if is_rate { 0.0 } else { rounding(subject)? },
    })
}

/// Returns the RMS of what rounding keeps up in the controlled quantity: the rounding of the control as white noise in the closed loop at
/// rest (B. Widrow, 1956), over the time of a run, and a share of the step for the arithmetic of the run itself. A loop that is
/// unstable at rest passes on no noise that could be told from its motion: there the share alone counts.
fn rounding(subject: &Subject<'_>) -> Result<f64, Error> {
    let arithmetic = ROUNDED_STEP * subject.procedure.step.rate_rad_s.abs();
    let linear = ElementLoop::close(subject, &Elements::at_rest(subject)?, Learning::Still)?;
    if linear.largest_pole().norm() >= 1.0 {
        return Ok(arithmetic);
    }
    let interface = &subject.case.plant.parameters().interface;
    let readings = port::FIRST_READING..linear.plant.sampled.outputs();
    let outputs: Vec<usize> = std::iter::once(port::HUB).chain(readings).collect();
    let opened = linear.plant.sampled.select(&outputs, &[port::CONTROL, port::CONTROL]);
    let closed = lft(&opened, &linear.controller)?;
    let samples = (RUN_S / interface.sample_period_s) as usize;
    Ok((impulse_energy(&closed, samples).sqrt() * interface.control_step_v() / 12f64.sqrt())
        .hypot(arithmetic))
}

/// Returns the sum of the squares of a discrete impulse response over a number of samples: D^2 + C W C' with W = sum of A^k B B' A'^k, whose
/// terms are doubled and one is added, by the binary digits of their number.
fn impulse_energy(system: &StateSpace, samples: usize) -> f64 {
    let (A, driven) = (&system.A, &system.B * &system.B.t());
    let (mut sum, mut power) = (driven.scale(0.0), Mat::eye(system.order()));
    for digit in (0..usize::BITS - samples.leading_zeros()).rev() {
        sum = &sum + &(&power * &sum * power.t());
        power = &power * &power;
        if (samples >> digit) & 1 == 1 {
            sum = &driven + &(A * &sum * A.t());
            power = A * &power;
        }
    }
    system.D[(0, 0)].powi(2) + (&system.C * &sum * system.C.t())[(0, 0)]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use counterpoise_lti::Timebase;

    #[test]
    fn the_energy_is_that_of_the_samples_one_by_one() {
        let A = Mat::from_rows(&[[0.9, 0.3], [-0.2, 0.7]]);
        let (B, C) = (Mat::col(&[0.4, -1.0]), Mat::row(&[2.0, 0.5]));
        let timebase = Timebase::Discrete { period_s: 1e-3 };
        let system = StateSpace::new(A, B, C, Mat::row(&[0.3]), timebase).unwrap();
        for samples in [0, 1, 2, 7, 100] {
            let (mut state, mut expected) = (system.B.clone(), 0.3_f64.powi(2));
            for _ in 0..samples {
                expected += (&system.C * &state)[(0, 0)].powi(2);
                state = &system.A * &state;
            }
            let found = impulse_energy(&system, samples);
            assert!((found - expected).abs() < 1e-12 * expected, "{samples}: {found} {expected}");
        }
    }
}
