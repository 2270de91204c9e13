//! The sensors and converters of the digital controller, sample by sample.

use crate::engine::filter::Filter;
use crate::engine::moments::NODES;
use crate::motion::MotionSample;
use crate::noise::Noise;
use crate::sampling_errors::{DRIFT_STREAM, DriftNoise, SURGE_STREAM, is_missing};
use counterpoise_controller::Readings;
use counterpoise_models::plant::{SensorErrors, SensorRegime, SinCos};
use counterpoise_models::{
    AccelerometerAxis, CONVERTER_RANGE_V, Interface, LearnedPlace, Parameters, Sensor, Sensors,
    converter_step_v,
};

/// Imperfections of the sensors and converters that are simulated. Their dynamics, gains, biases and delays always are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Imperfections {
    /// Noise from a seed, and quantised converters.
    NoiseAndQuantisation {
        /// Seed of the noise: the same seed, the same noise.
        seed: u64,
    },
    /// Quantised converters without noise.
    Quantisation,
    /// Neither noise nor quantisation.
    None,
}

/// A quantiser over +/- 10 V; an infinitesimal step leaves the value alone.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Converter {
    step_v: f64,
    /// Share of the codes that it never gives.
    missing_codes: f64,
}

impl Converter {
    pub fn new(bits: u32, imperfections: Imperfections) -> Self {
        let step_v = match imperfections {
            Imperfections::None => 0.0,
            _ => converter_step_v(bits),
        };
        Self { step_v, missing_codes: 0.0 }
    }

    /// Returns the converter with a share of its codes missing.
    pub fn with_missing_codes(self, missing_codes: f64) -> Self {
        Self { missing_codes, ..self }
    }

    pub fn convert(&self, volts: f64) -> f64 {
        let limited = volts.clamp(-CONVERTER_RANGE_V, CONVERTER_RANGE_V);
        if self.step_v == 0.0 {
            return limited;
        }
        let mut code = (limited / self.step_v).round();
        while self.missing_codes > 0.0 && is_missing(code as i64, self.missing_codes) {
            code -= 1.0;
        }
        code * self.step_v
    }

    /// Returns a digital reading in steps of its own, if anything is quantised; it does not pass the converter's range.
    pub fn quantise(&self, value: f64, resolution: f64) -> f64 {
        if self.step_v == 0.0 { value } else { (value / resolution).round() * resolution }
    }
}

/// The instant at which a sensor is read, its noise, and what its errors depend on beside the reading.
#[derive(Debug, Clone, Copy)]
struct Instant {
    /// Noise of unit variance.
    noise: f64,
    /// Distance from the instant of an ideal clock, in periods.
    offset: f64,
    /// Angle of the hub on the platform, rad.
    hub_angle_rad: f64,
    /// Time since the start, s.
    time_s: f64,
}

/// One sensor from the filtered truth to the reading.
#[derive(Debug, Clone)]
struct Chain {
    sensor: Sensor,
    converter: Converter,
    delay_samples: f64,
    past: Vec<f64>,
    /// Change of the value from sample to sample before the first one.
    slope_before: f64,
    /// The value at the sample before; `None` before the first.
    before: Option<f64>,
    drift: Option<DriftNoise>,
    /// Errors that free functions give.
    errors: Option<Box<SensorErrors>>,
    /// What differences the angles, if the readings are differences.
    difference: Option<AngleDifference>,
    /// Samples between two readings of its own, and the reading that is held between them.
    held: Option<HeldReading>,
}

/// The angle behind readings that are differences of it: the integral of the rate by the trapezoidal rule from sample to sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AngleDifference {
    period_s: f64,
    every: usize,
    sample: usize,
    /// The rate at the sample before; `None` before the first.
    rate: Option<f64>,
    angle: f64,
    /// The angle as it was read last.
    last: f64,
}

impl AngleDifference {
    /// Returns the differences of a sensor's angles; `None` if its readings are none.
    pub fn of(sensor: &Sensor, period_s: f64) -> Option<Self> {
        let every = sensor.samples_between_readings(period_s);
        let fresh = Self { period_s, every, sample: 0, rate: None, angle: 0.0, last: 0.0 };
        sensor.is_differenced.then_some(fresh)
    }

