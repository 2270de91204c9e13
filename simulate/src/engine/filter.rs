//! A second-order sensor driven by a rate that is known at the nodes of each step.

use super::moments::{Moments, cardinal_weights};
use super::tables::DEEPEST;
use counterpoise_lti::Mat;
use counterpoise_models::Sensor;

/// Answers of the sensor over one step.
#[derive(Debug, Clone, Copy)]
struct FilterStep {
    phi: [[f64; 2]; 2],
    nodes: [[f64; 2]; 4],
}

/// y'' + 2 z w y' + w^2 y = w^2 r, stepped exactly for a cubic r.
#[derive(Debug, Clone)]
pub(crate) struct Filter {
    levels: Vec<FilterStep>,
}

impl Filter {
    /// The filter of a sensor over steps of `period_s` halved up to [`DEEPEST`] times.
    pub fn new(sensor: &Sensor, period_s: f64) -> Self {
        let (w, z) = (sensor.natural_frequency_rad_s, sensor.damping_ratio);
        if w.is_infinite() {
            return Self { levels: Vec::new() };
        }
        let A = Mat::from_rows(&[&[0.0, 1.0], &[-w * w, -2.0 * z * w]]);
        let finest = period_s / f64::from(1u32 << DEEPEST);
        let family = Moments::family(&A, &Mat::col(&[0.0, w * w]), finest, DEEPEST + 1);
        let mut levels: Vec<FilterStep> = family
            .iter()
            .enumerate()
            .map(|(k, moments)| FilterStep::new(moments, finest * f64::from(1u32 << k)))
            .collect();
        levels.reverse();
        Self { levels }
    }

    /// The state \[y, y'\] after a step at `level`, for the input at the four nodes.
    #[inline]
    pub fn advance(&self, level: usize, state: &mut [f64; 2], input: &[f64; 4]) {
        let Some(step) = self.levels.get(level) else {
            *state = [input[3], 0.0];
            return;
        };
        let mut next = [0.0; 2];
        for i in 0..2 {
            next[i] = step.phi[i][0] * state[0] + step.phi[i][1] * state[1];
            for (answer, value) in step.nodes.iter().zip(input) {
                next[i] += answer[i] * value;
            }
        }
        *state = next;
    }
}

impl FilterStep {
    fn new(moments: &Moments, step_s: f64) -> Self {
        let weights = cardinal_weights(step_s);
        let nodes = std::array::from_fn(|node| [0, 1].map(|row| moments.answer(row, 0, &weights[node])));
        Self { phi: [0, 1].map(|i| [0, 1].map(|j| moments.phi(i, j))), nodes }
    }
}
