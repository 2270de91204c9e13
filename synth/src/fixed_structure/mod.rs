//! A feedback of fixed structure: blocks in series from the error to the control, each with few parameters.
//!
//! ```text
//!     e = r - y --[ block 1 ]--[ block 2 ]-- ... --> u
//! ```
//!
//! Each parameter is fixed, or left to [`crate::tuning`] within a range. A structure of which every parameter has a value is an
//! ordinary feedback controller ([`FixedStructure::controller`]).

mod block;

use counterpoise_lti::StateSpace;

pub use block::{Block, BlockKind, BlockParameter, ParameterName};

use crate::Error;
use crate::error_feedback::from_demand_and_reading;
use crate::rational_function::RationalFunction;

/// Blocks in series.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FixedStructure {
    /// The blocks, from the error to the control.
    pub blocks: Vec<Block>,
}

impl FixedStructure {
    /// Returns whether a parameter is left to the tuning.
    pub fn is_open(&self) -> bool {
        self.blocks.iter().flat_map(|block| &block.parameters).any(BlockParameter::is_open)
    }

    /// Returns the values of all parameters, block by block.
    ///
    /// # Errors
    /// [`Error::System`] if a parameter has no value.
    pub fn values(&self) -> Result<Vec<Vec<f64>>, Error> {
        let of_block =
            |block: &Block| block.parameters.iter().map(|each| each.value).collect::<Option<Vec<_>>>();
        let all: Option<Vec<Vec<f64>>> = self.blocks.iter().map(of_block).collect();
        let problem = "a parameter has neither a value nor been tuned";
        all.ok_or(Error::System { what: "fixed structure", problem })
    }

    /// Returns the transfer function from the error to the control.
    ///
    /// # Errors
    /// As [`FixedStructure::values`].
    pub fn rational(&self) -> Result<RationalFunction, Error> {
        let values = self.values()?;
        let one = RationalFunction::new(&[], &[], 1.0);
        Ok(self
            .blocks
            .iter()
            .zip(&values)
            .fold(one, |all, (block, values)| all.times(&block.kind.rational(values))))
    }

    /// Returns the continuous controller from (demand, measured rate) to the control, which sees their difference alone.
    ///
    /// # Errors
    /// As [`FixedStructure::values`], and [`Error::Lti`] for more zeros than poles.
    pub fn controller(&self) -> Result<StateSpace, Error> {
        from_demand_and_reading(&self.rational()?.realise()?)
    }

    /// Returns the name of the structure: its blocks in order.
    pub fn name(&self) -> String {
        let names: Vec<&str> = self.blocks.iter().map(|block| block.kind.name()).collect();
        names.join(" + ")
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use counterpoise_linalg::C64;
    use counterpoise_lti::response_at;

    /// Values at which no two roots of a block coincide.
    fn example(kind: BlockKind) -> Vec<f64> {
        kind.parameters().iter().enumerate().map(|(k, _)| 0.3 + 1.7 * (k as f64 + 1.0)).collect()
    }

    #[test]
    fn the_slopes_of_every_block_are_those_of_differences() {
        for kind in BlockKind::ALL {
            let values = example(kind);
            for s in [C64::new(0.0, 0.4), C64::new(0.0, 3.0), C64::new(0.0, 40.0)] {
                for (k, slope) in kind.slopes(&values, s).into_iter().enumerate() {
                    let step = 1e-5_f64;
                    let moved = |sign: f64| {
                        let mut values = values.clone();
                        values[k] *= (sign * step).exp();
                        kind.at(&values, s).ln()
                    };
                    let difference = (moved(1.0) - moved(-1.0)) / (2.0 * step);
                    assert!((slope - difference).norm() < 1e-8, "{} {k}: {slope} {difference}", kind.name());
                }
            }
        }
    }

    #[test]
    fn zeros_and_poles_of_every_block_give_its_response() {
        for kind in BlockKind::ALL {
            let values = example(kind);
            for s in [C64::new(0.0, 0.4), C64::new(0.0, 7.0)] {
                let (direct, by_roots) = (kind.at(&values, s), kind.rational(&values).at(s));
                assert!((direct - by_roots).norm() < 1e-12 * direct.norm(), "{}", kind.name());
            }
        }
    }

    #[test]
    fn a_series_of_blocks_is_the_product_of_their_responses() {
        let block = |kind: BlockKind| Block {
            kind,
            parameters: example(kind).into_iter().map(BlockParameter::with_fixed_value).collect(),
        };
        let structure = FixedStructure {
            blocks: vec![
                block(BlockKind::ProportionalIntegral),
                block(BlockKind::Notch),
                block(BlockKind::LowPass),
            ],
        };
        let at = |kind: BlockKind, s: C64| kind.at(&example(kind), s);
        let found = response_at(&structure.controller().unwrap(), 2.5).unwrap();
        let s = C64::new(0.0, 2.5);
        let product =
            at(BlockKind::ProportionalIntegral, s) * at(BlockKind::Notch, s) * at(BlockKind::LowPass, s);
        assert!((found[(0, 0)] - product).norm() < 1e-12 * product.norm());
        assert!((found[(0, 1)] + product).norm() < 1e-12 * product.norm());
    }
}