    /// Returns the difference at the next sample, given the rate there and the reading of an angle. Before the first sample the rate was the same.
    pub fn next(&mut self, rate: f64, read: impl Fn(f64) -> f64) -> f64 {
        let between_s = self.every as f64 * self.period_s;
        match self.rate.replace(rate) {
            Some(before) => self.angle += 0.5 * self.period_s * (before + rate),
            None => self.last = read(-rate * between_s),
        }
        let now = read(self.angle);
        let difference = (now - self.last) / between_s;
        if self.sample.is_multiple_of(self.every) {
            self.last = now;
        }
        self.sample += 1;
        difference
    }
}

/// The last reading of a sensor that is slower than the controller.
#[derive(Debug, Clone, Copy)]
struct HeldReading {
    every: usize,
    sample: usize,
    reading: f64,
}

impl HeldReading {
    /// Returns what the controller sees of the reading that the sensor would give at this sample.
    fn hold_reading(&mut self, reading: f64) -> f64 {
        if self.sample.is_multiple_of(self.every) {
            self.reading = reading;
        }
        self.sample += 1;
        self.reading
    }
}

impl Chain {
    fn new(sensor: &Sensor, interface: &Interface, imperfections: Imperfections, place: u64) -> Self {
        let drift = match imperfections {
            Imperfections::NoiseAndQuantisation { seed } => {
                DriftNoise::new(sensor.drift, interface.sample_period_s, seed, DRIFT_STREAM + place)
            }
            _ => None,
        };
        let every = sensor.samples_between_readings(interface.sample_period_s);
        Self {
            sensor: sensor.clone(),
            converter: Converter::new(interface.input_bits, imperfections)
                .with_missing_codes(interface.missing_codes),
            delay_samples: sensor.delay_s / interface.sample_period_s,
            past: Vec::new(),
            slope_before: 0.0,
            before: None,
            drift,
            errors: None,
            difference: AngleDifference::of(sensor, interface.sample_period_s),
            held: (every > 1).then_some(HeldReading { every, sample: 0, reading: 0.0 }),
        }
    }

    /// Returns the same with the errors that a machine's free functions give the sensor at a place.
    fn with_errors(self, parameters: &Parameters, place: LearnedPlace) -> Self {
        Self { errors: SensorErrors::of(parameters, place).map(Box::new), ..self }
    }

    /// Returns the value at a fraction of a period after the sample instant, from this one and the one before.
    fn at_offset(&mut self, value: f64, offset: f64) -> f64 {
        let before = self.before.replace(value).unwrap_or(value);
        if offset == 0.0 { value } else { value + offset * (value - before) }
    }

    /// Returns the reading for a filtered truth and a filtered heave.
    fn read(&mut self, truth: f64, heave: f64, at: Instant) -> f64 {
        let sensor = &self.sensor;
        let mut value = sensor.gain * truth + sensor.bias + sensor.g_sensitivity * heave;
        if let Some(errors) = &self.errors {
            let Instant { hub_angle_rad, time_s, .. } = at;
            value += errors.at(&SensorRegime { reading: value, hub_angle_rad, time_s });
        }
        let (scale, spread, resolution) = (sensor.scale_v_unit, sensor.noise_rms, sensor.resolution);
        let value = self.at_offset(value, at.offset);
        let mut delayed = self.delay_value(value);
        if let Some(difference) = &mut self.difference {
            let converter = self.converter;
            let read = |angle| if resolution > 0.0 { converter.quantise(angle, resolution) } else { angle };
            delayed = difference.next(delayed, read);
        }
        delayed += spread * at.noise;
        if let Some(drift) = &mut self.drift {
            delayed += drift.next();
        }
        let reading = if self.difference.is_some() {
            delayed
        } else if resolution > 0.0 {
            self.converter.quantise(delayed, resolution)
        } else {
            self.converter.convert(delayed * scale) / scale
        };
        self.held.as_mut().map_or(reading, |held| held.hold_reading(reading))
    }

    fn delay_value(&mut self, value: f64) -> f64 {
        if self.delay_samples == 0.0 {
            return value;
        }
        self.past.push(value);
        let position = (self.past.len() - 1) as f64 - self.delay_samples;
        if position <= 0.0 {
            return self.past[0] + position * self.slope_before;
        }
        let (index, part) = (position as usize, position.fract());
        let next = self.past.get(index + 1).copied().unwrap_or(value);
        self.past[index] + part * (next - self.past[index])
    }
}

