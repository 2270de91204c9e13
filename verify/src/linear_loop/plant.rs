//! The plant with its sensors, as the sampled controller sees it.

use counterpoise_linalg::Mat;
use counterpoise_lti::{Discretisation, StateSpace, Timebase, append, c2d, delay_samples, series};
use counterpoise_models::parameters::{Parameters, ReadingDelay, Sensor};
use counterpoise_models::plant::LinearPlant;
use counterpoise_models::{AccelerometerAxis, ControlledQuantity};

use crate::Error;
use crate::tolerance::MOST_DELAY_STATES;

/// Readings of the linear part of a controller, in the order of [`counterpoise_controller::READING_NAMES`].
const READINGS: usize = counterpoise_controller::COMMON_READINGS;

/// Outputs of [`SampledPlant::continuous`] before the sensors.
const TRUTHS: usize = 4;

/// The plant and its sensors
///
/// ```text
///     continuous: (control, heave, pitch rate) -> (hub rate, tip rate, motor rate, current | loop's sensor, platform gyro,
///                                                  accelerometer, tachometer, resolver)
///     sampled:    (demand, heave, pitch rate, control) -> (hub rate, tip rate, motor rate, current, control | readings)
/// ```
///
/// The sampled system holds the control and joins the samples of heave and pitch rate by straight lines; both are exact.
/// Whole samples of delay, of the control and of sensors, are part of the sampled system alone. If the loop's sensor measures a
/// position, the outputs of hub and tip are positions relative to the platform.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledPlant {
    /// The continuous system.
    pub continuous: StateSpace,
    /// The sampled system.
    pub sampled: StateSpace,
    /// Sample period, s.
    pub sample_period_s: f64,
    /// The control that holds the mechanism at its operating point, V.
    pub holding_v: f64,
    /// Quantity that the loop controls.
    pub controlled: ControlledQuantity,
    /// `true` if hub and tip are positions and not rates: the loop's sensor measures one.
    pub controls_position: bool,
    /// `true` if the loop controls a torque or a current, which is then in the place of the hub's rate.
    pub controls_effort: bool,
    /// The hub's angle at the operating point, rad.
    pub hub_angle_rad: f64,
    /// `true` if the platform's accelerometer feels surge as the out-of-balance does.
    pub surge_is_measured: bool,
    /// Delays: of the control, then of the readings, in samples.
    pub(crate) delays: Delays,
}

/// The delays of signals: the control by whole samples, readings by whole samples and a rest. The rests are part of the continuous
/// system.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Delays {
    pub(crate) control: usize,
    pub(crate) readings: [ReadingDelay; READINGS],
}

/// Inputs and outputs of the sampled system.
pub(crate) mod port {
    /// Inputs.
    pub const DEMAND: usize = 0;
    pub const HEAVE: usize = 1;
    pub const PITCH: usize = 2;
    pub const CONTROL: usize = 3;
    /// Outputs.
    pub const HUB: usize = 0;
    pub const TIP: usize = 1;
    pub const MOTOR: usize = 2;
    pub const CURRENT: usize = 3;
    pub const CONTROL_OUT: usize = 4;
    pub const FIRST_READING: usize = 5;
}

/// Use of the hub's angle: it is a state only if the controller reads it, for it is an integrator that nothing else sees.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Resolver {
    /// The controller reads the hub's angle.
    Read,
    /// The controller does not read the angle.
    Unread,
}

/// The inputs of a plant beside its control.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Drivers {
    /// Heave and pitch rate, which the platform's sensors feel.
    Platform,
    /// Torques on the motor shaft and on the hub, which no sensor feels.
    Torques,
}

impl SampledPlant {
    /// Returns the plant with the sensors and the clock of `parameters`.
    ///
    /// # Errors
    /// [`Error::Range`] if the delays together are longer than [`MOST_DELAY_STATES`] samples; those of the models and of the sampling.
    pub fn new(plant: &LinearPlant, parameters: &Parameters, resolver: Resolver) -> Result<Self, Error> {
        Self::with_drivers(plant, parameters, resolver, Drivers::Platform)
    }

