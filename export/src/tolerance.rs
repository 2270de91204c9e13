//! The numbers that decide in the exported code and its error analysis, each with its reason.

/// Factor by which the anti-windup is made smaller than the inputs while a form is found: so small that the form is that of the path
/// alone, so large that its columns stay far above rounding.
pub(crate) const ANTI_WINDUP_SHARE: f64 = 1e-6;

/// Below this, relative to the sensitivity's largest entry so far, a sensitivity of the control is taken for 0.
pub(crate) const NEGLIGIBLE_SENSITIVITY: f64 = 1e-200;

/// Below this a covariance is taken for 0: it would only slow the arithmetic down.
pub(crate) const NEGLIGIBLE_COVARIANCE: f64 = 1e-200;

/// Modulus beyond which a pole of the controller is unstable: rounding may move the pole of an integrator this far from 1.
pub(crate) const UNSTABLE_MODULUS: f64 = 1.0 + 1e-9;

/// Allowance for products of errors, which a first-order bound leaves out.
pub(crate) const SECOND_ORDER: f64 = 1.01;

/// Most samples by which a signal of the plant's unit may be late: it keeps them all, 80 kB a signal.
pub const MOST_DELAY_SAMPLES: f64 = 1e4;

/// Most bristles of a joint of the plant's unit: each is computed in every step.
pub const MOST_BRISTLES: f64 = 1e5;

/// Factor by which a summand must be smaller than a sum, to be rounded to the sum's grid.
pub const SMALL_SUMMAND: f64 = 8.0;

/// Share of the accumulator's range that the largest sum of a fixed-point operation may take: one percent is kept for the rounding of its summands,
/// which the bound of the sum leaves out.
pub(crate) const ACCUMULATOR_SHARE: f64 = 0.99;

/// Multiple of the root of the sum of squares in the likely bound of the rounding error: six standard deviations.
pub const LIKELY_BOUND_FACTOR: f64 = 6.0;
/// Probability that a sample leaves the likely bound: 2 exp(-f^2 / 2) for the factor f above
/// (W. Hoeffding, Probability inequalities for sums of bounded random variables, 1963).
pub const LIKELY_BOUND_EXCEEDANCE: f64 = 3.05e-8;
