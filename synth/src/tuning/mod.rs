//! Tuning of a feedback: the least residual rate under limits of the loop, on several plants at once. What moves is the parameters of a
//! fixed structure, or the weights of the H2 feedback.
//!
//! ```text
//!     least   max over the plants  ln sqrt( sum power_k |S(jw_k)|^2 + noise^2 mean |T|^2 )
//!     under   |S| <= Ms, |T| <= Mt, |KS| <= ..., margins, noise gain, effort, poles       on every plant
//! ```
//!
//! The peaks over frequency make the problem nonsmooth. Each step solves a tangent program (a quadratic program, Clarabel)
//! in which every peak near its limit has its own line, so that the step is not misled by the one that happens to be the
//! highest: the extended set of frequencies of Apkarian and Noll, "Nonsmooth H-infinity synthesis", IEEE TAC 51 (2006) 71.
//! An exact penalty and a trust region decide on the step; several deterministic starts guard against local minima.
//!
//! Modules in reading order: `disturbance`, `limits` (with the figures of a loop by another path), `grid`, `family`, `random`, `blocks`, `starts`,
//! `block_family`, `shape`, `weights`, `problem`, `loop_response`, `crossings`, `evaluation`, `tangent`, `descent`,
//! `search`; and `grid_measures`, the figures of a loop without slopes.

mod block_family;
mod blocks;
mod crossings;
pub(crate) mod descent;
mod disturbance;
mod evaluation;
pub(crate) mod family;
pub(crate) mod grid;
mod grid_measures;
mod limits;
mod loop_response;
pub(crate) mod problem;
pub(crate) mod random_generator;
mod search;
mod shape;
mod starts;
mod tangent;
#[cfg(test)]
mod tests;
mod weights;

use counterpoise_lti::{StateSpace, c2d};

pub use disturbance::Disturbance;
pub(crate) use grid::{Clock, Density, LoopGrid};
pub use limits::{LoopLimits, LoopMeasures, feedback_path, measure_controller, measure_loop};

use crate::fixed_structure::{FixedStructure, ParameterName};
use crate::{DesignPlant, Error, FeedbackWeights, Sampling, SamplingMethod, Specification};
use search::Search;

/// Input of a tuning: structure, plants and objective.
#[derive(Debug, Clone)]
pub struct TuningTask<'a> {
    /// Subject of the tuning.
    pub subject: TuningSubject<'a>,
    /// The plants that one controller must serve, the nominal one first.
    pub plants: &'a [DesignPlant],
    /// Further plants on which the loop must be stable: the machine with what the linear plant leaves out, such as gravity's
    /// gradient. A loop that only drifts there is stable.
    pub held: &'a [DesignPlant],
    /// Sampling of the controller.
    pub sampling: &'a Sampling,
    /// Disturbance of the loop: the objective is the rate that it leaves.
    pub disturbance: &'a Disturbance,
    /// Limits that the loop must keep.
    pub limits: LoopLimits,
    /// Number of starts, and of restarts near the best answer.
    pub starts: usize,
    /// Seed of both.
    pub seed: u64,
}

/// Quantities that a tuning changes.
#[derive(Debug, Clone, Copy)]
pub enum TuningSubject<'a> {
    /// The open parameters of a fixed structure.
    Structure(&'a FixedStructure),
    /// The weights of the H2 feedback on the nominal plant, from those of a specification: gain, corners and damping ratios of error and
    /// control weight, the noise of the measurement and the loop recovery. The error weight gets two further pairs of a corner and its opposite.
    Weights(&'a Specification),
}

/// The feedback that a tuning found.
#[derive(Debug, Clone, PartialEq)]
pub enum TunedFeedback {
    /// A structure with a value for every parameter.
    Structure(FixedStructure),
    /// Weights of the H2 feedback.
    Weights(Box<FeedbackWeights>),
}

/// A tuned feedback.
#[derive(Debug, Clone, PartialEq)]
pub struct TunedDesign {
    /// The feedback.
    pub feedback: TunedFeedback,
    /// Sampled feedback, from the error to the control.
    pub sampled: StateSpace,
    /// The figures of the loop on each plant, computed from state-space systems and not from the grid of the tuning.
    pub measures: Vec<LoopMeasures>,
    /// By how much the worst limit is missed, relative to it; 0 if all are kept.
    pub missed: f64,
    /// Residual rate that each start reached, rad/s; infinite if it found no loop within the limits.
    pub starts_rad_s: Vec<f64>,
    /// Loops that were evaluated.
    pub evaluations: usize,
    /// Parameters of a structure that ended at an end of their range: a wider one may hold a better answer.
    pub range_ends: Vec<RangeEnd>,
}

/// A parameter of a block at an end of the range in which it was tuned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeEnd {
    /// Place of the block in the structure, from 0.
    pub block: usize,
    /// Parameter.
    pub parameter: ParameterName,
    /// The range: lowest and highest value.
    pub range: [f64; 2],
}

impl TunedDesign {
    /// Returns the tuned structure; one without blocks if weights were tuned.
    pub fn structure(&self) -> FixedStructure {
        match &self.feedback {
            TunedFeedback::Structure(structure) => structure.clone(),
            TunedFeedback::Weights(_) => FixedStructure::default(),
        }
    }

    /// Returns the residual rate on the worst plant, rad/s.
    pub fn residual_rad_s(&self) -> f64 {
        self.measures.iter().map(|each| each.residual_rad_s).fold(0.0, f64::max)
    }
}

/// Tunes the open parameters of a structure, or the weights of the H2 feedback.
///
/// # Errors
/// [`Error::System`] for a structure without open parameters, without plant, a disturbance without power, or a conversion other than
/// the bilinear map; [`Error::System`] if no start gives a stable loop.
pub fn tune_parameters(task: &TuningTask<'_>) -> Result<TunedDesign, Error> {
    let mut search = Search::new(task)?;
    search.descend_from_starts()?;
    search.descend_near_best()?;
    search.bring_in_decay()?;
    search.keep_limits()
}

/// Returns the sampled controller of a structure from the error to the control.
///
/// # Errors
/// As [`FixedStructure::rational`], and those of the conversion.
pub fn sampled_structure(structure: &FixedStructure, sampling: &Sampling) -> Result<StateSpace, Error> {
    let continuous = structure.rational()?.realise()?;
    Ok(c2d(&continuous, sampling.period_s, sampling.method.conversion())?)
}

/// The factor k of s = k (z - 1)/(z + 1), by which the sampled controller has the continuous one's response.
pub(crate) fn bilinear_factor(sampling: &Sampling) -> Result<f64, Error> {
    use counterpoise_lti::Discretisation::Tustin;
    let problem = "only the bilinear map keeps the parameters' meaning: use discretisation = \"tustin\"";
    match sampling.method {
        SamplingMethod::Emulation(Tustin { prewarp_rad_s: None }) => Ok(2.0 / sampling.period_s),
        SamplingMethod::Emulation(Tustin { prewarp_rad_s: Some(rate) }) => {
            Ok(rate / (0.5 * rate * sampling.period_s).tan())
        }
        _ => Err(Error::System { what: "tuning", problem }),
    }
}
