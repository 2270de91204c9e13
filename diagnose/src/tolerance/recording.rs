//! Limits of the repair and of the sanity checks of recordings. Set on about 60 faults put into the practice recordings; sound recordings
//! must stay without a fault.

/// Longest gap in samples that is interpolated.
pub const LONGEST_FILLED_GAP: usize = 10;
/// Shortest part that is kept, s.
pub const SHORTEST_PART_S: f64 = 1.0;
/// Number of equal readings from which a sensor with noise on it is stuck.
pub const STUCK_READINGS: usize = 40;
/// Smallest share of the usual motion during which a sensor counts as stuck.
pub const STUCK_MOTION_SHARE: f64 = 0.3;
/// Multiple of what rounding leaves beyond which a control is not the controller's.
pub const FOREIGN_CONTROL_MULTIPLE: f64 = 5.0;
/// Two slopes within this share of each other agree.
pub const SLOPE_AGREEMENT: f64 = 0.1;
/// Clock offset from which it is reported, s: sensors and gear account for a few milliseconds.
pub const REPORTED_OFFSET_S: f64 = 8e-3;
/// Largest clock offset that is tried, s.
pub const LARGEST_OFFSET_S: f64 = 0.1;
/// Largest share of the difference between two channels that an offset may leave to be believed: a wide backlash makes the motor
/// lead as well, but leaves a quarter or more.
pub const OFFSET_REMAINDER: f64 = 0.1;
/// Number of samples at one extreme that make a flat top.
pub const FLAT_TOP_SAMPLES: usize = 5;
/// Share of a column that flat tops must hold for it to be clipped.
pub const CLIPPED_SHARE: f64 = 0.01;
/// Fewest steps of the quantiser over the range for which a flat top means something.
pub const FLAT_TOP_STEPS: f64 = 200.0;
/// Rate above which a platform moves, rad/s RMS; below it stands still. It is well above the noise of the gyroscopes in use.
pub const PLATFORM_MOVES_RAD_S: f64 = 5e-3;
/// Half width of the window that smooths a column before it is compared with another, s.
pub const SMOOTHING_S: f64 = 0.025;
/// Relative uncertainty above which the balance is not used.
pub const HEAVE_FACTOR_DOUBT: f64 = 0.5;
/// Factors of units, and of a sign.
pub const HEAVE_UNIT_FACTORS: [f64; 5] = [1.0, 9.80665, 1.0 / 9.80665, 1e3, 1e-3];
/// Factor within which the balance finds them: the out-of-balance may differ from the project's.
pub const HEAVE_FACTOR_REACH: f64 = 1.5;
/// Smallest clock offset that is reported, s. Sensors and filters of a sound machine differ by up to a millisecond.
pub const SMALLEST_OFFSET_S: f64 = 1.5e-3;
/// Smallest clock offset that is reported, as a multiple of its uncertainty.
pub const SMALLEST_OFFSET_DOUBTS: f64 = 1.5;
/// Smallest clock offset of the motor that is reported if the platform moves, s: the platform's rate is a part of the difference.
pub const SMALLEST_MOVING_OFFSET_S: f64 = 5e-3;
/// Largest difference between a recording's offset and that of the others for which it is taken to have theirs, s.
pub const COMMON_OFFSET_S: f64 = 3e-3;
/// Share of the rate that the kinematics may leave for their lag to be believed.
pub const KINEMATIC_REMAINDER: f64 = 0.1;
/// Corrections of the lag, each by the slope at the last.
pub const LAG_CORRECTIONS: usize = 5;
/// Difference of the clocks over half a recording from which they drift, s: if several recordings agree, or in a single one.
pub const CLOCK_DRIFT_S: (f64, f64) = (6e-4, 2e-3);
/// Share of a drift by which the offset in the middle of a recording may differ from the mean of those at its ends. A clock's offset grows
/// evenly; that of an elastic drive, which leads and lags as it is loaded, does not.
pub const DRIFT_BENT_SHARE: f64 = 0.25;
/// Share of the mean drift by which a recording's drift may differ from it.
pub const DRIFT_AGREEMENT: f64 = 0.5;
/// Largest shift in samples at which the controller's columns are tried.
pub const LARGEST_SHIFT: i32 = 60;
/// Share of the residual that the right shift may leave, and multiple of the converter's noise above which there is a residual at
/// all.
pub const SHIFT_REMAINDER: (f64, f64) = (0.3, 3.0);
/// Largest number of wrong factors that are corrected one after the other.
pub const WRONG_FACTORS_AT_MOST: usize = 3;
/// Relative uncertainty up to which a factor that is not a unit's is corrected; beyond it a motor's or a resolver's column is left
/// out.
pub const FACTOR_CERTAINTY: f64 = 4e-3;
/// Difference of the motor's and the resolver's mean rate of the hub from which the motor has a bias, rad/s.
pub const MOTOR_BIAS_RAD_S: f64 = 1e-3;
/// Largest variation of a platform at rest, as a multiple of its noise.
pub const PLATFORM_REST_MULTIPLE: f64 = 1.5;
/// Largest error of a recomputed control that may replace useless readings, as a multiple of the converter's noise.
pub const RECOMPUTED_CONTROL_MULTIPLE: f64 = 3.0;
/// Gains that a gyroscope itself may have; these are in the library of physics.
pub const GYROSCOPE_GAINS: (f64, f64) = (0.5, 2.0);
/// A broken identity counts as no more than this.
pub const BROKEN_IDENTITY_AT_MOST: f64 = 3.0;
/// The share that an exchange must leave of what was broken, and of each identity.
pub const EXCHANGE_REMAINDER: (f64, f64) = (0.5, 0.7);
/// Relative and absolute difference up to which two explanations are taken as equivalent.
pub const EQUIVALENT_EXPLANATIONS: (f64, f64) = (1.1, 0.01);
/// Largest residual of the controller's identity, as a multiple of the converter's noise, for it to hold.
pub const CONTROLLER_IDENTITY_MULTIPLE: f64 = 3.0;
/// Relative uncertainty above which a factor is not used.
pub const FACTOR_DOUBT: f64 = 0.3;
/// A factor is a unit's where it is as near as this, relative.
pub const UNIT_FACTOR_REACH: f64 = 0.03;
/// Relative doubt of every factor from the kinematics, and from the controller.
pub const IDENTITY_DOUBT: (f64, f64) = (0.01, 3e-3);
/// Controls nearer to the converter's limit than this are not the controller's, V.
pub const NEAR_LIMIT_V: f64 = 0.02;
/// Share of equal neighbours below which a column has enough noise to change its readings.
pub const NOISY_COLUMN_SHARE: f64 = 0.5;
/// Share of the runs of equal readings that must be of one length for a lower rate.
pub const EVEN_RUNS_SHARE: f64 = 0.95;
/// Fewest runs of equal readings from which a lower rate is inferred.
pub const FEWEST_RUNS: usize = 50;
/// Times the project's step from which a converter is coarser.
pub const COARSER_CONVERTER: f64 = 3.5;
/// Steps from which a difference of neighbours is no longer compared with a grid: the rounding of a written number moves it by a part of a step.
pub const GRID_STEPS: f64 = 100.0;
/// Distance of a difference from a whole number of steps below which it lies on the grid, in steps. Differences without a grid lie there at
/// a rate of one in five.
pub const GRID_DEVIATION: f64 = 0.1;
/// Fewest differences that show a grid: by chance, eight lie there once in 400 000 times.
pub const GRID_DIFFERENCES: usize = 8;
/// Share of the differences that must lie on the grid; the others are outliers.
pub const GRID_SHARE: f64 = 0.9;
/// Share of the converter's range from which a limit is the converter's own, which the simulator has.
pub const CONVERTER_LIMIT_SHARE: f64 = 0.98;
/// Samples of exactly one value from which on a sensor counts as at rest. A noisy reading does not repeat so often by chance; fewer would
/// take the steps of a coarse sensor for rest.
pub const REST_SAMPLES: usize = 25;

