//! Sensors, converters and the clock of the digital controller.

use std::f64::consts::SQRT_2;

use counterpoise_lti::{StateSpace, pade};

use crate::tolerance::{NEGLIGIBLE_REST, REST_ORDER};

/// Quantity that the sensor of the controlled output measures: the controller's first reading, and the quantity of the demand.
///
/// Values of the motor are divided by the ratio, so that every reading of the loop is one of the hub's side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FeedbackSignal {
    /// Inertial rate of the hub: a gyroscope on it.
    #[default]
    HubRate,
    /// Rate of the hub relative to the platform: a tachometer on its axis.
    RelativeRate,
    /// Rate of the motor relative to the platform over the ratio: a tachometer on its shaft.
    MotorRate,
    /// Angle of the hub relative to the platform: a resolver or an encoder on its axis.
    HubPosition,
    /// Angle of the motor relative to the platform over the ratio: a resolver or an encoder on its shaft.
    MotorPosition,
    /// Torque that the transmission passes to the hub, N m: a torque sensor between them. The transmission must yield.
    Torque,
    /// Current of the motor, A, which must be a state: an inductance or a lag of the current loop.
    Current,
}

impl FeedbackSignal {
    /// Returns whether it is an angle or a place.
    pub fn is_position(self) -> bool {
        matches!(self, Self::HubPosition | Self::MotorPosition)
    }

    /// Returns the measured quantity of which this one is the integral; `None` for any but a position.
    pub fn rate(self) -> Option<Self> {
        match self {
            Self::HubPosition => Some(Self::RelativeRate),
            Self::MotorPosition => Some(Self::MotorRate),
            Self::HubRate | Self::RelativeRate | Self::MotorRate | Self::Torque | Self::Current => None,
        }
    }

    /// Returns whether it is a torque or a current, which shows neither a rate nor a position.
    pub fn is_effort(self) -> bool {
        matches!(self, Self::Torque | Self::Current)
    }
}

/// The sensors. Each one's reading is gain x truth + bias + g_sensitivity x heave, filtered, delayed, with noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensors {
    /// Sensor of the controlled output: a rate gyroscope on the hub, unless `measured` says otherwise.
    pub hub_gyro: Sensor,
    /// Quantity that the sensor measures.
    pub measured: FeedbackSignal,
    /// Rate gyroscope on the platform (inertial rate); [`Sensor::ABSENT`] if none is fitted.
    pub platform_gyro: Sensor,
    /// Accelerometer on the platform (heave, gravity removed); [`Sensor::ABSENT`] if none is fitted.
    pub platform_accelerometer: Sensor,
    /// Distance of that accelerometer from the pivot, m: it also reads lever arm x pitch acceleration.
    pub accelerometer_lever_arm_m: f64,
    /// Along which axis that accelerometer measures.
    pub accelerometer_axis: AccelerometerAxis,
    /// Tachometer on the motor; absent if none is fitted.
    pub motor_tachometer: Option<Sensor>,
    /// Resolver at the hub, relative to the platform; absent if none is fitted.
    pub hub_resolver: Option<Sensor>,
    /// Second accelerometer on the platform, at the pivot (surge, forward, gravity removed); absent if none is fitted. The controller projects its
    /// reading and that of heave across the beam.
    pub surge_accelerometer: Option<Sensor>,
}

impl Sensors {
    /// Returns what the heave reading that the controller takes has of heave at a hub angle, per m/s^2: the cosine of the angle for an
    /// accelerometer on the elevated mass and for a projection of heave and surge.
    pub fn share_of_heave(&self, hub_angle_rad: f64) -> f64 {
        if self.surge_accelerometer.is_some() {
            return hub_angle_rad.cos();
        }
        self.accelerometer_share_of_heave(hub_angle_rad)
    }

    /// Returns what the platform's accelerometer reads of heave at a hub angle, per m/s^2: the cosine of the angle between its axis and the vertical.
    pub fn accelerometer_share_of_heave(&self, hub_angle_rad: f64) -> f64 {
        let tilt = self.platform_accelerometer.alignment.tilt_rad;
        match self.accelerometer_axis {
            AccelerometerAxis::Vertical => tilt.cos(),
            AccelerometerAxis::Elevated => (hub_angle_rad + tilt).cos(),
        }
    }

    /// Returns whether an accelerometer reads a part of surge.
    pub fn reads_surge(&self) -> bool {
        self.measures_surge() || self.platform_accelerometer.alignment.tilt_rad != 0.0
    }

    /// Returns whether the heave feedforward sees surge as the out-of-balance feels it.
    pub fn measures_surge(&self) -> bool {
        self.accelerometer_axis == AccelerometerAxis::Elevated || self.surge_accelerometer.is_some()
    }
}

/// Along which axis the accelerometer of the platform's motion measures, gravity removed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AccelerometerAxis {
    /// Upward: it reads heave.
    #[default]
    Vertical,
    /// Along the normal of the beam, on the elevated mass at the pivot: it reads heave cos(theta_h) - surge sin(theta_h), which is what
    /// the out-of-balance feels at any elevation.
    Elevated,
}

