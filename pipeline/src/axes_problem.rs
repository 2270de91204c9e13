//! The contradictions between two axes.

/// Why two axes do not fit together, and what to change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum AxesProblem {
    /// The traverse axis has a traverse axis itself.
    #[error("it has a [traverse] section itself: a machine has one traverse axis under one elevation axis")]
    TwoTraverseAxes,
    /// An axis does not turn.
    #[error("both axes must turn: leave plant.axis at \"rotary\" in both files")]
    LinearAxis,
    /// The gyroscopes of the traverse axis read other rates too.
    #[error(
        "roll_sensitivity and yaw_sensitivity of its gyroscopes must be 0: what they would read of the ring's other rates is not simulated with two axes"
    )]
    CrossAxisSensitivity,
    /// A loop does not hold the inertial rate of its hub.
    #[error(
        "both loops must hold the inertial rate of their hub: leave plant.sensors.loop at its usual value in both files"
    )]
    OtherLoop,
    /// Gravity acts on the traverse axis.
    #[error(
        "plant.gravity must be 0: the axis is upright, and what a tilted base makes of gravity comes with the base's motion"
    )]
    Gravity,
    /// The controllers do not run at the same rate.
    #[error("plant.interface.sample_period must be that of the elevation axis")]
    SamplePeriod,
}