/// A platform sensor: its dynamics, driven by the platform alone, and its chain.
#[derive(Debug, Clone)]
struct PlatformSensor {
    filter: Filter,
    state: [f64; 2],
    heave: [f64; 2],
    /// The rates about other axes that a misaligned gyroscope reads, filtered.
    cross: [f64; 2],
    chain: Chain,
}

impl PlatformSensor {
    fn new(sensor: &Sensor, parameters: &Parameters, imperfections: Imperfections, place: u64) -> Self {
        Self {
            filter: Filter::new(sensor, parameters.interface.sample_period_s),
            state: [0.0; 2],
            heave: [0.0; 2],
            cross: [0.0; 2],
            chain: Chain::new(sensor, &parameters.interface, imperfections, place),
        }
    }

    /// Returns a truth with what the sensor reads about other axes.
    fn with_cross_axis(&self, truth: f64) -> f64 {
        if self.has_cross_axis() { truth + self.cross[0] } else { truth }
    }

    fn has_cross_axis(&self) -> bool {
        self.chain.sensor.alignment.has_cross_axis()
    }

    /// Moves what a misaligned gyroscope reads about other axes over a sample; what carries it stands at an angle at each node.
    fn advance_cross_axis(&mut self, motion: &MotionSample, angle_rad: impl Fn(f64) -> f64) {
        if !self.has_cross_axis() {
            return;
        }
        let felt = NODES.map(|node| self.cross_axis_rate(motion, node, angle_rad(node)));
        self.filter.advance(0, &mut self.cross, &felt);
    }

    /// Returns what the sensor reads about other axes, unfiltered, at a fraction of a sample; what carries it stands at an angle.
    fn cross_axis_rate(&self, motion: &MotionSample, part: f64, angle_rad: f64) -> f64 {
        let Some(further) = motion.further_at(part) else { return 0.0 };
        let (sin, cos) = angle_rad.sin_cos();
        let [roll, yaw] = further.rates;
        let alignment = &self.chain.sensor.alignment;
        alignment.roll_sensitivity * (roll * cos + yaw * sin)
            + alignment.yaw_sensitivity * (yaw * cos - roll * sin)
    }
}

/// The truth at a sample instant that the sensors of the mechanism turn into readings.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Truth {
    pub hub_gyro: f64,
    pub motor_rate: f64,
    pub hub_position: f64,
}

/// All sensors.
#[derive(Debug, Clone)]
pub(crate) struct Sensing {
    noise: Option<Noise>,
    hub_gyro: Chain,
    hub_heave: PlatformSensor,
    platform_gyro: PlatformSensor,
    accelerometer: PlatformSensor,
    mounted: AccelerometerMounting,
    tachometer: Option<Chain>,
    resolver: Option<Chain>,
    surge: Option<Surge>,
    period_s: f64,
    /// Samples that were read.
    samples: usize,
}

/// The accelerometer of surge with its own noise.
#[derive(Debug, Clone)]
struct Surge {
    sensor: PlatformSensor,
    noise: Option<Noise>,
}

impl Sensing {
    pub fn new(parameters: &Parameters, imperfections: Imperfections) -> Self {
        let sensors = &parameters.sensors;
        let chain = |sensor: &Sensor, stream, place| {
            Chain::new(sensor, &parameters.interface, imperfections, stream).with_errors(parameters, place)
        };
        let driven = |sensor: &Sensor, place| PlatformSensor::new(sensor, parameters, imperfections, place);
        let with_errors = |sensor: PlatformSensor, place| PlatformSensor {
            chain: sensor.chain.clone().with_errors(parameters, place),
            ..sensor
        };
        let noise = match imperfections {
            Imperfections::NoiseAndQuantisation { seed } => Some(Noise::new(seed)),
            _ => None,
        };
        Self {
            noise,
            hub_gyro: chain(&sensors.hub_gyro, 0, LearnedPlace::LoopSensor),
            hub_heave: driven(&sensors.hub_gyro, 0),
            platform_gyro: with_errors(driven(&sensors.platform_gyro, 1), LearnedPlace::PlatformGyro),
            accelerometer: with_errors(
                driven(&sensors.platform_accelerometer, 2),
                LearnedPlace::PlatformAccelerometer,
            ),
            mounted: AccelerometerMounting::of(sensors, parameters.gravity_m_s2),
            tachometer: sensors
                .motor_tachometer
                .as_ref()
                .map(|sensor| chain(sensor, 3, LearnedPlace::MotorTachometer)),
            resolver: sensors.hub_resolver.as_ref().map(|sensor| chain(sensor, 4, LearnedPlace::HubResolver)),
            period_s: parameters.interface.sample_period_s,
            samples: 0,
            surge: sensors.surge_accelerometer.as_ref().map(|sensor| Surge {
                sensor: driven(sensor, 5),
                noise: match imperfections {
                    Imperfections::NoiseAndQuantisation { seed } => {
                        Some(Noise::from_stream(seed, SURGE_STREAM))
                    }
                    _ => None,
                },
            }),
        }
    }

