//! The remarks about the recordings themselves.

use crate::recording::gap_repair::{Repair, RepairedPart};
use crate::recording::instrument_faults::InstrumentFault;
use crate::recording::sanity_checks::{ControlMismatch, SanityRemark};

/// Treatment of a recording whose platform moves and whose heave was not recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeaveTreatment {
    /// The heave is taken as none.
    TakenAsNone,
    /// The recording is left out.
    LeftOut,
}

/// Comparison state of a channel on which something was remarked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ComparisonState {
    /// The channel is compared.
    Compared,
    /// The channel is not compared.
    NotCompared,
}

/// Something to be reported about the recordings.
#[derive(Debug, Clone, PartialEq)]
pub enum RecordingRemark {
    /// Another controller than the project's was in the loop, so that the recorded control is played back.
    OtherController {
        /// Name of the recording.
        recording: String,
        /// The distance of the recorded control from that of the project's controller.
        mismatch: ControlMismatch,
    },
    /// The platform moves, and its heave was not recorded.
    UnknownHeave {
        /// Name of the recording.
        recording: String,
        /// The treatment of it.
        treatment: HeaveTreatment,
    },
    /// A fault of a sensor or of the recorder.
    Fault(InstrumentFault),
    /// A channel, or the clock, was repaired.
    Repaired {
        /// Name of the recording.
        recording: String,
        /// The part that was repaired.
        part: RepairedPart,
        /// The repair.
        repair: Repair,
    },
    /// A check found something unusual.
    Checked {
        /// The anomaly.
        remark: SanityRemark,
        /// The use of the channel: still compared or left out.
        comparison: ComparisonState,
    },
    /// Only the first part of a recording is used.
    Shortened {
        /// Name of the recording.
        recording: String,
        /// Length that is used, s.
        used_s: f64,
        /// Length of the recording, s.
        length_s: f64,
        /// Number of samples of all recordings together that are replayed.
        most_samples: usize,
    },
}
