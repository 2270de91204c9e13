//! The family of a fixed structure: the open parameters of its blocks.

use std::f64::consts::LN_2;

use counterpoise_linalg::C64;
use counterpoise_lti::StateSpace;

use super::family::{Family, GridResponse};
use super::grid::LoopGrid;
use super::problem::{LoopPlant, Problem};
use super::starts::{placed_starts, usual_range};
use super::{TunedFeedback, sampled_structure};
use crate::fixed_structure::{FixedStructure, Parameter, ParameterName};
use crate::{Error, Sampling};

/// A parameter that moves.
pub(crate) struct OpenParameter {
    /// Block and place in it.
    pub block: usize,
    pub place: usize,
    /// What it is.
    pub name: ParameterName,
    /// The first value that the file states.
    pub stated: Option<f64>,
}

/// A structure with open parameters.
pub(crate) struct Blocks<'a> {
    pub structure: &'a FixedStructure,
    pub open: Vec<OpenParameter>,
    sampling: &'a Sampling,
    ranges: Vec<[f64; 2]>,
}

impl<'a> Blocks<'a> {
    /// The family; a parameter without a range gets one that suits the grid and the nominal plant.
    ///
    /// # Errors
    /// [`Error::System`] for a structure without open parameters.
    pub fn new(
        structure: &'a FixedStructure,
        sampling: &'a Sampling,
        grid: &LoopGrid,
        nominal: &LoopPlant,
    ) -> Result<Self, Error> {
        let (mut open, mut ranges) = (Vec::new(), Vec::new());
        for (block, each) in structure.blocks.iter().enumerate() {
            for (place, (parameter, name)) in each.parameters.iter().zip(each.kind.parameters()).enumerate() {
                if parameter.is_open() {
                    let range = parameter.range.unwrap_or_else(|| usual_range(*name, grid, nominal));
                    ranges.push(range.map(f64::ln));
                    open.push(OpenParameter { block, place, name: *name, stated: parameter.value });
                }
            }
        }
        if open.is_empty() {
            let problem = "every parameter of the structure is fixed";
            return Err(Error::System { what: "tuning", problem });
        }
        Ok(Self { structure, open, sampling, ranges })
    }

    /// The values of all parameters at a point.
    pub fn values(&self, at: &[f64]) -> Vec<Vec<f64>> {
        let stated = |parameter: &Parameter| parameter.value.unwrap_or(1.0);
        let blocks = &self.structure.blocks;
        let mut all: Vec<Vec<f64>> =
            blocks.iter().map(|b| b.parameters.iter().map(stated).collect()).collect();
        for (parameter, value) in self.open.iter().zip(at) {
            all[parameter.block][parameter.place] = value.exp();
        }
        all
    }

    /// K at s, for given values.
    pub fn at(&self, values: &[Vec<f64>], s: C64) -> C64 {
        self.structure.blocks.iter().zip(values).map(|(block, p)| block.kind.at(p, s)).product()
    }

    /// The structure with every parameter fixed at a point.
    fn fixed(&self, at: &[f64]) -> FixedStructure {
        let mut structure = self.structure.clone();
        for (block, values) in structure.blocks.iter_mut().zip(self.values(at)) {
            block.parameters = values.into_iter().map(Parameter::fixed).collect();
        }
        structure
    }
}

impl Family for Blocks<'_> {
    fn ranges(&self) -> &[[f64; 2]] {
        &self.ranges
    }

    fn gain(&self, at: &[f64], grid: &LoopGrid) -> Result<Vec<C64>, Error> {
        let values = self.values(at);
        Ok(grid.s.iter().map(|s| self.at(&values, *s)).collect())
    }

    fn response(&self, at: &[f64], grid: &LoopGrid) -> Result<GridResponse, Error> {
        let values = self.values(at);
        let blocks = &self.structure.blocks;
        let of = |s: &C64| -> Vec<C64> {
            let slopes: Vec<Vec<C64>> =
                blocks.iter().zip(&values).map(|(block, p)| block.kind.slopes(p, *s)).collect();
            self.open.iter().map(|open| slopes[open.block][open.place]).collect()
        };
        Ok(GridResponse { K: self.gain(at, grid)?, slopes: grid.s.iter().map(of).collect() })
    }

    fn unchecked(&self, at: &[f64]) -> Result<StateSpace, Error> {
        self.sampled(at)
    }

    fn sampled(&self, at: &[f64]) -> Result<StateSpace, Error> {
        sampled_structure(&self.fixed(at), self.sampling)
    }

    fn calmer(&self, at: &[f64]) -> Option<Vec<f64>> {
        let gain = self.open.iter().position(|open| open.name == ParameterName::Gain)?;
        let mut calmer = at.to_vec();
        for (k, open) in self.open.iter().enumerate() {
            // With the corner, the gain's crossover stays above what integrates.
            if k == gain || open.name == ParameterName::Corner {
                calmer[k] = (at[k] - LN_2).max(self.ranges[k][0]);
            }
        }
        Some(calmer)
    }

    fn starts(&self, problem: &Problem<'_>, count: usize, seed: u64) -> Vec<Vec<f64>> {
        placed_starts(self, problem, count, seed)
    }

    fn feedback(&self, at: &[f64]) -> TunedFeedback {
        TunedFeedback::Structure(self.fixed(at))
    }
}