    /// Puts the platform's sensors where they would be after a long time at a platform state and a hub angle; what the loop's sensor is given
    /// changed by `slope` a sample before the start.
    pub fn settle_sensors(&mut self, motion: &MotionSample, hub_angle_rad: f64, slope: f64) {
        let start = motion.at(0.0);
        self.hub_gyro.slope_before = self.hub_gyro.sensor.gain * slope;
        self.platform_gyro.state = [start.rate, 0.0];
        self.accelerometer.state = [self.mounted.heave_felt(motion, 0.0, hub_angle_rad), 0.0];
        if let Some(surge) = &mut self.surge {
            surge.sensor.state = [self.mounted.surge_felt(motion, 0.0), 0.0];
        }
        for (gyro, angle) in [(&mut self.hub_heave, hub_angle_rad), (&mut self.platform_gyro, start.angle)] {
            gyro.cross = [gyro.cross_axis_rate(motion, 0.0, angle), 0.0];
        }
        for sensor in [&mut self.hub_heave, &mut self.platform_gyro, &mut self.accelerometer] {
            sensor.heave = [start.heave, 0.0];
        }
    }

    /// Returns the readings at an offset, in periods, from a sample instant; the demand is left at 0.
    pub fn read(&mut self, truth: &Truth, offset: f64) -> Readings {
        let (hub_angle_rad, time_s) = (truth.hub_position, self.samples as f64 * self.period_s);
        self.samples += 1;
        let noise = [0; 5].map(|_| {
            let noise = self.noise.as_mut().map_or(0.0, Noise::next);
            Instant { noise, offset, hub_angle_rad, time_s }
        });
        let gyro = &mut self.platform_gyro;
        let accelerometer = &mut self.accelerometer;
        Readings {
            demand_rad_s: 0.0,
            hub_rate_rad_s: self.hub_gyro.read(
                self.hub_heave.with_cross_axis(truth.hub_gyro),
                self.hub_heave.heave[0],
                noise[0],
            ),
            platform_rate_rad_s: gyro.chain.read(
                gyro.with_cross_axis(gyro.state[0]),
                gyro.heave[0],
                noise[1],
            ),
            platform_accel_m_s2: accelerometer.chain.read(accelerometer.state[0], 0.0, noise[2]),
            motor_rate_rad_s: self
                .tachometer
                .as_mut()
                .map_or(0.0, |c| c.read(truth.motor_rate, 0.0, noise[3])),
            hub_position_rad: self
                .resolver
                .as_mut()
                .map_or(0.0, |c| c.read(truth.hub_position, 0.0, noise[4])),
            platform_surge_m_s2: self.surge.as_mut().map_or(0.0, |surge| surge.read(offset)),
        }
    }

    /// Moves the platform's sensors over a sample at whose end the hub stands at an angle: within a sample it turns too little to matter
    /// (1e-4 rad at 0.1 rad/s).
    pub fn advance(&mut self, motion: &MotionSample, hub_angle_rad: f64) {
        let rate = motion.nodes(|p| p.rate);
        let heave = motion.nodes(|p| p.heave);
        let felt = self.mounted.heave_felt_at_nodes(motion, heave, hub_angle_rad);
        self.platform_gyro.filter.advance(0, &mut self.platform_gyro.state, &rate);
        self.accelerometer.filter.advance(0, &mut self.accelerometer.state, &felt);
        if let Some(surge) = &mut self.surge {
            let felt = NODES.map(|node| self.mounted.surge_felt(motion, node));
            surge.sensor.filter.advance(0, &mut surge.sensor.state, &felt);
        }
        for sensor in [&mut self.hub_heave, &mut self.platform_gyro] {
            if sensor.chain.sensor.g_sensitivity != 0.0 {
                sensor.filter.advance(0, &mut sensor.heave, &heave);
            }
        }
        self.hub_heave.advance_cross_axis(motion, |_| hub_angle_rad);
        self.platform_gyro.advance_cross_axis(motion, |node| motion.at(node).angle);
    }
}