    /// Returns the plant on a platform that stands still, with torques on the motor shaft and on the hub in the places of heave and pitch rate.
    ///
    /// # Errors
    /// As [`SampledPlant::new`].
    pub fn with_torque_inputs(
        plant: &LinearPlant,
        parameters: &Parameters,
        resolver: Resolver,
    ) -> Result<Self, Error> {
        Self::with_drivers(&plant.with_torque_inputs()?, parameters, resolver, Drivers::Torques)
    }

    /// Returns by how many whole samples each reading is late; the rest of a delay is part of the continuous system.
    pub fn reading_delays_samples(&self) -> Vec<usize> {
        self.delays.readings.iter().map(|delay| delay.samples).collect()
    }

    fn with_drivers(
        plant: &LinearPlant,
        parameters: &Parameters,
        resolver: Resolver,
        drivers: Drivers,
    ) -> Result<Self, Error> {
        let delays = Delays::of(parameters);
        delays.check()?;
        let sensed = with_truths(plant, parameters, drivers)?;
        let hub_angle_rad = plant.equilibrium.point.hub_angle_rad;
        let share = parameters.sensors.accelerometer_share_of_heave(hub_angle_rad);
        let undelayed = series(&sensed, &sensors(parameters, resolver, share)?)?;
        let continuous = delays.apply_rests(undelayed)?;
        let sample_period_s = parameters.interface.sample_period_s;
        let sampled = delays.apply(&sample(&continuous, sample_period_s)?, sample_period_s)?;
        Ok(Self {
            continuous,
            sampled,
            sample_period_s,
            holding_v: plant.equilibrium.control_v,
            controlled: parameters.controlled_quantity(),
            controls_position: parameters.sensors.measured.is_position(),
            controls_effort: parameters.sensors.measured.is_effort(),
            hub_angle_rad,
            surge_is_measured: parameters.sensors.measures_surge(),
            delays,
        })
    }
}

/// Outputs: hub, tip, motor rate and current; then what each sensor feels: measured output and heave, pitch rate and heave, heave and
/// pitch rate, motor rate, hub rate less pitch rate (in a loop of position the hub's position).
fn with_truths(plant: &LinearPlant, parameters: &Parameters, drivers: Drivers) -> Result<StateSpace, Error> {
    let g = &plant.system;
    let output = |row: usize| (g.C.block(row, 0, 1, g.order()), g.D.block(row, 0, 1, 3));
    let input = |column: usize| {
        let is_felt = |j: usize| j == column && drivers == Drivers::Platform;
        (Mat::zeros(1, g.order()), Mat::from_fn(1, 3, |_, j| if is_felt(j) { 1.0 } else { 0.0 }))
    };
    let current = (Mat::row(&plant.current.states), Mat::row(&plant.current.inputs));
    let (hub, motor) = (output(LinearPlant::HUB_RATE), output(LinearPlant::MOTOR_RATE));
    let (heave, pitch) = (input(LinearPlant::HEAVE), input(LinearPlant::PITCH_RATE));
    let relative = match parameters.sensors.measured.is_position() {
        true => hub.clone(),
        false => (hub.0.clone(), &hub.1 - &pitch.1),
    };
    let controlled = if parameters.sensors.measured.is_effort() { output(plant.measured) } else { hub };
    let truths = [controlled, output(LinearPlant::TIP_RATE), motor.clone(), current];
    let felt =
        [output(plant.measured), heave.clone(), pitch.clone(), heave.clone(), heave, pitch, motor, relative];
    let rows: Vec<(Mat, Mat)> = truths.into_iter().chain(felt).collect();
    let C = Mat::from_fn(rows.len(), g.order(), |i, j| rows[i].0[(0, j)]);
    let D = Mat::from_fn(rows.len(), 3, |i, j| rows[i].1[(0, j)]);
    Ok(StateSpace::new(g.A.clone(), g.B.clone(), C, D, Timebase::Continuous)?)
}

