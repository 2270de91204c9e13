//! Sensors, converters and the clock of the digital controller.

/// The sensors. Each one's reading is gain x truth + bias + g_sensitivity x heave, filtered, delayed, with noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensors {
    /// Rate gyroscope on the hub (inertial rate).
    pub hub_gyro: Sensor,
    /// Rate gyroscope on the platform (inertial rate).
    pub platform_gyro: Sensor,
    /// Accelerometer on the platform (heave, gravity removed).
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
    };
}
