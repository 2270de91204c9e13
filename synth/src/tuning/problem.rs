//! The problem of the tuning as numbers: which parameters move, between what, and on which plants.

use counterpoise_lti::response::Response;
use counterpoise_lti::{C64, Mat, StateSpace, feedback, poles, series};

use super::grid::{Clock, Density, LoopGrid};
use super::starts::usual_range;
use super::{LoopLimits, TuningTask, bilinear_factor, sampled_structure};
use crate::Error;
use crate::fixed_structure::{FixedStructure, Parameter, ParameterName};
use crate::sampling::sampled_plant;

/// A plant under a zero-order hold.
pub(crate) struct LoopPlant {
    /// From the held control to the reading.
    pub system: StateSpace,
    /// Its response on the grid.
    pub response: Vec<C64>,
}

/// A parameter that moves.
pub(crate) struct OpenParameter {
    /// Block and place in it.
    pub block: usize,
    pub place: usize,
    /// What it is.
    pub name: ParameterName,
    /// Logarithms of its lowest and highest value.
    pub range: [f64; 2],
    /// The first value that the file states.
    pub stated: Option<f64>,
}

/// The problem; a point is the logarithms of the open parameters.
pub(crate) struct Problem<'a> {
    pub task: &'a TuningTask<'a>,
    pub open: Vec<OpenParameter>,
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
        if sampled.is_empty() {
            return Err(Error::System { what: "tuning", problem: "there is no plant" });
        }
        let period_s = task.sampling.period_s;
        let clock = Clock { period_s, factor: bilinear_factor(task.sampling)? };
        let grid = LoopGrid::new(&sampled, task.disturbance, clock, Density::OF_BLOCKS)?;
        let mut plants = Vec::new();
        for system in sampled {
            let of = Response::of(&system)?.at_all(&grid.rates)?;
            plants.push(LoopPlant { response: of.iter().map(|H| H[(0, 0)]).collect(), system });
        }
        let open = open_parameters(task, &grid, &plants[0]);
        if open.is_empty() {
            return Err(Error::System {
                what: "tuning",
                problem: "every parameter of the structure is fixed",
            });
        }
        let held: Vec<StateSpace> =
            task.held.iter().map(|plant| sampled_plant(plant, task.sampling)).collect::<Result<_, _>>()?;
        Ok(Self { task, open, grid, plants, held, limits: task.limits })
    }

    /// The values of all parameters at a point.
    pub fn values(&self, at: &[f64]) -> Vec<Vec<f64>> {
        let stated = |parameter: &Parameter| parameter.value.unwrap_or(1.0);
        let blocks = &self.task.structure.blocks;
        let mut all: Vec<Vec<f64>> =
            blocks.iter().map(|b| b.parameters.iter().map(stated).collect()).collect();
        for (parameter, value) in self.open.iter().zip(at) {
            all[parameter.block][parameter.place] = value.exp();
        }
        all
    }

    /// The structure with every parameter fixed at a point.
    pub fn structure(&self, at: &[f64]) -> FixedStructure {
        let mut structure = self.task.structure.clone();
        for (block, values) in structure.blocks.iter_mut().zip(self.values(at)) {
            block.parameters = values.into_iter().map(Parameter::fixed).collect();
        }
        structure
    }

    /// The poles of the closed loop on each plant at a point.
    pub fn closed_poles(&self, at: &[f64]) -> Result<Vec<Vec<C64>>, Error> {
        let K = sampled_structure(&self.structure(at), self.task.sampling)?;
        self.plants.iter().map(|plant| closed_poles(&plant.system, &K)).collect()
    }

    /// Whether every loop is stable at a point. A realisation or connection that fails counts as unstable: its numbers are
    /// beyond what a controller could hold.
    pub fn is_stable(&self, at: &[f64]) -> bool {
        let inside = |all: Vec<Vec<C64>>| all.iter().flatten().all(|pole| pole.norm() < 1.0);
        self.closed_poles(at).map(inside).unwrap_or(false) && self.holds(at).unwrap_or(false)
    }

    /// Whether the loop holds the machine with what the linear plant leaves out.
    fn holds(&self, at: &[f64]) -> Result<bool, Error> {
        let K = sampled_structure(&self.structure(at), self.task.sampling)?;
        for plant in &self.held {
            let drifts = |pole: &C64| (pole - C64::ONE).norm() < DRIFT;
            if closed_poles(plant, &K)?.iter().any(|pole| pole.norm() >= 1.0 && !drifts(pole)) {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// A pole this near to 1 is an angle that the loop does not see: it drifts.
const DRIFT: f64 = 1e-6;

fn closed_poles(plant: &StateSpace, K: &StateSpace) -> Result<Vec<C64>, Error> {
    let unit = StateSpace::gain(Mat::eye(1), K.timebase)?;
    Ok(poles(&feedback(&series(plant, K)?, &unit)?)?)
}

fn open_parameters(task: &TuningTask<'_>, grid: &LoopGrid, nominal: &LoopPlant) -> Vec<OpenParameter> {
    let mut open = Vec::new();
    for (block, each) in task.structure.blocks.iter().enumerate() {
        for (place, (parameter, name)) in each.parameters.iter().zip(each.kind.parameters()).enumerate() {
            if !parameter.is_open() {
                continue;
            }
            let range = parameter.range.unwrap_or_else(|| usual_range(*name, grid, nominal)).map(f64::ln);
            open.push(OpenParameter { block, place, name: *name, range, stated: parameter.value });
        }
    }
    open
}
