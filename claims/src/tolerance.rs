//! The numbers that decide in the measurements of the claims, each with its reason.

/// Relative and absolute tolerance of a step, on states divided by their own size.
pub(crate) const STEP_TOLERANCE: f64 = 1e-5;

/// A state counts as unseen below this share of the system's size.
pub(crate) const UNSEEN_STATE: f64 = 1e-11;

/// Least error over tolerance that a step is given: the next step's length divides by a power of it. So small an error lengthens the step
/// by the largest factor anyway.
pub(crate) const LEAST_STEP_ERROR: f64 = 1e-10;

/// Length below which nothing but rounding is left of a vector of unit length from which its projections were taken.
pub(crate) const LEAST_LENGTH: f64 = 1e-12;
