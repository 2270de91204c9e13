//! Why a run has no derivatives.

use crate::Error;

/// A reason for which the derivatives of a run are not there. The run itself may be sound.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SensitivityRefusal {
    /// The run itself was refused or ended early.
    #[error(transparent)]
    Run(#[from] Error),
    /// A part of the machine or of the scenario whose derivatives the engine does not have.
    #[error("the derivatives along a run do not cover {part}: take differences of runs in their place")]
    Part {
        /// The part.
        part: &'static str,
    },
    /// A law of friction whose torque jumps at instants that the engine does not seek.
    #[error(
        "the torque of {law} jumps where a bond breaks, and the outputs with it: they have no derivative"
    )]
    Jump {
        /// The law.
        law: &'static str,
    },
    /// A direction along which the machine changes its structure.
    #[error("direction {direction} changes {what}, which is no matter of degree")]
    Structure {
        /// Place of the direction.
        direction: usize,
        /// The part that changes.
        what: &'static str,
    },
    /// An event that a small change moves by far, or makes disappear.
    #[error(
        "at {time_s} s {event} only grazes its limit: a small change may leave it out, and the outputs jump"
    )]
    Grazing {
        /// When.
        time_s: f64,
        /// The event.
        event: &'static str,
    },
    /// Two events at one instant, of which a small change may exchange the order.
    #[error("at {time_s} s two events fall on one instant: their order decides what follows")]
    Simultaneous {
        /// When.
        time_s: f64,
    },
}
