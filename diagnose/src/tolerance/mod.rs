//! The numbers that decide, each with where it comes from and what breaks if it is changed.
//!
//! General limits of fitting, screening and selection stand here; those of one part of the story in its module.
//!
//! Log-likelihoods are natural logarithms. Values without a derivation were set on the machines that were used during development: the practice
//! machines, the closed-form machines of this crate's tests, and seeds 1 to 56 and 81 to 140 of the sealed machines. After a change, run
//! those again: the false alarm rate must not rise, and the parameters' intervals must hold as often as they say.

pub mod experiment;
pub mod findings;
pub mod fitting;
pub mod identification;
pub mod learning;
pub mod localisation;
pub mod recording;
pub mod selection;

// ---------------------------------------------------------------------------------------------------------------- fitting

/// Iterations of one fit at most. The limit bounds the time of a fit that does not settle by [`FIT_TOLERANCE`]; reaching it is
/// reported as a warning.
pub const FIT_ITERATIONS: usize = 25;
/// A fit has settled when an iteration lowers the cost by less than this share. Smaller values cost iterations and change parameters
/// by less than their intervals.
pub const FIT_TOLERANCE: f64 = 1e-4;
/// Step of the numerical derivative, in units of a parameter's typical size. Larger steps leave the linear range of friction near
/// zero rate; smaller ones drown in the integrator's error.
pub const FIT_STEP: f64 = 1e-3;
/// Iterations of a fit while candidates are compared. A comparison needs less accuracy than the final fit.
pub const SEARCH_ITERATIONS: usize = 10;
/// Iterations of a first fit of a candidate: enough to rank it, so that only the best are fitted further.
pub const TRIAL_ITERATIONS: usize = 6;
/// Times at most that a fit estimates the recordings' initial states anew at what it found. An initial state that is far off is not
/// found from nearby, so at least one is needed.
pub const RESTARTS: usize = 1;
/// The same for a first fit of a candidate.
pub const TRIAL_RESTARTS: usize = 1;
/// Share by which a new initial state must lower the cost for a further restart.
pub const RESTART_WORTH: f64 = 2e-3;
/// Fewest parameters for which exact derivatives take the place of differences of runs: a run with derivatives costs as much as six runs before its
/// first direction, and each direction less than a run (docs/evidence/simulator.md).
pub const FEWEST_EXACT_DIRECTIONS: usize = 16;
/// Units of a variable on either side within which a parameter must be inside its bounds to be varied on both: twice the distance over which a
/// replay's stored numbers are differenced, and as much again.
pub const VARIED_UNITS: f64 = 4e-2;
/// Iterations for which the derivatives with respect to the initial states are reused. They change
/// slowly, and computing them costs one replay for each freedom.
pub const STARTS_KEPT: usize = 4;
/// Share of a recording that a candidate is fitted to; the rest is held out. A smaller share leaves slow effects unobservable in the
/// fitted part, a larger one leaves too little to judge them by.
pub const FITTED_SHARE: f64 = 0.6;

// ------------------------------------------------------------------------------------------------------------ uncertainty

/// Samples of a stretch over which the scores of a fit are summed: longer than the control loop remembers its noise, so that sums of
/// different stretches are nearly independent.
pub const STRETCH: usize = 250;
/// Lags, in stretches, over which the scatter of the gradient is summed (Newey and West 1987).
pub const STRETCHES_TOGETHER: usize = 3;
/// Relative deviation of a parameter between two careful simulators of one mechanism. It is the smallest uncertainty that an interval
/// states: without it, intervals from long recordings claim more than any model can hold.
pub const SYSTEMATIC: f64 = 5e-4;
/// Residuals below this share of the noise floor count as this share. It keeps a channel that is quieter than its floor from
/// dominating a likelihood ratio.
pub const SCORE_FLOOR: f64 = 0.3;

// --------------------------------------------------------------------------------------------------------------- screening

