//! The contradictions between two axes.

/// Why two axes do not fit together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum AxesProblem {
    /// The traverse axis has a traverse axis itself.
    TwoTraverseAxes,
    /// An axis does not turn.
    LinearAxis,
    /// The gyroscopes of the traverse axis read other rates too.
    CrossAxisSensitivity,
    /// A loop does not hold the inertial rate of its hub.
    OtherLoop,
    /// Gravity acts on the traverse axis.
    Gravity,
    /// The controllers do not run at the same rate.
    SamplePeriod,
}
