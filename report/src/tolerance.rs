//! The numbers that decide what a page shows, each with its reason.

/// Change below which an assumption has no effect on the loop, dB or degrees: two decimals show it as 0.
pub(crate) const NO_EFFECT: f64 = 0.005;
/// Relative change up to which a figure counts as the same in a comparison of two verifications: the results of two processors differ by less.
pub(crate) const SAME_FIGURE: f64 = 1e-6;
