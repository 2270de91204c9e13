//! Time histories of the linear loop, exact at the samples.

use counterpoise_linalg::Mat;
use counterpoise_lti::lsim;

use super::plant::port;
use super::{Closed, SampledPlant};
use crate::history::{Experiment, History, integrate};
use crate::procedure::{Step, Triangle};
use crate::{Arrangement, Error, HeaveAndPitch, Model, Source};

/// Returns the response to a step of the demand.
///
/// # Errors
/// Those of the simulation.
pub fn step(plant: &SampledPlant, closed: &Closed, step: Step) -> Result<History, Error> {
    run(plant, closed, Experiment::Step, step.duration_s, |_| LoopInputs::demand(step.rate_rad_s))
}

/// Returns the response to a triangle of the demand.
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
    run(plant, closed, Experiment::Triangle, duration_s, |time_s| LoopInputs::demand(demand.at(time_s)))
}

/// Returns the response to platform motion: `motion` is that motion over time in s.
///
/// # Errors
/// Those of the simulation.
pub fn disturbance(
    plant: &SampledPlant,
    closed: &Closed,
    source: Source,
    arrangement: Arrangement,
    duration_s: f64,
    motion: impl Fn(f64) -> HeaveAndPitch,
) -> Result<History, Error> {
    let inputs = |time_s: f64| LoopInputs { demand_rad_s: 0.0, platform: motion(time_s) };
    run(plant, closed, Experiment::Disturbance(source, arrangement), duration_s, inputs)
}

/// The inputs of the closed loop at a time.
#[derive(Debug, Clone, Copy)]
struct LoopInputs {
    demand_rad_s: f64,
    platform: HeaveAndPitch,
}

impl LoopInputs {
    /// A demand while the platform is at rest.
    fn demand(demand_rad_s: f64) -> Self {
        Self { demand_rad_s, platform: HeaveAndPitch::default() }
    }

    /// The inputs in the order of [`Closed::system`].
    fn array(&self) -> [f64; 3] {
        [self.demand_rad_s, self.platform.heave_m_s2, self.platform.pitch_rate_rad_s]
    }
}

fn run(
    plant: &SampledPlant,
    closed: &Closed,
    experiment: Experiment,
    duration_s: f64,
    inputs: impl Fn(f64) -> LoopInputs,
) -> Result<History, Error> {
    let period_s = plant.sample_period_s;
    let samples = (duration_s / period_s).round() as usize + 1;
    let time_s: Vec<f64> = (0..samples).map(|k| k as f64 * period_s).collect();
    let driven: Vec<LoopInputs> = time_s.iter().map(|&t| inputs(t)).collect();
    let u = Mat::from_fn(samples, 3, |k, j| driven[k].array()[j]);
    let y = lsim(&closed.system, &u, None)?;
    let column = |j: usize| y.column(j).to_vec();
    let hub = column(port::HUB);
    // A loop of a torque or a current has it in the place of the hub's rate.
    let moving = if plant.controls_effort { column(port::TIP) } else { hub.clone() };
    let relative = moving.iter().zip(&driven).map(|(rate, inputs)| rate - inputs.platform.pitch_rate_rad_s);
    let travel_rad = if plant.controls_position { hub.clone() } else { integrate(relative, period_s) };
    Ok(History {
        model: Model::Linear,
        experiment,
        demand_rad_s: driven.iter().map(|d| d.demand_rad_s).collect(),
        heave_m_s2: driven.iter().map(|d| d.platform.heave_m_s2).collect(),
        pitch_rate_rad_s: driven.iter().map(|d| d.platform.pitch_rate_rad_s).collect(),
        travel_rad,
        hub_rate_rad_s: hub,
        tip_rate_rad_s: column(port::TIP),
        control_v: column(port::CONTROL_OUT).iter().map(|v| v + plant.holding_v).collect(),
        current_a: column(port::CURRENT),
        contact: Vec::new(),
        time_s,
    })
}
