//! What can be wrong with a column of a recording, in words and for a machine.

use crate::findings::answer::{Finding, FittedParameter, Name};
use crate::tolerance::RIGHT_WHERE_EXPLAINED;

use super::column::Column;

/// What is wrong with a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Kind {
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
        /// How long in all, s.
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
        with: Column,
    },
}

/// Something wrong with a column.
#[derive(Debug, Clone, PartialEq)]
pub struct InstrumentFault {
    /// The column.
    pub column: Column,
    /// What is wrong.
    pub kind: Kind,
    /// Names of the recordings in which it was seen.
    pub recordings: Vec<String>,
    /// Whether that is all of them.
    pub everywhere: bool,
    /// What was done about it.
    pub done: &'static str,
    /// Columns that could be at fault in its place.
    pub or: Vec<Column>,
}

const DEGREES: f64 = 180.0 / std::f64::consts::PI;
/// Factors by which units differ, and what they mean.
const UNITS: [(f64, &str); 6] = [
    (DEGREES, "in degrees instead of radians"),
    (1.0 / DEGREES, "divided by 57.3, as if degrees were turned to radians twice"),
    (1e3, "in thousandths"),
    (1e-3, "in thousands"),
    (9.80665, "multiplied by 9.80665, as if g were turned to m/s^2 twice"),
    (1.0 / 9.80665, "in g instead of m/s^2"),
];
/// A factor is a unit's where it is as near as this, relative.
const NEAR: f64 = 0.03;

/// The factor that is meant: exactly that of a unit or a sign where it is as near as its doubt and a few percent.
pub(super) fn meant(gain: f64, doubt: f64) -> f64 {
    let near = |known: f64| (gain.abs() / known - 1.0).abs() < NEAR + doubt.min(2.0 * NEAR);
    let known = UNITS.iter().map(|(factor, _)| *factor).find(|known| near(*known));
    match known {
        Some(known) => known.copysign(gain),
        None if gain < 0.0 && near(1.0) => -1.0,
        None => gain,
    }
}

/// Whether a gain is exactly that of a unit or a sign.
pub(super) fn is_known(gain: f64) -> bool {
    gain == -1.0 || UNITS.iter().any(|(factor, _)| (gain.abs() / factor - 1.0).abs() < 1e-9)
}

impl Kind {
    /// Name of the effect.
    pub fn effect(&self) -> &'static str {
        match self {
            Self::Scale { .. } => "scale",
            Self::ClockOffset { .. } => "clock_offset",
            Self::ClockDrift { .. } => "clock_drift",
            Self::Bias { .. } => "bias",
            Self::Stuck { .. } => "stuck",
            Self::Clipped { .. } => "clipped",
            Self::Coarse { .. } => "quantisation",
            Self::Held { .. } => "sample_rate",
            Self::Exchanged { .. } => "exchanged",
        }
    }

    /// In plain words, after the column's name.
    fn in_words(&self) -> String {
        match self {
            Self::Scale { gain, .. } => scale_in_words(*gain),
            Self::ClockOffset { late_s, .. } => {
                let word = if *late_s > 0.0 { "late" } else { "early" };
                format!("is {:.1} ms {word}: its clock has an offset", 1e3 * late_s.abs())
            }
            Self::ClockDrift { slow, .. } => {
                let word = if *slow > 0.0 { "slow" } else { "fast" };
                format!("is on a clock that runs {:.0} ppm {word}", 1e6 * slow.abs())
            }
            Self::Bias { bias, .. } => format!("has {bias:.4} added to it"),
            Self::Stuck { from_s, for_s, value } => {
                format!("is stuck at {value:.6} from {from_s:.3} s on, for {for_s:.3} s in all")
            }
            Self::Clipped { limit, share } => {
                format!("is clipped at {limit:.6}: {:.1} % of its samples lie there", 100.0 * share)
            }
            Self::Coarse { step, expected } => format!(
                "moves in steps of {step:.3e}, {:.0} times the step of the project's converter",
                step / expected
            ),
            Self::Held { samples } => {
                format!("changes only every {samples} samples: it was recorded at a lower rate and held")
            }
            Self::Exchanged { with } => format!("and {} stand in each other's place", with.name()),
        }
    }

    fn parameters(&self) -> Vec<FittedParameter> {
        let one = |name, value: f64, unit, before, doubt: f64| {
            vec![FittedParameter { name, value, unit, before, ci95: [value - doubt, value + doubt] }]
        };
        match *self {
            Self::Scale { gain, doubt } => one("gain", gain, "1", 1.0, (gain * doubt).abs()),
            Self::ClockOffset { late_s, doubt_s } => one("offset", late_s, "s", 0.0, doubt_s),
            Self::ClockDrift { slow, doubt } => one("drift", slow, "1", 0.0, doubt),
            Self::Bias { bias, doubt } => one("bias", bias, "", 0.0, doubt),
            Self::Stuck { from_s, .. } => one("from", from_s, "s", 0.0, 0.0),
            Self::Clipped { limit, .. } => one("limit", limit, "", 0.0, 0.0),
            Self::Coarse { step, expected } => one("step", step, "", expected, 0.0),
            Self::Held { samples } => one("samples", samples as f64, "1", 1.0, 0.0),
            Self::Exchanged { .. } => Vec::new(),
        }
    }
}

fn scale_in_words(gain: f64) -> String {
    let size = gain.abs();
    let unit = UNITS.iter().find(|(factor, _)| (size / factor - 1.0).abs() < 1e-9).map(|(_, words)| *words);
    match (unit, gain < 0.0) {
        (Some(unit), false) => format!("is {unit}"),
        (Some(unit), true) => format!("is {unit}, and its sign is swapped"),
        (None, true) if size == 1.0 => "has its sign swapped".to_owned(),
        (None, true) => format!("is {gain:.4} times what it should be: its sign is swapped, too"),
        (None, false) => format!("is {gain:.4} times what it should be"),
    }
}

impl InstrumentFault {
    /// In plain words: what is wrong in which recordings, and what was done.
    pub fn in_words(&self) -> String {
        let mut out = format!("{} {}{}", self.column.name(), self.kind.in_words(), self.place());
        if !self.or.is_empty() {
            let others: Vec<&str> = self.or.iter().map(|c| c.name()).collect();
            out += &format!("; these recordings cannot tell it from a fault of {}", others.join(" or "));
        }
        format!("{out}; {}", self.done)
    }

    fn place(&self) -> String {
        if self.everywhere { String::new() } else { format!(" (in {})", self.recordings.join(", ")) }
    }

    /// As a finding of a diagnosis.
    pub fn finding(&self) -> Finding {
        let other = |column: &Column| Name { effect: self.kind.effect(), component: column.component() };
        let exchanged = match self.kind {
            Kind::Exchanged { with } => vec![other(&with)],
            _ => Vec::new(),
        };
        let alternatives: Vec<Name> = self.or.iter().map(other).chain(exchanged).collect();
        Finding {
            effect: self.kind.effect(),
            component: self.column.component(),
            probability: RIGHT_WHERE_EXPLAINED / (1.0 + self.or.len() as f64),
            when: if self.everywhere {
                "in every recording".to_owned()
            } else {
                format!("in {}", self.recordings.join(", "))
            },
            explanation: format!("A fault of the sensor or the recorder, no physics: {}.", self.in_words()),
            parameters: self.kind.parameters(),
            alternatives,
        }
    }
}
