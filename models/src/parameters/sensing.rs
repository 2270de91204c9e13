//! Sensors, converters and the clock of the digital controller.

/// What the sensor of the controlled output measures: the controller's first reading, and what a demand demands.
///
/// Values of the motor are divided by the ratio, so that every reading of the loop is one of the hub's side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Measured {
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
}

impl Measured {
    /// Returns whether it is an angle or a place, and not a rate.
    pub fn is_position(self) -> bool {
        matches!(self, Self::HubPosition | Self::MotorPosition)
    }

    /// Returns the measured quantity of which this one is the integral; `None` for a rate.
    pub fn rate(self) -> Option<Self> {
        match self {
            Self::HubPosition => Some(Self::RelativeRate),
            Self::MotorPosition => Some(Self::MotorRate),
            Self::HubRate | Self::RelativeRate | Self::MotorRate => None,
        }
    }
}

/// The sensors. Each one's reading is gain x truth + bias + g_sensitivity x heave, filtered, delayed, with noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensors {
    /// Sensor of the controlled output: a rate gyroscope on the hub, unless `measured` says otherwise.
    pub hub_gyro: Sensor,
    /// What that sensor measures.
    pub measured: Measured,
    /// Rate gyroscope on the platform (inertial rate); [`Sensor::ABSENT`] if none is fitted.
    pub platform_gyro: Sensor,
    /// Accelerometer on the platform (heave, gravity removed); [`Sensor::ABSENT`] if none is fitted.
    pub platform_accelerometer: Sensor,
    /// Distance of that accelerometer from the pivot, m: it also reads lever arm x pitch acceleration.
    pub accelerometer_lever_arm_m: f64,
    /// Tachometer on the motor; absent if none is fitted.
    pub motor_tachometer: Option<Sensor>,
    /// Resolver at the hub, relative to the platform; absent if none is fitted.
    pub hub_resolver: Option<Sensor>,
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
    };

    /// No sensor: its reading is 0.
    pub const ABSENT: Self = Self { gain: 0.0, ..Self::IDEAL };

    /// Returns whether there is a sensor.
    pub fn is_fitted(&self) -> bool {
        self.gain != 0.0
    }
}
