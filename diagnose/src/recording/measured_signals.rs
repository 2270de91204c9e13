//! The signals of one recording as the localisation and the sanity checks take them.

use std::borrow::Cow;

use counterpoise_models::FeedbackSignal;
use counterpoise_recordings::{Channel, Recording};

use crate::recording::series::derivative;

/// The measured signals of one recording.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredSignals {
    /// Sample period, s.
    pub period_s: f64,
    /// Control, V.
    pub control: Vec<f64>,
    /// What the loop's sensor measures, which is recorded as the hub rate.
    pub measured: FeedbackSignal,
    /// Hub rate, rad/s; in a loop of another quantity the reading of its sensor.
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

impl MeasuredSignals {
    /// Returns the rate of the hub on the platform that the loop's sensor shows, rad/s: its reading less the platform's rate, its reading,
    /// or the derivative of its reading.
    pub fn relative_rate(&self) -> Vec<f64> {
        match self.measured {
            FeedbackSignal::HubRate => {
                self.hub_rate.iter().zip(&self.platform_rate).map(|(h, p)| h - p).collect()
            }
            FeedbackSignal::RelativeRate | FeedbackSignal::MotorRate => self.hub_rate.clone(),
            FeedbackSignal::HubPosition | FeedbackSignal::MotorPosition => {
                derivative(&self.hub_rate, self.period_s)
            }
            // Of a torque or a current there are no signals: see [`read_signals`].
            FeedbackSignal::Torque | FeedbackSignal::Current => vec![f64::NAN; self.hub_rate.len()],
        }
    }

    /// Returns the signals with the hub's inertial rate as a gyroscope would have measured it, whatever the loop's sensor measures; an
    /// angle that it measures is the hub's position, unless that was recorded.
    pub fn with_inertial_rate(&self) -> Cow<'_, Self> {
        if self.measured == FeedbackSignal::HubRate {
            return Cow::Borrowed(self);
        }
        let relative = self.relative_rate();
        let hub_rate = relative.iter().zip(&self.platform_rate).map(|(r, p)| r + p).collect();
        let own = self.measured.is_position().then(|| self.hub_rate.clone());
        let hub_position = self.hub_position.clone().or(own);
        Cow::Owned(Self { measured: FeedbackSignal::HubRate, hub_rate, hub_position, ..self.clone() })
    }
}

/// Returns the signals of a recording in a loop of what `measured` says; `None` if it has no control or no hub rate, or if the loop's sensor
/// measures a torque or a current, which shows no motion.
pub fn read_signals(recording: &Recording, measured: FeedbackSignal) -> Option<MeasuredSignals> {
    if measured.is_effort() {
        return None;
    }
    let recorded = |channel| recording.samples(channel).map(<[f64]>::to_vec);
    let still = || vec![0.0; recording.len()];
    Some(MeasuredSignals {
        period_s: recording.sample_period_s,
        measured,
        control: recorded(Channel::Control)?,
        hub_rate: recorded(Channel::HubRate)?,
        platform_rate: recorded(Channel::PlatformRate).unwrap_or_else(still),
        platform_accel: recorded(Channel::PlatformAccel).unwrap_or_else(still),
        motor_rate: recorded(Channel::MotorRate),
        hub_position: recorded(Channel::HubPosition),
    })
}
