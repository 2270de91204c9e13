//! The signals of one recording as the localisation and the sanity checks take them.

use counterpoise_simulate::recording::Recording;

/// The measured signals of one recording.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredSignals {
    /// Sample period, s.
    pub period_s: f64,
    /// Control, V.
    pub control: Vec<f64>,
    /// Hub rate, rad/s.
    pub hub_rate: Vec<f64>,
    /// Platform rate, rad/s.
    pub platform_rate: Vec<f64>,
    /// Heave, m/s^2.
    pub platform_accel: Vec<f64>,
    /// Motor rate, rad/s.
    pub motor_rate: Option<Vec<f64>>,
    /// Hub angle on the platform, rad.
    pub hub_position: Option<Vec<f64>>,
}

/// Returns the signals of a recording; `None` if it has no control or no hub rate.
pub fn read_signals(recording: &Recording) -> Option<MeasuredSignals> {
    let still = || vec![0.0; recording.len()];
    Some(MeasuredSignals {
        period_s: recording.sample_period_s,
        control: recording.control_v.clone()?,
        hub_rate: recording.hub_rate_rad_s.clone()?,
        platform_rate: recording.platform_rate_rad_s.clone().unwrap_or_else(still),
        platform_accel: recording.platform_accel_m_s2.clone().unwrap_or_else(still),
        motor_rate: recording.motor_rate_rad_s.clone(),
        hub_position: recording.hub_position_rad.clone(),
    })
}
