//! The numbers that decide what a page shows, each with its reason.

/// Change below which an assumption has no effect on the loop, dB or degrees: two decimals show it as 0.
pub(crate) const NO_EFFECT: f64 = 0.005;
/// Relative change up to which a figure counts as the same in a comparison of two verifications: the results of two processors differ by less.
pub(crate) const SAME_FIGURE: f64 = 1e-6;

/// RMS residual over noise floor up to which a model is said to fit: more than half of the power above it is none of the noise, so that what does not fit can be improved.
pub(crate) const FITS_FLOORS: f64 = 1.5;
