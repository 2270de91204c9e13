//! The obstacles of a design: which part, which weight, at which frequency, and what is wrong.

use crate::DisturbanceChannel;
use crate::cause::Cause;
use crate::weight::Weight;

/// Severity of a finding of a design.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FindingSeverity {
    /// The problem has no solution as it is put.
    Refusal,
    /// There is a solution, but perhaps not the one that is wanted.
    Warning,
}

/// Part of a design.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The plant, its sensors or its delay.
    Plant,
    /// The feedback.
    Feedback,
    /// The heave feedforward.
    Heave,
    /// The pitch feedforward.
    Pitch,
    /// A generalised plant.
    Generalised,
}

impl From<DisturbanceChannel> for Part {
    fn from(channel: DisturbanceChannel) -> Self {
        match channel {
            DisturbanceChannel::Heave => Part::Heave,
            DisturbanceChannel::Pitch => Part::Pitch,
        }
    }
}

/// Signal that a weight weighs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WeightRole {
    /// The error.
    Error,
    /// The control.
    Control,
    /// Nothing: it generates the spectrum of a disturbance.
    Generator,
}

/// A weight that a finding concerns.
#[derive(Debug, Clone, PartialEq)]
pub struct ConcernedWeight {
    /// Signal that it weighs.
    pub role: WeightRole,
    /// The weight itself.
    pub weight: Weight,
}

/// One thing that stands in a design's way.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignFinding {
    /// The severity: whether the design can go on.
    pub severity: FindingSeverity,
    /// Part that is concerned.
    pub part: Part,
    /// The weight that is concerned.
    pub weight: Option<ConcernedWeight>,
    /// The frequency that is concerned, rad/s; infinite for "at high frequency".
    pub rate_rad_s: Option<f64>,
    /// Cause.
    pub cause: Cause,
}

impl DesignFinding {
    /// Returns a refusal.
    pub fn refusal(part: Part, cause: Cause) -> Self {
        Self { severity: FindingSeverity::Refusal, part, weight: None, rate_rad_s: None, cause }
    }

    /// Returns a warning.
    pub fn warning(part: Part, cause: Cause) -> Self {
        Self { severity: FindingSeverity::Warning, ..Self::refusal(part, cause) }
    }

    /// Returns the finding with the weight named.
    pub fn with_weight(self, role: WeightRole, weight: &Weight) -> Self {
        Self { weight: Some(ConcernedWeight { role, weight: weight.clone() }), ..self }
    }

    /// Returns the finding with the frequency named.
    pub fn at(self, rate_rad_s: f64) -> Self {
        Self { rate_rad_s: Some(rate_rad_s), ..self }
    }

    /// Returns whether the design cannot go on.
    pub fn is_refusal(&self) -> bool {
        self.severity == FindingSeverity::Refusal
    }
}
