//! A sensor's input from its readings: deconvolution by a Kalman smoother.

use crate::engine::moments::Moments;
use crate::tolerance::{IDEAL_FREQUENCY, LEAST_NOISE, PRIOR_DEVIATION, ROUGHNESS_DECADES, SETTLED_VARIANCE};
use counterpoise_linalg::Mat;
use counterpoise_models::Sensor;
use nalgebra::{SMatrix, SVector};

/// States of the model: sensor output and its derivative, input and its two derivatives.
const STATES: usize = 5;

type Vector = SVector<f64, STATES>;
type Square = SMatrix<f64, STATES, STATES>;

/// Returns the input of a sensor, sample by sample: r''' is white noise whose strength is the one under which the readings
/// are likeliest (among powers of ten), y'' + 2 z w y' + w^2 y = w^2 r, and the readings are y + noise.
///
/// Readings of pure noise give a parabola through them: the strength shrinks to nothing, and a platform at rest
/// stays at rest. Readings that are NaN are bridged. The answer is the fixed-interval smoother of Bryson and Frazier.
///
/// `noise` is the standard deviation of a reading, quantisation included.
pub(crate) fn sensor_input(readings: &[f64], sensor: &Sensor, noise: f64, period_s: f64) -> Vec<f64> {
    let largest = readings.iter().filter(|r| r.is_finite()).fold(0.0_f64, |a, r| a.max(r.abs()));
    if largest == 0.0 {
        return vec![0.0; readings.len()];
    }
    let model = Model::new(sensor, period_s, noise.max(LEAST_NOISE * largest), largest);
    let unit = (model.noise / period_s.powi(3)).powi(2) * period_s;
    let strengths = (0..ROUGHNESS_DECADES).map(|k| unit * 10f64.powi(2 - k));
    let mut best: Option<(f64, f64)> = None;
    for strength in strengths {
        let likelihood = model.filter(readings, strength, None);
        if best.is_none_or(|(top, _)| likelihood > top) {
            best = Some((likelihood, strength));
        }
    }
    let strength = best.map_or(unit, |(_, strength)| strength);
    let mut pass = Pass::with_capacity(readings.len());
    model.filter(readings, strength, Some(&mut pass));
    model.smooth(&pass)
}

/// The sampled model of sensor and input.
struct Model {
    transition: Square,
    /// Covariance that unit strength adds in a sample.
    added: Square,
    noise: f64,
    prior: Vector,
}

/// The results of the filter for the smoother.
struct Pass {
    predicted: Vec<Vector>,
    covariance: Vec<Square>,
    innovation: Vec<f64>,
}

impl Pass {
    fn with_capacity(n: usize) -> Self {
        Self {
            predicted: Vec::with_capacity(n),
            covariance: Vec::with_capacity(n),
            innovation: Vec::with_capacity(n),
        }
    }
}

impl Model {
    fn new(sensor: &Sensor, period_s: f64, noise: f64, largest: f64) -> Self {
        let w = sensor.natural_frequency_rad_s.min(IDEAL_FREQUENCY * std::f64::consts::TAU / period_s);
        let z = sensor.damping_ratio;
        let A = Mat::from_rows(&[
            &[0.0, 1.0, 0.0, 0.0, 0.0],
            &[-w * w, -2.0 * z * w, w * w, 0.0, 0.0],
            &[0.0, 0.0, 0.0, 1.0, 0.0],
            &[0.0, 0.0, 0.0, 0.0, 1.0],
            &[0.0, 0.0, 0.0, 0.0, 0.0],
        ]);
        let drive = Mat::col(&[0.0, 0.0, 0.0, 0.0, 1.0]);
        let end = Moments::family(&A, &drive, period_s, 1).remove(0);
        let scale = PRIOR_DEVIATION * (largest + noise);
        Self {
            transition: square(&end),
            added: added_covariance(&A, period_s),
            noise,
            prior: Vector::from([scale, scale * w, scale, scale * w, scale * w * w]),
        }
    }

    /// Returns the log-likelihood of the readings, up to a constant.
    fn filter(&self, readings: &[f64], strength: f64, mut pass: Option<&mut Pass>) -> f64 {
        let mut x = Vector::zeros();
        let mut P = Square::from_diagonal(&self.prior.map(|s| s * s));
        let mut likelihood = 0.0;
        let mut settled = false;
        for &reading in readings {
            let innovation = reading - x[0];
            if let Some(pass) = pass.as_deref_mut() {
                pass.predicted.push(x);
                pass.covariance.push(P);
                pass.innovation.push(innovation);
            }
            let variance = P[(0, 0)] + self.noise * self.noise;
            let gain = if reading.is_finite() { P.column(0) / variance } else { Vector::zeros() };
            if reading.is_finite() {
                likelihood -= 0.5 * (variance.ln() + innovation * innovation / variance);
                x += gain * innovation;
            }
            x = self.transition * x;
            if !(settled && reading.is_finite()) {
                let next = self.propagate(&P, &gain, strength);
                settled = reading.is_finite() && nearly_equal(&next, &P);
                P = next;
            }
        }
        likelihood
    }