/// The truths as they are, and each sensor on what it feels; the accelerometer reads a share of heave.
fn sensors(parameters: &Parameters, resolver: Resolver, share: f64) -> Result<StateSpace, Error> {
    let sensors = &parameters.sensors;
    let gyro = |sensor: &Sensor| -> Result<StateSpace, Error> {
        let sum = StateSpace::gain(
            Mat::row(&[1.0, sensor.g_sensitivity / nonzero_gain(sensor.gain)]),
            Timebase::Continuous,
        )?;
        Ok(series(&sum, &sensor.dynamics()?)?)
    };
    let tachometer = sensors.motor_tachometer.as_ref().map_or(0.0, |sensor| sensor.gain);
    let angle = sensors.hub_resolver.as_ref().map_or(0.0, |sensor| sensor.gain);
    let position = match resolver {
        Resolver::Unread => StateSpace::gain(Mat::row(&[0.0]), Timebase::Continuous)?,
        Resolver::Read if sensors.measured.is_position() => {
            StateSpace::gain(Mat::row(&[angle]), Timebase::Continuous)?
        }
        Resolver::Read => integrator(angle)?,
    };
    let mut all = StateSpace::gain(Mat::eye(TRUTHS), Timebase::Continuous)?;
    for part in [
        gyro(&sensors.hub_gyro)?,
        gyro(&sensors.platform_gyro)?,
        accelerometer(parameters, share)?,
        StateSpace::gain(Mat::row(&[tachometer]), Timebase::Continuous)?,
        position,
    ] {
        all = append(&all, &part)?;
    }
    Ok(all)
}

/// A gain of 0 reads nothing; its g-sensitivity then has no meaning either.
fn nonzero_gain(gain: f64) -> f64 {
    if gain == 0.0 { f64::INFINITY } else { gain }
}

fn integrator(gain: f64) -> Result<StateSpace, Error> {
    let one = Mat::row(&[1.0]);
    Ok(StateSpace::new(Mat::zeros(1, 1), one, Mat::row(&[gain]), Mat::zeros(1, 1), Timebase::Continuous)?)
}

/// From (heave, pitch rate) to the reading: a sensor at a distance l from the pivot also feels l times the pitch acceleration.
/// The derivative is taken inside the sensor's dynamics: x2 = x2' + w^2 l p.
fn accelerometer(parameters: &Parameters, share: f64) -> Result<StateSpace, Error> {
    let sensor = &parameters.sensors.platform_accelerometer;
    let arm = match parameters.sensors.accelerometer_axis {
        AccelerometerAxis::Vertical => parameters.sensors.accelerometer_lever_arm_m,
        AccelerometerAxis::Elevated => 0.0,
    };
    let g = sensor.dynamics()?;
    if g.order() == 0 {
        return Ok(StateSpace::gain(Mat::row(&[share * sensor.gain, 0.0]), Timebase::Continuous)?);
    }
    let (w, z) = (sensor.natural_frequency_rad_s, sensor.damping_ratio);
    let pitch = w * w * arm;
    let B = Mat::from_rows(&[&[0.0, pitch], &[share * w * w, -2.0 * z * w * pitch]]);
    Ok(StateSpace::new(g.A, B, g.C, Mat::zeros(1, 2), Timebase::Continuous)?)
}

/// (control, heave, pitch) -> (truths, readings) becomes (demand, heave, pitch, control) -> (truths, control, demand, readings).
fn sample(continuous: &StateSpace, period_s: f64) -> Result<StateSpace, Error> {
    let held = c2d(continuous, period_s, Discretisation::ZeroOrderHold)?;
    let joined = c2d(continuous, period_s, Discretisation::FirstOrderHold)?;
    let column = |j: usize| match j {
        port::CONTROL => Some((&held, 0)),
        port::HEAVE => Some((&joined, 1)),
        port::PITCH => Some((&joined, 2)),
        _ => None,
    };
    let row = |i: usize| match i {
        port::CONTROL_OUT | port::FIRST_READING => None,
        below if below < port::CONTROL_OUT => Some(below),
        above => Some(above - 2),
    };
    let outputs = port::FIRST_READING + READINGS;
    let B = Mat::from_fn(held.order(), 4, |i, j| column(j).map_or(0.0, |(g, from)| g.B[(i, from)]));
    let C = Mat::from_fn(outputs, held.order(), |i, j| row(i).map_or(0.0, |from| held.C[(from, j)]));
    let D = Mat::from_fn(outputs, 4, |i, j| match (i, j) {
        (port::CONTROL_OUT, port::CONTROL) | (port::FIRST_READING, port::DEMAND) => 1.0,
        _ => row(i).zip(column(j)).map_or(0.0, |(from, (g, input))| g.D[(from, input)]),
    });
    Ok(StateSpace::new(held.A.clone(), B, C, D, held.timebase)?)
}

