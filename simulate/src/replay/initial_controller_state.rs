//! The states of an exported controller at the first sample of a recording.
//!
//! The readings were recorded, so the control is a known function of the states at the start: linear but for the limiter, the friction
//! observers and the schedule. Gauss and Newton's method fits them to the first recorded controls. If the controller at its start
//! already gives the recorded control, it is taken as it is: most recordings begin when the controller does.

use counterpoise_controller::{Controller, Readings, Runner, SampledController};
use counterpoise_models::CONVERTER_RANGE_V;
use counterpoise_recordings::{Channel, Recording};
use nalgebra::{DMatrix, DVector};

use super::normal_equations::squares;
use super::recorded_readings::recorded_readings;
use crate::tolerance::{
    CONTROLLER_STATE_ITERATIONS, CONTROLLER_STATE_NOISE_V, CONTROLLER_STATE_SAMPLES, CONTROLLER_STATE_STEP,
};

/// Returns the controller with the states at the first sample that fit the recorded control; `None` if demand, hub rate or control was
/// not recorded.
pub(super) fn fit_initial_states(controller: &Controller, recording: &Recording) -> Option<Runner> {
    let read = recorded_readings(recording)?;
    let control = recording.samples(Channel::Control)?;
    let span = read.len().min(CONTROLLER_STATE_SAMPLES);
    let fit = Fit::new(controller, &read[..span], &control[..span]);
    let start = controller.runner().states();
    let mut best = (start.clone(), fit.cost(&start));
    for _ in 0..CONTROLLER_STATE_ITERATIONS {
        let Some(moved) = fit.improve_states(&best.0) else { break };
        let cost = fit.cost(&moved);
        if cost.is_nan() || cost >= best.1 {
            break;
        }
        best = (moved, cost);
    }
    Some(controller.runner().with_states(&best.0))
}

struct Fit<'a> {
    controller: &'a Controller,
    read: &'a [Readings],
    control: &'a [f64],
    /// The motion of each state while the controller follows the recorded readings: the standard deviation expected of its start.
    spread: Vec<f64>,
}

impl<'a> Fit<'a> {
    fn new(controller: &'a Controller, read: &'a [Readings], control: &'a [f64]) -> Self {
        let mut runner = controller.runner();
        let start = runner.states();
        let mut squared = vec![0.0; start.len()];
        for readings in read {
            runner.step(readings);
            for (sum, (now, first)) in squared.iter_mut().zip(runner.states().iter().zip(&start)) {
                *sum += (now - first) * (now - first);
            }
        }
        let spread = squared.iter().map(|sum| (sum / read.len().max(1) as f64).sqrt()).collect();
        Self { controller, read, control, spread }
    }

    /// Returns recorded less computed control; 0 if the control was not recorded or stood at the converter's limit.
    fn residuals(&self, states: &[f64]) -> Vec<f64> {
        let mut runner = self.controller.runner().with_states(states);
        let one = |(readings, recorded): (&Readings, &f64)| {
            let left = recorded - runner.step(readings);
            if left.is_finite() && recorded.abs() < CONVERTER_RANGE_V { left } else { 0.0 }
        };
        self.read.iter().zip(self.control).map(one).collect()
    }

    fn cost(&self, states: &[f64]) -> f64 {
        squares(&self.residuals(states))
    }

    /// Returns the states after one step of Gauss and Newton's method with the prior N(start, spread^2) on each; `None` if the
    /// equations are singular.
    fn improve_states(&self, states: &[f64]) -> Option<Vec<f64>> {
        let left = self.residuals(states);
        let moving: Vec<usize> = (0..states.len()).filter(|&i| self.spread[i] > 0.0).collect();
        let column = |&i: &usize| {
            let mut moved = states.to_vec();
            moved[i] += CONTROLLER_STATE_STEP * self.spread[i];
            let changed = self.residuals(&moved);
            changed.iter().zip(&left).map(|(a, b)| (b - a) / CONTROLLER_STATE_STEP).collect::<Vec<f64>>()
        };
        let columns: Vec<Vec<f64>> = moving.iter().map(column).collect();
        let inner = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let n = columns.len();
        let mut matrix = DMatrix::from_fn(n, n, |i, j| inner(&columns[i], &columns[j]));
        (0..n).for_each(|i| matrix[(i, i)] += CONTROLLER_STATE_NOISE_V * CONTROLLER_STATE_NOISE_V);
        let change = matrix.cholesky()?.solve(&DVector::from_fn(n, |i, _| inner(&columns[i], &left)));
        let mut next = states.to_vec();
        moving.iter().zip(change.iter()).for_each(|(&i, z)| next[i] += z * self.spread[i]);
        Some(next)
    }
}
