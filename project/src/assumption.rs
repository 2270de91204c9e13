//! The values that a file leaves open: values that are assumed, and how far values may lie from what is written.

use crate::file::SettingValue;
use serde::Serialize;

/// Latest reading that is usual for a sensor whose delay is not stated, s: digital sensors filter and transmit for up to two milliseconds.
pub const LATEST_USUAL_READING_S: f64 = 2e-3;

/// Latest reading that is usual for an encoder or for a current sensor, s: a counter is read at once, or sent by a serial link within a tenth of a millisecond, and a
/// drive samples its current with its own clock.
pub(crate) const LATEST_USUAL_COUNT_S: f64 = 1e-4;

/// Lowest natural frequency that is usual for a gyroscope, rad/s: 100 Hz, as data sheets of gyroscopes state their bandwidth.
pub(crate) const SLOWEST_USUAL_GYROSCOPE_RAD_S: f64 = 628.0;
/// Lowest natural frequency that is usual for a tachometer, a resolver with its converter, or for a torque sensor, rad/s: 300 Hz.
pub(crate) const SLOWEST_USUAL_READING_RAD_S: f64 = 1885.0;
/// Lowest natural frequency that is usual for an encoder with its interpolation or filter, or for a current sensor, rad/s: 3 kHz, beside their usual delay.
pub(crate) const SLOWEST_USUAL_COUNT_RAD_S: f64 = 18850.0;
/// Lowest bandwidth of a drive's current loop that is usual, rad/s: 1 kHz, beside its usual delay.
pub const SLOWEST_USUAL_DRIVE_RAD_S: f64 = 6283.0;
/// Latest action that is usual for a drive that controls its current, s: it samples its command with its own clock, and switches a period later.
pub const LATEST_USUAL_DRIVE_S: f64 = 2e-4;

/// A value that the file does not have and that a default stands in for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Assumption {
    /// Path of the key or section that is absent.
    pub key: String,
    /// The value that is taken; infinite if nothing limits it.
    pub value: f64,
    /// Unit; empty for a pure number.
    pub unit: &'static str,
    /// Meaning of the value.
    pub meaning: &'static str,
    /// The rule by which it is taken.
    pub rule: &'static str,
    /// Why the rule holds, or where it comes from.
    pub source: &'static str,
    /// Lowest and highest value that are usual; `None` if nothing is known about them.
    pub usual: Option<[f64; 2]>,
}

/// Tolerance of the value of a key: evenly distributed within the half-width.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KeyTolerance {
    /// Path of the key.
    pub key: String,
    /// The value that is written, in the unit of the key.
    pub value: f64,
    /// Half-width of the distribution, in the unit of the key.
    pub half_width: f64,
    /// The unit of the key; empty for a pure number.
    pub unit: &'static str,
    /// Notation of the tolerance.
    pub kind: ToleranceKind,
}

/// Notation of a tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToleranceKind {
    /// As a fraction of the value.
    Relative,
    /// In the unit of the value.
    Absolute,
}

impl KeyTolerance {
    /// Returns the lowest and the highest value.
    pub fn range(&self) -> [f64; 2] {
        [self.value - self.half_width, self.value + self.half_width]
    }

    /// Returns the tolerance as the value of its key.
    pub(crate) fn setting(&self) -> SettingValue {
        match self.kind {
            ToleranceKind::Relative => SettingValue::Number(self.half_width / self.value.abs()),
            ToleranceKind::Absolute => {
                SettingValue::Text(format!("{} {}", crate::file::setting::number(self.half_width), self.unit))
            }
        }
    }

    /// Returns the tolerance as the file spells it.
    pub(crate) fn as_written(&self) -> String {
        self.setting().as_written()
    }
}
