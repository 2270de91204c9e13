//! The numbers that decide in this crate, each with its reason.

/// Smallest share from which a time is extrapolated. Earlier ones depend on the first stage alone.
pub(crate) const EXTRAPOLATED_FROM_SHARE: f64 = 0.05;
