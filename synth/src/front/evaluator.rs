//! The evaluation of many points on the processors at hand.

use std::sync::Mutex;

use counterpoise_pool::{Pool, map};

use super::FrontObjective;
use super::domination::CandidateRating;
use crate::tolerance::FRONT_GRID_SHARE;
use crate::tuning::problem::Problem;
use crate::{Error, LoopLimits, LoopMeasures, TuningTask};

/// A point of the family with its rating.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    /// Logarithms of the open parameters.
    pub at: Vec<f64>,
    pub rating: CandidateRating,
}

/// Evaluates points of one family. Each processor has a problem of its own, because a family keeps its last designs.
pub(super) struct Evaluator<'a> {
    task: &'a TuningTask<'a>,
    objectives: &'a [FrontObjective],
    pool: &'a dyn Pool,
    /// The limits that a loop must keep on the grid so that it keeps those of the task off it.
    grid_limits: LoopLimits,
    idle: Mutex<Vec<Problem<'a>>>,
}

impl<'a> Evaluator<'a> {
    /// Returns the evaluator of a task.
    ///
    /// # Errors
    /// As [`Problem::new`].
    pub fn new(
        task: &'a TuningTask<'a>,
        objectives: &'a [FrontObjective],
        pool: &'a dyn Pool,
    ) -> Result<Self, Error> {
        let idle = Mutex::new(vec![Problem::new(task)?]);
        let grid_limits = task.limits.tighten_by(FRONT_GRID_SHARE);
        Ok(Self { task, objectives, pool, grid_limits, idle })
    }

    /// Says how many of some evaluations are done.
    pub fn report_progress(&self, done: usize, of: usize) {
        self.pool.progress("searching", done.min(of), of);
    }

    /// Hands a job a problem that no other job uses meanwhile.
    ///
    /// # Errors
    /// As [`Problem::new`], and those of the job.
    pub fn with_problem<T>(
        &self,
        job: impl FnOnce(&mut Problem<'a>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let kept = self.idle.lock().ok().and_then(|mut idle| idle.pop());
        let mut problem = match kept {
            Some(problem) => problem,
            None => Problem::new(self.task)?,
        };
        problem.limits = self.grid_limits;
        let result = job(&mut problem);
        if let Ok(mut idle) = self.idle.lock() {
            idle.push(problem);
        }
        result
    }

    /// Returns the results of a job for each of `count` places, in order; `None` if the user asked to stop before all were done.
    ///
    /// # Errors
    /// The first of the jobs'.
    pub fn map_places<T: Send>(
        &self,
        count: usize,
        job: impl Fn(&mut Problem<'a>, usize) -> Result<T, Error> + Sync,
    ) -> Result<Option<Vec<T>>, Error> {
        let found = map(self.pool, count, |k| self.with_problem(|problem| job(problem, k)));
        if found.len() < count {
            return Ok(None);
        }
        found.into_iter().collect::<Result<Vec<T>, Error>>().map(Some)
    }

    /// Returns the points with their rating; `None` if the user asked to stop before all were evaluated.
    ///
    /// # Errors
    /// As [`Problem::new`].
    pub fn evaluate(&self, points: Vec<Vec<f64>>) -> Result<Option<Vec<Candidate>>, Error> {
        let ratings = self.map_places(points.len(), |problem, k| Ok(self.judge(problem, &points[k])))?;
        let pair = |(at, rating)| Candidate { at, rating };
        Ok(ratings.map(|ratings| points.into_iter().zip(ratings).map(pair).collect()))
    }

    /// Returns the rating of a point. One without a feedback counts as a loop that is not stable.
    pub fn judge(&self, problem: &Problem<'_>, at: &[f64]) -> CandidateRating {
        match problem.grid_measures(at) {
            Ok(Some(found)) => {
                let costs = self.costs(&found);
                let missed = worst_shortfall(&self.grid_limits, &found);
                let is_finite = costs.iter().all(|cost| cost.is_finite());
                CandidateRating { costs, missed: if is_finite { missed } else { f64::INFINITY } }
            }
            _ => CandidateRating { costs: vec![f64::INFINITY; self.objectives.len()], missed: f64::INFINITY },
        }
    }

    /// Returns the costs of loops on the worst plant.
    pub fn costs(&self, found: &[LoopMeasures]) -> Vec<f64> {
        self.objectives.iter().map(|each| each.cost(each.worst_figure(found))).collect()
    }
}

/// Returns by how much the worst limit is missed on the worst plant.
pub(super) fn worst_shortfall(limits: &LoopLimits, found: &[LoopMeasures]) -> f64 {
    found.iter().map(|each| limits.worst_shortfall(each)).fold(0.0, f64::max)
}
