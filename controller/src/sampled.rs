//! What a sampled controller reads, and the control that it returns.

/// What the controller reads at a sample instant: converter readings divided by their scale, in SI units.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Readings {
    /// Demanded hub rate, rad/s.
    pub demand_rad_s: f64,
    /// Hub gyroscope, rad/s (inertial).
    pub hub_rate_rad_s: f64,
    /// Platform gyroscope, rad/s (inertial).
    pub platform_rate_rad_s: f64,
    /// Platform accelerometer (heave), m/s^2, gravity removed.
    pub platform_accel_m_s2: f64,
    /// Motor tachometer, rad/s relative to the platform; 0 if none is fitted.
    pub motor_rate_rad_s: f64,
    /// Hub angle relative to the platform, rad; 0 if no resolver is fitted.
    pub hub_position_rad: f64,
    /// Second accelerometer on the platform (surge, forward), m/s^2, gravity removed; 0 if none is fitted.
    pub platform_surge_m_s2: f64,
}

/// A controller that acts once a sample.
pub trait SampledController {
    /// Puts every state back to its start.
    fn reset(&mut self);
    /// Takes the readings of this instant and returns the control in volts, before the output converter.
    fn step(&mut self, readings: &Readings) -> f64;
}

/// The controller of a recording: e = demand - hub rate, u = kp e + q + bias, then q += ki T e.
#[derive(Debug, Clone, PartialEq)]
pub struct ProportionalIntegral {
    /// Proportional gain, V s/rad.
    pub kp_v_s_rad: f64,
    /// Integral gain, V/rad.
    pub ki_v_rad: f64,
    /// Constant added, V.
    pub bias_v: f64,
    /// Sample period, s.
    pub sample_period_s: f64,
    /// State q, V.
    pub integral_v: f64,
}

impl SampledController for ProportionalIntegral {
    fn reset(&mut self) {
        self.integral_v = 0.0;
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        let error = readings.demand_rad_s - readings.hub_rate_rad_s;
        let control = self.kp_v_s_rad * error + self.integral_v + self.bias_v;
        self.integral_v += self.ki_v_rad * self.sample_period_s * error;
        control
    }
}
