//! The controller that was in the loop when a recording was made.

use std::sync::Arc;

use counterpoise_controller::{
    AntiWindup, Controller, PositionController, PositionSource, ProportionalIntegral, READINGS, RateSource,
    Readings, Runner, SampledController,
};
use counterpoise_models::{CONVERTER_RANGE_V, Parameters, Sensor};
use counterpoise_recordings::{Channel, Recording};

use super::exported_controller::{ExportedController, FittedStart};
use super::initial_controller_state::fit_initial_states;
use super::platform::reading_floor;
use super::recorded_readings::{READ, recorded_readings};
use crate::Error;
use crate::sensitivity::{
    DifferentiableController, DifferentiablePi, DifferentiablePosition, DifferentiableProgram,
};
use crate::tolerance::{INTEGRAL_SAMPLES, START_RATE_SAMPLES};

/// A controller whose control a closed-loop replay computes anew from the simulated readings.
#[derive(Debug, Clone, PartialEq)]
pub enum RecordedController {
    /// A proportional-integral controller of the hub rate.
    ProportionalIntegral(ProportionalIntegral),
    /// A position controller with a rate loop inside.
    Position(PositionController),
    /// A controller as it is exported, with every block that runs on the target.
    Exported(Arc<ExportedController>),
}

impl RecordedController {
    /// Returns the proportional-integral controller; `None` if it is another one.
    pub fn as_proportional_integral(&self) -> Option<&ProportionalIntegral> {
        match self {
            Self::ProportionalIntegral(controller) => Some(controller),
            Self::Position(_) | Self::Exported(_) => None,
        }
    }

    /// Returns the controller at rest, ready for a run of its own.
    pub fn at_rest(&self) -> Box<dyn SampledController> {
        match self {
            Self::ProportionalIntegral(controller) => Box::new(controller.clone()),
            Self::Position(controller) => Box::new(controller.clone()),
            Self::Exported(controller) => Box::new(controller.controller().runner()),
        }
    }

    /// Returns the same controller with a rule against windup; `None` if it has one, or if it is an exported one.
    pub fn with_anti_windup(&self, rule: AntiWindup) -> Option<Self> {
        match self {
            Self::ProportionalIntegral(one) if one.anti_windup == AntiWindup::None => {
                Some(Self::ProportionalIntegral(ProportionalIntegral { anti_windup: rule, ..one.clone() }))
            }
            Self::Position(one) if one.anti_windup == AntiWindup::None => {
                Some(Self::Position(PositionController { anti_windup: rule, ..one.clone() }))
            }
            Self::ProportionalIntegral(_) | Self::Position(_) | Self::Exported(_) => None,
        }
    }

    /// Returns whether the controller's demand is a position.
    pub fn demands_position(&self) -> bool {
        matches!(self, Self::Position(_))
    }

    /// Returns whether the controller knows the position, so that a replay under it finds the position by itself.
    pub(crate) fn knows_position(&self) -> bool {
        matches!(self, Self::Position(_))
    }

