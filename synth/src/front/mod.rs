//! The front of a family of feedbacks: the designs of which none is better than another in every objective.
//!
//! The family is the weights of the H2 feedback, or the open parameters of a fixed structure. The objectives are figures of the sampled loop on the
//! worst plant. Generations of points compete by domination (`domination`, `evolution`), and between them the tuner of [`crate::tuning`] descends from some
//! of the best points (`refinement`). Every design that is returned is measured by state-space systems, which is another path than the grid of
//! the search.
//!
//! The points are drawn one after the other from one seed, and only their evaluation runs side by side: the answer is the same on any number of processors.
//!
//! Modules in reading order: `objective`, `domination`, `evaluator`, `evolution`, `refinement`, `search`.

mod domination;
mod evaluator;
mod evolution;
mod objective;
mod refinement;
mod search;
#[cfg(test)]
mod tests;

use counterpoise_lti::StateSpace;
use counterpoise_pool::Pool;

pub use domination::{dominates, hypervolume, nondominated_places};
pub use objective::FrontObjective;

use crate::{Error, LoopMeasures, TunedFeedback, TuningTask};

/// Input of a search for a front.
#[derive(Debug, Clone)]
pub struct FrontTask<'a> {
    /// Family, plants, disturbance, limits, number of starts and seed.
    pub tuning: TuningTask<'a>,
    /// The objectives that are traded, two or more.
    pub objectives: &'a [FrontObjective],
    /// Method.
    pub method: FrontMethod,
    /// Feedbacks that are evaluated, about: the last generation and the last descents are finished.
    pub evaluations: usize,
    /// Designs that are returned at most.
    pub points: usize,
}

/// How the points of a front are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrontMethod {
    /// Differential evolution with descents of the tuner.
    Evolution,
    /// Points drawn at random, half of them anywhere in the ranges and half about the starts: what another method is compared with.
    Random,
}

/// A design of a front.
#[derive(Debug, Clone, PartialEq)]
pub struct FrontPoint {
    /// The feedback.
    pub feedback: TunedFeedback,
    /// Sampled feedback, from the error to the control.
    pub sampled: StateSpace,
    /// The figures of the loop on each plant, computed from state-space systems.
    pub measures: Vec<LoopMeasures>,
    /// The figure of each objective on the worst plant.
    pub figures: Vec<f64>,
}

impl FrontPoint {
    /// Returns what the front makes least, objective by objective.
    pub fn costs(&self, objectives: &[FrontObjective]) -> Vec<f64> {
        objectives.iter().zip(&self.figures).map(|(objective, figure)| objective.cost(*figure)).collect()
    }
}

/// The designs of a family of which none dominates another.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignFront {
    /// The designs, by the first objective.
    pub points: Vec<FrontPoint>,
    /// Feedbacks that were evaluated.
    pub evaluations: usize,
    /// Whether the search went to its end; it ends early if the user asks to stop.
    pub is_complete: bool,
}

/// Searches the designs of a family of which none is better than another in every objective. A front without a point means that no loop was found that
/// is stable and keeps the limits.
///
/// # Errors
/// [`Error::System`] for fewer than two objectives, an objective that is named twice, or a front of no points; those of
/// [`crate::tune_parameters`] about structure, plants, disturbance and sampling.
pub fn search_front(task: &FrontTask<'_>, pool: &dyn Pool) -> Result<DesignFront, Error> {
    check_task(task)?;
    let mut search = search::FrontSearch::new(task, pool)?;
    match task.method {
        FrontMethod::Evolution => search.evolve_and_refine()?,
        FrontMethod::Random => search.draw()?,
    }
    search.measure_front()
}

fn check_task(task: &FrontTask<'_>) -> Result<(), Error> {
    let refused = |problem| Err(Error::System { what: "front", problem });
    let objectives = task.objectives;
    if objectives.len() < 2 {
        return refused("a front needs two objectives or more");
    }
    if (1..objectives.len()).any(|k| objectives[..k].contains(&objectives[k])) {
        return refused("an objective is named twice");
    }
    if task.points == 0 || task.evaluations == 0 {
        return refused("it must have a point and an evaluation at least");
    }
    Ok(())
}
