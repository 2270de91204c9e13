//! The matrices of a sample's step for several mechanisms side by side.

use super::number::{LANES, Lane, Lanes, load_registers};
use crate::engine::linear_core::ModeDynamics;
use crate::engine::tables::{FIXED_INPUTS, MIDDLE_ROWS, OUTPUTS, PORTS, STAGE_ROWS, STAGES};
use counterpoise_models::friction::Real;
use pulp::Simd;
use std::ops::Range;

/// Columns behind the state in [`LaneTable::fixed`].
const PORT_COLUMNS: usize = STAGES * PORTS;
/// Rows of a state that are worked on at a time: independent sums that keep a core busy.
const STATE_ROWS: usize = 4;

/// One step over a sample from each mechanism's core, as [`crate::engine::tables::StepTable`] has it.
#[derive(Debug, Clone)]
pub(crate) struct LaneTable {
    /// Number of states.
    pub order: usize,
    /// States before the pairs.
    head: usize,
    /// From \[state, fixed inputs\] to the outputs at the stages and in the middle, node by node.
    fixed: Vec<Lanes>,
    /// From \[states of the head, fixed inputs\] to the states of the head at the end.
    head_end: Vec<Lanes>,
    /// From the two states of each pair to themselves, row by row, and from the fixed inputs to them.
    pairs_end: Vec<Lanes>,
    /// From the ports at the stages to the outputs there, node by node.
    stages: Vec<Lanes>,
    /// From the ports at the stages to the outputs in the middle.
    middle: Vec<Lanes>,
    /// From the ports at the stages to the state at the end.
    state: Vec<Lanes>,
    /// From the state to what is seen.
    seen: Vec<Lanes>,
}

/// The outputs of a core: outputs, voltage, rate of the tip.
pub(crate) const SEEN: usize = OUTPUTS + 2;

impl LaneTable {
    /// Returns the tables of cores; `None` if they are not of one shape, or without the table of a whole sample.
    pub fn new(cores: [&ModeDynamics; LANES]) -> Option<Self> {
        let (order, head) = (cores[0].order(), cores[0].leading_size());
        let alike = |core: &&ModeDynamics| {
            core.order() == order
                && core.leading_size() == head
                && core.table(0).is_some()
                && !core.has_stuck_joint()
        };
        if !cores.iter().all(alike) {
            return None;
        }
        let cores = Cores(cores);
        let columns = order + FIXED_INPUTS;
        let mut fixed = cores.nodes(Part::Fixed, columns);
        fixed.extend(cores.block(Part::Fixed, STAGE_ROWS..STAGE_ROWS + OUTPUTS, columns));
        let state = groups(0..order).flat_map(|rows| {
            cores.block(Part::End, MIDDLE_ROWS + rows.start..MIDDLE_ROWS + rows.end, PORT_COLUMNS)
        });
        Some(Self {
            order,
            head,
            fixed,
            head_end: cores.head_end(head),
            pairs_end: cores.pairs_end(head..order),
            stages: cores.nodes(Part::Stages, PORT_COLUMNS),
            middle: cores.block(Part::End, 0..OUTPUTS, PORT_COLUMNS),
            state: state.collect(),
            seen: cores.block(Part::Seen, 0..SEEN, order),
        })
    }

    /// Returns the outputs at the stages and in the middle that the state and the fixed inputs make.
    #[inline(always)]
    pub fn fixed_outputs<S: Simd>(&self, simd: S, inputs: &[Lanes]) -> [[Lane<S>; OUTPUTS]; STAGES + 1] {
        let mut outputs = [[Lane::splat(simd, 0.0); OUTPUTS]; STAGES + 1];
        for (node, block) in outputs.iter_mut().zip(self.fixed.chunks_exact(OUTPUTS * inputs.len())) {
            *node = sums(simd, *node, block, inputs);
        }
        outputs
    }