    /// Returns the controller in the state that it had at the recording's first sample, ready for a closed-loop run; `fitted` keeps
    /// that state from run to run.
    ///
    /// An exported controller reads the recorded platform sensors where they were recorded: the mechanism does not act on them, so
    /// they are what the real controller read.
    ///
    /// # Errors
    /// [`Error::NoChannel`] if the demand was not recorded.
    pub(crate) fn at_start_of<'r>(
        &self,
        recording: &'r Recording,
        fitted: &FittedStart,
    ) -> Result<Box<dyn SampledController + 'r>, Error> {
        recording.samples(Channel::Demand).ok_or(Error::NoChannel { channel: "demand" })?;
        Ok(match self {
            Self::ProportionalIntegral(controller) => Box::new(with_fitted_integral(controller, recording)),
            Self::Position(controller) => Box::new(position_at_start(controller, recording)),
            Self::Exported(controller) => {
                let runner = fitted.of(controller, recording);
                Box::new(WithRecordedPlatform { runner, platform: recorded_platform(recording), next: 0 })
            }
        })
    }

    /// Returns the same as [`Self::at_start_of`], for a run with derivatives.
    ///
    /// # Errors
    /// As [`Self::at_start_of`].
    pub(crate) fn differentiable_at_start_of<'r>(
        &self,
        recording: &'r Recording,
        fitted: &FittedStart,
    ) -> Result<Box<dyn DifferentiableController + 'r>, Error> {
        recording.samples(Channel::Demand).ok_or(Error::NoChannel { channel: "demand" })?;
        Ok(match self {
            Self::ProportionalIntegral(controller) => {
                Box::new(DifferentiablePi::new(&with_fitted_integral(controller, recording), &[]))
            }
            Self::Position(controller) => {
                Box::new(DifferentiablePosition::new(&position_at_start(controller, recording)))
            }
            Self::Exported(controller) => {
                let runner = fitted.of(controller, recording);
                Box::new(WithRecordedPlatform {
                    runner: DifferentiableProgram::new(controller.controller(), &runner),
                    platform: recorded_platform(recording),
                    next: 0,
                })
            }
        })
    }

    /// Returns the control that the controller makes of recorded readings, sample by sample from the first of `range` on, with the
    /// initial state that fits the recorded control best, limited to the converter's range; `None` if a channel that it reads was
    /// not recorded.
    pub(crate) fn compute_control(&self, recording: &Recording) -> Option<Vec<f64>> {
        let read = recorded_readings(recording)?;
        let control = recording.samples(Channel::Control)?;
        match self {
            Self::ProportionalIntegral(controller) => Some(proportional_integral(controller, &read, control)),
            Self::Position(controller) => {
                let mut ready = position_at_start(controller, recording);
                let limited = |u: f64| u.clamp(-CONVERTER_RANGE_V, CONVERTER_RANGE_V);
                Some(read.iter().map(|readings| limited(ready.step(readings))).collect())
            }
            Self::Exported(controller) => {
                let mut runner = fit_initial_states(controller.controller(), recording)?;
                Some(read.iter().map(|readings| runner.step(readings)).collect())
            }
        }
    }

    /// Returns for how many samples the controller computes with readings from before the recording.
    pub(crate) fn unrecorded_samples(&self) -> usize {
        match self {
            Self::Position(controller) => controller.rate_samples(),
            Self::ProportionalIntegral(_) | Self::Exported(_) => 0,
        }
    }

    /// Returns the channels that the controller needs to be compared with its recorded control.
    pub(crate) fn needed_channels(&self) -> Vec<Channel> {
        match self {
            Self::ProportionalIntegral(_) => vec![Channel::Demand, Channel::HubRate],
            Self::Position(controller) => match controller.position {
                PositionSource::LoopSensor => vec![Channel::Demand, Channel::HubRate],
                PositionSource::HubPosition => vec![Channel::Demand, Channel::HubRate, Channel::HubPosition],
            },
            Self::Exported(controller) => {
                (0..READINGS).filter(|&j| controller.reads(j)).map(|j| READ[j]).collect()
            }
        }
    }

    /// Returns the RMS of the control that noise and quantisation of the readings and the output converter's step leave in a
    /// closed-loop replay, V. The platform's readings are the recorded ones, so that they add nothing.
    pub fn control_floor(&self, parameters: &Parameters) -> f64 {
        let floor = |sensor: &Sensor| reading_floor(sensor, &parameters.interface);
        self.of_noise(parameters, floor).hypot(parameters.interface.control_step_v() / 12f64.sqrt())
    }

    /// Returns the RMS of the control that the rounding of the converters leaves when the recorded readings are used, V.
    pub(crate) fn rounding_floor(&self, parameters: &Parameters) -> f64 {
        let interface = &parameters.interface;
        let read = |sensor: &Sensor| interface.reading_step(sensor) / 12f64.sqrt();
        (interface.control_step_v() / 12f64.sqrt()).hypot(self.of_noise(parameters, read))
    }

    /// Returns the RMS of the control from white noise on what the mechanism's sensors read.
    fn of_noise(&self, parameters: &Parameters, size: impl Fn(&Sensor) -> f64) -> f64 {
        let sensors = &parameters.sensors;
        match self {
            Self::ProportionalIntegral(controller) => controller.kp_v_s_rad * size(&sensors.hub_gyro),
            Self::Position(controller) => position_noise(controller, parameters, size),
            Self::Exported(controller) => {
                let gain = |j: usize| controller.noise_gain(j);
                let sized = |sensor: Option<&Sensor>| sensor.map_or(0.0, &size);
                let hub = gain(1) * size(&sensors.hub_gyro);
                let motor = gain(4) * sized(sensors.motor_tachometer.as_ref());
                hub.hypot(motor).hypot(gain(5) * sized(sensors.hub_resolver.as_ref()))
            }
        }
    }
}

