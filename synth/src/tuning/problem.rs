//! The problem of the tuning as numbers: which parameters move, between what, and on which plants.

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::response::Response;
use counterpoise_lti::{StateSpace, feedback, poles, series};

use super::blocks::Blocks;
use super::family::FeedbackFamily;
use super::grid::{Clock, Density, LoopGrid, LoopPlant};
use super::weights::Weights;
use super::{LoopLimits, TuningSubject, TuningTask, bilinear_factor};
use crate::Error;
use crate::sampling::sampled_plant;
use crate::tolerance::DRIFTING_POLE;

/// The problem; a point is the logarithms of the open parameters.
pub(crate) struct Problem<'a> {
    pub task: &'a TuningTask<'a>,
    /// Family of the feedback that moves.
    pub family: Box<dyn FeedbackFamily + Send + 'a>,
    pub grid: LoopGrid,
    pub plants: Vec<LoopPlant>,
    /// The sampled plants on which the loop must be stable alone.
    pub held: Vec<StateSpace>,
    /// The limits on the grid.
    pub limits: LoopLimits,
}

impl<'a> Problem<'a> {
    pub fn new(task: &'a TuningTask<'a>) -> Result<Self, Error> {
        let sampled: Vec<StateSpace> =
            task.plants.iter().map(|plant| sampled_plant(plant, task.sampling)).collect::<Result<_, _>>()?;
        let nominal = task.plants.first();
        let nominal = nominal.ok_or(Error::System { what: "tuning", problem: "there is no plant" })?;
        let period_s = task.sampling.period_s;
        // Designed weights keep their meaning under any conversion: their feedback is taken as sampled.
        let factor = match task.subject {
            TuningSubject::Structure(_) => bilinear_factor(task.sampling)?,
            TuningSubject::Weights(_) => 2.0 / period_s,
        };
        let clock = Clock { period_s, factor };
        let grid = LoopGrid::new(&sampled, task.disturbance, clock, Density::OF_BLOCKS)?;
        let mut plants = Vec::new();
        for system in sampled {
            let of = Response::of(&system)?.at_all(&grid.rates)?;
            plants.push(LoopPlant { response: of.iter().map(|H| H[(0, 0)]).collect(), system });
        }
        let family: Box<dyn FeedbackFamily + Send + 'a> = match task.subject {
            TuningSubject::Structure(structure) => {
                Box::new(Blocks::new(structure, task.sampling, &grid, &plants[0])?)
            }
            TuningSubject::Weights(specification) => {
                Box::new(Weights::new(specification, nominal, task.sampling)?)
            }
        };
        let held: Vec<StateSpace> =
            task.held.iter().map(|plant| sampled_plant(plant, task.sampling)).collect::<Result<_, _>>()?;
        Ok(Self { task, family, grid, plants, held, limits: task.limits })
    }

    /// Returns the poles of the closed loop on each plant with a feedback.
    pub fn closed_poles(&self, K: &StateSpace) -> Result<Vec<Vec<C64>>, Error> {
        self.plants.iter().map(|plant| closed_poles(&plant.system, K)).collect()
    }

    /// Returns whether every loop is stable at a point. A realisation or connection that fails counts as unstable: its numbers
    /// are beyond what a controller could hold.
    pub fn is_stable(&self, at: &[f64]) -> bool {
        let inside = |all: Vec<Vec<C64>>| all.iter().flatten().all(|pole| pole.norm() < 1.0);
        let Ok(K) = self.family.sampled_feedback(at) else { return false };
        self.closed_poles(&K).map(inside).unwrap_or(false) && self.holds(&K).unwrap_or(false)
    }

    /// Returns whether the loop holds the machine with what the linear plant leaves out.
    pub fn holds(&self, K: &StateSpace) -> Result<bool, Error> {
        for plant in &self.held {
            let drifts = |pole: &C64| (pole - C64::ONE).norm() < DRIFTING_POLE;
            if closed_poles(plant, K)?.iter().any(|pole| pole.norm() >= 1.0 && !drifts(pole)) {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

fn closed_poles(plant: &StateSpace, K: &StateSpace) -> Result<Vec<C64>, Error> {
    let unit = StateSpace::gain(Mat::eye(1), K.timebase)?;
    Ok(poles(&feedback(&series(plant, K)?, &unit)?)?)
}