impl Surge {
    fn read(&mut self, offset: f64) -> f64 {
        let noise = self.noise.as_mut().map_or(0.0, Noise::next);
        let at = Instant { noise, offset, hub_angle_rad: 0.0, time_s: 0.0 };
        self.sensor.chain.read(self.sensor.state[0], 0.0, at)
    }
}

/// The mounting of the accelerometers.
#[derive(Debug, Clone, Copy)]
struct AccelerometerMounting {
    axis: AccelerometerAxis,
    lever_arm_m: f64,
    gravity_m_s2: f64,
    /// Tilts of the accelerometers of heave and of surge, rad.
    tilt_rad: f64,
    surge_tilt_rad: f64,
}

impl AccelerometerMounting {
    fn of(sensors: &Sensors, gravity_m_s2: f64) -> Self {
        let of_surge = sensors.surge_accelerometer.as_ref().map_or(0.0, |sensor| sensor.alignment.tilt_rad);
        Self {
            axis: sensors.accelerometer_axis,
            lever_arm_m: sensors.accelerometer_lever_arm_m,
            gravity_m_s2,
            tilt_rad: sensors.platform_accelerometer.alignment.tilt_rad,
            surge_tilt_rad: of_surge,
        }
    }

    /// Returns what the accelerometer of heave feels at a fraction of a sample, m/s^2, but for its lever arm.
    fn heave_felt(&self, motion: &MotionSample, part: f64, hub_angle_rad: f64) -> f64 {
        let heave = motion.at(part).heave;
        let nominal = match self.axis {
            AccelerometerAxis::Vertical if self.tilt_rad == 0.0 => return heave,
            AccelerometerAxis::Vertical => 0.0,
            AccelerometerAxis::Elevated => hub_angle_rad,
        };
        let surge = motion.further_at(part).unwrap_or_default().surge;
        let axis = SinCos::of(nominal + self.tilt_rad);
        let felt = heave * axis.cos - surge * axis.sin;
        if self.tilt_rad == 0.0 { felt } else { felt + self.gravity_m_s2 * (axis.cos - nominal.cos()) }
    }

    /// Returns the same at the nodes of a sample at which heave is known, with the lever arm.
    fn heave_felt_at_nodes(&self, motion: &MotionSample, heave: [f64; 4], hub_angle_rad: f64) -> [f64; 4] {
        let mut felt = heave;
        if self.axis == AccelerometerAxis::Elevated || self.tilt_rad != 0.0 {
            felt = NODES.map(|node| self.heave_felt(motion, node, hub_angle_rad));
        }
        if self.lever_arm_m != 0.0 && self.axis == AccelerometerAxis::Vertical {
            felt = [0, 1, 2, 3].map(|k| felt[k] + self.lever_arm_m * motion.pitch_acceleration_at(NODES[k]));
        }
        felt
    }

    /// Returns what the accelerometer of surge feels at a fraction of a sample, m/s^2.
    fn surge_felt(&self, motion: &MotionSample, part: f64) -> f64 {
        let surge = motion.further_at(part).unwrap_or_default().surge;
        if self.surge_tilt_rad == 0.0 {
            return surge;
        }
        let (sin, cos) = self.surge_tilt_rad.sin_cos();
        surge * cos + (motion.at(part).heave + self.gravity_m_s2) * sin
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_converter_rounds_to_its_step_and_limits() {
        let converter = Converter::new(12, Imperfections::Quantisation);
        let step = 20.0 / 4096.0;
        assert_eq!(converter.convert(1.4 * step), step);
        assert_eq!(converter.convert(11.0), 10.0);
        assert_eq!(Converter::new(12, Imperfections::None).convert(1.4 * step), 1.4 * step);
    }
}
