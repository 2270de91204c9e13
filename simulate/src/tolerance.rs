//! The numbers that decide in the simulator, in one place: what each decides, why it has this size, and what another size costs.
//!
//! If a comment gives no source, the number was chosen for the reference rig and its relatives; the tests of the crate
//! (order of convergence, second method, sticking, replay) hold with it.

// ---- steps ----

/// Defect of a step that a run allows, relative to the plant's dry friction and a tenth of its weight torque: it
/// leaves errors of about 1e-5 of the motion over 10 s on the reference rig.
pub const TOLERANCE: f64 = 2e-5;
/// Factor by which the defect must be below the tolerance for the next step to be twice as long: 2^-6, so that the longer step passes if
/// its defect grows with no more than the sixth power of its length.
pub(crate) const LENGTHEN_BELOW: f64 = 1.0 / 64.0;
/// Fraction of the predicted time to step before predicting the event again, in bits: 1 - 2^-5 of it. More bits are fewer predictions
/// and shorter steps after a prediction that was off.
pub(crate) const EVENT_BITS: u32 = 5;
/// Changes of joints in a sample from which on their instants are found to the shortest ordinary step only: a joint that
/// switches so often chatters, and finer instants would only cost time.
pub(crate) const MANY_CHANGES: usize = 40;
/// Halvings with which the instants at which teeth or voltage change are found, at a tolerance of [`CONTACT_TOLERANCE`]; one
/// more for half of it.
pub(crate) const CONTACT_LEVELS: f64 = 11.0;
/// See [`CONTACT_LEVELS`].
pub(crate) const CONTACT_TOLERANCE: f64 = TOLERANCE;
/// Fewest halvings for the instants of contact, however large the tolerance.
pub(crate) const FEWEST_CONTACT_LEVELS: usize = 6;
/// Halvings that roughness may ask for where bonds snap: each makes a jump, which no step resolves.
pub(crate) const BRISTLE_LEVELS: usize = 3;

/// Mechanisms that must be in their lanes for a common step: with one, the step of a single mechanism costs less.
pub(crate) const FEWEST_LANES: usize = 2;

// ---- iteration on the ports within a step ----

/// Largest error of a port, relative to its scale, at which its iteration ends.
pub(crate) const ITERATION_TOLERANCE: f64 = 2e-6;
/// The same relative to the step's tolerance: the iteration's error stays a small part of the defect that is judged.
pub(crate) const ITERATION_SHARE: f64 = 0.05;
/// Least contraction that is counted on from one iteration to the next: a smaller one would be trusted after a single
/// lucky iteration.
pub(crate) const LEAST_CONTRACTION: f64 = 0.01;
/// Change of a port, relative to its scale, below which its contraction is rounding and tells nothing.
pub(crate) const PORT_ROUNDING: f64 = 1e-10;
/// Change in the first iteration, relative to the scale, above which a step was not foreseen and its defect is looked at.
pub(crate) const PREDICTED: f64 = 1e-3;
/// Change of a torque over the step before, relative to its scale, below which it is taken to stay as it is: going on as before would
/// enlarge what the iteration leaves open, and a mechanism at rest would never come to rest.
pub(crate) const QUIET: f64 = 2e-6;
/// Iterations after which a step is halved.
pub(crate) const STEP_ITERATIONS: usize = 8;

// ---- two axes ----

/// Change of the torque between two axes at which the relaxation of a sample ends, relative to the step's tolerance and the scale of the hub's
/// torques: a small part of the defect that a step may leave.
pub(crate) const COUPLING_SHARE: f64 = 0.1;
/// Change of the torque, as a multiple of that at which the relaxation ends, whose effect on the traverse axis within the sample is taken from
/// its linear core: on the reference rig 0.2 N m turns the hub by 1e-10 rad in a sample, where dry friction answers with 5e-5 N m. A sample of
/// several steps leaves its impulse, 4e-7 rad/s there, to the next one.
pub(crate) const LINEAR_ANSWER: f64 = 1000.0;
/// Passes over a sample after which its torque is taken as it is: smooth samples need one or two, and where teeth meet the instants of contact
/// are only known to their own tolerance.
pub(crate) const COUPLING_PASSES: usize = 8;

/// Least inertia of the traverse hub with the elevated body where it is, over that in its parameters: below, the body weighs more in the
/// motion than in the parameters, and the two contradict each other.
pub(crate) const LEAST_HUB_SHARE: f64 = 0.05;

// ---- joints that truly stick ----