impl From<ProportionalIntegral> for RecordedController {
    fn from(controller: ProportionalIntegral) -> Self {
        Self::ProportionalIntegral(controller)
    }
}

impl From<PositionController> for RecordedController {
    fn from(controller: PositionController) -> Self {
        Self::Position(controller)
    }
}

impl From<Controller> for RecordedController {
    fn from(controller: Controller) -> Self {
        Self::Exported(Arc::new(ExportedController::new(controller)))
    }
}

/// Returns the controller with the integral that it had at the first sample: the mean of what its output leaves unexplained, for its
/// inputs were recorded; as it was handed in if control or hub rate were not.
fn with_fitted_integral(controller: &ProportionalIntegral, recording: &Recording) -> ProportionalIntegral {
    let mut ready = controller.clone();
    let recorded = |channel| recording.samples(channel);
    let (Some(demand), Some(control), Some(rate)) =
        (recorded(Channel::Demand), recorded(Channel::Control), recorded(Channel::HubRate))
    else {
        return ready;
    };
    ready.integral_v = 0.0;
    let read = demand.iter().zip(rate).map(|(demand, rate)| Readings {
        demand_rad_s: *demand,
        hub_rate_rad_s: *rate,
        ..Readings::default()
    });
    ready.integral_v = integral_at_start(ready.clone(), ready.anti_windup, read, control);
    ready
}

/// Returns the integral at the first sample that explains the first recorded controls best: the mean of what a controller whose integral
/// starts at 0 leaves unexplained, as long as the control is not limited; 0 if it is from the first sample on.
fn integral_at_start(
    mut observer: impl SampledController,
    rule: AntiWindup,
    read: impl Iterator<Item = Readings>,
    control: &[f64],
) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (readings, recorded) in read.zip(control).take(INTEGRAL_SAMPLES) {
        let left = recorded - observer.step(&readings);
        if left.is_nan() || is_limited(rule, *recorded) {
            break;
        }
        sum += left;
        count += 1.0;
    }
    if count > 0.0 { sum / count } else { 0.0 }
}

/// Returns the RMS of a position controller's control from white noise on its sensors.
fn position_noise(
    controller: &PositionController,
    parameters: &Parameters,
    size: impl Fn(&Sensor) -> f64,
) -> f64 {
    let sensors = &parameters.sensors;
    let position = match controller.position {
        PositionSource::LoopSensor => size(&sensors.hub_gyro),
        PositionSource::HubPosition => sensors.hub_resolver.as_ref().map_or(0.0, &size),
    };
    let kv = controller.kv_v_s_rad;
    match controller.rate {
        RateSource::Measured => kv * (controller.kp_1_s * position).hypot(size(&sensors.hub_gyro)),
        RateSource::Differences(count) => {
            // u = -kv ((kp + d) q_k - d q_(k - n)), d = 1 / (n T)
            let difference = 1.0 / (count.max(1) as f64 * controller.sample_period_s);
            kv * position * (controller.kp_1_s + difference).hypot(difference)
        }
    }
}

/// Returns a position controller with the rate and the integral that it had at the first sample; as it was handed in if its readings were
/// not recorded.
///
/// A controller that was switched on with the recording knew no position before the first, so that its rate began at 0; one that ran before
/// knew the motion. The one that gives the first recorded controls more closely is taken.
fn position_at_start(controller: &PositionController, recording: &Recording) -> PositionController {
    let fresh = PositionController {
        integral_v: 0.0,
        earlier_rad: Vec::new(),
        start_rate_rad_s: 0.0,
        ..controller.clone()
    };
    let running = PositionController { start_rate_rad_s: first_rate(controller, recording), ..fresh.clone() };
    let (Some(read), Some(control)) = (recorded_readings(recording), recording.samples(Channel::Control))
    else {
        return running;
    };
    let [fresh, running] = [fresh, running].map(|one| with_integral_of(one, &read, control));
    let apart = |one: &PositionController| {
        let mut runner = one.clone();
        let pairs = read.iter().zip(control).take(runner.rate_samples());
        let errors = pairs.map(|(readings, recorded)| (recorded - runner.step(readings)).powi(2));
        errors.filter(|error| error.is_finite()).sum::<f64>()
    };
    if apart(&fresh) < apart(&running) { fresh } else { running }
}

