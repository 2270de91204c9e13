//! The signals of one recording as the localisation and the sanity checks take them.

use std::borrow::Cow;

use counterpoise_models::FeedbackSignal;
use counterpoise_recordings::{Channel, ColumnName, Recording, Signals};

use crate::machine::RedundantSensors;
use crate::recording::series::derivative;

/// A column of the measured signals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeasuredColumn {
    /// Control, V.
    Control,
    /// Hub rate, rad/s; in a loop of another quantity the reading of its sensor.
    HubRate,
    /// Platform rate, rad/s.
    PlatformRate,
    /// Heave, m/s^2.
    PlatformAccel,
    /// Motor rate, rad/s; 0 if it was not recorded.
    MotorRate,
    /// Hub angle on the platform, rad; 0 if it was not recorded.
    HubPosition,
}

impl ColumnName for MeasuredColumn {
    fn index(self) -> usize {
        self as usize
    }
}

/// The measured signals of one recording.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredSignals {
    /// Sample period, s.
    pub period_s: f64,
    /// Quantity of the loop's sensor, which is recorded as the hub rate.
    pub measured: FeedbackSignal,
    /// Recorded columns that a machine can do without.
    pub recorded: RedundantSensors,
    /// The samples, in all columns of [`MeasuredColumn`].
    pub signals: Signals<MeasuredColumn>,
}

impl MeasuredSignals {
    /// Returns the control, V.
    pub fn control(&self) -> &[f64] {
        self.signals.column(MeasuredColumn::Control)
    }

    /// Returns the hub rate, rad/s; in a loop of another quantity the reading of its sensor.
    pub fn hub_rate(&self) -> &[f64] {
        self.signals.column(MeasuredColumn::HubRate)
    }

    /// Returns the platform's rate, rad/s.
    pub fn platform_rate(&self) -> &[f64] {
        self.signals.column(MeasuredColumn::PlatformRate)
    }

    /// Returns the heave, m/s^2.
    pub fn platform_accel(&self) -> &[f64] {
        self.signals.column(MeasuredColumn::PlatformAccel)
    }

    /// Returns the motor's rate, rad/s, if it was recorded.
    pub fn motor_rate(&self) -> Option<&[f64]> {
        self.recorded.motor_rate.then(|| self.signals.column(MeasuredColumn::MotorRate))
    }

    /// Returns the hub's angle on the platform, rad, if it was recorded.
    pub fn hub_position(&self) -> Option<&[f64]> {
        self.recorded.hub_position.then(|| self.signals.column(MeasuredColumn::HubPosition))
    }

    /// Returns the samples of a column, to be changed; none if it was not recorded.
    pub fn recorded_mut(&mut self, column: MeasuredColumn) -> &mut [f64] {
        let is_recorded = match column {
            MeasuredColumn::MotorRate => self.recorded.motor_rate,
            MeasuredColumn::HubPosition => self.recorded.hub_position,
            _ => true,
        };
        if is_recorded { self.signals.column_mut(column) } else { &mut [] }
    }

    /// Returns the rate of the hub on the platform that the loop's sensor shows, rad/s: its reading less the platform's rate, its reading,
    /// or the derivative of its reading.
    pub fn relative_rate(&self) -> Vec<f64> {
        let reading = self.hub_rate();
        match self.measured {
            FeedbackSignal::HubRate => reading.iter().zip(self.platform_rate()).map(|(h, p)| h - p).collect(),
            FeedbackSignal::RelativeRate | FeedbackSignal::MotorRate => reading.to_vec(),
            FeedbackSignal::HubPosition | FeedbackSignal::MotorPosition => derivative(reading, self.period_s),
            // Of a torque or a current there are no signals: see [`read_signals`].
            FeedbackSignal::Torque | FeedbackSignal::Current => vec![f64::NAN; reading.len()],
        }
    }

    /// Returns the signals with the hub's inertial rate as a gyroscope would have measured it, whatever the loop's sensor measures; an
    /// angle that it measures is the hub's position, unless that was recorded.
    pub fn with_inertial_rate(&self) -> Cow<'_, Self> {
        if self.measured == FeedbackSignal::HubRate {
            return Cow::Borrowed(self);
        }
        let mut out = Self { measured: FeedbackSignal::HubRate, ..self.clone() };
        let relative = self.relative_rate();
        let inertial = relative.iter().zip(self.platform_rate()).map(|(r, p)| r + p);
        let hub_rate = out.signals.column_mut(MeasuredColumn::HubRate);
        hub_rate.iter_mut().zip(inertial).for_each(|(place, rate)| *place = rate);
        if self.measured.is_position() && !self.recorded.hub_position {
            out.signals.column_mut(MeasuredColumn::HubPosition).copy_from_slice(self.hub_rate());
            out.recorded.hub_position = true;
        }
        Cow::Owned(out)
    }
}

/// Returns the signals of a recording in a loop of what `measured` says; `None` if it has no control or no hub rate, or if the loop's sensor
/// measures a torque or a current, which shows no motion.
pub fn read_signals(recording: &Recording, measured: FeedbackSignal) -> Option<MeasuredSignals> {
    if measured.is_effort() {
        return None;
    }
    let (control, hub_rate) = (recording.samples(Channel::Control)?, recording.samples(Channel::HubRate)?);
    let still = vec![0.0; recording.len()];
    let or_still = |channel| recording.samples(channel).unwrap_or(&still);
    Some(MeasuredSignals {
        period_s: recording.sample_period_s,
        measured,
        recorded: RedundantSensors {
            motor_rate: recording.samples(Channel::MotorRate).is_some(),
            hub_position: recording.samples(Channel::HubPosition).is_some(),
        },
        signals: Signals::stack([
            control,
            hub_rate,
            or_still(Channel::PlatformRate),
            or_still(Channel::PlatformAccel),
            or_still(Channel::MotorRate),
            or_still(Channel::HubPosition),
        ]),
    })
}
