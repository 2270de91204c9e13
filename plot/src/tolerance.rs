//! The numbers that decide how axes are laid out, each with its reason.

/// A range smaller than this part of its largest value is rounding noise: the values count as equal.
pub(crate) const LEAST_SPAN: f64 = 1e-9;

/// A tick may lie outside the range by this part of its step, so that rounding does not lose the ticks at the ends.
pub(crate) const TICK_SLACK: f64 = 1e-9;

/// Values beyond this cannot be told from an overflow, and values below its inverse not from an underflow: neither is drawn.
pub(crate) const LARGEST_DRAWN: f64 = 1e300;

/// Positions are limited to this many lengths of the axis, so that they remain numbers for which a drawing has room.
pub(crate) const FARTHEST: f64 = 100.0;

/// On fewer decades than this, ticks at whole decades alone are too few to read values by.
pub(crate) const FEW_DECADES: f64 = 1.2;

/// On more decades than this, ticks between the decades are closer than the eye can part.
pub(crate) const MANY_DECADES: f64 = 7.0;
