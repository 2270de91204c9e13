//! A second-order sensor driven by a rate that is known at the nodes of each step.

use super::moments::{Moments, cardinal_weights};
use super::tables::DEEPEST;
use counterpoise_linalg::Mat;
use counterpoise_models::Sensor;
use nalgebra::{Matrix2, Matrix2x4, Vector2, Vector4};

/// Answers of the sensor over one step.
#[derive(Debug, Clone, Copy)]
struct FilterStep {
    phi: Matrix2<f64>,
    nodes: Matrix2x4<f64>,
}

/// y'' + 2 z w y' + w^2 y = w^2 r, stepped exactly for a cubic r.
#[derive(Debug, Clone)]
pub(crate) struct Filter {
    levels: Vec<FilterStep>,
}

impl Filter {
    /// Returns the filter of a sensor over steps of `period_s` halved up to [`DEEPEST`] times.
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

    /// Returns the rows from \[y, y', input at the four nodes\] to the state after a step at a level; `None` if the sensor is ideal.
    pub fn rows(&self, level: usize) -> Option<[[f64; 6]; 2]> {
        let step = self.levels.get(level)?;
        let (phi, nodes) = (&step.phi, &step.nodes);
        Some(
            [0, 1].map(|i| {
                [phi[(i, 0)], phi[(i, 1)], nodes[(i, 0)], nodes[(i, 1)], nodes[(i, 2)], nodes[(i, 3)]]
            }),
        )
    }

    /// Returns the state \[y, y'\] after a step at `level`, for the input at the four nodes.
    #[inline]
    pub fn advance(&self, level: usize, state: &mut [f64; 2], input: &[f64; 4]) {
        let Some(step) = self.levels.get(level) else {
            *state = [input[3], 0.0];
            return;
        };
        let mut next = step.phi * Vector2::from(*state);
        // adds the answers node by node
        next.gemv(1.0, &step.nodes, &Vector4::from(*input), 1.0);
        *state = next.into();
    }
}

impl FilterStep {
    fn new(moments: &Moments, step_s: f64) -> Self {
        let weights = cardinal_weights(step_s);
        Self {
            phi: Matrix2::from_fn(|i, j| moments.phi(i, j)),
            nodes: Matrix2x4::from_fn(|row, node| moments.answer(row, 0, &weights[node])),
        }
    }
}
