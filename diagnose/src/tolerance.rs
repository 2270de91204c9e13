//! The numbers that decide, in one place.

/// Iterations of one fit at the most.
pub const FIT_ITERATIONS: usize = 25;
/// A fit has settled when an iteration lowers the cost by less than this share.
pub const FIT_TOLERANCE: f64 = 1e-4;
/// Step of the numerical derivative, in units of a knob's typical size.
pub const FIT_STEP: f64 = 1e-3;
/// Residuals smaller than this share of the floor count as this: a fit cannot be better than the noise.
pub const SCORE_FLOOR: f64 = 0.97;
/// Effects that are fitted in the simulator at every stage, after the first look.
pub const SHORTLIST: usize = 9;
/// Effects that may act together.
pub const EFFECTS_AT_MOST: usize = 3;
/// Log-likelihood that an effect must gain on data that it was not fitted to, in nats.
pub const GAIN_NEEDED: f64 = 15.0;
/// Share by which an effect must shrink the distance from the floor to be worth naming.
pub const SHARE_NEEDED: f64 = 0.10;
/// Candidates whose distance from the floor is this close to the best one's cannot be told apart.
pub const EQUIVALENT_DISTANCE: f64 = 0.01;
/// A model whose largest excess stays below this explains the recordings.
pub const EXPLAINED: f64 = 1.5;
/// Share of a fitted recording that a candidate may see; the rest judges it.
pub const FITTED_SHARE: f64 = 0.6;
/// An effect is idle when dropping it costs less than this share of the distance that was to be explained.
pub const PRUNE_SHARE: f64 = 0.05;
/// An effect is replaced when another one's ranking is better by this much.
pub const SWAP_NEEDED: f64 = 0.02;
/// Share of the distance that must be explained for the explanation to count; below it the mismatch is unknown.
pub const SHARE_TO_NAME: f64 = 0.5;
/// Probability lost per unit of distance between the best effect and a rival, as an exponent.
pub const RIVALRY: f64 = 60.0;
/// Pairs of effects that are fitted together at a stage.
pub const PAIRS: usize = 5;
/// Distance that one more effect must be worth.
pub const EFFECT_PRICE: f64 = 0.01;
/// Distance that one more parameter must be worth.
pub const PARAMETER_PRICE: f64 = 2e-3;
/// Iterations of a fit while candidates are compared.
pub const SEARCH_ITERATIONS: usize = 10;
/// A model with more parameters than this stays as it is while further effects are compared, and is fitted together
/// with the chosen one.
pub const JOINT_KNOBS: usize = 6;
/// Effects that are fitted in the place of one that was found.
pub const RIVALS: usize = 5;
/// Distance from the floor below which nothing is left that a further effect could explain.
pub const NOTHING_LEFT: f64 = 0.07;
/// Samples of a stretch: longer than the loop remembers its noise.
pub const STRETCH: usize = 250;
/// Relative deviation of a parameter that two careful simulators of one mechanism differ by.
pub const SYSTEMATIC: f64 = 5e-4;
/// Difference between the gyroscopes and the motor's or the resolver's rate, rad/s, from which a bias is sought.
pub const BIAS_SEEN_RAD_S: f64 = 2e-4;