    /// Writes the state at the end that the state and the fixed inputs make.
    #[inline(always)]
    pub fn advance_state<S: Simd>(&self, simd: S, inputs: &[Lanes], end: &mut [Lanes]) {
        let (core, drive) = inputs.split_at(self.order);
        let zero = Lane::splat(simd, 0.0);
        let mut table = &self.head_end[..];
        for target in end[..self.head].chunks_mut(STATE_ROWS) {
            let (flow, rest) = table.split_at(target.len() * self.head);
            let (forced, rest) = rest.split_at(target.len() * drive.len());
            table = rest;
            let mut rows = [zero; STATE_ROWS];
            add_rows(simd, &mut rows, target.len(), flow, &core[..self.head]);
            add_rows(simd, &mut rows, target.len(), forced, drive);
            store(target, &rows);
        }
        let pairs = end[self.head..].chunks_exact_mut(2).zip(core[self.head..].chunks_exact(2));
        for ((target, z), block) in pairs.zip(self.pairs_end.chunks_exact(4 + 2 * FIXED_INPUTS)) {
            let [a, b, c, d] = load_registers(simd, &[block[0], block[1], block[2], block[3]]);
            let [z0, z1] = load_registers(simd, &[z[0], z[1]]);
            let rows = sums(simd, [a * z0 + c * z1, b * z0 + d * z1], &block[4..], drive);
            store(target, &rows);
        }
    }

    /// Returns the outputs at the stages with what the ports there add.
    #[inline(always)]
    pub fn stage_outputs<S: Simd>(
        &self,
        simd: S,
        fixed: &[[Lane<S>; OUTPUTS]; STAGES + 1],
        ports: &[Lanes; PORT_COLUMNS],
    ) -> [[Lane<S>; OUTPUTS]; STAGES] {
        let mut outputs = [fixed[0], fixed[1], fixed[2]];
        for (node, block) in outputs.iter_mut().zip(self.stages.chunks_exact(OUTPUTS * PORT_COLUMNS)) {
            *node = sums(simd, *node, block, ports);
        }
        outputs
    }

    /// Returns the outputs in the middle with what the ports at the stages add.
    #[inline(always)]
    pub fn middle_outputs<S: Simd>(
        &self,
        simd: S,
        fixed: [Lane<S>; OUTPUTS],
        ports: &[Lanes; PORT_COLUMNS],
    ) -> [Lane<S>; OUTPUTS] {
        sums(simd, fixed, &self.middle, ports)
    }

    /// Adds to the state at the end what the ports at the stages do.
    #[inline(always)]
    pub fn add_ports<S: Simd>(&self, simd: S, ports: &[Lanes; PORT_COLUMNS], end: &mut [Lanes]) {
        let mut table = &self.state[..];
        for target in end.chunks_mut(STATE_ROWS) {
            let (block, rest) = table.split_at(target.len() * PORT_COLUMNS);
            table = rest;
            let mut rows = [Lane::splat(simd, 0.0); STATE_ROWS];
            for (row, value) in rows.iter_mut().zip(&*target) {
                *row = Lane::new(simd, *value);
            }
            add_rows(simd, &mut rows, target.len(), block, ports);
            store(target, &rows);
        }
    }

    /// Returns what is seen at a state.
    #[inline(always)]
    pub fn outputs_at<S: Simd>(&self, simd: S, state: &[Lanes]) -> [Lane<S>; SEEN] {
        sums(simd, [Lane::splat(simd, 0.0); SEEN], &self.seen, state)
    }
}

#[inline(always)]
fn store<S: Simd>(target: &mut [Lanes], rows: &[Lane<S>]) {
    for (place, row) in target.iter_mut().zip(rows) {
        *place = row.values();
    }
}

/// The cores whose matrices are put side by side.
struct Cores<'a>([&'a ModeDynamics; LANES]);