/// Returns the rate that the first positions of a recording show, rad/s; 0 if they were not recorded.
fn first_rate(controller: &PositionController, recording: &Recording) -> f64 {
    let channel = match controller.position {
        PositionSource::LoopSensor => Channel::HubRate,
        PositionSource::HubPosition => Channel::HubPosition,
    };
    let column = recording.samples(channel).unwrap_or_default();
    let place = START_RATE_SAMPLES.min(column.len().saturating_sub(1));
    if place == 0 {
        return 0.0;
    }
    let rate = (column[place] - column[0]) / (place as f64 * recording.sample_period_s);
    if rate.is_finite() { rate } else { 0.0 }
}

/// Returns a position controller with the integral at the start that explains the first recorded controls best.
fn with_integral_of(ready: PositionController, read: &[Readings], control: &[f64]) -> PositionController {
    if ready.ki_v_rad == 0.0 {
        return ready;
    }
    let integral_v = integral_at_start(ready.clone(), ready.anti_windup, read.iter().copied(), control);
    PositionController { integral_v, ..ready }
}

/// Returns whether a recorded control stood at the limit of the converter or of a rule against windup.
fn is_limited(rule: AntiWindup, control_v: f64) -> bool {
    control_v.abs() >= CONVERTER_RANGE_V || rule.is_limited(control_v)
}

/// Returns the control of a proportional-integral controller, with the integral at the start that fits best.
fn proportional_integral(controller: &ProportionalIntegral, read: &[Readings], control: &[f64]) -> Vec<f64> {
    let limited = |u: f64| u.clamp(-CONVERTER_RANGE_V, CONVERTER_RANGE_V);
    let at_zero = ProportionalIntegral { integral_v: 0.0, ..controller.clone() };
    let made_by = |mut ready: ProportionalIntegral| read.iter().map(move |readings| ready.step(readings));
    if controller.anti_windup != AntiWindup::None {
        // such a rule lets the integral forget its start once the control is limited
        let read = read.iter().copied();
        let integral_v = integral_at_start(at_zero.clone(), controller.anti_windup, read, control);
        return made_by(ProportionalIntegral { integral_v, ..at_zero }).map(limited).collect();
    }
    let made: Vec<f64> = made_by(at_zero).collect();
    let free = |k: &usize| control[*k].abs() < CONVERTER_RANGE_V;
    let left: Vec<f64> = (0..made.len()).filter(free).map(|k| control[k] - made[k]).collect();
    let integral = left.iter().sum::<f64>() / left.len().max(1) as f64;
    made.into_iter().map(|u| limited(u + integral)).collect()
}

/// Returns the recorded platform rate, heave and surge; empty if not recorded.
fn recorded_platform(recording: &Recording) -> [&[f64]; 3] {
    [Channel::PlatformRate, Channel::PlatformAccel, Channel::PlatformSurge]
        .map(|channel| recording.samples(channel).unwrap_or_default())
}

/// An exported controller that reads the recorded platform sensors.
struct WithRecordedPlatform<'r, R = Runner> {
    runner: R,
    /// Recorded platform rate, heave and surge; empty if not recorded.
    platform: [&'r [f64]; 3],
    next: usize,
}

impl<R> WithRecordedPlatform<'_, R> {
    /// Returns the readings of the next sample, with those of the platform as recorded.
    fn read_recorded(&mut self, readings: &Readings) -> Readings {
        let recorded = |column: &[f64], simulated: f64| {
            column.get(self.next).copied().filter(|v| v.is_finite()).unwrap_or(simulated)
        };
        let read = Readings {
            platform_rate_rad_s: recorded(self.platform[0], readings.platform_rate_rad_s),
            platform_accel_m_s2: recorded(self.platform[1], readings.platform_accel_m_s2),
            platform_surge_m_s2: recorded(self.platform[2], readings.platform_surge_m_s2),
            ..*readings
        };
        self.next += 1;
        read
    }
}

impl SampledController for WithRecordedPlatform<'_> {
    fn reset(&mut self) {
        self.runner.reset();
        self.next = 0;
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        let read = self.read_recorded(readings);
        self.runner.step(&read)
    }
}

impl DifferentiableController for WithRecordedPlatform<'_, DifferentiableProgram> {
    fn step(&mut self, readings: &Readings, slopes: &[Readings], control: &mut [f64]) -> f64 {
        let read = self.read_recorded(readings);
        self.runner.step(&read, slopes, control)
    }
}
