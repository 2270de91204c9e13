//! The control that a ramp of the demand asks for.

use counterpoise_controller::{Controller, PathSignal};
use counterpoise_lti::StateSpace;

use crate::sampling::sampled_plant;
use crate::{DesignPlant, Error, Sampling};

/// Fewest and most samples of a ramp that are computed. A loop is faster than the fewest only if it is as fast as its samples.
const SAMPLES: std::ops::RangeInclusive<f64> = 100.0..=200_000.0;

/// Returns the largest control, in V, while the linear sampled loop begins to follow a demand that rises by 1 unit a second, within a
/// duration. As the loop is linear, the same control brakes the machine when the ramp ends.
///
/// # Errors
/// [`Error::Lti`], [`Error::Controller`].
pub fn control_of_ramp(
    plant: &DesignPlant,
    controller: &Controller,
    sampling: &Sampling,
    duration_s: f64,
) -> Result<f64, Error> {
    let plant = sampled_plant(plant, sampling)?;
    let readings = [PathSignal::Demand, PathSignal::HubRate].map(|signal| signal.reading().unwrap_or(0));
    let controller = controller.linear(sampling.out_of_balance_kg_m)?.select(&[0], &readings);
    let samples = (duration_s / sampling.period_s).ceil().clamp(*SAMPLES.start(), *SAMPLES.end());
    let (mut x, mut z) = (vec![0.0; plant.order()], vec![0.0; controller.order()]);
    let mut largest = 0.0_f64;
    for k in 0..samples as usize {
        let demand = k as f64 * sampling.period_s;
        // The plant is strictly proper under its hold: the reading needs no control of the same sample.
        let reading = output(&plant, &x, &[0.0]);
        let control = output(&controller, &z, &[demand, reading]);
        largest = largest.max(control.abs());
        x = next(&plant, &x, &[control]);
        z = next(&controller, &z, &[demand, reading]);
    }
    Ok(largest)
}

fn output(system: &StateSpace, x: &[f64], u: &[f64]) -> f64 {
    let states: f64 = x.iter().enumerate().map(|(j, x)| system.C[(0, j)] * x).sum();
    states + u.iter().enumerate().map(|(j, u)| system.D[(0, j)] * u).sum::<f64>()
}

fn next(system: &StateSpace, x: &[f64], u: &[f64]) -> Vec<f64> {
    let row = |i: usize| {
        let states: f64 = x.iter().enumerate().map(|(j, x)| system.A[(i, j)] * x).sum();
        states + u.iter().enumerate().map(|(j, u)| system.B[(i, j)] * u).sum::<f64>()
    };
    (0..x.len()).map(row).collect()
}