    /// F (P - K P_0) F' + Q.
    fn propagate(&self, P: &Square, gain: &Vector, strength: f64) -> Square {
        let kept = P - gain * P.row(0);
        let mut next = self.transition * kept * self.transition.transpose();
        for i in 0..STATES {
            for j in 0..=i {
                let mean = 0.5 * (next[(i, j)] + next[(j, i)]) + strength * self.added[(i, j)];
                next[(i, j)] = mean;
                next[(j, i)] = mean;
            }
        }
        next
    }

    /// Bryson and Frazier's backward pass: x = x_predicted - P lambda.
    fn smooth(&self, pass: &Pass) -> Vec<f64> {
        let n = pass.predicted.len();
        let mut input = vec![0.0; n];
        let back = self.transition.transpose();
        let mut later = Vector::zeros();
        for k in (0..n).rev() {
            let P = &pass.covariance[k];
            let mut lambda = if k + 1 == n { Vector::zeros() } else { back * later };
            if pass.innovation[k].is_finite() {
                let variance = P[(0, 0)] + self.noise * self.noise;
                let along: f64 = (0..STATES).map(|i| P[(i, 0)] * lambda[i]).sum();
                lambda[0] -= (along + pass.innovation[k]) / variance;
            }
            let correction: f64 = (0..STATES).map(|j| P[(2, j)] * lambda[j]).sum();
            input[k] = pass.predicted[k][2] - correction;
            later = lambda;
        }
        input
    }
}

/// Covariance that white noise of unit strength at the input's third derivative adds in a period, by Simpson's rule
/// on the integral of Phi g g' Phi'.
fn added_covariance(A: &Mat, period_s: f64) -> Square {
    const INTERVALS: usize = 32;
    let step = period_s / INTERVALS as f64;
    let one = Moments::family(A, &Mat::col(&[0.0; STATES]), step, 1).remove(0);
    let phi = square(&one);
    let mut direction = Vector::from([0.0, 0.0, 0.0, 0.0, 1.0]);
    let mut sum = Square::zeros();
    for k in 0..=INTERVALS {
        let weight = if k == 0 || k == INTERVALS { 1.0 } else { 2.0 + 2.0 * (k % 2) as f64 };
        sum += direction * (weight * step / 3.0) * direction.transpose();
        direction = phi * direction;
    }
    sum
}

fn square(moments: &Moments) -> Square {
    Square::from_fn(|i, j| moments.phi(i, j))
}

fn nearly_equal(a: &Square, b: &Square) -> bool {
    (0..STATES).all(|i| (a[(i, i)] - b[(i, i)]).abs() <= SETTLED_VARIANCE * b[(i, i)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::filter::Filter;

    fn readings(truth: impl Fn(f64) -> f64, noise: f64) -> (Vec<f64>, Vec<f64>) {
        let sensor = gyro();
        let filter = Filter::new(&sensor, 1e-3);
        let mut state = [truth(0.0), 0.0];
        let mut seed = 12345_u64;
        let mut uniform = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 33) as f64 / (1u64 << 31) as f64 - 0.5
        };
        let (mut read, mut true_input) = (Vec::new(), Vec::new());
        for k in 0..5000 {
            let t = f64::from(k) * 1e-3;
            read.push(state[0] + noise * 12f64.sqrt() * uniform());
            true_input.push(truth(t));
            filter.advance(0, &mut state, &crate::engine::moments::NODES.map(|c| truth(t + c * 1e-3)));
        }
        (read, true_input)
    }

    fn gyro() -> Sensor {
        Sensor { natural_frequency_rad_s: 377.0, ..Sensor::IDEAL }
    }

    fn error(found: &[f64], expected: &[f64]) -> f64 {
        let sum: f64 = found.iter().zip(expected).map(|(a, b)| (a - b).powi(2)).sum();
        (sum / found.len() as f64).sqrt()
    }

    #[test]
    fn motion_is_recovered_far_below_the_noise() {
        let truth = |t: f64| 0.1 * (9.0 * t).sin() + 0.03 * (31.0 * t + 1.0).sin();
        let (read, expected) = readings(truth, 2e-4);
        let found = sensor_input(&read, &gyro(), 2e-4, 1e-3);
        assert!(error(&found, &expected) < 0.35 * 2e-4, "{}", error(&found, &expected));
    }

    #[test]
    fn a_still_platform_stays_still() {
        let (mut read, expected) = readings(|_| 0.0, 2e-4);
        read[100] = f64::NAN;
        let found = sensor_input(&read, &gyro(), 2e-4, 1e-3);
        assert!(error(&found, &expected) < 0.05 * 2e-4, "{}", error(&found, &expected));
    }
}
