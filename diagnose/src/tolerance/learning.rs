//! Limits of free functions: how many points, how smooth, and when one is kept.

/// Factors that a free function may take. Below 0 a friction would drive; a factor of 6 is beyond every practice machine.
pub const FACTOR_BOUNDS: [f64; 2] = [0.0, 6.0];
/// Largest torque of a free function, as a multiple of the step with which it is differenced.
pub const TORQUE_BOUND: f64 = 400.0;
/// Step of a factor in the numerical derivative. A step of half a percent drowns in the output converter's steps, one of six percent
/// does not.
pub const FACTOR_STEP: f64 = 0.05;
/// Step of a torque, as a share of the RMS torque of the drive at that place: the control then moves by some converter steps.
pub const TORQUE_STEP: f64 = 0.01;
/// Step of a sensor's error, as a share of the RMS of what it reads: some steps of the converter.
pub const ERROR_STEP: f64 = 0.01;
/// Spacing of the points of a sensor's error at a reading of zero, as a share of an even one: a dead band of a hundredth of the range is seen.
pub const ZOOM: f64 = 0.1;
/// Distance of two points of a form, relative to the range, below which they are one.
pub const SAME_POINT: f64 = 1e-4;
/// Smallest dead band of a sensor that is read, as a share of its largest reading.
pub const SMALLEST_DEAD_BAND: f64 = 0.002;
/// Samples that another sensor must have near a point to say what the error of the loop's sensor is there.
pub const LEAST_SHOWN: f64 = 5.0;
/// Points of a function while candidates are ranked.
pub const SCREENED_POINTS: usize = 12;
/// Points of a function that is fitted.
pub const FITTED_POINTS: usize = 20;
/// Points of the chosen function: enough for a bump of a twentieth of the range.
pub const FINE_POINTS: usize = 25;
/// Points of a function of time for each period of what repeats in time.
pub const POINTS_A_PERIOD: f64 = 8.0;
/// Largest number of points of a function of time.
pub const TIME_POINTS_AT_MOST: usize = 60;
/// Candidates that are fitted in the simulator, of those that were screened.
pub const FITTED_CANDIDATES: usize = 3;
/// Share of the best candidate's promise that another must have to be fitted.
pub const PROMISE_OF_BEST: f64 = 0.25;
/// Smallest share of the residual's power that a candidate must promise on held-out stretches.
pub const LEAST_PROMISE: f64 = 0.05;
/// Weights of the penalty on second differences, relative to the median curvature of the cost, from rough to smooth. The held-out
/// stretches choose among them.
pub const ROUGHNESS: [f64; 6] = [1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0];
/// The weight while candidates are compared.
pub const USUAL_ROUGHNESS: f64 = 1e-4;
/// Weight of the preference for a value that changes nothing, relative to the median curvature: it holds points that no recording visits.
pub const NEUTRAL_WEIGHT: f64 = 1e-6;
/// Iterations of a fit while candidates are compared, and of the final one.
pub const COMPARED_ITERATIONS: usize = 6;
/// See [`COMPARED_ITERATIONS`].
pub const FINAL_ITERATIONS: usize = 8;
/// Free functions of a model at most. Two are enough for an effect that acts along two variables; more follow noise.
pub const FUNCTIONS_AT_MOST: usize = 2;
/// Samples of a stretch that is held out while the others choose the smoothness: half a second at 1 kHz.
pub const HELD_OUT_STRETCH: usize = 500;
/// Groups of stretches, each held out in turn.
pub const HELD_OUT_GROUPS: usize = 4;
/// Share of the residual's power on held-out data that a function must remove to be kept.
pub const LEAST_POWER: f64 = 0.1;
/// Quantile of a variable's samples at which the range of a function ends: single spikes of a sensor do not extend it.
pub const RANGE_QUANTILE: f64 = 0.001;
/// Share of its range by which a free function may be left without a remark: the noise of a sensor and the rarest samples, which do not
/// count when the range is chosen.
pub const RANGE_MARGIN: f64 = 0.02;
/// Share of the recorded samples that a point must have to be read: others are extrapolated.
pub const READ_FROM_COVERAGE: f64 = 0.002;
/// Share of a curve's variation that a form must explain to be named.
pub const READ_SHARE: f64 = 0.95;
/// Smallest deviation of a point that a reading assumes, as a share of the curve's range: the band of a smooth fit leaves out its own bias.
pub const BAND_FLOOR: f64 = 0.02;
/// Points of the grid along each parameter that does not enter a form linearly; it is refined twice.
pub const FORM_GRID: usize = 24;
/// Forms that are fitted in the simulator in the place of a free function, those that come nearest to its curve.
pub const FORMS_FITTED: usize = 3;
/// Points of the table of a form.
pub const FORM_POINTS: usize = 61;
/// Share of the visited range by which a form goes on at either end of it.
pub const FORM_CONTINUATION: f64 = 0.5;
/// Steps in which the parameters of a form that do not enter linearly are found in the simulator.
pub const FORM_ROUNDS: usize = 3;
/// Relative step with which the slope of a form along a parameter of its own is differenced: half of the digits remain.
pub const FORM_SLOPE_STEP: f64 = 1e-4;
/// Largest torque of a term of a form anywhere in its table, as a multiple of the step with which it is differenced: a cubic term is ten times
/// as large at the end of the table as at that of the recordings.
pub const FORM_BOUND: f64 = 4000.0;
/// Diagonal of the inverse of normalised rows from which on they do not determine their coefficients: seven digits are lost.
pub const INDISTINCT_ROWS: f64 = 1e7;
/// Smallest width of a bump, as a share of the range.
pub const SMALLEST_WIDTH: f64 = 0.02;
/// Most periods of a sine over the range.
pub const ORDERS_AT_MOST: f64 = 30.0;
/// Shortest held-out part of a recording, as a share of its length, that counts.
pub const LEAST_PART: f64 = 0.05;
/// Share of the best function's merit within which another counts as equal.
pub const EVEN_SHARE: f64 = 0.05;
/// Largest number of parameters of effects that are compared with a free function: an amplifier's curve is a free function itself.
pub const COMPARED_PARAMETERS_AT_MOST: usize = 12;
/// Width of a 95 % interval, as a difference of logarithms, from which on a parameter of shape counts as undetermined: a factor of 3.
pub const UNDETERMINED_LOGARITHM: f64 = 1.1;
/// The same for a parameter that is not positive by nature, as a share of its value.
pub const UNDETERMINED_SHARE: f64 = 1.0;
/// Times at most that a curve becomes an effect of the library, and what that leaves is modelled anew.
pub const NAMED_FROM_CURVES: usize = 2;
/// Multiple of the parameters of the library's effects up to which a free function that predicts as well is offered beside them.
pub const EVEN_PARAMETERS: f64 = 2.5;

/// Range of a curve, relative to its size, below which it is flat up to rounding.
pub const FLAT_CURVE: f64 = 1e-12;

/// Relative increase of the diagonal of the normal equations of a form: keeps them regular if two of its terms coincide on the points.
pub const FORM_RIDGE: f64 = 1e-12;

/// Range of a variable, relative to its size, up to which it did not move: rounding of the recording.
pub const LEAST_RELATIVE_RANGE: f64 = 1e-9;

/// Turns of the hub that recordings must go for a function over its turn.
pub const LEAST_TURNS: f64 = 1.2;
