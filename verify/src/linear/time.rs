//! Time histories of the linear loop, exact at the samples.

use counterpoise_linalg::Mat;
use counterpoise_lti::lsim;

use super::plant::port;
use super::{Closed, SampledPlant};
use crate::history::{Experiment, History, integrated};
use crate::procedure::{Step, Triangle};
use crate::{Arrangement, Error, Model, Source};

/// The response to a step of the demand.
///
/// # Errors
/// Those of the simulation.
pub fn step(plant: &SampledPlant, closed: &Closed, step: Step) -> Result<History, Error> {
    run(plant, closed, Experiment::Step, step.duration_s, |_| (step.rate_rad_s, 0.0, 0.0))
}

/// The response to a triangle of the demand.
///
/// # Errors
/// Those of the simulation.
pub fn triangle(
    plant: &SampledPlant,
    closed: &Closed,
    triangle: Triangle,
    duration_s: f64,
) -> Result<History, Error> {
    let demand = triangle.signal();
    run(plant, closed, Experiment::Triangle, duration_s, |time_s| (demand.at(time_s), 0.0, 0.0))
}

/// The response to platform motion: `motion` gives heave (m/s^2) and pitch rate (rad/s) at a time.
///
/// # Errors
/// Those of the simulation.
pub fn disturbance(
    plant: &SampledPlant,
    closed: &Closed,
    source: Source,
    arrangement: Arrangement,
    duration_s: f64,
    motion: impl Fn(f64) -> (f64, f64),
) -> Result<History, Error> {
    let inputs = |time_s: f64| {
        let (heave, pitch) = motion(time_s);
        (0.0, heave, pitch)
    };
    run(plant, closed, Experiment::Disturbance(source, arrangement), duration_s, inputs)
}

fn run(
    plant: &SampledPlant,
    closed: &Closed,
    experiment: Experiment,
    duration_s: f64,
    inputs: impl Fn(f64) -> (f64, f64, f64),
) -> Result<History, Error> {
    let period_s = plant.sample_period_s;
    let samples = (duration_s / period_s).round() as usize + 1;
    let time_s: Vec<f64> = (0..samples).map(|k| k as f64 * period_s).collect();
    let driven: Vec<(f64, f64, f64)> = time_s.iter().map(|&t| inputs(t)).collect();
    let u = Mat::from_fn(samples, 3, |k, j| [driven[k].0, driven[k].1, driven[k].2][j]);
    let y = lsim(&closed.system, &u, None)?;
    let column = |j: usize| y.column(j).to_vec();
    let hub = column(port::HUB);
    // A loop of a torque or a current has it in the place of the hub's rate.
    let moving = if plant.controls_effort { column(port::TIP) } else { hub.clone() };
    let relative = moving.iter().zip(&driven).map(|(rate, inputs)| rate - inputs.2);
    let travel_rad = if plant.controls_position { hub.clone() } else { integrated(relative, period_s) };
    Ok(History {
        model: Model::Linear,
        experiment,
        demand_rad_s: driven.iter().map(|d| d.0).collect(),
        heave_m_s2: driven.iter().map(|d| d.1).collect(),
        pitch_rate_rad_s: driven.iter().map(|d| d.2).collect(),
        travel_rad,
        hub_rate_rad_s: hub,
        tip_rate_rad_s: column(port::TIP),
        control_v: column(port::CONTROL_OUT).iter().map(|v| v + plant.holding_v).collect(),
        current_a: column(port::CURRENT),
        contact: Vec::new(),
        time_s,
    })
}