/// Torque by which a joint at rest may exceed what its friction holds without breaking away, relative to that: some thousand units of rounding.
pub(crate) const HOLD_ROUNDING: f64 = 1e-12;
/// Rate below zero that is still zero but for rounding, rad/s at the hub.
pub(crate) const RATE_ROUNDING_RAD_S: f64 = 1e-12;
/// Rate relative to the platform, rad/s at the hub, below which a joint that rests is still taken to rest at the
/// beginning of a sample: what the pieces of the platform's motion leave open between them.
pub(crate) const AT_REST_RATE_RAD_S: f64 = 1e-7;

// ---- matrices of the core ----

/// Largest norm of A t at which the power series of the matrix exponential starts.
pub(crate) const SERIES_NORM: f64 = 0.1;
/// Terms of the power series: at [`SERIES_NORM`] the first one left out, 0.1^12 / 12!, is below the rounding error.
pub(crate) const SERIES_TERMS: usize = 12;
/// Halvings of the shortest step for the power series up to which slow motion keeps its digits beside one: each costs a binary digit of it.
pub(crate) const MOST_HALVINGS: usize = 10;
/// Cores of fewer states stay as they are: a dense product is as fast as one of blocks.
pub(crate) const FEWEST_MODAL_STATES: usize = 12;
/// Most states in the block that stays together; with a larger one the blocks save little.
pub(crate) const LARGEST_HEAD: usize = 8;
/// Imaginary part of a pole, relative to its modulus, from which on it is one of an oscillating pair.
pub(crate) const OSCILLATES: f64 = 0.02;
/// Largest entry of a coupling that is solved for: beyond, the coordinates are so skew that six digits are lost in them.
pub(crate) const SKEWEST: f64 = 1e6;
/// Error of a row of the matrix put together again, relative to its largest entry, that is rounding.
pub(crate) const MODAL_ROUNDING: f64 = 1e-8;
/// The same, absolute, of a row that only says which state is whose rate.
pub(crate) const MODAL_ROUNDING_OF_RATES: f64 = 1e-10;
/// Acceleration of the hub, rad/s^2, whose torque measures the errors of the nonlinear parts of a machine without friction and
/// weight: a smaller one makes steps shorter than such a machine needs.
pub(crate) const SMALL_ACCELERATION: f64 = 1.0;
/// Share of the full flow of a servo valve against which an error of its flow is small: the flow at which a loop holds and follows slowly.
pub(crate) const SMALL_FLOW: f64 = 0.01;
/// Distance of an angle from one whose sine is known, rad, within which the series of the difference is exact to rounding: the
/// first term left out is d^7 / 5040, relative to d.
pub(crate) const NEAR_ANGLE_RAD: f64 = 2e-3;

// ---- drift of sensors ----

/// Ratio of the correlation times of the processes whose sum is flicker noise: its density then ripples by about 2 %.
pub(crate) const FLICKER_RATIO: f64 = 5.0;
/// Longest of those correlation times, s: no run is longer.
pub const FLICKER_LONGEST_S: f64 = 1e5;

// ---- signals and runs ----

/// Angle per sample, rad, below which a sine over a sample is its series about the middle to the fourth power: the first term left
/// out is (0.05 / 2)^5 / 120, or 8e-11 of the amplitude.
pub(crate) const SLOW_SINE_RAD: f64 = 0.05;
/// Samples after which a rotor's sine is computed again, so that the rounding of its turns does not add up.
pub(crate) const ROTOR_SAMPLES: usize = 64;
/// Fraction of a sample by which a time may miss a whole number of samples and still count as the later one.
pub(crate) const HELD_ROUNDING: f64 = 1e-9;
/// Fraction of a sample by which a duration may exceed a whole number of samples without one more sample.
pub(crate) const DURATION_ROUNDING: f64 = 1e-6;
/// Relative difference between two sample periods that is rounding in a file.
pub(crate) const SAME_PERIOD: f64 = 1e-6;
/// Most samples that a run may have: a day at 1 kHz is 8.6e7, and the columns of such a run fill gigabytes.
pub(crate) const MOST_SAMPLES: f64 = 1e8;
/// Largest hub angle at the start, rad: beyond, the displacements of presliding are lost in rounding.
pub(crate) const MOST_ANGLE_RAD: f64 = 1e5;

// ---- start of a replay ----

