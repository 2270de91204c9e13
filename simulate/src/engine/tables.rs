//! A step of the linear core as a few matrices: from the state and its inputs to what the nonlinear parts see at the
//! nodes of the step, and to the state at its end.

use super::strips::{Strips, pad_rows};
use nalgebra::Matrix2;

/// The inputs of the nonlinear parts at a node: motor state, wind-up, hub angle, hub rate, current.
pub(crate) const OUTPUTS: usize = 5;
/// Nonlinear inputs ("ports"): torque at the motor (flow into a cylinder), torque at the hub, load.
pub(crate) const PORTS: usize = 3;
/// Unknown nodes of a step.
pub(crate) const STAGES: usize = 3;
/// Rows and columns of the coupling between the ports at the unknown nodes and the outputs there, padded.
pub(crate) const STAGE_ROWS: usize = 16;
/// Rows of the outputs in the middle, padded.
pub(crate) const MIDDLE_ROWS: usize = 8;
/// Index at which the state begins in a result.
pub(crate) const STATE: usize = STAGE_ROWS + MIDDLE_ROWS;
/// Halvings of a sample period down to the shortest step that smoothness may ask for.
pub(crate) const LEVELS: usize = 8;
/// Halvings of a sample period down to the shortest step: with these the instants of sticking and breaking away are
/// found, to a millionth of the period.
pub(crate) const DEEPEST: usize = 20;
/// Rows of what holds the joints inside a step: four a joint, at its first and second inner node and in its middle; padded.
pub(crate) const HOLD_ROWS: usize = 8;
/// Fixed inputs of a step behind the state: drive, half gap, platform rate at four nodes, ports at the first node.
pub(crate) const FIXED_INPUTS: usize = 2 + 4 + PORTS;

/// The torque on the hub among the ports.
const HUB: usize = 1;

/// One step of a given length from a given core. A result is \[outputs at the stages (16 rows); outputs in the middle
/// (8 rows); state at the end\].
#[derive(Debug, Clone)]
pub(crate) struct StepTable {
    /// Length of the step, s.
    pub step_s: f64,
    /// From \[state, fixed inputs\] to the outputs at the stages and in the middle.
    pub fixed: Strips,
    /// From the state to the state at the end.
    pub flow: Flow,
    /// From the fixed inputs to the state at the end.
    pub drive: Strips,
    /// From the ports at the stages to the outputs at the stages.
    pub stages: Strips,
    /// From the ports at the stages to the outputs in the middle and the state at the end.
    pub end: Strips,
    /// From \[state, fixed inputs, ports at the stages\] to the state's share of the torques that hold joints at rest, inside the
    /// step; `None` if no joint rests.
    pub hold: Option<Strips>,
}

impl StepTable {
    /// Returns the answer of a state at the end to the torque on the hub at each node.
    pub fn hub_answers(&self, row: usize) -> [f64; STAGES + 1] {
        let stage = |k: usize| self.end.entry(MIDDLE_ROWS + row, k * PORTS + HUB);
        [self.drive.entry(row, FIXED_INPUTS - PORTS + HUB), stage(0), stage(1), stage(2)]
    }
}

/// exp(A h), block by block.
#[derive(Debug, Clone)]
pub(crate) struct Flow {
    /// Blocks of two states.
    pub(super) pairs: Vec<Matrix2<f64>>,
    pub(super) from: usize,
    /// A block of any size before them.
    pub(super) head: Strips,
    pub(super) head_rows: usize,
}

impl Flow {
    /// Returns an entry of exp(A h).
    pub fn entry(&self, row: usize, column: usize) -> f64 {
        if row < self.from && column < self.from {
            return self.head.entry(row, column);
        }
        let pair = |index: usize| index.checked_sub(self.from).map(|beyond| beyond / 2);
        match (pair(row), pair(column)) {
            (Some(block), Some(other)) if block == other => {
                self.pairs[block][((row - self.from) % 2, (column - self.from) % 2)]
            }
            _ => 0.0,
        }
    }

    /// Computes out = exp(A h) z, in the registers of the function that it becomes part of.
    #[inline(always)]
    pub fn multiply_inline(&self, z: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        self.head.multiply_add_inline(&z[..self.from], &mut out[..self.head_rows]);
        let pairs = z[self.from..].chunks_exact(2).zip(out[self.from..].chunks_exact_mut(2));
        for (block, (z, out)) in self.pairs.iter().zip(pairs) {
            out[0] = block.m11 * z[0] + block.m12 * z[1];
            out[1] = block.m21 * z[0] + block.m22 * z[1];
        }
    }
}

/// Returns the length of a vector of the results of a step, padded.
pub(crate) fn result_length(order: usize) -> usize {
    STATE + pad_rows(order)
}
