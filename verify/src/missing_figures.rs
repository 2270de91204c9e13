//! Why a figure has no number.

use crate::Error;

/// Why a figure was not measured, or has no number.
#[derive(Debug, Clone, PartialEq)]
pub enum MissingReason {
    /// The procedure has no road.
    NoRoad,
    /// The procedure has no triangle.
    NoTriangle,
    /// The nonlinear plant was not simulated.
    LinearPlantAlone,
    /// The experiment of the figure was not run for another reason.
    NotRun,
    /// The procedure has no line of sight.
    NoLineOfSight,
    /// The line of sight has no shots.
    NoCoincidence,
    /// The line of sight has no optics.
    NoOptics,
    /// The controlled quantity is a position, so that nothing holds the line of sight in space.
    HoldsPosition,
    /// The controlled quantity is no motion.
    HoldsEffort,
    /// The plant does not have the signal of the figure.
    NoSuchSignal,
    /// The run ends too early.
    ShortRun,
    /// No sample is left after the settling time.
    EmptyRecord,
    /// The rise time of a step that does not rise so far.
    NoRise,
    /// The peak time of a step without overshoot.
    NoPeak,
    /// A ratio over a motion that is zero.
    PlatformStill,
    /// The figure came out as NaN.
    NotANumber,
    /// A requirement on a value that is NaN.
    NoValue,
    /// The stability certificate was not computed beside the verification.
    NoCertificate,
    /// The certificate neither shows a limit cycle nor excludes one.
    NotPredicted,
    /// A step response that cannot be read.
    StepResponse(Box<Error>),
}
