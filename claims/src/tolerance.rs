//! The numbers that decide in the measurements of the claims, each with its reason.

/// Relative and absolute tolerance of a step, on states divided by their own size.
pub(crate) const STEP_TOLERANCE: f64 = 1e-5;

/// A state counts as unobservable below this share of the system's size.
pub(crate) const UNSEEN_STATE: f64 = 1e-11;

/// Least error over tolerance that a step is given: the next step's length divides by a power of it. So small an error lengthens the step
/// by the largest factor anyway.
pub(crate) const LEAST_STEP_ERROR: f64 = 1e-10;

/// Length below which nothing but rounding is left of a vector of unit length from which its projections were taken.
pub(crate) const LEAST_LENGTH: f64 = 1e-12;

/// The hub rate has returned where it is within this times the default case's.
pub(crate) const RETURNED: f64 = 1.1;

/// The largest error of a reduction, relative to the largest response, that keeps the response: the thesis' figure does not show 5 %.
pub(crate) const KEPT_RESPONSE: f64 = 0.05;

/// The closed loop is the same where smaller numbers cost no more of its error than this, dB.
pub(crate) const SAME_LOOP_DB: f64 = 0.1;

/// Laws agree within this over the map's largest amplitude, dB.
pub(crate) const LAWS_AGREE_DB: f64 = 1.0;

/// A split reproduces the test badly where it is off by more than this part of what friction does to the control.
pub(crate) const BADLY_REPRODUCED: f64 = 0.1;

/// The high gain: the first whose steady-state error is below this, %.
pub(crate) const SMALL_ERROR_PERCENT: f64 = 2.0;

/// Difference of two controllers up to which they perform alike, dB.
pub(crate) const ALIKE_DB: f64 = 2.0;
/// The same of gain margins, dB: they are read where the loop gain is steep.
pub(crate) const MARGIN_ALIKE_DB: f64 = 3.0;
/// The same of overshoots, percentage points.
pub(crate) const OVERSHOOT_ALIKE: f64 = 2.0;
/// The same of residual rates, relative.
pub(crate) const RESIDUAL_ALIKE: f64 = 0.1;

/// Rate relative to the platform below which the hub counts as stopped for an impulse of control, rad/s.
pub(crate) const STOPPED_RAD_S: f64 = 2e-3;

/// Step in which the beam's inertia is changed until the loop is unstable, as a share of it: finer than the thesis' figure can be read.
pub(crate) const INERTIA_STEP: f64 = 0.02;
/// Factors of the beam's inertia that are tried at most: the thesis changes it by less than a half.
pub(crate) const INERTIA_FACTORS: [f64; 2] = [0.5, 2.0];
/// Step of a fit of two factors at which it ends: a tenth is less than two laws of friction differ by.
pub(crate) const LAST_FACTOR_STEP: f64 = 1.1;
/// Least factor of such a fit: a thousandth of a value is as good as none.
pub(crate) const LEAST_FACTOR: f64 = 1e-3;
