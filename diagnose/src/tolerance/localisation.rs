//! Limits of the localisation: how balances are formed, regressed and classified. Set on the machines that were used during development.

/// Share of the best gain by which a component may be behind and still be equivalent: what the balances leave out is not noise.
pub const EQUIVALENT_COMPONENT_SHARE: f64 = 0.1;
/// Share of the gain of a perfect explanation above which a cell's function is classified.
pub const CLASSIFIED_GAIN_SHARE: f64 = 0.1;
/// Knots of a free function.
pub const FUNCTION_KNOTS: usize = 7;
/// Number of samples along which a function is classified.
pub const FUNCTION_SAMPLES: usize = 2000;
/// Highest frequency at which a periodic torque is sought in time, Hz.
pub const HIGHEST_PERIODIC_HZ: f64 = 12.0;
/// Smallest number of periods in the longest recording that counts as a repetition.
pub const PERIODS_IN_TIME: f64 = 2.0;
/// Frequencies tried per reciprocal of the longest recording: four keep the best within a quarter of a resolution cell.
pub const TIME_FREQUENCIES_TRIED: f64 = 4.0;
/// Refinements of the best frequency in time, each halving the interval.
pub const TIME_FREQUENCY_REFINEMENTS: usize = 10;
/// Numbers of periods in a turn of the motor at which a torque is sought that repeats with its angle.
pub const MOTOR_ORDERS: [f64; 14] =
    [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 9.0, 10.0, 12.0, 16.0, 18.0, 24.0, 36.0];
/// Number of stretches of a recording, every other one of which is held out.
pub const REGRESSION_STRETCHES: usize = 20;
/// Ridge that keeps nearly equal columns solvable, as a share of their size.
pub const REGRESSION_RIDGE: f64 = 1e-6;
/// Variance below which a balance counts as explained, in units of its noise.
pub const EXPLAINED_VARIANCE: f64 = 1.0;
/// Number of fits, each with weights from the residual variances of the last; the first takes all balances at their noise.
pub const REWEIGHTED_FITS: usize = 2;
/// Share of the RMS rate below which something is nearly at rest.
pub const NEARLY_AT_REST_SHARE: f64 = 0.02;
/// Half width of the smoothing window, samples; two passes.
pub const BALANCE_SMOOTHING: usize = 2;
/// Interval in samples at which a balance is kept.
pub const BALANCE_THINNING: usize = 4;
/// Number of samples that are left off at either end.
pub const BALANCE_MARGIN: usize = 40;
/// Share of the power that a shape must explain to be reported.
pub const TREND_SHARE: f64 = 0.3;
/// Smallest number of periods that counts as a repetition.
pub const TREND_PERIODS_AT_LEAST: f64 = 1.5;
/// Largest number of periods over the covered range.
pub const TREND_PERIODS_AT_MOST: f64 = 40.0;
/// Frequencies tried per period over the covered range.
pub const TREND_FREQUENCIES_TRIED: f64 = 6.0;
/// Refinements of the best frequency of a trend, each halving the interval.
pub const TREND_FREQUENCY_REFINEMENTS: usize = 12;
/// Deviation of a function, as a share of its mean, below which it is the same throughout.
pub const CONSTANT_TREND: f64 = 0.15;
/// Share by which an odd function must explain more than a straight line to be preferred: every straight line is odd as well.
pub const PROPORTIONAL_PREFERENCE: f64 = 0.05;
/// Order of the autoregression.
pub const WHITENING_ORDER: usize = 16;
/// Share of its variance that is added to a series as white noise, so that the recursion stays stable.
pub const WHITENING_REGULARITY: f64 = 1e-6;

/// Distance of two knots, relative to the range of the variable, up to which they are one: values that repeat give quantiles that coincide.
pub const SAME_KNOT: f64 = 1e-6;

/// Least share of a residual that a sine is taken to explain: the doubt of its frequency divides by the share.
pub const LEAST_SHARE: f64 = 1e-6;

/// Least RMS rate, rad/s, by which rates are compared: keeps the comparison finite for a recording at rest.
pub const LEAST_RMS_RATE_RAD_S: f64 = 1e-9;

/// Determinant of the normal equations of a sine and a cosine, relative to the product of their powers, from which on both are fitted: below
/// it they are one function over the range that was visited.
pub const INDEPENDENT_PAIR: f64 = 1e-9;
