//! The numbers that decide, in one place.

/// Iterations of one fit at the most.
pub const FIT_ITERATIONS: usize = 25;
/// A fit has settled when an iteration lowers the cost by less than this share.
pub const FIT_TOLERANCE: f64 = 1e-4;
/// Step of the numerical derivative, in units of a parameter's typical size.
pub const FIT_STEP: f64 = 1e-3;
/// Residuals smaller than this share of the floor count as this.
pub const SCORE_FLOOR: f64 = 0.3;
/// Effects that are fitted in the simulator at every stage, after the first look.
pub const SHORTLIST: usize = 8;
/// Effects that may act together.
pub const EFFECTS_AT_MOST: usize = 3;
/// Log-likelihood that an effect must gain on data that it was not fitted to, in nats.
pub const GAIN_NEEDED: f64 = 60.0;
/// A model whose largest excess stays below this explains the recordings.
pub const EXPLAINED: f64 = 1.5;
/// Share of a fitted recording that a candidate may see; the rest judges it.
pub const FITTED_SHARE: f64 = 0.6;
/// Share of the needed gain that a signature must promise for its effect to be fitted, where the model is close.
pub const PROMISE_SHARE: f64 = 0.5;
/// An effect is replaced when another one is ahead of it by this many nats.
pub const SWAP_NEEDED: f64 = 10.0;
/// Share of the distance that must be explained for the explanation to count; below it the mismatch is unknown.
pub const SHARE_TO_NAME: f64 = 0.5;
/// Probability lost per nat between the best effect and a rival, as an exponent.
pub const RIVALRY: f64 = 0.15;
/// Pairs of effects that are fitted together at a stage.
pub const PAIRS: usize = 5;
/// Log-likelihood that one more effect must be worth, in nats.
pub const EFFECT_PRICE: f64 = 15.0;
/// Log-likelihood that one more parameter must be worth, in nats: half the logarithm of the number of samples, and what
/// the scan for its start gives it by chance.
pub const PARAMETER_PRICE: f64 = 10.0;
/// Iterations of a fit while candidates are compared.
pub const SEARCH_ITERATIONS: usize = 10;
/// A model with more parameters than this stays as it is while further effects are compared, and is fitted together
/// with the chosen one.
pub const JOINT_PARAMETERS: usize = 6;
/// Effects that are fitted in the place of one that was found.
pub const RIVALS: usize = 5;
/// Distance from the floor below which nothing is left that a further effect could explain.
pub const NOTHING_LEFT: f64 = 0.07;
/// Samples of a stretch: longer than the loop remembers its noise.
pub const STRETCH: usize = 250;
/// Lags, in stretches, over which the gradient's scatter is summed.
pub const STRETCHES_TOGETHER: usize = 3;
/// Relative deviation of a parameter that two careful simulators of one mechanism differ by.
pub const SYSTEMATIC: f64 = 5e-4;
/// Difference between the gyroscopes and the motor's or the resolver's rate, rad/s, from which a bias is sought.
pub const BIAS_SEEN_RAD_S: f64 = 2e-4;
/// A channel is harmed that is left further from its floor by this factor.
pub const HARM: f64 = 1.15;
/// Share of all that was gained that a further effect must gain: less is what two simulators differ by.
pub const SYSTEMATIC_GAIN: f64 = 5e-3;
/// Candidates of a stage that are fitted once more, to every recording.
pub const FINALISTS: usize = 4;
/// Mean ln(RMS / floor) by which a finalist may be behind the best after its first fit: where the best explains the
/// recordings, and where it does not.
pub const FINAL_REACH: [f64; 2] = [0.03, 0.7];
/// Iterations of a first fit of a candidate.
pub const TRIAL_ITERATIONS: usize = 6;
/// Candidates that are behind the best by fewer nats than this cannot be told from it: three standard errors of the
/// log-likelihood ratio of two models so close.
pub const AMBIGUOUS: f64 = 18.0;
/// Times at the most that a fit seeks the recordings' starts anew at what it found.
pub const RESTARTS: usize = 1;
/// The same for a first fit of a candidate.
pub const TRIAL_RESTARTS: usize = 1;
/// Share by which a new start must lower the cost for a further one to be sought.
pub const RESTART_WORTH: f64 = 2e-3;
/// Iterations of a fit for which what the recordings' starts do is taken as it was.
pub const STARTS_KEPT: usize = 4;
/// Outcomes of other noise from which what chance would explain is taken.
pub const CHANCES: u64 = 8;
/// Times what chance explains on the average that an effect must gain beyond what is needed anyway.
pub const BEYOND_CHANCE: f64 = 12.0;
/// Gain, in nats, above which no noise is thought of as its cause.
pub const NO_CHANCE: f64 = 4000.0;
/// Share of what a candidate gains beyond which a recording is the only one that shows its effect.
pub const ONLY_THERE: f64 = 0.9;
/// Share of a period that the travel must cover for a torque to count as one that repeats.
pub const PERIOD_SEEN: f64 = 0.75;
/// Samples of all recordings together that a diagnosis replays: four recordings of 12 s at 1 kHz.
pub const SAMPLES_AT_MOST: usize = 48_000;
/// Periods a sample of a torque that repeats, at the RMS rate, above which no reading follows it: half the sampling rate.
pub const PERIODS_SAMPLED: f64 = 0.5;
/// Steps a sample, on the average, beyond which a mechanism is not tried: so stiff is none that is recorded at this rate.
pub const STEPS_PER_SAMPLE: f64 = 60.0;
/// Log-likelihood that an effect must gain on data that it was not fitted to, in nats, in a machine whose model is a textbook's: what
/// that leaves is motion that lasts, of which a recording holds few independent samples.
pub const TEXTBOOK_GAIN_NEEDED: f64 = 12.0;
/// Share of the power of what such a model leaves that effects must explain to carry a name.
pub const TEXTBOOK_SHARE_TO_NAME: f64 = 0.15;
/// The same of a machine whose model is a textbook's: its effects are many and large, and every fit takes longer.
pub const TEXTBOOK_SAMPLES_AT_MOST: usize = 12_000;
/// Single effects that are fitted in the place of two of one component.
pub const MERGES: usize = 4;
/// Spacing of the inputs at which a curve's points may lie, V, and the most points that it may have.
pub const KNOT_SPACING_V: f64 = 0.0125;
/// See [`KNOT_SPACING_V`].
pub const KNOTS_AT_MOST: usize = 24;
/// Two points of a curve are further apart than this, V.
pub const KNOT_GAP_V: f64 = 0.03;
/// Iterations of a fit of a curve with other points.
pub const KNOT_ITERATIONS: usize = 6;
/// Log-likelihood that a point of a curve must be worth on stretches that it was not fitted to, in nats.
pub const KNOT_PRICE: f64 = 12.0;
/// Share that it must be worth of what all points of the fine curve together are worth beyond the present ones.
pub const KNOT_SHARE: f64 = 0.005;
/// The same, that a point must gain to be moved.
pub const KNOT_WANDER: f64 = 1.0;
/// Samples of a stretch that is fitted while the next one judges.
pub const KNOT_STRETCH: usize = 1000;
/// Times that the points are moved to where each is worth most, and the idle ones taken away.
pub const KNOT_MOVES: usize = 6;
/// Times that a curve's points are chosen anew.
pub const KNOT_ROUNDS: usize = 1;
/// How often a name without a rival was true, (n + 1) / (m + 2) for n of m on the development machines (seeds 1 to 56 and 81 to 140 of the sealed
/// machines; `sealed --calibrate` counts them anew): one or two effects that explain the recordings, 72 of 72.
pub const RIGHT_WHERE_EXPLAINED: f64 = 0.98;
/// The same, three effects that explain them: 1 of 3.
pub const RIGHT_OF_THREE: f64 = 0.4;
/// The same, where something is left over: 3 of 6. Of a textbook's model, too, for which there are no sealed machines.
pub const RIGHT_WHERE_INCOMPLETE: f64 = 0.5;
/// The same, that something unknown sits in the component that is named first: 22 of 22, of three kinds that were all in view, so a little less.
pub const RIGHT_OF_UNKNOWN: f64 = 0.9;
