//! Remarks about the columns of a recording while it was read.

use counterpoise_diagnose::learning::visited_ranges::RangeExceedance;
use counterpoise_diagnose::recording::gap_repair::{Repair, RepairedPart};
use counterpoise_diagnose::recording::sanity_checks::{Anomaly, ControlMismatch};
use counterpoise_recordings::{Channel, Remark};

/// Something found about the columns of a recording.
#[derive(Debug, Clone, PartialEq)]
pub enum ColumnRemark {
    /// Found when the file was read.
    File(Remark),
    /// Readings lie beyond the range of their converter.
    BeyondRange {
        /// The channel.
        channel: Channel,
        /// The number of samples, and their place.
        found: BeyondRange,
    },
    /// Repaired.
    Repair {
        /// The part that was repaired.
        part: RepairedPart,
        /// The repair.
        repair: Repair,
    },
    /// The recorded control is not what the project's recording controller makes of the recorded measurements.
    Controller(ControlMismatch),
    /// A channel looks wrong whatever the mechanism is.
    Anomaly {
        /// The channel.
        channel: Channel,
        /// Anomaly that was found.
        anomaly: Anomaly,
    },
    /// The recording leaves the range over which a free function of the mechanism is known.
    RangeExceeded(RangeExceedance),
}

/// A column of a file that was not used.
#[derive(Debug, Clone, PartialEq)]
pub struct UnusedColumn {
    /// Name of the recording.
    pub recording: String,
    /// Why the column was not used.
    pub remark: Remark,
}

/// Readings of a channel beyond the range of its converter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeyondRange {
    /// Number of readings.
    pub samples: usize,
    /// Number of those that count as missing, because no fault of a scale explains them.
    pub missing: usize,
    /// Row of the first, from 1.
    pub first_row: usize,
    /// Value, in the channel's unit.
    pub value: f64,
    /// Range of the converter, in the channel's unit: readings lie between minus and plus this.
    pub limit: f64,
}
