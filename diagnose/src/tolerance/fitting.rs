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