/// Length of the first part of a recording to which the start is fitted, s.
pub(crate) const START_WINDOW_S: f64 = 0.6;
/// Share of a recording that this part is at the most.
pub(crate) const START_WINDOW_SHARE: f64 = 0.1;
/// Iterations of the fit of a start.
pub(crate) const START_ITERATIONS: usize = 12;
/// Relative fall of the cost at which the fit of a start ends.
pub(crate) const START_FLAT: f64 = 1e-3;
/// Damping beyond which no step of the fit of a start lowers the cost.
pub(crate) const START_STUCK: f64 = 1e3;
/// Mean square of the residuals, in noise floors, below which a start is as good as it gets.
pub(crate) const START_EXPLAINED: f64 = 1.1;
/// Share of the Coulomb level that an imbalance of the torques costs one unit.
pub(crate) const IMBALANCE: f64 = 0.5;
/// Distance from the guess, in steps of the differences, that costs one unit: it decides nothing that a reading shows,
/// and holds what no reading shows. Without it rounding errors in the place of a sensitivity send an angle to 1e10 rad,
/// where displacements of a micrometre are lost.
pub(crate) const FAR: f64 = 3e4;
/// Samples from which the first rates and angles are taken.
pub(crate) const FIRST_SAMPLES: usize = 5;
/// Samples through which a parabola gives angle, rate and acceleration at the start: as many of these as it follows.
pub(crate) const FIRST_MOTION_SAMPLES: [usize; 3] = [20, 12, 8];
/// What such a parabola may leave, in noise floors: a step within the samples leaves more.
pub(crate) const FIRST_MOTION_LEFT: f64 = 1.5;
/// Standard errors of the rate at the start beyond which the hub moves.
pub(crate) const FIRST_MOTION_ERRORS: f64 = 6.0;
/// Share of the recorded control's RMS below which a difference says nothing about the controller: a converter that the project does not
/// state (14 bits have steps of 1.2e-4 of their range), gains written with four digits, and numbers printed with six all leave less.
pub(crate) const SAME_CONTROL_SHARE: f64 = 2e-4;
/// Samples from which the controller's integral at the start is taken.
pub(crate) const INTEGRAL_SAMPLES: usize = 200;
/// Samples from which the rate before the first sample is taken, for a controller that differences its position.
pub(crate) const START_RATE_SAMPLES: usize = 4;
/// Share of an unknown's own curvature below which it cannot be told from those before it: the rounding of the differences
/// that the normal equations are made of.
pub(crate) const INDISTINCT: f64 = 1e-12;

// ---- windows of a replay ----

/// Shortest window, samples; also the fewest whole samples from which a controller's integral is found.
pub(crate) const SHORTEST_WINDOW: usize = 20;
/// Share of a window to which its start is fitted: the other half shows what the model makes of it.
pub(crate) const WINDOW_FITTED_SHARE: f64 = 0.5;
/// Longest part of a recording to which the start of a replay in open loop is fitted, s: what a machine that nearly stalls remembers of its
/// start fades within seconds, and the fit runs the part a hundred times.
pub(crate) const LONGEST_START_FIT_S: f64 = 60.0;
/// Iterations of the fit of a window's start.
pub(crate) const WINDOW_ITERATIONS: usize = 15;
/// Relative fall of the cost at which the fit of a window's start ends.
pub(crate) const WINDOW_FLAT: f64 = 1e-4;
/// Damping beyond which no step of the fit of a window's start lowers the cost.
pub(crate) const WINDOW_STUCK: f64 = 1e6;
/// Seed of the noise in what the model itself would have recorded.
pub(crate) const MODEL_SEED: u64 = 1;
/// Residual over the noise floor up to which a replay over windows explains what the model itself would have recorded: below [`EXPLAINED`],
/// so that a true model is explained whatever the noise.
pub(crate) const OWN_EXPLAINED: f64 = 1.3;
/// Shortest window that the model's own recording asks for, s: a start is fitted to 60 samples at 1 kHz.
pub(crate) const SHORTEST_OWN_WINDOW_S: f64 = 0.125;
/// Largest residual of a channel, over its noise floor, of a model that explains the recording.
pub(crate) const EXPLAINED: f64 = 1.5;
/// Difference of two runs of one model, in noise floors, from which on the closed loop diverges: a loop that forgets its start
/// differs by 0.1 in the hub's rate and 0.4 in the motor's.
pub(crate) const DIVERGED_FLOORS: f64 = 0.5;
/// A recording of no more than this many windows is replayed from start to end: what is not known of its start is as much in a
/// window.
pub(crate) const LONG_WINDOWS: f64 = 3.0;
/// A residual of more than this many times the difference of two runs of one model is not their divergence: the free replay says that the
/// model is wrong.
pub const WRONG_MODEL: f64 = 10.0;