impl Cores<'_> {
    /// Returns an entry of a matrix of each core.
    fn entry(&self, part: Part, row: usize, column: usize) -> Lanes {
        self.0.map(|core| {
            core.table(0).map_or(0.0, |table| match part {
                Part::Fixed => table.fixed.entry(row, column),
                Part::Flow => table.flow.entry(row, column),
                Part::Drive => table.drive.entry(row, column),
                Part::Stages => table.stages.entry(row, column),
                Part::End => table.end.entry(row, column),
                Part::Seen => core.output_entry(row, column),
            })
        })
    }

    /// Returns rows of a matrix, column by column.
    fn block(&self, part: Part, rows: Range<usize>, columns: usize) -> Vec<Lanes> {
        let places = (0..columns).flat_map(|column| rows.clone().map(move |row| (row, column)));
        places.map(|(row, column)| self.entry(part, row, column)).collect()
    }

    /// Returns the rows of the outputs at the stages, node by node.
    fn nodes(&self, part: Part, columns: usize) -> Vec<Lanes> {
        (0..STAGES).flat_map(|k| self.block(part, k * OUTPUTS..(k + 1) * OUTPUTS, columns)).collect()
    }

    /// See [`LaneTable::head_end`].
    fn head_end(&self, head: usize) -> Vec<Lanes> {
        let mut entries = Vec::new();
        for rows in groups(0..head) {
            entries.extend(self.block(Part::Flow, rows.clone(), head));
            entries.extend(self.block(Part::Drive, rows, FIXED_INPUTS));
        }
        entries
    }

    /// See [`LaneTable::pairs_end`].
    fn pairs_end(&self, states: Range<usize>) -> Vec<Lanes> {
        let mut entries = Vec::new();
        for first in states.step_by(2) {
            let own = [(0, 0), (1, 0), (0, 1), (1, 1)];
            entries.extend(own.map(|(row, column)| self.entry(Part::Flow, first + row, first + column)));
            entries.extend(self.block(Part::Drive, first..first + 2, FIXED_INPUTS));
        }
        entries
    }
}

/// Returns the rows of a state in groups of [`STATE_ROWS`].
fn groups(rows: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    let end = rows.end;
    rows.step_by(STATE_ROWS).map(move |first| first..(first + STATE_ROWS).min(end))
}

/// A matrix of a step.
#[derive(Debug, Clone, Copy)]
enum Part {
    Fixed,
    Flow,
    Drive,
    Stages,
    End,
    Seen,
}

/// Returns sums + M v, for a block M of as many rows as there are sums, column by column.
#[inline(always)]
fn sums<S: Simd, const ROWS: usize>(
    simd: S,
    mut sums: [Lane<S>; ROWS],
    block: &[Lanes],
    v: &[Lanes],
) -> [Lane<S>; ROWS] {
    for (column, factor) in block.chunks_exact(ROWS).zip(v) {
        let factor = Lane::new(simd, *factor);
        for row in 0..ROWS {
            sums[row] = sums[row] + Lane::new(simd, column[row]) * factor;
        }
    }
    sums
}

/// Adds M v for a block of `count` rows, which may be fewer than there are sums.
#[inline(always)]
fn add_rows<S: Simd>(simd: S, rows: &mut [Lane<S>; STATE_ROWS], count: usize, block: &[Lanes], v: &[Lanes]) {
    if count == STATE_ROWS {
        *rows = sums(simd, *rows, block, v);
        return;
    }
    for (column, factor) in block.chunks_exact(count).zip(v) {
        let factor = Lane::new(simd, *factor);
        for (row, entry) in rows.iter_mut().zip(column) {
            *row = *row + Lane::new(simd, *entry) * factor;
        }
    }
}

/// Returns the larger of a number and a magnitude; what is not a number counts as large.
#[inline(always)]
pub(crate) fn larger_magnitude<S: Simd>(number: Lane<S>, magnitude: Lane<S>) -> Lane<S> {
    magnitude.is_at_most(number).select(number, magnitude)
}

/// Returns |a - b| / scale.
#[inline(always)]
pub(crate) fn distance<S: Simd>(a: Lane<S>, b: Lane<S>, scale: Lane<S>) -> Lane<S> {
    (a - b).abs() / scale
}
