//! Why a figure has no number.

use crate::Error;

/// Why a figure was not measured, or has no number.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unmeasured {
    /// The procedure has no road.
    #[error("this experiment was not run: the verification has no road")]
    NoRoad,
    /// The procedure has no triangle.
    #[error("this experiment was not run: the verification has no triangle")]
    NoTriangle,
    /// The nonlinear plant was not simulated.
    #[error("this experiment was not run: the linear plant alone was verified")]
    LinearPlantAlone,
    /// The experiment of the figure was not run for another reason.
    #[error("this experiment was not run")]
    NotRun,
    /// The procedure has no line of sight.
    #[error("this figure was not measured: the project has no [verify.line_of_sight]")]
    NoLineOfSight,
    /// The line of sight has no shots.
    #[error("this figure was not measured: the project has no [verify.line_of_sight.coincidence]")]
    NoCoincidence,
    /// The line of sight has no optics.
    #[error("this figure was not measured: the project has no [verify.line_of_sight.optics]")]
    NoOptics,
    /// The controlled quantity is a position, so that nothing holds the line of sight in space.
    #[error("the loop holds a position on the platform: its line of sight moves with it")]
    HoldsPosition,
    /// The controlled quantity is no motion.
    #[error("the loop holds a torque, a force or a current: nothing holds a line of sight")]
    HoldsEffort,
    /// The plant does not have the signal of the figure.
    #[error("not computed on this plant")]
    NoSuchSignal,
    /// The run ends too early.
    #[error("the run is too short for it")]
    ShortRun,
    /// No sample is left after the settling time.
    #[error("the record is empty")]
    EmptyRecord,
    /// The rise time of a step that does not rise so far.
    #[error("the hub never reaches 90 % of the demand")]
    NoRise,
    /// The peak time of a step without overshoot.
    #[error("the hub never exceeds the demand")]
    NoPeak,
    /// A ratio over a motion that is zero.
    #[error("the platform does not move")]
    PlatformStill,
    /// The figure came out as NaN.
    #[error("not a number")]
    NotANumber,
    /// A requirement on a value that is NaN.
    #[error("it could not be measured")]
    NoValue,
    /// A step response that cannot be read.
    #[error("{0}")]
    StepResponse(Box<Error>),
}
