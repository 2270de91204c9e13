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
//! Modules in reading order: `disturbance`, `limits` (with the figures of a loop by another path), `grid`, `family`, `blocks`, `weights`,
//! `problem`, `evaluation`, `crossings`, `tangent`, `descent`, `starts`.

mod blocks;
mod crossings;
mod descent;
mod disturbance;
mod evaluation;
mod family;
mod grid;
mod limits;
mod problem;
mod starts;
mod tangent;
#[cfg(test)]
mod tests;
mod weights;

use counterpoise_lti::{StateSpace, c2d};

pub use disturbance::Disturbance;
pub(crate) use grid::{Clock, Density, LoopGrid};
pub use limits::{LoopLimits, LoopMeasures, measure_controller, measure_loop};

use crate::fixed_structure::FixedStructure;
use crate::{DesignPlant, Error, FeedbackWeights, Sampling, SamplingMethod, Specification};
use descent::{Descended, descend};
use problem::{LoopPlant, Problem};
use starts::near;

/// What is tuned, on what, for what.
#[derive(Debug, Clone)]
pub struct TuningTask<'a> {
    /// What is tuned.
    pub subject: TuningSubject<'a>,
    /// The plants that one controller must serve, the nominal one first.
    pub plants: &'a [DesignPlant],
    /// Further plants on which the loop must be stable: the machine with what the linear plant leaves out, such as gravity's
    /// gradient. A loop that only drifts there is stable.
    pub held: &'a [DesignPlant],
    /// How the controller is sampled.
    pub sampling: &'a Sampling,
    /// What acts on the loop: the objective is the rate that it leaves.
    pub disturbance: &'a Disturbance,
    /// What the loop must keep.
    pub limits: LoopLimits,
    /// Number of starts, and of restarts near the best answer.
    pub starts: usize,
    /// Seed of both.
    pub seed: u64,
}

/// What a tuning moves.
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
pub struct Tuned {
    /// The feedback.
    pub feedback: TunedFeedback,
    /// It sampled, from the error to the control.
    pub sampled: StateSpace,
    /// The figures of the loop on each plant, computed from state-space systems and not from the grid of the tuning.
    pub measures: Vec<LoopMeasures>,
    /// By how much the worst limit is missed, relative to it; 0 if all are kept.
    pub missed: f64,
    /// Residual rate that each start reached, rad/s; infinite if it found no loop within the limits.
    pub starts_rad_s: Vec<f64>,
    /// Loops that were evaluated.
    pub evaluations: usize,
}

impl Tuned {
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

/// Rounds in which the limits on the grid are tightened by what the figures of the state-space systems exceed them.
const ROUNDS: usize = 6;

/// Tunes the open parameters of a structure, or the weights of the H2 feedback.
///
/// # Errors
/// [`Error::System`] for a structure without open parameters, without plant, a disturbance without power, or a conversion other than
/// the bilinear map; [`Error::System`] if no start gives a stable loop.
pub fn tune(task: &TuningTask<'_>) -> Result<Tuned, Error> {
    let mut problem = Problem::new(task)?;
    let mut evaluations = 0;
    let mut reached: Vec<Option<Descended>> = Vec::new();
    let starts = task.starts.div_ceil(problem.family.cost());
    for start in problem.family.starts(&problem, starts, task.seed) {
        let found = descend(&problem, &start)?;
        evaluations += found.as_ref().map_or(0, |found| found.evaluations);
        reached.push(found);
    }
    let starts_rad_s = reached.iter().map(reached_residual).collect();
    let mut best = reached.into_iter().flatten().min_by(|a, b| a.merit.total_cmp(&b.merit));
    for k in 0..starts {
        let Some(before) = &best else { break };
        let start = near(&before.at, task.seed.wrapping_add(k as u64));
        let Some(found) = descend(&problem, &start)? else { continue };
        evaluations += found.evaluations;
        if found.merit < before.merit {
            best = Some(found);
        }
    }
    if let Some(before) = &best
        && let Some(found) = continued(&mut problem, &before.at)?
    {
        evaluations += found.evaluations;
        if found.merit < before.merit {
            best = Some(found);
        }
    }
    let problem_text =
        "no start gives a stable loop: widen the ranges of the parameters, or add a block with a gain";
    let mut best = best.ok_or(Error::System { what: "tuning", problem: problem_text })?;
    let mut answer = judged(task, &problem, &best.at)?;
    for _ in 0..ROUNDS {
        if answer.1 <= KEPT {
            break;
        }
        problem.limits = task.limits.tightened(&problem.limits, &answer.0);
        let Some(next) = descend(&problem, &best.at)? else { break };
        evaluations += next.evaluations;
        let judged = judged(task, &problem, &next.at)?;
        if judged.1 >= answer.1 {
            break;
        }
        (best, answer) = (next, judged);
    }
    let (measures, missed) = answer;
    let missed = if missed <= KEPT { 0.0 } else { missed };
    let (feedback, sampled) = (problem.family.feedback(&best.at), problem.family.sampled(&best.at)?);
    Ok(Tuned { feedback, sampled, measures, missed, starts_rad_s, evaluations })
}

/// Shares of the limit of the decay through which it is brought in.
const SHARES: [f64; 5] = [0.0, 0.3, 0.55, 0.8, 1.0];

/// Descends from a point without the limit of the decay, and brings the limit in step by step, each time from the last answer: a slow pole that
/// a start gives a loop is often left only through loops that are slower still. `None` without such a limit, or if a step finds no loop.
fn continued(problem: &mut Problem<'_>, from: &[f64]) -> Result<Option<Descended>, Error> {
    let asked = problem.limits;
    if asked.decay_rad_s <= 0.0 {
        return Ok(None);
    }
    let (mut at, mut evaluations, mut last) = (from.to_vec(), 0, None);
    for share in SHARES {
        problem.limits.decay_rad_s = share * asked.decay_rad_s;
        last = descend(problem, &at)?;
        let Some(found) = &mut last else { break };
        evaluations += found.evaluations;
        at.clone_from(&found.at);
        found.evaluations = evaluations;
    }
    problem.limits = asked;
    Ok(last)
}

/// A limit that is exceeded by less than this share counts as kept: far below what a plant is known to.
const KEPT: f64 = 5e-4;

fn reached_residual(found: &Option<Descended>) -> f64 {
    match found {
        Some(found) if found.missed <= KEPT => found.objective.exp(),
        _ => f64::INFINITY,
    }
}

/// The figures on each plant, and by how much the worst limit is missed.
fn judged(
    task: &TuningTask<'_>,
    problem: &Problem<'_>,
    at: &[f64],
) -> Result<(Vec<LoopMeasures>, f64), Error> {
    let K = problem.family.sampled(at)?;
    let measure = |plant: &LoopPlant| measure_loop(&plant.system, &K, task.disturbance);
    let measures: Vec<LoopMeasures> = problem.plants.iter().map(measure).collect::<Result<_, Error>>()?;
    let missed = measures.iter().map(|each| task.limits.missed(each)).fold(0.0, f64::max);
    Ok((measures, missed))
}

/// The sampled controller of a structure from the error to the control.
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