/// Difference of two readings, relative to the size of all, up to which they are the same reading: above the rounding of a unit's conversion,
/// far below the step of any converter (2^-24 is 6e-8).
pub const SAME_READING: f64 = 1e-9;

/// Relative distance of a gain from the factor between two units up to which it is this factor: the gains that are compared were set to it.
pub const SAME_UNIT_FACTOR: f64 = 1e-9;

/// Distance of a place from a sample, in samples, up to which it is this sample: rounding of the delay over the period.
pub const ON_SAMPLE: f64 = 1e-9;
/// Part of a recording, one in so many, over which equal readings are a long run: a machine that moves passes every value sooner.
pub const LONG_RUN_PART: usize = 10;
/// Steps of the quantiser over which a channel must range for a long run to mean something: a channel of fewer steps is at rest, or coarse.
pub const LONG_RUN_STEPS: f64 = 20.0;
/// Share of its range above which a channel's step is coarse: with fewer than twenty steps its rounding is no noise any more.
pub const COARSE_STEP_SHARE: f64 = 0.05;
/// Coherence of two channels below which the slope between them means nothing: less than half of the one's power comes from the other.
pub const SLOPE_COHERENCE: f64 = 0.5;
/// Distance of a slope from 1 below which it is no fault: scale factors of sensors and a gear's ratio are known better.
pub const WRONG_SLOPE: f64 = 0.2;
/// Distance from a whole number of samples up to which a delay is taken for it: delays come from loops that are whole samples late, and the
/// search finds them to a few tenths.
pub const NEARLY_WHOLE_SAMPLES: f64 = 0.3;
/// Share of the distance between the means of motor and resolver below which the resolver's own mean must be for the motor to be at fault.
pub const RESOLVER_MEAN_SHARE: f64 = 0.5;
/// Correlation of a series with itself below which its further lags count as noise: they would only add their scatter to the correlation time.
pub const UNCORRELATED: f64 = 0.05;
/// Doubt of an offset, in [`SMALLEST_OFFSET_S`], from which on it is not used: it is then known less well than what is looked for.
pub const MOST_OFFSET_DOUBT: f64 = 3.0;
