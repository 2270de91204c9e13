//! The signals of one recording as the localisation and the sanity checks take them.

use counterpoise_recordings::{Channel, Recording};

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
    let recorded = |channel| recording.samples(channel).map(<[f64]>::to_vec);
    let still = || vec![0.0; recording.len()];
    Some(MeasuredSignals {
        period_s: recording.sample_period_s,
        control: recorded(Channel::Control)?,
        hub_rate: recorded(Channel::HubRate)?,
        platform_rate: recorded(Channel::PlatformRate).unwrap_or_else(still),
        platform_accel: recorded(Channel::PlatformAccel).unwrap_or_else(still),
        motor_rate: recorded(Channel::MotorRate),
        hub_position: recorded(Channel::HubPosition),
    })
}