/// Natural logarithm of the factor, mean over the channels, by which the initial states of the first moments may leave more than fitted ones
/// before they are of no use for a screening: twice the residual is three quarters of its power.
pub const THROWN_OFF: f64 = 0.7;
/// Effects that are fitted in the simulator at every stage, after the screening. Fewer lose an effect whose signature is not
/// proportional to its size; more cost time in proportion.
pub const SHORTLIST: usize = 8;
/// Pairs of effects that are fitted together at a stage.
pub const PAIRS: usize = 5;
/// Share of the required gain that a signature must promise for its effect to be fitted, if the model is close to the recordings. It
/// is below 1 because a signature is linearised.
pub const PROMISE_SHARE: f64 = 0.5;
/// Share of a period that the travel must cover for a torque to count as one that repeats. A piece of a sine fits any smooth function
/// of the position.
pub const PERIOD_SEEN: f64 = 0.75;
/// Periods a sample of a repeating torque, at the RMS rate, above which no reading follows it: half the sampling rate (Nyquist).
pub const PERIODS_SAMPLED: f64 = 0.5;
/// Steps a sample, on average, beyond which a mechanism is not tried: no mechanism that is recorded at this rate is so stiff.
pub const STEPS_PER_SAMPLE: f64 = 60.0;
/// The same for a machine that the project file describes so stiff, or sampled so slowly, that its own model takes more: it is diagnosed slowly.
pub const STIFF_STEPS_PER_SAMPLE: f64 = 1500.0;
/// Difference between the gyroscopes' rate and the motor's or the resolver's, rad/s, from which a bias is sought from the start. The
/// signature of a small bias does not show that a loop that holds a biased rate moves from the first sample on.
pub const BIAS_SEEN_RAD_S: f64 = 2e-4;

// --------------------------------------------------------------------------------------------------------- model selection

/// Largest number of effects in a model. Of models with three effects that explain the recordings, one in three was right: see
/// [`RIGHT_OF_THREE`].
pub const EFFECTS_AT_MOST: usize = 3;
/// Log-likelihood that an effect must gain on held-out data. Lower values raise the false alarm rate.
pub const GAIN_NEEDED: f64 = 60.0;
/// The same for a machine whose model has textbook values: what such a model leaves is slow motion, of which a recording holds few
/// independent samples.
pub const TEXTBOOK_GAIN_NEEDED: f64 = 12.0;
/// Share of everything gained so far that a further effect must gain. Less is what two simulators of one mechanism differ by.
pub const SYSTEMATIC_GAIN: f64 = 5e-3;
/// Log-likelihood that one more effect must be worth.
pub const EFFECT_PRICE: f64 = 15.0;
/// Log-likelihood that one more parameter must be worth: half the logarithm of the number of samples (Schwarz 1978), and what the scan
/// for its start gives it by chance.
pub const PARAMETER_PRICE: f64 = 10.0;
/// Log-likelihood by which another effect must be ahead to replace one that was found. Smaller values exchange equivalent effects by
/// the noise.
pub const SWAP_NEEDED: f64 = 10.0;
/// Candidates that are behind the best by less than this cannot be told from it: three standard errors of the log-likelihood ratio
/// of two models that are so close.
pub const AMBIGUOUS: f64 = 18.0;
/// A channel is made worse if its excess grows by this factor on held-out data.
pub const HARM: f64 = 1.15;
/// A model explains the recordings if no channel's residual exceeds its noise floor by this factor.
pub const EXPLAINED: f64 = 1.5;
/// Mean ln(RMS / floor) below which nothing is left that a further effect could explain.
pub const NOTHING_LEFT: f64 = 0.07;
/// Effects that are fitted in the place of one that was found.
pub const RIVALS: usize = 5;
/// Single effects that are fitted in the place of two effects of one component.
pub const MERGES: usize = 4;
/// A model with more parameters than this is held while further effects are compared, and fitted together with the chosen one. The
/// time of a fit grows with its parameters.
pub const JOINT_PARAMETERS: usize = 6;
/// Candidates of a stage that are fitted once more, to every recording.
pub const FINALISTS: usize = 4;
/// Mean ln(RMS / floor) by which a finalist may be behind the best after its first fit: if the best explains the recordings, and if
/// it does not, when a first fit may still be far from its optimum.
pub const FINAL_REACH: [f64; 2] = [0.03, 0.7];
/// Realisations of other noise from which the gain under the null hypothesis is averaged. Fewer scatter more than
/// a mean that is to be multiplied by [`NULL_GAIN_MULTIPLE`] may.
pub const NULL_REALISATIONS: u64 = 8;
/// Required gain beyond [`GAIN_NEEDED`], as a multiple of the mean gain under the null hypothesis. Lower values name slow effects that
/// noise in the loop imitates.
pub const NULL_GAIN_MULTIPLE: f64 = 12.0;
/// Gain above which noise is not considered as its cause, so that its gain need not be computed.
pub const GAIN_BEYOND_NULL: f64 = 4000.0;
/// Share of a candidate's gain from which on one recording counts as the only one that shows its effect. It is then judged on its own
/// last part, because no other recording can predict it.
pub const SOLE_EVIDENCE_SHARE: f64 = 0.9;

