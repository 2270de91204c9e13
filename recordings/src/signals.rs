//! What the sensors of a machine measure, where that is not the inertial rate of a turning hub.

use crate::Channel;

/// How a part moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Motion {
    /// It turns.
    #[default]
    Turning,
    /// It slides.
    Sliding,
}

/// What the sensor of the loop reads.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Reading {
    /// A rate of the hub.
    #[default]
    HubRate,
    /// The position of the hub relative to the platform.
    HubPosition,
    /// The rate of the motor, which turns so many times as fast as the hub.
    MotorRate {
        /// Motor turns per hub turn, or per travel of a slide.
        ratio: f64,
    },
    /// The position of the motor, which turns so many times as far as the hub.
    MotorPosition {
        /// Motor turns per hub turn, or per travel of a slide.
        ratio: f64,
    },
}

/// The signals of a machine: the units of its channels, and which channel its loop reads.
///
/// [`Channel::HubRate`] holds the reading of the loop's sensor, and [`Channel::Demand`] what is demanded of it. Both are in the unit of what
/// is controlled, on the hub's side of the transmission.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MachineSignals {
    /// How the hub moves.
    pub hub: Motion,
    /// How the motor moves.
    pub motor: Motion,
    /// What the sensor of the loop reads.
    pub reading: Reading,
}

impl MachineSignals {
    /// Returns whether the loop controls a position.
    pub fn controls_position(&self) -> bool {
        matches!(self.reading, Reading::HubPosition | Reading::MotorPosition { .. })
    }

    /// Returns the unit of a channel.
    pub fn unit(&self, channel: Channel) -> &'static str {
        let (motion, is_position) = match channel {
            Channel::Demand | Channel::HubRate => (self.hub, self.controls_position()),
            Channel::PlatformRate => (self.hub, false),
            Channel::HubPosition => (self.hub, true),
            Channel::MotorRate => (self.motor, false),
            Channel::MotorPosition => (self.motor, true),
            _ => return channel.unit(),
        };
        match (motion, is_position) {
            (Motion::Turning, false) => "rad/s",
            (Motion::Turning, true) => "rad",
            (Motion::Sliding, false) => "m/s",
            (Motion::Sliding, true) => "m",
        }
    }

    /// Returns the channel by whose name the reading is recorded too, and the factor that makes it the reading; `None` if there is none.
    ///
    /// A column of this channel is taken for the reading, so that a log of an encoder need not call its position a rate.
    pub fn reading_channel(&self) -> Option<(Channel, f64)> {
        match self.reading {
            Reading::HubRate => None,
            Reading::HubPosition => Some((Channel::HubPosition, 1.0)),
            Reading::MotorRate { ratio } => Some((Channel::MotorRate, 1.0 / ratio)),
            Reading::MotorPosition { ratio } => Some((Channel::MotorPosition, 1.0 / ratio)),
        }
    }
}
