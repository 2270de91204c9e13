//! The columns of a recording.

use counterpoise_models::{CONVERTER_RANGE_V, Parameters, Sensor};
use counterpoise_recordings::{Channel, Recording};

/// A column of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum RecorderColumn {
    /// Demanded hub rate.
    Demand,
    /// Control.
    Control,
    /// Hub gyroscope.
    HubRate,
    /// Platform gyroscope.
    PlatformRate,
    /// Platform accelerometer.
    PlatformAccel,
    /// Motor tachometer.
    MotorRate,
    /// Hub resolver.
    HubPosition,
}

impl RecorderColumn {
    /// All columns.
    pub const ALL: [Self; 7] = [
        Self::Demand,
        Self::Control,
        Self::HubRate,
        Self::PlatformRate,
        Self::PlatformAccel,
        Self::MotorRate,
        Self::HubPosition,
    ];
    /// The columns that a sensor writes.
    pub(super) const SENSORS: [Self; 5] =
        [Self::HubRate, Self::PlatformRate, Self::PlatformAccel, Self::MotorRate, Self::HubPosition];

    /// Returns the channel that the column holds.
    pub fn channel(self) -> Channel {
        match self {
            Self::Demand => Channel::Demand,
            Self::Control => Channel::Control,
            Self::HubRate => Channel::HubRate,
            Self::PlatformRate => Channel::PlatformRate,
            Self::PlatformAccel => Channel::PlatformAccel,
            Self::MotorRate => Channel::MotorRate,
            Self::HubPosition => Channel::HubPosition,
        }
    }

    /// Returns the name in recordings.
    pub fn name(self) -> &'static str {
        self.channel().name()
    }

    /// Returns the values, if they were recorded.
    pub(super) fn of(self, r: &Recording) -> Option<&[f64]> {
        r.samples(self.channel())
    }

    /// Returns the values, to be changed; `None` if they were not recorded.
    pub fn of_mut(self, r: &mut Recording) -> Option<&mut [f64]> {
        r.samples_mut(self.channel())
    }

    /// Returns the step of the converter that the column went through, in its own unit; `None` if there is none.
    pub(super) fn converter_step(self, p: &Parameters) -> Option<f64> {
        match self {
            Self::Demand => None,
            Self::Control => Some(p.interface.control_step_v()),
            _ => Some(p.interface.reading_step(self.sensor(p)?)),
        }
    }

    /// Returns the largest reading that the converter gives, in the column's unit; `None` if there is no converter.
    pub(super) fn converter_limit(self, p: &Parameters) -> Option<f64> {
        match self {
            Self::Demand => None,
            Self::Control => Some(CONVERTER_RANGE_V),
            _ => Some(CONVERTER_RANGE_V / self.sensor(p)?.scale_v_unit),
        }
    }

    /// Returns the sensor that writes the column, as the project describes it.
    pub(super) fn sensor(self, p: &Parameters) -> Option<&Sensor> {
        match self {
            Self::Demand | Self::Control => None,
            Self::HubRate => Some(&p.sensors.hub_gyro),
            Self::PlatformRate => Some(&p.sensors.platform_gyro),
            Self::PlatformAccel => Some(&p.sensors.platform_accelerometer),
            Self::MotorRate => p.sensors.motor_tachometer.as_ref(),
            Self::HubPosition => p.sensors.hub_resolver.as_ref(),
        }
    }
}
