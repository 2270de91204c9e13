//! The structure of a perturbation.

use std::ops::Range;

/// One block of a block-diagonal perturbation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PerturbationBlock {
    /// A real number, repeated so many times: a parameter that enters at as many places.
    Real {
        /// Number of repetitions, at least 1.
        repeated: usize,
    },
    /// A complex number: dynamics of which only a size is known.
    Complex,
}

impl PerturbationBlock {
    /// Returns the rows and columns of the block.
    pub fn order(self) -> usize {
        match self {
            PerturbationBlock::Real { repeated } => repeated,
            PerturbationBlock::Complex => 1,
        }
    }
}

/// A block-diagonal structure.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PerturbationStructure {
    /// Blocks, from top to bottom.
    pub blocks: Vec<PerturbationBlock>,
}

impl PerturbationStructure {
    /// Returns the structure of the given blocks.
    pub fn of(blocks: &[PerturbationBlock]) -> Self {
        Self { blocks: blocks.to_vec() }
    }

    /// Returns the rows and columns of the whole perturbation.
    pub fn order(&self) -> usize {
        self.blocks.iter().map(|block| block.order()).sum()
    }

    /// Returns each block with the rows that it takes.
    pub fn place_blocks(&self) -> Vec<(PerturbationBlock, Range<usize>)> {
        let mut from = 0;
        let mut place = |block: &PerturbationBlock| {
            let rows = from..from + block.order();
            from = rows.end;
            (*block, rows)
        };
        self.blocks.iter().map(&mut place).collect()
    }
}