/// One sensor with its second-order dynamics.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    /// Natural frequency, rad/s; infinite for an ideal sensor.
    pub natural_frequency_rad_s: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// Volts at the converter per unit.
    pub scale_v_unit: f64,
    /// RMS of the white noise at the sample rate, in the measured unit.
    pub noise_rms: f64,
    /// Error of the gain: 1 means none.
    pub gain: f64,
    /// Bias in the measured unit.
    pub bias: f64,
    /// Delay, s (whole samples are what a sampled loop sees).
    pub delay_s: f64,
    /// Reading per m/s^2 of heave, in the measured unit.
    pub g_sensitivity: f64,
    /// Step of a digital reading, in the measured unit: 2 pi over the counts a turn of an encoder. 0: the reading passes the
    /// analogue converter.
    pub resolution: f64,
    /// Slow errors of the reading.
    pub drift: Drift,
    /// Deviation of its axis from the nominal one.
    pub alignment: Alignment,
    /// Time between two readings of its own, s, to whole samples of the controller, which sees the last one in between. 0: a reading each sample.
    pub own_period_s: f64,
    /// Whether a digital reading of a rate is the difference of two angles over the time between them: `resolution` is then the step of the angle.
    pub is_differenced: bool,
}

/// Deviation of a sensor's axis from the nominal one. Every number is 0 for a sensor that is aligned.
///
/// A gyroscope reads rate + c_r w_f + c_y w_u, with the inertial rates w_f about the forward and w_u about the upward axis of what carries it: the
/// platform, or the elevated mass along the beam and its normal. A small misalignment by an angle has that angle as its sensitivity, and the
/// cross-axis sensitivity of the sensor itself adds to it (D. Titterton and J. Weston, Strapdown Inertial Navigation Technology, 2004).
///
/// An accelerometer whose axis is turned by the tilt t reads, gravity removed as if it were aligned: on the platform
/// a cos(t) - a_x sin(t) + g (cos(t) - 1), on the elevated mass a cos(theta + t) - a_x sin(theta + t) + g (cos(theta + t) - cos(theta)), and of surge
/// a_x cos(t) + (a + g) sin(t), with heave a and surge a_x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alignment {
    /// Of a gyroscope: reading per inertial rate about the forward axis of what carries it.
    pub roll_sensitivity: f64,
    /// Of a gyroscope: reading per inertial rate about the upward axis of what carries it.
    pub yaw_sensitivity: f64,
    /// Of an accelerometer: angle about the elevation axis, rad, positive nose-up.
    pub tilt_rad: f64,
}

/// Slow errors of a gyroscope, by the parameters of its Allan deviation (IEEE Std 952-1997, annex C). For another sensor read its unit in
/// place of rad/s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// Angle random walk N, rad/s^0.5: white noise of the rate with the two-sided spectral density N^2. Allan deviation N / tau^0.5.
    pub angle_random_walk: f64,
    /// Bias instability B, rad/s: flicker noise with the two-sided density B^2 / (2 pi f). Allan deviation 0.664 B.
    pub bias_instability: f64,
    /// Rate random walk K, rad/s^1.5: the bias walks at random. Allan deviation K (tau / 3)^0.5.
    pub rate_random_walk: f64,
}

/// Errors of the clock of a real controller: every number is 0 for an ideal one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    /// RMS of the distance of the instants at which sensors are read from those of an ideal clock, s.
    pub jitter_s: f64,
    /// Share of the samples that are missed: the controller does not run, and its control stays.
    pub missed_samples: f64,
    /// Share of the samples whose control arrives too late: it acts one period later.
    pub late_samples: f64,
}

/// Converters and clock of the digital controller.
#[derive(Debug, Clone, PartialEq)]
pub struct Interface {
    /// Sample period, s.
    pub sample_period_s: f64,
    /// Bits of the analogue-to-digital converters over +/- 10 V.
    pub input_bits: u32,
    /// Bits of the digital-to-analogue converter over +/- 10 V.
    pub output_bits: u32,
    /// Whole samples by which the control is held back.
    pub output_delay_samples: usize,
    /// Errors of the clock.
    pub clock: Clock,
    /// Share of the codes that the analogue-to-digital converters never give: the code below stands in for a missing one.
    pub missing_codes: f64,
}

/// Full range of every converter, V to either side.
pub const CONVERTER_RANGE_V: f64 = 10.0;

/// Bits that stand for an ideal converter: its steps are as good as none.
pub const IDEAL_CONVERTER_BITS: u32 = 48;

/// Returns the step of a converter with a number of bits, V: its full range over the number of its codes.
pub fn converter_step_v(bits: u32) -> f64 {
    2.0 * CONVERTER_RANGE_V / f64::from(bits).exp2()
}

impl Interface {
    /// Returns the step of the control, V.
    pub fn control_step_v(&self) -> f64 {
        converter_step_v(self.output_bits)
    }

    /// Returns the step of the converter that the reading of an analogue sensor passes, in the measured unit.
    pub fn converter_step(&self, sensor: &Sensor) -> f64 {
        converter_step_v(self.input_bits) / sensor.scale_v_unit
    }

