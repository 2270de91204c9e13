//! The family of a fixed structure.

use std::f64::consts::LN_2;

use counterpoise_linalg::C64;
use counterpoise_lti::StateSpace;

use super::blocks::Blocks;
use super::family::{FeedbackFamily, GridResponse};
use super::grid::{LoopGrid, LoopPlant};
use super::starts::placed_starts;
use super::{RangeEnd, TunedFeedback, sampled_structure};
use crate::Error;
use crate::fixed_structure::{BlockKind, ParameterName};
use crate::tolerance::{AT_RANGE_END, IDLE_LOW_PASS};

impl FeedbackFamily for Blocks<'_> {
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

    fn unchecked_feedback(&self, at: &[f64]) -> Result<StateSpace, Error> {
        self.sampled_feedback(at)
    }

    fn sampled_feedback(&self, at: &[f64]) -> Result<StateSpace, Error> {
        sampled_structure(&self.fix_parameters(at), self.sampling)
    }

    fn calmer_point(&self, at: &[f64]) -> Option<Vec<f64>> {
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

    fn starts(&self, nominal: &LoopPlant, grid: &LoopGrid, count: usize, seed: u64) -> Vec<Vec<f64>> {
        placed_starts(self, nominal, grid, count, seed)
    }

    fn range_ends(&self, at: &[f64]) -> Vec<RangeEnd> {
        let mut ends = Vec::new();
        for ((open, range), value) in self.open.iter().zip(&self.ranges).zip(at) {
            let kind = self.structure.blocks[open.block].kind;
            let is_low = value - range[0] < AT_RANGE_END;
            let is_high = range[1] - value < AT_RANGE_END;
            // there, the block does nothing, and nothing lies beyond
            let is_idle = match open.name {
                ParameterName::Ratio => is_low,
                ParameterName::Depth => is_high,
                ParameterName::Frequency
                    if matches!(kind, BlockKind::LowPass | BlockKind::SecondOrderLowPass) =>
                {
                    is_high && range[1].exp() * self.sampling.period_s > IDLE_LOW_PASS
                }
                _ => false,
            };
            if (is_low || is_high) && !is_idle {
                ends.push(RangeEnd { block: open.block, parameter: open.name, range: range.map(f64::exp) });
            }
        }
        ends
    }

    fn feedback(&self, at: &[f64]) -> TunedFeedback {
        TunedFeedback::Structure(self.fix_parameters(at))
    }
}
