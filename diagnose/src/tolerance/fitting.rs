//! Limits of the replays and of the fits beyond the general ones: initial states, gain curves, whiteness.

/// Factor on the measured divergence: that of one pair of runs is a poor estimate of that of any two.
pub const DIVERGENCE_DOUBT: f64 = 2.0;
/// Divergence of two runs, in noise floors, above which the loop hunts: no replay in closed loop can follow.
pub const HUNTING_DIVERGENCE: f64 = 5.0;
/// Corner of a gain curve of which nothing is known, V.
pub const USUAL_GAIN_CORNER_V: f64 = 0.8;
/// Inputs at which a curve is described before the recordings determine better ones, V; above the last one it is linear.
pub const FREE_INPUTS_V: [f64; 14] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.95, 1.1, 1.25, 1.4, 1.7, 2.0];
/// Share of a degree of freedom's own curvature that is added to it, so that what the readings hardly distinguish moves little.
pub const INITIAL_STATE_RIDGE: f64 = 1e-3;
/// Curvature, in noise floors squared per step squared, of the preference for the initial state as it was: some hundred steps cost
/// one unit.
pub const INITIAL_STATE_PREFERENCE: f64 = 1e-5;
/// Number of lags.
pub const WHITENESS_LAGS: usize = 60;
/// Half width of a 95 % band in standard deviations.
pub const BAND_95: f64 = 1.96;

/// Relative loss of gain of the first point of the amplifier's curve below which the curve has no dead zone: rounding of the file.
pub const LEAST_GAIN_LOSS: f64 = 1e-6;

/// Least curvature of an unknown, relative to the largest of all, by which it is damped: an unknown without effect does not move.
pub const LEAST_CURVATURE: f64 = 1e-9;

/// Addition to the diagonal of a Gram matrix of signatures, relative to its trace: keeps it regular if two signatures coincide.
pub const GRAM_RIDGE: f64 = 1e-9;

/// Least damping of a Levenberg-Marquardt step, relative to the curvature: below it the step is a Gauss-Newton step up to rounding.
pub const LEAST_DAMPING: f64 = 1e-9;

/// Smallest Coulomb level, N m, that is written: a level of 0 would change the friction's law.
pub const LEAST_LEVEL_NM: f64 = 1e-9;
/// Share of its own information that is added to each parameter's if the matrix of information is singular.
pub const INDISTINCT_SHARE: f64 = 1e-9;
