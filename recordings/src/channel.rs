//! The quantities of the mechanism that a recording can hold.

/// A quantity of the mechanism that a recording can hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Channel {
    /// Demanded hub rate, rad/s.
    Demand,
    /// Control after the output converter, V.
    Control,
    /// Hub gyroscope, rad/s.
    HubRate,
    /// Platform gyroscope, rad/s.
    PlatformRate,
    /// Platform accelerometer, m/s^2.
    PlatformAccel,
    /// Motor tachometer, rad/s.
    MotorRate,
    /// Hub angle relative to the platform, rad.
    HubPosition,
    /// Motor angle relative to the platform, rad.
    MotorPosition,
    /// Motor current, A.
    MotorCurrent,
    /// Second platform accelerometer: surge, m/s^2.
    PlatformSurge,
    /// Inertial rate of the platform about its forward axis, rad/s; no controller reads it.
    PlatformRoll,
    /// Inertial rate of the platform about its upward axis, rad/s; no controller reads it.
    PlatformYaw,
}

/// Quantity of a loop's sensor and demand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LoopQuantity {
    /// A rate.
    #[default]
    Rate,
    /// A position.
    Position,
    /// A torque or a force.
    Torque,
    /// A current.
    Current,
}

/// Kind of an axis' motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Travel {
    /// The axis turns: angles in rad.
    #[default]
    Turning,
    /// The axis slides: places in m.
    Sliding,
}

/// Units of the channels of a machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ChannelUnits {
    /// Quantity of the loop's sensor, which is the channel `hub_rate`.
    pub reading: LoopQuantity,
    /// Quantity of the demand.
    pub demand: LoopQuantity,
    /// Kind of the axis' motion.
    pub travel: Travel,
}

impl ChannelUnits {
    /// Returns the unit of a channel of the machine.
    pub fn of(self, channel: Channel) -> &'static str {
        let controlled = |what: LoopQuantity| match (what, self.travel) {
            (LoopQuantity::Rate, Travel::Turning) => "rad/s",
            (LoopQuantity::Rate, Travel::Sliding) => "m/s",
            (LoopQuantity::Position, Travel::Turning) => "rad",
            (LoopQuantity::Position, Travel::Sliding) => "m",
            (LoopQuantity::Torque, Travel::Turning) => "N m",
            (LoopQuantity::Torque, Travel::Sliding) => "N",
            (LoopQuantity::Current, _) => "A",
        };
        match channel {
            Channel::Demand => controlled(self.demand),
            Channel::HubRate => controlled(self.reading),
            Channel::HubPosition => controlled(LoopQuantity::Position),
            other => other.unit(),
        }
    }
}

impl Channel {
    /// All channels.
    pub const ALL: [Self; 12] = [
        Self::Demand,
        Self::Control,
        Self::HubRate,
        Self::PlatformRate,
        Self::PlatformAccel,
        Self::MotorRate,
        Self::HubPosition,
        Self::MotorPosition,
        Self::MotorCurrent,
        Self::PlatformSurge,
        Self::PlatformRoll,
        Self::PlatformYaw,
    ];

    /// Returns the channel's name in files and results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Demand => "demand",
            Self::Control => "control",
            Self::HubRate => "hub_rate",
            Self::PlatformRate => "platform_rate",
            Self::PlatformAccel => "platform_accel",
            Self::MotorRate => "motor_rate",
            Self::HubPosition => "hub_position",
            Self::MotorPosition => "motor_position",
            Self::MotorCurrent => "motor_current",
            Self::PlatformSurge => "platform_surge",
            Self::PlatformRoll => "platform_roll",
            Self::PlatformYaw => "platform_yaw",
        }
    }

    /// Returns the channel's unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Demand | Self::HubRate | Self::PlatformRate | Self::MotorRate => "rad/s",
            Self::PlatformRoll | Self::PlatformYaw => "rad/s",
            Self::Control => "V",
            Self::PlatformAccel | Self::PlatformSurge => "m/s^2",
            Self::HubPosition | Self::MotorPosition => "rad",
            Self::MotorCurrent => "A",
        }
    }

    /// Returns whether it is a motion of the platform.
    pub fn is_of_platform(self) -> bool {
        matches!(
            self,
            Self::PlatformRate
                | Self::PlatformAccel
                | Self::PlatformSurge
                | Self::PlatformRoll
                | Self::PlatformYaw
        )
    }

    /// Returns whether the value holds from one sample to the next, as that of an output converter does, rather than being
    /// the reading of a continuous quantity at one instant.
    pub fn is_held(self) -> bool {
        matches!(self, Self::Control | Self::Demand)
    }
}
