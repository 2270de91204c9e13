//! Time histories of the linear loop, exact at the samples.

use counterpoise_linalg::Mat;
use counterpoise_lti::lsim;

use super::plant::port;
use super::{ClosedLoop, SampledPlant};
use crate::history::{Experiment, History, HistoryColumn, integrate};
use crate::procedure::{Step, Triangle};
use crate::{Arrangement, Error, HeaveAndPitch, Model, Source};

/// Returns the response to a step of the demand.
///
/// # Errors
/// Those of the simulation.
pub fn simulate_step(plant: &SampledPlant, closed: &ClosedLoop, step: Step) -> Result<History, Error> {
    run(plant, closed, Experiment::Step, step.duration_s, |_| LoopInputs::demand(step.rate_rad_s))
}

/// Returns the response to a triangle of the demand.
///
/// # Errors
/// Those of the simulation.
pub fn simulate_triangle(
    plant: &SampledPlant,
    closed: &ClosedLoop,
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
pub fn simulate_disturbance(
    plant: &SampledPlant,
    closed: &ClosedLoop,
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

    /// The inputs in the order of [`ClosedLoop::system`].
    fn array(&self) -> [f64; 3] {
        [self.demand_rad_s, self.platform.heave_m_s2, self.platform.pitch_rate_rad_s]
    }
}

fn run(
    plant: &SampledPlant,
    closed: &ClosedLoop,
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
    let column = |j: usize| y.column(j).iter().copied();
    // A loop of a torque or a current has it in the place of the hub's rate.
    let moving = column(if plant.controls_effort { port::TIP } else { port::HUB });
    let relative = moving.zip(&driven).map(|(rate, inputs)| rate - inputs.platform.pitch_rate_rad_s);
    let travel_rad =
        if plant.controls_position { column(port::HUB).collect() } else { integrate(relative, period_s) };
    Ok(History::zeros(Model::Linear, experiment, samples)
        .with(HistoryColumn::Time, time_s)
        .with(HistoryColumn::Demand, driven.iter().map(|d| d.demand_rad_s))
        .with(HistoryColumn::Heave, driven.iter().map(|d| d.platform.heave_m_s2))
        .with(HistoryColumn::PitchRate, driven.iter().map(|d| d.platform.pitch_rate_rad_s))
        .with(HistoryColumn::HubRate, column(port::HUB))
        .with(HistoryColumn::TipRate, column(port::TIP))
        .with(HistoryColumn::Control, column(port::CONTROL_OUT).map(|v| v + plant.holding_v))
        .with(HistoryColumn::Current, column(port::CURRENT))
        .with(HistoryColumn::Travel, travel_rad))
}
