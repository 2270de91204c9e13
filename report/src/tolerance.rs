//! The numbers that decide what a page shows, each with its reason.

/// Change below which an assumption has no effect on the loop, dB or degrees: two decimals show it as 0.
pub(crate) const NO_EFFECT: f64 = 0.005;
/// Relative change up to which a figure counts as the same in a comparison of two verifications: the results of two processors differ by less.
pub(crate) const SAME_FIGURE: f64 = 1e-6;

/// RMS residual over noise floor up to which a model is said to fit: more than half of the power above it is none of the noise, so that what does not fit can be improved.
pub(crate) const FITS_FLOORS: f64 = 1.5;

/// Difference of two figures in decibels, degrees or percent below which it is said to be under 0.01: two decimals show it as 0.
pub(crate) const LEAST_SHOWN_DIFFERENCE: f64 = 0.005;

/// Relative change of a figure below which it is said to be under 0.1 %: one decimal shows it as 0.
pub(crate) const LEAST_SHOWN_CHANGE: f64 = 5e-4;

/// Range of a magnitude above which its axis is cut from below, dB: what lies 120 dB under the top is rounding of the response, not a property of the
/// loop. A smaller range would cut poles and zeros of lightly damped structures.
pub(crate) const DEPTH_DB: f64 = 120.0;

/// Coherence above which a response estimated from a recording is drawn: at 0.5 noise has as much power as the response, and the estimate's
/// standard deviation is as large as the estimate over few averages (J. Bendat and A. Piersol, Random Data, section 9.1).
pub(crate) const COHERENT: f64 = 0.5;

/// Figure in decibels below which two decimals show 0: it is written without a sign.
pub(crate) const SHOWN_AS_ZERO_DB: f64 = 0.005;

/// The same with three decimals, for the cost of an arithmetic.
pub(crate) const COST_SHOWN_AS_ZERO_DB: f64 = 5e-4;

/// Magnitude below which three decimals leave fewer than two digits: the number is written with an exponent.
pub(crate) const LEAST_WITH_THREE_DECIMALS: f64 = 0.01;

/// Ratio of the largest value to the smallest from which on an axis of a front is logarithmic: on a linear one most of its designs lie on top of each other.
pub(crate) const DECADE: f64 = 10.0;

/// Distance of a pole's modulus from 1 below which it is written as a distance: six decimals show fewer than three digits of it.
pub(crate) const SHOWN_DISTANCE: f64 = 1e-4;

/// A gain of a part that lowers the total cost of an assembled loop by less than this is not worth a word, %.
pub(crate) const WORTH_A_WORD_PERCENT: f64 = 1.0;

/// A tuned PI that leaves less than a design by less than this share is not worth a word: it is within what friction changes.
pub(crate) const PI_WORTH_A_WORD: f64 = 0.02;
/// Share of what is measured that a reading may still show where it counts as none.
pub(crate) const NO_READING: f64 = 0.1;

/// Probability of deciding from which on two machines count as told apart by an experiment: that of the intervals everywhere.
pub(crate) const TOLD_APART: f64 = 0.95;

/// Whole numbers below it are counts, of an encoder for instance, and are written with all of their digits.
pub(crate) const MOST_COUNTED: f64 = 1e9;
