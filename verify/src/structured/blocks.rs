//! The structure of a perturbation.

use std::ops::Range;

/// One block of a block-diagonal perturbation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Block {
    /// A real number, repeated so many times: a parameter that enters at as many places.
    Real {
        /// How many times, at least 1.
        repeated: usize,
    },
    /// A complex number: dynamics of which only a size is known.
    Complex,
}

impl Block {
    /// Returns the rows and columns of the block.
    pub fn order(self) -> usize {
        match self {
            Block::Real { repeated } => repeated,
            Block::Complex => 1,
        }
    }
}

/// A block-diagonal structure.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Structure {
    /// Its blocks, from top to bottom.
    pub blocks: Vec<Block>,
}

impl Structure {
    /// Returns the structure of the given blocks.
    pub fn of(blocks: &[Block]) -> Self {
        Self { blocks: blocks.to_vec() }
    }

    /// Returns the rows and columns of the whole perturbation.
    pub fn order(&self) -> usize {
        self.blocks.iter().map(|block| block.order()).sum()
    }

    /// Returns each block with the rows that it takes.
    pub fn place_blocks(&self) -> Vec<(Block, Range<usize>)> {
        let mut from = 0;
        let mut place = |block: &Block| {
            let rows = from..from + block.order();
            from = rows.end;
            (*block, rows)
        };
        self.blocks.iter().map(&mut place).collect()
    }
}