impl Delays {
    fn of(parameters: &Parameters) -> Self {
        let period_s = parameters.interface.sample_period_s;
        let sensors = &parameters.sensors;
        let fitted =
            |sensor: Option<&Sensor>| sensor.map_or(ReadingDelay::NONE, |sensor| sensor.mean_delay(period_s));
        let readings = [
            ReadingDelay::NONE,
            fitted(Some(&sensors.hub_gyro)),
            fitted(Some(&sensors.platform_gyro)),
            fitted(Some(&sensors.platform_accelerometer)),
            fitted(sensors.motor_tachometer.as_ref()),
            fitted(sensors.hub_resolver.as_ref()),
        ];
        Self { control: parameters.interface.output_delay_samples, readings }
    }

    /// Adds the rests of the delays to the readings of the continuous system, whose last outputs they are; the demand is none of them.
    fn apply_rests(&self, continuous: StateSpace) -> Result<StateSpace, Error> {
        let sensed = &self.readings[1..];
        if sensed.iter().all(|delay| delay.rest_s == 0.0) {
            return Ok(continuous);
        }
        let others = continuous.outputs() - sensed.len();
        let mut after = StateSpace::gain(Mat::eye(others), Timebase::Continuous)?;
        for delay in sensed {
            after = append(&after, &delay.dynamics_of_rest()?)?;
        }
        Ok(series(&continuous, &after)?)
    }

    /// Refuses delays that would fill the memory: the loop's matrices are dense, with a state for each sample of delay.
    fn check(&self) -> Result<(), Error> {
        let all = self.readings.iter().fold(self.control, |sum, delay| sum.saturating_add(delay.samples));
        if all <= MOST_DELAY_STATES {
            return Ok(());
        }
        let allowed = "at most 2000: shorten the delays, or sample more slowly";
        Err(Error::Range {
            what: "delays of the control and of all sensors, in samples",
            value: all as f64,
            allowed,
        })
    }

    /// Delays between the control computed and the control held (the output `control` is the computed one), and after sensors.
    fn apply(&self, g: &StateSpace, period_s: f64) -> Result<StateSpace, Error> {
        let discrete = Timebase::Discrete { period_s };
        let line = |samples: usize| -> Result<StateSpace, Error> {
            if samples == 0 {
                Ok(StateSpace::gain(Mat::eye(1), discrete)?)
            } else {
                Ok(delay_samples(samples, period_s)?)
            }
        };
        let before = append(&StateSpace::gain(Mat::eye(3), discrete)?, &line(self.control)?)?;
        let mut after = StateSpace::gain(Mat::eye(port::FIRST_READING), discrete)?;
        for delay in self.readings {
            after = append(&after, &line(delay.samples)?)?;
        }
        let mut delayed = series(&series(&before, g)?, &after)?;
        if self.control > 0 {
            computed_control(&mut delayed);
        }
        Ok(delayed)
    }
}

/// Makes the output `control` the one that is computed, before its delay.
fn computed_control(g: &mut StateSpace) {
    (0..g.order()).for_each(|j| g.C[(port::CONTROL_OUT, j)] = 0.0);
    (0..4).for_each(|j| g.D[(port::CONTROL_OUT, j)] = if j == port::CONTROL { 1.0 } else { 0.0 });
}
