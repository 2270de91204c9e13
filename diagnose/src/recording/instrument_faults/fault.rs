//! The faults of a column of a recording.

use super::column::RecorderColumn;
use crate::tolerance::recording::SAME_UNIT_FACTOR;
use crate::tolerance::recording::UNIT_FACTOR_REACH;

/// Kind of a fault of a recorded column.
#[derive(Debug, Clone, PartialEq)]
pub enum FaultKind {
    /// Written with another factor: a unit, a sign, a gain.
    Scale {
        /// Written = gain x true.
        gain: f64,
        /// Relative doubt of it.
        doubt: f64,
    },
    /// On a clock that is off by a time.
    ClockOffset {
        /// Written late by this, s.
        late_s: f64,
        /// Doubt of it, s.
        doubt_s: f64,
    },
    /// On a clock that runs fast or slow.
    ClockDrift {
        /// Share by which it runs slow.
        slow: f64,
        /// Doubt of it.
        doubt: f64,
    },
    /// A constant added.
    Bias {
        /// Written = true + bias.
        bias: f64,
        /// Doubt of it.
        doubt: f64,
    },
    /// Stands still from time to time.
    Stuck {
        /// The first time, s.
        from_s: f64,
        /// The time in all, s.
        for_s: f64,
        /// Value.
        value: f64,
    },
    /// Cut off at a value.
    Clipped {
        /// The value.
        limit: f64,
        /// Share of the samples that lie there.
        share: f64,
    },
    /// A converter coarser than the project's.
    Coarse {
        /// Step that the readings show.
        step: f64,
        /// Step of the project's converter.
        expected: f64,
    },
    /// Read less often than it was written.
    Held {
        /// Samples for which each reading stands.
        samples: usize,
    },
    /// Written in each other's place.
    Exchanged {
        /// The other column.
        with: RecorderColumn,
    },
}

/// Something wrong with a column.
#[derive(Debug, Clone, PartialEq)]
pub struct InstrumentFault {
    /// The column.
    pub column: RecorderColumn,
    /// Kind of the fault.
    pub kind: FaultKind,
    /// Names of the recordings in which it was seen.
    pub recordings: Vec<String>,
    /// `true` if that is all of them.
    pub everywhere: bool,
    /// Treatment of the fault.
    pub treatment: Treatment,
    /// Columns that could be at fault in its place.
    pub or: Vec<RecorderColumn>,
}

/// Treatment of a fault: the column is corrected or left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Treatment {
    /// The column is used as it is.
    UsedAsItIs,
    /// The control was computed by the recorded controller from demand and hub rate.
    ControlRecomputed,
    /// Straight lines join the readings.
    Interpolated,
    /// The recording is used without these stretches.
    StretchesLeftOut,
    /// These samples are not compared.
    SamplesNotCompared,
    /// The column is not compared.
    NotCompared,
    /// Each column is taken as the other one.
    ExchangedBack,
    /// The column is divided by the gain.
    DividedByGain,
    /// The column is shifted back.
    ShiftedBack,
}

const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// A wrong unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnitMistake {
    /// Degrees instead of radians.
    Degrees,
    /// Divided by 57.3, as if degrees were turned to radians twice.
    RadiansTwice,
    /// Thousandths.
    Thousandths,
    /// Thousands.
    Thousands,
    /// Multiplied by 9.80665, as if g were turned to m/s^2 twice.
    StandardGravityTwice,
    /// g instead of m/s^2.
    StandardGravity,
}

/// Factors by which units differ, and what they mean.
const UNITS: [(f64, UnitMistake); 6] = [
    (DEGREES, UnitMistake::Degrees),
    (1.0 / DEGREES, UnitMistake::RadiansTwice),
    (1e3, UnitMistake::Thousandths),
    (1e-3, UnitMistake::Thousands),
    (9.80665, UnitMistake::StandardGravityTwice),
    (1.0 / 9.80665, UnitMistake::StandardGravity),
];

impl FaultKind {
    /// Returns the step of a coarse converter over that of the project's; `None` for another fault.
    pub fn step_ratio(&self) -> Option<f64> {
        match self {
            FaultKind::Coarse { step, expected } => Some(step / expected),
            _ => None,
        }
    }
}

impl UnitMistake {
    /// Returns the mistake whose factor a gain has, whatever its sign; `None` if it is no unit's.
    pub fn of_gain(gain: f64) -> Option<Self> {
        let size = gain.abs();
        UNITS
            .iter()
            .find(|(factor, _)| (size / factor - 1.0).abs() < SAME_UNIT_FACTOR)
            .map(|(_, mistake)| *mistake)
    }
}

impl FaultKind {
    /// Returns the wrong unit that a factor comes from; `None` if the fault is no factor, or no unit's.
    pub fn unit_mistake(&self) -> Option<UnitMistake> {
        match self {
            FaultKind::Scale { gain, .. } => UnitMistake::of_gain(*gain),
            _ => None,
        }
    }
}

/// The factor that is meant: exactly that of a unit or a sign where it is as near as its doubt and a few percent.
pub(super) fn intended_factor(gain: f64, doubt: f64) -> f64 {
    let near = |known: f64| {
        (gain.abs() / known - 1.0).abs() < UNIT_FACTOR_REACH + doubt.min(2.0 * UNIT_FACTOR_REACH)
    };
    let known = UNITS.iter().map(|(factor, _)| *factor).find(|known| near(*known));
    match known {
        Some(known) => known.copysign(gain),
        None if gain < 0.0 && near(1.0) => -1.0,
        None => gain,
    }
}

/// Returns whether a gain is exactly that of a unit or a sign.
pub(super) fn is_known(gain: f64) -> bool {
    gain == -1.0 || UnitMistake::of_gain(gain).is_some()
}