// -------------------------------------------------------------------------------------------------------- amount of data

/// Samples of all recordings together that a diagnosis replays: four recordings of 12 s at 1 kHz. More cost time in proportion.
pub const SAMPLES_AT_MOST: usize = 48_000;
/// The same for a machine whose model has textbook values: its effects are many and large, and every fit takes longer.
pub const TEXTBOOK_SAMPLES_AT_MOST: usize = 12_000;
/// Mean square of the residual after the first part of a recording, as a multiple of that within it, from which on more of the recordings is replayed.
pub const LATE_MISMATCH: f64 = 4.0;

// --------------------------------------------------------------------------------------------------- knots of the gain curve

/// Spacing of the inputs at which a curve's knots may lie, V: finer than two knots may be apart.
pub const KNOT_SPACING_V: f64 = 0.0125;
/// Largest number of knots of a curve.
pub const KNOTS_AT_MOST: usize = 24;
/// Smallest distance between two knots of a curve, V. Closer knots are nearly the same column of the fit.
pub const KNOT_GAP_V: f64 = 0.03;
/// Iterations of a fit of a curve with other knots: it starts next to its optimum.
pub const KNOT_ITERATIONS: usize = 6;
/// Log-likelihood that a knot must be worth on held-out stretches. Lower values place knots by the noise.
pub const KNOT_PRICE: f64 = 12.0;
/// Share that a knot must be worth of what all knots of the fine curve together are worth beyond the present ones.
pub const KNOT_SHARE: f64 = 0.005;
/// Log-likelihood that moving a knot must gain.
pub const KNOT_MOVE_GAIN: f64 = 1.0;
/// Samples of a stretch that is fitted while the next one is held out: a second at 1 kHz.
pub const KNOT_STRETCH: usize = 1000;
/// Times at most that the knots are moved and the idle ones removed.
pub const KNOT_MOVES: usize = 6;
/// Times at most that a curve's knots are chosen anew.
pub const KNOT_ROUNDS: usize = 1;

// ------------------------------------------------------------------------------------------------------ stated probabilities

/// Share of the distance from the noise floor that must be explained for an incomplete explanation to be named; below it the effect
/// is unidentified.
pub const SHARE_TO_NAME: f64 = 0.5;
/// Share of the power of the residual that effects must explain to be named, for a machine whose model has textbook values.
pub const TEXTBOOK_SHARE_TO_NAME: f64 = 0.15;
/// Decay of a rival's weight with its log-likelihood behind the best, 1/nat. A value of 1 would take residuals as white; they are not.
pub const RIVAL_DECAY: f64 = 0.15;
/// Probability that a name without a rival is true, (n + 1) / (m + 2) for n of m on the development machines (`sealed --calibrate`
/// counts them anew): one or two effects that explain the recordings, 72 of 72.
pub const RIGHT_WHERE_EXPLAINED: f64 = 0.98;
/// The same for three effects that explain them: 1 of 3.
pub const RIGHT_OF_THREE: f64 = 0.4;
/// The same for one or two effects on a machine with textbook values: 27 of 30 of the machines that `tests/peers/identification/textbook.py` draws,
/// of which two have physics that is not in the library, and a name of the nearest shape.
pub const RIGHT_OF_TEXTBOOK: f64 = 0.87;
/// The same if something is left over: 3 of 6.
pub const RIGHT_WHERE_INCOMPLETE: f64 = 0.5;
/// The same for an unknown effect in the component that is named first: 22 of 22, but of three kinds that were all used during
/// development, so a little less.
pub const RIGHT_OF_UNKNOWN: f64 = 0.9;
