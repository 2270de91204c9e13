//! One experiment on a simulated machine.

use counterpoise_controller::SampledController;
use counterpoise_diagnose::experiment::ExperimentExtremes;
use counterpoise_models::{Parameters, Plant};
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::{
    Detail, Imperfections, Initial, PlatformMotion, Scenario, Signal, Simulator, TimeHistory,
};

use crate::PipelineError;
use crate::tolerance::SAME_CLOCK;

/// The request of a run: demand and motion of the base, sample by sample.
#[derive(Debug, Clone, PartialEq)]
pub struct RunRequest {
    /// Sample period, s.
    pub sample_period_s: f64,
    /// Demand, in the unit of what the loop controls.
    pub demand: Vec<f64>,
    /// Pitch rate of the base, rad/s; empty if the base stands still.
    pub platform_rate_rad_s: Vec<f64>,
    /// Heave of the base, m/s^2; empty if the base stands still.
    pub platform_accel_m_s2: Vec<f64>,
    /// Hub angle at the start, rad.
    pub start_angle_rad: f64,
}

/// A run of a simulated machine.
#[derive(Debug, Clone, PartialEq)]
pub struct MachineRun {
    /// The recording of its sensors and its controller.
    pub recording: Recording,
    /// The largest angle from the start and the largest rate, both from the base, and the largest current of the machine.
    pub reached: ExperimentExtremes,
}

impl RunRequest {
    /// Returns whether the base moves.
    pub fn moves_base(&self) -> bool {
        !self.platform_rate_rad_s.is_empty()
    }

    /// Returns whether a recording has the sample period of the run.
    pub fn has_clock_of(&self, recording: &Recording) -> bool {
        (recording.sample_period_s / self.sample_period_s - 1.0).abs() <= SAME_CLOCK
    }

    /// Returns the scenario of the run, with noise from a seed.
    fn scenario(&self, seed: u64) -> Scenario {
        let samples = |values: &[f64]| match values.is_empty() {
            true => Signal::ZERO,
            false => Signal::Samples { period_s: self.sample_period_s, values: values.to_vec() },
        };
        Scenario {
            demand_rad_s: Signal::Held { period_s: self.sample_period_s, values: self.demand.clone() },
            platform: PlatformMotion {
                heave_m_s2: samples(&self.platform_accel_m_s2),
                pitch_rate_rad_s: samples(&self.platform_rate_rad_s),
                ..PlatformMotion::STILL
            },
            imperfections: Imperfections::NoiseAndQuantisation { seed },
            initial: Initial::Rest { hub_angle_rad: self.start_angle_rad },
            detail: Detail::Everything,
            ..Scenario::at_rest(self.demand.len() as f64 * self.sample_period_s)
        }
    }
}

/// Runs an experiment on a machine that a plant stands for, with any controller.
///
/// # Errors
/// Those of the simulator, a motion that diverges among them.
pub fn simulate_run(
    plant: &Plant,
    controller: &mut dyn SampledController,
    request: &RunRequest,
    seed: u64,
) -> Result<MachineRun, PipelineError> {
    let history = Simulator::new(plant)?.run(controller, &request.scenario(seed))?;
    Ok(MachineRun::new(&history, plant.parameters()))
}

impl MachineRun {
    fn new(history: &TimeHistory, machine: &Parameters) -> Self {
        let mut recording = history.readings.recording("run", history.sample_period_s);
        for channel in Channel::ALL.into_iter().filter(|channel| !is_fitted(machine, *channel)) {
            recording.remove(channel);
        }
        let truth = &history.truth;
        let peak = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |most: f64, v| most.max(v.abs()));
        let from_base = |hub: &[f64], base: &[f64]| -> Vec<f64> {
            hub.iter().zip(base).map(|(hub, base)| hub - base).collect()
        };
        let angles = from_base(truth.hub_angle_rad(), truth.platform_angle_rad());
        let rates = from_base(truth.hub_rate_rad_s(), truth.platform_rate_rad_s());
        let start = angles.first().copied().unwrap_or(0.0);
        Self {
            recording,
            reached: ExperimentExtremes {
                angle_rad: peak(&mut angles.iter().map(|angle| angle - start)),
                rate_rad_s: peak(&mut rates.iter().copied()),
                current_a: peak(&mut truth.current_a().iter().copied()),
            },
        }
    }
}

/// The presence of a channel in a machine's recordings.
fn is_fitted(machine: &Parameters, channel: Channel) -> bool {
    let sensors = &machine.sensors;
    match channel {
        Channel::PlatformRate => sensors.platform_gyro.is_fitted(),
        Channel::PlatformAccel => sensors.platform_accelerometer.is_fitted(),
        Channel::PlatformSurge => sensors.surge_accelerometer.is_some(),
        Channel::MotorRate => sensors.motor_tachometer.is_some(),
        Channel::HubPosition => sensors.hub_resolver.is_some(),
        _ => true,
    }
}
