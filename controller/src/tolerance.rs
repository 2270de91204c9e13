//! The numbers that decide in the controller, in one place: what each decides, why it has this size, and what another size costs.

// ---- checks ----

/// Relative difference of two sample periods that is taken for rounding.
pub(crate) const SAME_PERIOD: f64 = 1e-12;
/// Most samples of a window of the mean. Single precision counts whole numbers up to 2^24, so that a window is counted exactly.
pub(crate) const LONGEST_WINDOW: f64 = 1e6;

// ---- realisation of a path ----

/// Largest condition number of the modal transformation, columns scaled to unit length; beyond it neighbouring modes
/// stay together in a larger block. With 1e5 a path keeps eleven of the sixteen digits of double precision.
pub const MODAL_CONDITION: f64 = 1e5;
/// A real discrete pole that is this near to 1 is an integrator, and becomes exactly 1.
pub const INTEGRATOR: f64 = 1e-12;
/// Distances of eigenvalues, relative to their distance from 1, below which modes are kept together, tried in turn until the
/// condition number is below [`MODAL_CONDITION`].
pub(crate) const CLUSTERS: [f64; 6] = [0.0, 1e-6, 1e-4, 1e-2, 1e-1, 1.0];
/// Factor by which the balanced form must be less sensitive to be worth its products.
pub const WORTH: f64 = 10.0;
/// Hankel values below this, relative to the largest, are rounding errors of the path: their states are left out.
pub(crate) const NEGLIGIBLE: f64 = 1e-12;
/// Modulus above which a pole stays in modal form: it has no Gramian, or hardly one.
pub(crate) const MARGINAL: f64 = 1.0 - 1e-9;
/// Half a unit in the last place of single precision, relative.
pub(crate) const SINGLE_ROUNDING: f64 = 1.0 / (1u64 << 24) as f64;

// ---- friction observers ----

/// Points of the curve y(r) = r^i of a Dahl law with an exponent; below a distance of 0 from yielding nothing moves. More points are
/// more operations on the target.
pub(crate) const POWER_POINTS: i32 = 14;
/// Largest distance from yielding: the torque is at the level against the motion.
pub(crate) const FARTHEST: f64 = 2.0;
/// Rates over w0 at which the softened sign tanh has its points.
pub(crate) const TANH_AT: [f64; 9] = [0.25, 0.5, 0.75, 1.0, 1.3, 1.7, 2.2, 3.0, 4.5];
/// Share of the bond's limit at which the reset integrator's breakaway begins to fall to the sliding level: a jump there would be one of the control.
pub(crate) const BREAKS_FROM: f64 = 0.98;

// ---- estimator of the out-of-balance ----

/// The mean square of the platform's acceleration, over that of the dead-band, at which learning is whole: 1.1 squared.
pub(crate) const WHOLE: f64 = 1.21;
/// Share of gravity that the mean over a window counts at least: a hub held beyond 60 degrees is not divided by.
pub(crate) const LEAST_LIFT: f64 = 0.5;
/// Share of the hold band within which a followed estimate counts as settled. A quarter leaves a changed load wrong by at most a quarter of the band and what is still to
/// come after the wait; less would follow the noise of the estimate for ever.
pub(crate) const SETTLED_SHARE: f64 = 0.25;
/// Width over which a switch of the hold band rises, relative to its limit: a jump there would be one of the control.
pub(crate) const SWITCH_WIDTH: f64 = 0.01;
/// Most that what a sample tells may count, against all samples before it: beyond, the gain is as good as this one.
pub(crate) const MOST_TOLD: f64 = 1e9;
/// A variance over its start at which forgetting begins to fade.
pub(crate) const WOUND_START: f64 = 9.0;
/// A variance over its start at which forgetting has ended.
pub(crate) const WOUND_END: f64 = 10.0;

/// Time at rest after which a learning estimator is linearised, s: its lags have settled, and its weights have reached the bound
/// beyond which they forget no more.
pub const LEARNT_AT_REST_S: f64 = 5.0;
/// Times the largest plausible size at which an estimated parameter is held: the largest out-of-balance that may be set, or
/// the largest control. An estimate within the range is never touched, and a wrong one cannot run away.
pub(crate) const ESTIMATE_SPAN: f64 = 100.0;
/// Slowest half rate by which the bound of the viscous parameter is computed, rad/s.
pub(crate) const SLOWEST_RAD_S: f64 = 1e-6;
/// Largest hub angle that a controller with an estimator takes for good, rad: beyond half a turn the estimator's series for the
/// cosine means nothing.
pub(crate) const FARTHEST_ANGLE_RAD: f64 = 3.2;
/// Smallest and largest factor D of the covariance, over its start. Far outside what learning reaches; a smaller one would
/// never learn again.
pub(crate) const LEAST_VARIANCE: f64 = 1e-12;
/// See [`LEAST_VARIANCE`].
pub(crate) const MOST_VARIANCE: f64 = 1e3;

// ---- projection of accelerations ----

/// Largest elevation at which heave and surge are projected across the beam, rad. The series of sine and cosine are good to 3e-5 up to here
/// (the first term that is left out, 1.6^10 / 10!), and no machine elevates beyond the vertical.
pub const HIGHEST_ELEVATION_RAD: f64 = 1.6;

// ---- guard ----

/// Largest sum of the magnitudes of all states; beyond it they cannot be right and go back to their start. Products of three
/// numbers below it are still finite in single precision.
pub const MOST_STATES: f64 = 1e12;
/// Magnitude below which a number becomes 0 in single precision: 2^-70. The smallest normal number is 2^-126, so that a
/// product with any coefficient above 2^-56 stays normal.
pub const FLUSHED_SINGLE: f64 = 1.0 / (1_u128 << 70) as f64;
/// The same in double precision, whose smallest normal number is 2^-1022: 2^-960.
pub const FLUSHED_DOUBLE: f64 = f64::from_bits((1023 - 960) << 52);
/// Time after which a reading that stays exactly the same is flagged, s. A sensor's noise changes its last bit much sooner.
pub(crate) const UNCHANGED_S: f64 = 1.0;
/// Time over which the share of the other sensors fades when feedback works alone, s: the control makes no step.
pub(crate) const HANDOVER_S: f64 = 0.1;
/// Largest magnitude of the readings where a design says nothing, in the order of [`crate::READING_NAMES`]: rad/s, rad/s, rad/s,
/// m/s^2, rad/s, rad, m/s^2. No sensor of a stabilised mechanism gives more, and powers of them stay finite in single precision.
pub(crate) const READING_LIMITS: [f64; 7] = [1e3, 1e3, 1e3, 1e4, 1e5, 1e3, 1e4];

/// Largest size of what is learnt beside the level of the friction, in volts of the sliding friction: it only has to be beyond every feedback.
pub const MOST_LEARNT: f64 = 20.0;
