//! The signals that a controller can use.

use serde::{Deserialize, Serialize};

use crate::Readings;

/// Largest number of readings that the step of a controller takes.
pub const READINGS: usize = 7;

/// Number of readings that every controller takes, and that its linear part has as inputs. The one beyond them, the surge of the platform, is
/// taken by controllers with a [`Projection`](crate::Projection) alone.
pub const COMMON_READINGS: usize = 6;

/// Names of the readings with their units, in the order of the step's inputs.
pub const READING_NAMES: [&str; READINGS] = [
    "demand_rad_s",
    "hub_rate_rad_s",
    "platform_rate_rad_s",
    "platform_accel_m_s2",
    "motor_rate_rad_s",
    "hub_position_rad",
    "platform_surge_m_s2",
];

/// Index of the demand among the readings.
pub const DEMAND: usize = 0;
/// Index of the hub gyroscope among the readings.
pub const HUB_RATE: usize = 1;
/// Index of the hub's angle among the readings.
pub const HUB_POSITION: usize = 5;
/// Index of the platform gyroscope among the readings.
pub const PLATFORM_RATE: usize = 2;
/// Index of the heave accelerometer among the readings.
pub const PLATFORM_ACCELERATION: usize = 3;
/// Index of the surge accelerometer among the readings.
pub const PLATFORM_SURGE: usize = 6;

/// A signal that a path of the controller uses. Its name in a file is [`PathSignal::name`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum PathSignal {
    /// Demanded hub rate after the reference prefilter, rad/s.
    #[serde(rename = "filtered_demand_rad_s")]
    Demand,
    /// Hub gyroscope, rad/s.
    #[serde(rename = "hub_rate_rad_s")]
    HubRate,
    /// Demand after the prefilter less hub rate, rad/s.
    #[serde(rename = "rate_error_rad_s")]
    RateError,
    /// Platform gyroscope, rad/s.
    #[serde(rename = "platform_rate_rad_s")]
    PlatformRate,
    /// Platform accelerometer (heave), m/s^2.
    #[serde(rename = "platform_accel_m_s2")]
    PlatformAcceleration,
    /// Motor tachometer, rad/s relative to the platform.
    #[serde(rename = "motor_rate_rad_s")]
    MotorRate,
    /// Hub angle relative to the platform, rad.
    #[serde(rename = "hub_position_rad")]
    HubPosition,
    /// Hub rate less platform rate, rad/s.
    #[serde(rename = "relative_rate_rad_s")]
    RelativeRate,
    /// The limited control of the sample before, V.
    #[serde(rename = "previous_control_v")]
    PreviousControl,
}

impl PathSignal {
    /// Returns the reading behind the signal, if it is one; the demand is filtered first.
    pub fn reading(self) -> Option<usize> {
        match self {
            PathSignal::Demand => Some(0),
            PathSignal::HubRate => Some(1),
            PathSignal::PlatformRate => Some(2),
            PathSignal::PlatformAcceleration => Some(3),
            PathSignal::MotorRate => Some(4),
            PathSignal::HubPosition => Some(5),
            PathSignal::RateError | PathSignal::RelativeRate | PathSignal::PreviousControl => None,
        }
    }

    /// Returns the name with unit, as target code carries it.
    pub fn name(self) -> &'static str {
        match self {
            PathSignal::Demand => "filtered_demand_rad_s",
            PathSignal::RateError => "rate_error_rad_s",
            PathSignal::RelativeRate => "relative_rate_rad_s",
            PathSignal::PreviousControl => "previous_control_v",
            PathSignal::HubRate => READING_NAMES[1],
            PathSignal::PlatformRate => READING_NAMES[2],
            PathSignal::PlatformAcceleration => READING_NAMES[3],
            PathSignal::MotorRate => READING_NAMES[4],
            PathSignal::HubPosition => READING_NAMES[5],
        }
    }
}

impl Readings {
    /// Returns the readings in the order of [`READING_NAMES`].
    pub fn to_array(&self) -> [f64; READINGS] {
        [
            self.demand_rad_s,
            self.hub_rate_rad_s,
            self.platform_rate_rad_s,
            self.platform_accel_m_s2,
            self.motor_rate_rad_s,
            self.hub_position_rad,
            self.platform_surge_m_s2,
        ]
    }

    /// Returns readings from values in the order of [`READING_NAMES`].
    pub fn from_array(values: [f64; READINGS]) -> Self {
        let [demand, hub, platform, accel, motor, position, surge] = values;
        Self {
            demand_rad_s: demand,
            hub_rate_rad_s: hub,
            platform_rate_rad_s: platform,
            platform_accel_m_s2: accel,
            motor_rate_rad_s: motor,
            hub_position_rad: position,
            platform_surge_m_s2: surge,
        }
    }
}
