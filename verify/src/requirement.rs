//! Requirements and verdicts.

use std::fmt;

use crate::{Error, MissingReason, PerformanceFigure};

/// The side on which a figure has to stay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Limit {
    /// The figure must not be below.
    AtLeast(f64),
    /// The figure must not be above.
    AtMost(f64),
}

/// One figure and its limit.
#[derive(Debug, Clone, PartialEq)]
pub struct Requirement {
    /// Figure.
    pub figure: PerformanceFigure,
    /// Limit, in the figure's unit.
    pub limit: Limit,
    /// Source of the requirement, for example the clause of a specification; empty if it is not stated.
    pub source: String,
}

/// Verdict on a requirement.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// The figure is on the right side of its limit.
    Holds {
        /// Measured value.
        value: f64,
        /// Requested limit.
        limit: Limit,
        /// By how much there is room, at least 0.
        margin: f64,
    },
    /// The figure is on the wrong side.
    Fails {
        /// The measured value; NaN never occurs.
        value: f64,
        /// Requested limit.
        limit: Limit,
        /// By how much it falls short, above 0.
        by: f64,
    },
    /// The figure could not be measured on this plant or with this controller.
    NotApplicable {
        /// Why.
        why: MissingReason,
    },
}

impl Verdict {
    /// Returns the room to the limit, or what is missing to it, relative to the limit; `None` if the figure could not be measured.
    pub fn relative_distance(&self) -> Option<f64> {
        let (Verdict::Holds { limit, margin: distance, .. } | Verdict::Fails { limit, by: distance, .. }) =
            self
        else {
            return None;
        };
        Some(distance / limit.value().abs().max(f64::MIN_POSITIVE))
    }
}

impl Limit {
    /// Returns the bare number.
    pub fn value(self) -> f64 {
        match self {
            Limit::AtLeast(value) | Limit::AtMost(value) => value,
        }
    }

    /// Returns on which side of it a value holds: `at least` or `at most`.
    pub fn side(self) -> &'static str {
        match self {
            Limit::AtLeast(_) => "at least",
            Limit::AtMost(_) => "at most",
        }
    }

    /// Returns the room left between `value` and the limit: negative where the limit is broken, NaN for a NaN.
    pub fn distance_to_limit(self, value: f64) -> f64 {
        match self {
            Limit::AtLeast(limit) => value - limit,
            Limit::AtMost(limit) => limit - value,
        }
    }

    /// Holds `value` against the limit as [`Requirement::judge`] does.
    pub fn judge(self, value: f64) -> Verdict {
        let room = self.distance_to_limit(value);
        if room.is_nan() {
            Verdict::NotApplicable { why: MissingReason::NoValue }
        } else if room >= 0.0 {
            Verdict::Holds { value, limit: self, margin: room }
        } else {
            Verdict::Fails { value, limit: self, by: -room }
        }
    }
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.side(), self.value())
    }
}

impl Requirement {
    /// Returns a requirement with a finite limit.
    ///
    /// # Errors
    /// [`Error::Range`] if the limit is NaN or infinite.
    pub fn new(figure: PerformanceFigure, limit: Limit) -> Result<Self, Error> {
        if !limit.value().is_finite() {
            return Err(Error::Range {
                what: "limit of a requirement",
                value: limit.value(),
                allowed: "finite",
            });
        }
        Ok(Self { figure, limit, source: String::new() })
    }

    /// Returns the requirement with the text that says where it comes from.
    pub fn with_source(self, source: &str) -> Self {
        Self { source: source.to_owned(), ..self }
    }

    /// Holds `value` against the limit. A value exactly at the limit holds; a value that is not a number cannot be judged.
    pub fn judge(&self, value: f64) -> Verdict {
        self.limit.judge(value)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;
    use crate::LoopFigure;

    #[test]
    fn a_verdict_says_by_how_much() {
        let requirement =
            Requirement::new(PerformanceFigure::Loop(LoopFigure::GainMargin), Limit::AtLeast(12.0)).unwrap();
        assert_eq!(
            requirement.judge(13.5),
            Verdict::Holds { value: 13.5, limit: Limit::AtLeast(12.0), margin: 1.5 }
        );
        assert_eq!(
            requirement.judge(11.0),
            Verdict::Fails { value: 11.0, limit: Limit::AtLeast(12.0), by: 1.0 }
        );
        assert!(matches!(requirement.judge(f64::INFINITY), Verdict::Holds { .. }));
        assert!(matches!(requirement.judge(f64::NAN), Verdict::NotApplicable { .. }));
        assert!(matches!(requirement.judge(12.0), Verdict::Holds { margin: 0.0, .. }));
    }
}
