//! The numbers that decide what is identified, in one place.

/// Standard deviation of the low-pass that all signals pass, s.
pub const LOW_PASS_S: f64 = 0.03;
/// Standard deviation of the low-pass before the direction of motion is taken, s.
pub const SIGN_DEVIATION_S: f64 = 0.004;
/// Standard deviation of the low-pass through which a breakaway is looked at, s.
pub const BREAKAWAY_DEVIATION_S: f64 = 0.006;
/// Presliding distances after a reversal that are left out: what is missing of the level then is 2 exp(-8).
pub const PRESLIDING_LENGTHS: f64 = 8.0;
/// Presliding distance of a law that has none, or of one that is unknown, rad.
pub const LEAST_PRESLIDING_RAD: f64 = 2e-4;
/// Rates below this share of a recording's RMS rate are left out.
pub const CRAWL_SHARE: f64 = 0.1;
/// Control beyond this share of the amplifier's input limit is left out.
pub const LIMIT_SHARE: f64 = 0.98;
/// Time over which residuals are taken as correlated, s.
pub const MEMORY_S: f64 = 0.5;
/// Sliding time below which nothing is identified, s.
pub const LEAST_SLIDING_S: f64 = 1.0;
/// Condition number of the scaled normal equations above which the regressors cannot be told apart.
pub const WORST_CONDITION: f64 = 1e8;
/// Standard normal quantile of a 95 % interval.
pub const NORMAL_95: f64 = 1.96;
/// Share of the amplifier's input limit from which on it is taken as linear.
pub const LINEAR_FROM_SHARE: f64 = 0.2;
/// Knots of the amplifier's gain curve, evenly spaced from 0 to where it is linear.
pub const KNOTS: usize = 20;
/// Time that the control must have been near a knot, s.
pub const LEAST_AT_KNOT_S: f64 = 0.1;
/// Half width of a 95 % interval, relative to the current, beyond which a point of the curve is not reported.
pub const CURVE_DOUBT: f64 = 0.15;
/// Points below which there is no curve.
pub const LEAST_POINTS: usize = 4;
/// Share of the residual's power that the curve must take away to be there at all.
pub const CURVE_WORTH: f64 = 0.5;
/// Deviation of a current from the linear one that counts, relative to it.
pub const CURVE_DEPARTURE: f64 = 0.03;
/// Number of reversals below which no breakaway is reported.
pub const LEAST_REVERSALS: usize = 3;
/// Rounds: how far the beam swings and how long presliding lasts follow from what is identified.
pub const ROUNDS: usize = 3;
/// Significant digits of values that go into a project file.
pub const DIGITS: i32 = 6;
/// RMS of what the torque balance leaves, relative to the Coulomb friction, from which on something else acts.
pub const RESIDUAL_DOUBT: f64 = 0.02;
/// Points of a loop that are kept at the most.
pub const LOOP_POINTS: usize = 1500;
/// Exponent of the kernel (1 - (t/h)^2)^p: smooth enough at its ends for sums to be as good as integrals.
pub const KERNEL_POWER: i32 = 7;
/// Power of the platform's pitch acceleration over that of its noise from which on a lever arm is identified: below, the noise that is taken off the
/// normal equations decides.
pub const LEAST_PITCH_OVER_NOISE: f64 = 30.0;
/// RMS roll or yaw rate of the platform from which on a misalignment is identified, rad/s: a tenth of what a vehicle on a road has.
pub const LEAST_TURNING_RAD_S: f64 = 0.01;
