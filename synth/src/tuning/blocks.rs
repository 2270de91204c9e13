//! The open parameters of a fixed structure, and how far those without a range may go.

use counterpoise_linalg::C64;

use super::grid::{LoopGrid, LoopPlant};
use crate::fixed_structure::{BlockKind, BlockParameter, FixedStructure, ParameterName};
use crate::tolerance::{FASTEST_CORNER, FASTEST_LOW_PASS, GAIN_RANGE_SHARE, LEAST_RESPONSE};
use crate::{Error, Sampling};

/// A parameter that moves.
pub(crate) struct OpenParameter {
    /// Block and place in it.
    pub block: usize,
    pub place: usize,
    /// Kind.
    pub name: ParameterName,
    /// The first value that the file states.
    pub stated: Option<f64>,
}

/// A structure with open parameters.
pub(crate) struct Blocks<'a> {
    pub structure: &'a FixedStructure,
    pub open: Vec<OpenParameter>,
    pub sampling: &'a Sampling,
    /// Logarithms of the lowest and the highest value of each.
    pub ranges: Vec<[f64; 2]>,
}

impl<'a> Blocks<'a> {
    /// Returns the family; a parameter without a range gets one that suits the grid and the nominal plant.
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
                    let range =
                        parameter.range.unwrap_or_else(|| usual_range(each.kind, *name, grid, nominal));
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

    /// Returns the values of all parameters at a point.
    pub fn values(&self, at: &[f64]) -> Vec<Vec<f64>> {
        let stated = |parameter: &BlockParameter| parameter.value.unwrap_or(1.0);
        let blocks = &self.structure.blocks;
        let mut all: Vec<Vec<f64>> =
            blocks.iter().map(|b| b.parameters.iter().map(stated).collect()).collect();
        for (parameter, value) in self.open.iter().zip(at) {
            all[parameter.block][parameter.place] = value.exp();
        }
        all
    }

    /// Returns K at s, for given values.
    pub fn at(&self, values: &[Vec<f64>], s: C64) -> C64 {
        self.structure.blocks.iter().zip(values).map(|(block, p)| block.kind.at(p, s)).product()
    }

    /// Returns the structure with every parameter fixed at a point.
    pub fn fix_parameters(&self, at: &[f64]) -> FixedStructure {
        let mut structure = self.structure.clone();
        for (block, values) in structure.blocks.iter_mut().zip(self.values(at)) {
            block.parameters = values.into_iter().map(BlockParameter::with_fixed_value).collect();
        }
        structure
    }
}

/// The range of a parameter that the file leaves open: as wide as makes a difference to a loop at this sample rate.
fn usual_range(kind: BlockKind, name: ParameterName, grid: &LoopGrid, plant: &LoopPlant) -> [f64; 2] {
    let top = grid.rates[grid.rates.len() - 1];
    // under the bilinear map a corner acts up to far beyond half the sample rate
    let (slowest, fastest) = (3e-5 * top, FASTEST_CORNER * top);
    match name {
        ParameterName::Gain => {
            let sizes =
                grid.rates.iter().zip(&plant.response).filter(|(rate, _)| **rate > GAIN_RANGE_SHARE * top);
            let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
            for (_, response) in sizes {
                least = least.min(response.norm());
                most = most.max(response.norm());
            }
            [1e-3 / most, 10.0 / least.max(LEAST_RESPONSE * most)]
        }
        ParameterName::Frequency if matches!(kind, BlockKind::LowPass | BlockKind::SecondOrderLowPass) => {
            [slowest, FASTEST_LOW_PASS * top]
        }
        ParameterName::Frequency
        | ParameterName::Corner
        | ParameterName::ZeroFrequency
        | ParameterName::PoleFrequency => [slowest, fastest],
        ParameterName::DerivativeTime | ParameterName::FilterTime => [1.0 / fastest, 1.0 / slowest],
        ParameterName::Ratio => [1.0, 50.0],
        ParameterName::Damping | ParameterName::PoleDamping => [0.05, 3.0],
        ParameterName::ZeroDamping => [0.005, 3.0],
        ParameterName::Depth => [0.01, 1.0],
    }
}