// ---- deconvolution of a sensor ----

/// Natural frequency, rad/s, with which an ideal sensor is modelled, relative to the sample rate in rad/s.
pub(crate) const IDEAL_FREQUENCY: f64 = 2.0;
/// Decades of the input's roughness that are tried, relative to what the noise would make of one sample.
pub(crate) const ROUGHNESS_DECADES: i32 = 32;
/// Standard deviation of the state before the first reading, relative to the largest reading and the noise.
pub(crate) const PRIOR_DEVIATION: f64 = 10.0;
/// Least noise of a reading, relative to the largest one: the filter divides by it.
pub(crate) const LEAST_NOISE: f64 = 1e-9;
/// Relative change of the filter's variances from one sample to the next at which they have settled.
pub(crate) const SETTLED_VARIANCE: f64 = 1e-10;

// ---- study of convergence ----

/// Tolerance with which every step is taken as it is, whatever its defect.
pub(crate) const ANY_DEFECT: f64 = 1e9;
/// An error counts towards the observed order if it is this many times the second method's.
pub(crate) const CLEAR: f64 = 10.0;
/// Rounding with which instants of sticking and breaking away are found, relative to the largest rate: errors below it do not count
/// towards the observed order.
pub(crate) const EVENT_ROUNDING: f64 = 1e-9;
/// Halvings of a step of the second method in which something switches: down to a millionth.
pub(crate) const SECOND_LEVELS: u32 = 20;
/// Switches after which steps of the second method are no longer halved: a motion that switches without end is not followed.
pub(crate) const MOST_SWITCHES: usize = 2000;
/// Rate against the direction of sliding, rad/s, that is rounding in the second method.
pub(crate) const SECOND_RATE_ROUNDING: f64 = 1e-13;
/// Samples over which the response of an exported controller to a small impulse is summed for the control's noise floor: what remains
/// of it then is the integral's step, which is taken off.
pub(crate) const NOISE_RESPONSE_SAMPLES: usize = 400;
/// Samples from which the states of an exported controller at the start of a recording are fitted. Fewer leave its slow states to the
/// rounding of the converter.
pub(crate) const CONTROLLER_STATE_SAMPLES: usize = 1000;
/// Most iterations of that fit: without limiter and friction observers one is enough.
pub(crate) const CONTROLLER_STATE_ITERATIONS: usize = 6;
/// Step of that fit's numerical derivative, as a share of each state's spread: the controller is nearly linear in its states.
pub(crate) const CONTROLLER_STATE_STEP: f64 = 1e-3;
/// Standard deviation of a recorded control that the fit assumes, V: the rounding of a 12-bit converter over +/- 10 V is 1.4 mV.
pub(crate) const CONTROLLER_STATE_NOISE_V: f64 = 1.4e-3;

/// Least damping of a Levenberg-Marquardt step of a start or a window, relative to the curvature: below it the step is a Gauss-Newton step up
/// to rounding.
pub const LEAST_DAMPING: f64 = 1e-9;
/// Step of an angle by which the slopes of a fitted start are taken, rad: far above the simulator's error, within a presliding deflection.
pub const START_ANGLE_STEP_RAD: f64 = 1e-5;
/// Least bend of the gear, rad, by which the slopes of a window's start are taken: without dry friction nothing bends it at rest.
pub const LEAST_BEND_RAD: f64 = 1e-7;
/// Size of the impulse by which the responses of a recorded controller are taken, V and rad/s: it keeps friction observers in presliding and
/// the limiter out of the way.
pub const SMALL_IMPULSE: f64 = 1e-6;

// ---- derivatives of a run ----

/// Share of the torques on a joint below which the torque that is left to accelerate it makes a change of direction a graze: the derivatives
/// then grow by its inverse, and beyond a thousand a change within the noise of a reading decides whether the event happens.
pub(crate) const GRAZING: f64 = 1e-3;
/// Half the difference of controls by which the slope of the amplifier's static part is taken, V: the part is made of straight lines, so that
/// any difference is exact that is far above rounding and below the converter's step.
pub(crate) const DRIVE_DIFFERENCE_V: f64 = 1e-6;
/// Distance over which the stored numbers of a replay's mechanism are differenced, in units of a direction (a typical change of a parameter,
/// one step of a start): the fourth-order difference of a number that changes by a tenth within a unit is then wrong by 1e-12.
pub(crate) const FAMILY_STEP: f64 = 1e-2;
