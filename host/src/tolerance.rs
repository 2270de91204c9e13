//! The numbers that decide in this crate, each with its reason.

/// Smallest share from which a time is extrapolated. Earlier ones depend on the first stage alone.
pub(crate) const EXTRAPOLATED_FROM_SHARE: f64 = 0.05;

/// Samples one after another beyond the limit of a run that count as beyond it: one or two may be outliers of a sensor.
pub(crate) const SAMPLES_BEYOND: usize = 3;
/// Largest reading within a limit, over it: what is more is no noise of a sensor that serves the loop.
pub(crate) const READING_MARGIN: f64 = 1.1;
