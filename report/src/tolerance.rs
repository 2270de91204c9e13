//! The numbers that decide what a page shows, each with its reason.

/// Relative change up to which a figure counts as the same in a comparison of two verifications: the results of two processors differ by less.
pub(crate) const SAME_FIGURE: f64 = 1e-6;
