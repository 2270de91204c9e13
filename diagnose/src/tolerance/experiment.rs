//! Limits of the plan of an experiment.

/// Sizes of each demand, as shares of the largest that the limits allow: friction and gaps show at small ones.
pub const LEVELS: [f64; 3] = [0.9, 0.3, 0.08];
/// Rates of the ladder, as shares of the largest: evenly in the logarithm.
pub const STAIRS: [f64; 6] = [0.03, 0.06, 0.12, 0.25, 0.5, 1.0];
/// Periods of the growing sine.
pub const SWEEP_PERIODS: f64 = 8.0;
/// Lines of the multisine.
pub const MULTISINE_LINES: usize = 24;
/// Lowest and highest frequency of the multisine, Hz: a servo loop follows the lowest, its drive train answers the highest.
pub const MULTISINE_RANGE_HZ: [f64; 2] = [0.2, 20.0];
/// Factor by which a simulated machine may exceed the limits of angle and rate: the demand's limit is kept, and a loop overshoots.
pub const OVERSHOOT: f64 = 1.1;
/// Steps that a simulated sample may take: a machine that needs more is left out.
pub const STEPS_PER_SAMPLE: f64 = 500.0;
/// Share of a curvature that is added to it in the linearised fit of a rival, so that parameters that do the same do no harm.
pub const REFIT_RIDGE: f64 = 1e-8;
/// Smallest noise floor: a sensor that is written as perfect has one, too.
pub const LEAST_FLOOR: f64 = 1e-9;