    /// Returns the step of a reading in the measured unit: that of a digital sensor, or of the converter that an analogue one passes. Of two angles whose
    /// difference is read it is the step whose rounding has the same RMS as theirs together, sqrt(2) times the step of the angle over the time between them.
    pub fn reading_step(&self, sensor: &Sensor) -> f64 {
        match sensor.resolution {
            resolution if sensor.is_differenced => {
                SQRT_2 * resolution / sensor.time_between_readings_s(self.sample_period_s)
            }
            resolution if resolution > 0.0 => resolution,
            _ => self.converter_step(sensor),
        }
    }
}

impl Alignment {
    /// The nominal axis.
    pub const NOMINAL: Self = Self { roll_sensitivity: 0.0, yaw_sensitivity: 0.0, tilt_rad: 0.0 };

    /// Returns whether a gyroscope reads rates about other axes.
    pub fn has_cross_axis(&self) -> bool {
        self.roll_sensitivity != 0.0 || self.yaw_sensitivity != 0.0
    }
}

impl Drift {
    /// No slow error.
    pub const NONE: Self = Self { angle_random_walk: 0.0, bias_instability: 0.0, rate_random_walk: 0.0 };
}

impl Clock {
    /// A clock without errors.
    pub const IDEAL: Self = Self { jitter_s: 0.0, missed_samples: 0.0, late_samples: 0.0 };
}

/// The delay of a reading: whole samples of the controller, and the rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReadingDelay {
    /// Whole samples.
    pub samples: usize,
    /// The rest, s: less than a sample.
    pub rest_s: f64,
}

impl ReadingDelay {
    /// No delay.
    pub const NONE: Self = Self { samples: 0, rest_s: 0.0 };

    /// Returns the rest as a system in continuous time: a Padé approximation of order `REST_ORDER`.
    ///
    /// # Errors
    /// That of the approximation, for a rest that is no number.
    pub fn dynamics_of_rest(&self) -> Result<StateSpace, counterpoise_lti::Error> {
        pade(self.rest_s, if self.rest_s > 0.0 { REST_ORDER } else { 0 })
    }
}

impl Sensor {
    /// A sensor without dynamics, noise or error, 1 V per unit.
    pub const IDEAL: Self = Self {
        natural_frequency_rad_s: f64::INFINITY,
        damping_ratio: 0.7,
        scale_v_unit: 1.0,
        noise_rms: 0.0,
        gain: 1.0,
        bias: 0.0,
        delay_s: 0.0,
        g_sensitivity: 0.0,
        resolution: 0.0,
        drift: Drift::NONE,
        alignment: Alignment::NOMINAL,
        own_period_s: 0.0,
        is_differenced: false,
    };

    /// No sensor: its reading is 0.
    pub const ABSENT: Self = Self { gain: 0.0, ..Self::IDEAL };

    /// Returns the RMS of the white noise of a sample, in the measured unit: its own and the angle random walk's.
    pub fn white_noise_rms(&self, sample_period_s: f64) -> f64 {
        let walk = self.drift.angle_random_walk;
        if walk == 0.0 { self.noise_rms } else { self.noise_rms.hypot(walk / sample_period_s.sqrt()) }
    }

    /// Returns after how many samples of the controller it gives its next reading: 1 if it gives one each sample.
    pub fn samples_between_readings(&self, sample_period_s: f64) -> usize {
        ((self.own_period_s / sample_period_s).round() as usize).max(1)
    }

    /// Returns the time between two of its readings, s.
    pub fn time_between_readings_s(&self, sample_period_s: f64) -> f64 {
        self.samples_between_readings(sample_period_s) as f64 * sample_period_s
    }

    /// Returns by how many samples the difference of two angles is late: it is the mean rate of the time between them.
    pub fn difference_delay_samples(&self, sample_period_s: f64) -> f64 {
        if self.is_differenced { 0.5 * self.samples_between_readings(sample_period_s) as f64 } else { 0.0 }
    }

    /// Returns for how long a reading is held beyond a sample, on the average, in samples.
    pub fn mean_hold_samples(&self, sample_period_s: f64) -> f64 {
        0.5 * (self.samples_between_readings(sample_period_s) - 1) as f64
    }

    /// Returns by how many samples its readings are late on the average: its own delay, that of readings that are held, and that of a difference.
    pub fn mean_delay_samples(&self, sample_period_s: f64) -> f64 {
        let held = self.mean_hold_samples(sample_period_s) + self.difference_delay_samples(sample_period_s);
        self.delay_s / sample_period_s + held
    }

    /// Returns that delay as the linear loop takes it.
    pub fn mean_delay(&self, sample_period_s: f64) -> ReadingDelay {
        let all = self.mean_delay_samples(sample_period_s).max(0.0);
        let whole = (all + NEGLIGIBLE_REST).floor();
        let rest = (all - whole).max(0.0);
        let rest_s = if rest < NEGLIGIBLE_REST { 0.0 } else { rest * sample_period_s };
        ReadingDelay { samples: whole as usize, rest_s }
    }

    /// Returns whether there is a sensor.
    pub fn is_fitted(&self) -> bool {
        self.gain != 0.0
    }
}
