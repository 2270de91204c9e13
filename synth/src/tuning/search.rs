//! The stages of a tuning: from several starts, near the best answer, with the limit of the decay brought in by steps, and with the limits on
//! the grid tightened until the figures of the state-space systems keep them.

use super::descent::{DescentResult, descend};
use super::grid::LoopPlant;
use super::problem::Problem;
use super::starts::perturb_point;
use super::{LoopMeasures, TunedDesign, TuningTask, measure_loop};
use crate::Error;
use crate::tolerance::LIMIT_KEPT;

/// Rounds in which the limits on the grid are tightened by what the figures of the state-space systems exceed them.
const ROUNDS: usize = 6;
/// Answers within the limits on the grid that are tried if the best one cannot be brought within them.
const OTHER_ANSWERS: usize = 3;
/// Shares of the limit of the decay through which it is brought in.
const SHARES: [f64; 5] = [0.0, 0.3, 0.55, 0.8, 1.0];

/// A tuning on its way.
pub(super) struct Search<'a> {
    task: &'a TuningTask<'a>,
    problem: Problem<'a>,
    best: Option<DescentResult>,
    /// The best ends of descents within the limits, the best first.
    kept: Vec<DescentResult>,
    starts_rad_s: Vec<f64>,
    evaluations: usize,
}

/// The figures of a loop on each plant, and by how much the worst limit is missed.
struct JudgedMeasures {
    measures: Vec<LoopMeasures>,
    missed: f64,
}

impl<'a> Search<'a> {
    /// Sets up the problem of a task.
    ///
    /// # Errors
    /// As [`super::tune_parameters`].
    pub fn new(task: &'a TuningTask<'a>) -> Result<Self, Error> {
        let problem = Problem::new(task)?;
        Ok(Self { task, problem, best: None, kept: Vec::new(), starts_rad_s: Vec::new(), evaluations: 0 })
    }

    /// Descends from every start.
    ///
    /// # Errors
    /// Those of the descent.
    pub fn descend_from_starts(&mut self) -> Result<(), Error> {
        let (nominal, grid) = (&self.problem.plants[0], &self.problem.grid);
        for start in self.problem.family.starts(nominal, grid, self.task.starts, self.task.seed) {
            let found = self.descend_from(&start)?;
            self.starts_rad_s.push(kept_residual(found.as_ref()));
            self.keep_better(found);
        }
        Ok(())
    }

    /// Descends again from points near the best one.
    ///
    /// # Errors
    /// Those of the descent.
    pub fn descend_near_best(&mut self) -> Result<(), Error> {
        for k in 0..self.task.starts {
            let Some(best) = &self.best else { break };
            let start = perturb_point(&best.at, self.task.seed.wrapping_add(k as u64));
            let found = self.descend_from(&start)?;
            self.keep_better(found);
        }
        Ok(())
    }

    /// Descends from the best point without the limit of the decay, and brings the limit in step by step, each time from the last answer: a slow
    /// pole that a start gives a loop is often left only through loops that are slower still.
    ///
    /// # Errors
    /// Those of the descent.
    pub fn bring_in_decay(&mut self) -> Result<(), Error> {
        let asked = self.problem.limits;
        let Some(best) = self.best.as_ref().filter(|_| asked.decay_rad_s > 0.0) else { return Ok(()) };
        let (mut at, mut last) = (best.at.clone(), None);
        for share in SHARES {
            self.problem.limits.decay_rad_s = share * asked.decay_rad_s;
            last = self.descend_from(&at)?;
            let Some(found) = &last else { break };
            at.clone_from(&found.at);
        }
        self.problem.limits = asked;
        self.keep_better(last);
        Ok(())
    }

