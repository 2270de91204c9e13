//! The numbers that decide how axes are laid out, each with its reason.

/// A range smaller than this part of its largest value is rounding noise: the values count as equal.
pub(crate) const LEAST_SPAN: f64 = 1e-9;

/// A tick may lie outside the range by this part of its step, so that rounding does not lose the ticks at the ends.
pub(crate) const TICK_SLACK: f64 = 1e-9;
