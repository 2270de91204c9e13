//! The numbers that decide when a project file is checked, each with its reason.

/// Two ends of sections closer than this fraction of the beam's length adjoin.
pub(crate) const ADJOINING_SHARE: f64 = 1e-9;

/// Relative difference between two sample periods that is rounding in a file.
pub(crate) const SAME_SAMPLE_PERIOD: f64 = 1e-6;

/// Fraction of a sample period that is rounding when a delay is counted in whole samples.
pub(crate) const WHOLE_DELAY: f64 = 1e-9;

/// Sizes that a number of a machine can have: beyond them squares overflow or vanish.
pub(crate) const NUMBER_SIZES: std::ops::RangeInclusive<f64> = 1e-40..=1e40;

/// Distance of a sensor's own sample period from a whole number of samples that a file may round, in samples.
pub(crate) const ROUNDED_PERIOD: f64 = 1e-6;