    /// Tightens the limits on the grid until the figures of the state-space systems keep those that were asked. If the best answer cannot be
    /// brought within them, the next best ones that kept them on the grid are.
    ///
    /// # Errors
    /// [`Error::System`] if no start gave a stable loop; those of the figures.
    pub fn keep_limits(mut self) -> Result<TunedDesign, Error> {
        let problem =
            "no start gives a stable loop: widen the ranges of the parameters, or add a block with a gain";
        let best = self.best.take().ok_or(Error::System { what: "tuning", problem })?;
        let others: Vec<DescentResult> =
            self.kept.drain(..).filter(|other| other.at != best.at).take(OTHER_ANSWERS).collect();
        let (mut at, mut judged) = self.tighten_limits(best)?;
        for other in others {
            if judged.missed <= LIMIT_KEPT {
                break;
            }
            let (next, next_judged) = self.tighten_limits(other)?;
            if next_judged.missed < judged.missed {
                (at, judged) = (next, next_judged);
            }
        }
        let family = &self.problem.family;
        Ok(TunedDesign {
            feedback: family.feedback(&at),
            sampled: family.sampled_feedback(&at)?,
            measures: judged.measures,
            missed: if judged.missed <= LIMIT_KEPT { 0.0 } else { judged.missed },
            starts_rad_s: self.starts_rad_s,
            evaluations: self.evaluations,
            range_ends: family.range_ends(&at),
        })
    }

    /// Descends from an answer with limits on the grid that are tightened by what its figures miss; gives the best point with its figures.
    fn tighten_limits(&mut self, from: DescentResult) -> Result<(Vec<f64>, JudgedMeasures), Error> {
        self.problem.limits = self.task.limits;
        let (mut best, mut judged) = (from.at.clone(), self.judge_point(&from.at)?);
        for _ in 0..ROUNDS {
            if judged.missed <= LIMIT_KEPT {
                break;
            }
            self.problem.limits = self.task.limits.tighten(&self.problem.limits, &judged.measures);
            let Some(next) = self.descend_from(&best)? else { break };
            let next_judged = self.judge_point(&next.at)?;
            if next_judged.missed >= judged.missed {
                break;
            }
            (best, judged) = (next.at, next_judged);
        }
        Ok((best, judged))
    }

    fn descend_from(&mut self, start: &[f64]) -> Result<Option<DescentResult>, Error> {
        let found = descend(&self.problem, start)?;
        self.evaluations += found.as_ref().map_or(0, |found| found.evaluations);
        Ok(found)
    }

    /// Keeps an end of a descent if it is better than the best one: one within the limits is better than any that is not, whatever it leaves.
    fn keep_better(&mut self, found: Option<DescentResult>) {
        let Some(found) = found else { return };
        if found.missed <= LIMIT_KEPT {
            let place = self.kept.partition_point(|other| other.objective <= found.objective);
            self.kept.insert(place, found.clone());
        }
        if self.best.as_ref().is_none_or(|best| is_better(&found, best)) {
            self.best = Some(found);
        }
    }

    fn judge_point(&self, at: &[f64]) -> Result<JudgedMeasures, Error> {
        let K = self.problem.family.sampled_feedback(at)?;
        let measure = |plant: &LoopPlant| measure_loop(&plant.system, &K, self.task.disturbance);
        let measures = self.problem.plants.iter().map(measure).collect::<Result<Vec<_>, Error>>()?;
        let missed = measures.iter().map(|each| self.task.limits.worst_shortfall(each)).fold(0.0, f64::max);
        Ok(JudgedMeasures { measures, missed })
    }
}

/// Returns whether an end of a descent is better than another one.
fn is_better(found: &DescentResult, best: &DescentResult) -> bool {
    match (found.missed <= LIMIT_KEPT, best.missed <= LIMIT_KEPT) {
        (true, false) => true,
        (false, true) => false,
        _ => found.merit < best.merit,
    }
}

fn kept_residual(found: Option<&DescentResult>) -> f64 {
    match found {
        Some(found) if found.missed <= LIMIT_KEPT => found.objective.exp(),
        _ => f64::INFINITY,
    }
}
