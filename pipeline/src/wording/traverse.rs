//! Why a traverse axis does not fit under its elevation axis, in words.

use crate::axes_problem::AxesProblem;

/// Describes why two axes do not fit together, and what to change.
pub(crate) fn describe_axes_problem(problem: AxesProblem) -> &'static str {
    match problem {
        AxesProblem::TwoTraverseAxes => {
            "it has a [traverse] section itself: a machine has one traverse axis under one elevation axis"
        }
        AxesProblem::LinearAxis => "both axes must turn: leave plant.axis at \"rotary\" in both files",
        AxesProblem::CrossAxisSensitivity => {
            "roll_sensitivity and yaw_sensitivity of its gyroscopes must be 0: what they would read of the ring's other rates is not simulated with two axes"
        }
        AxesProblem::OtherLoop => {
            "both loops must hold the inertial rate of their hub: leave plant.sensors.loop at its usual value in both files"
        }
        AxesProblem::Gravity => {
            "plant.gravity must be 0: the axis is upright, and what a tilted base makes of gravity comes with the base's motion"
        }
        AxesProblem::SamplePeriod => "plant.interface.sample_period must be that of the elevation axis",
    }
}
