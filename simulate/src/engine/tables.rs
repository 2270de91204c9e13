//! A step of the linear core as a few matrices: from the state and its inputs to what the nonlinear parts see at the
//! nodes of the step, and to the state at its end.

use super::linear::{Linear, Span};
use super::moments::{MIDDLE, NODES, cardinal_weights};
use super::strips::{Strips, padded};
use counterpoise_linalg::Mat;
use counterpoise_models::plant::core::input;
use nalgebra::Matrix2;

/// What the nonlinear parts see at a node: motor state, wind-up, hub angle, hub rate, current.
pub(crate) const OUTPUTS: usize = 5;
/// Nonlinear inputs ("ports"): torque at the motor, torque at the hub, load.
pub(crate) const PORTS: usize = 3;
/// Unknown nodes of a step.
pub(crate) const STAGES: usize = 3;
/// Rows and columns of the coupling between the ports at the unknown nodes and the outputs there, padded.
pub(crate) const STAGE_ROWS: usize = 16;
/// Rows of the outputs in the middle, padded.
pub(crate) const MIDDLE_ROWS: usize = 8;
/// Where the state begins in a result.
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

pub(crate) const PORT_INPUTS: [usize; PORTS] = [input::MOTOR_TORQUE, input::HUB_TORQUE, input::LOAD];

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

/// exp(A h), block by block.
#[derive(Debug, Clone)]
pub(crate) struct Flow {
    /// Blocks of two states.
    pairs: Vec<Matrix2<f64>>,
    from: usize,
    /// A block of any size before them.
    head: Strips,
    head_rows: usize,
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
    STATE + padded(order)
}

/// Returns the table of a step.
pub(crate) fn step_table(core: &Linear, span: &Span) -> StepTable {
    let n = core.order();
    let end = Answers::new(core, span, STAGES);
    let eye = Mat::eye(n);
    let mut fixed = Mat::zeros(STATE, n + FIXED_INPUTS);
    let mut stages = Mat::zeros(STAGE_ROWS, STAGES * PORTS);
    for stage in 1..=STAGES {
        let answers = Answers::new(core, span, stage);
        fixed.set_block((stage - 1) * OUTPUTS, 0, &answers.fixed(&core.outputs));
        stages.set_block((stage - 1) * OUTPUTS, 0, &answers.ports(&core.outputs));
    }
    let middle = Answers::new(core, span, Span::MIDDLE);
    fixed.set_block(STAGE_ROWS, 0, &middle.fixed(&core.outputs));
    let mut end_ports = Mat::zeros(MIDDLE_ROWS + n, STAGES * PORTS);
    end_ports.set_block(0, 0, &middle.ports(&core.outputs));
    end_ports.set_block(MIDDLE_ROWS, 0, &end.ports(&eye));
    StepTable {
        step_s: span.step_s,
        fixed: Strips::new(&fixed),
        flow: flow(core, span),
        drive: Strips::new(&end.inputs),
        stages: Strips::new(&stages),
        end: Strips::new(&end_ports),
        hold: hold(core, span),
    }
}

/// See [`StepTable::hold`].
fn hold(core: &Linear, span: &Span) -> Option<Strips> {
    if core.stuck == [false; 2] {
        return None;
    }
    let rows = Mat::from_rows(&[&core.holds[0].row, &core.holds[1].row]);
    let mut all = Mat::zeros(HOLD_ROWS, core.order() + FIXED_INPUTS + STAGES * PORTS);
    for (k, node) in [1, 2, Span::MIDDLE].into_iter().enumerate() {
        let answers = Answers::new(core, span, node);
        let found = answers.fixed(&rows).hstack(&answers.ports(&rows));
        for joint in [0, 1] {
            all.set_block(joint * HOLD_ROWS / 2 + k, 0, &found.block(joint, 0, 1, found.ncols()));
        }
    }
    Some(Strips::new(&all))
}

fn flow(core: &Linear, span: &Span) -> Flow {
    let from = core.head();
    let phi = |block: usize, i: usize, j: usize| span.at(STAGES)[block].phi(i, j);
    let first = usize::from(from > 0);
    let head = Mat::from_fn(from, from, |i, j| phi(0, i, j));
    let pairs = (first..core.blocks()).map(|b| Matrix2::from_fn(|i, j| phi(b, i, j))).collect();
    Flow { pairs, from, head: Strips::new(&head), head_rows: padded(from) }
}

/// The state's answers at one node: to the state at the start, to the fixed inputs, to the ports at the stages.
struct Answers {
    Phi: Mat,
    inputs: Mat,
    stages: Mat,
}

impl Answers {
    fn new(core: &Linear, span: &Span, node: usize) -> Self {
        let n = core.order();
        let mut answers = Self {
            Phi: Mat::zeros(n, n),
            inputs: Mat::zeros(n, FIXED_INPUTS),
            stages: Mat::zeros(n, STAGES * PORTS),
        };
        let weights = cardinal_weights(span.step_s);
        for (block, moments) in span.at(node).iter().enumerate() {
            let first = core.first(block);
            for row in 0..moments.order() {
                let i = first + row;
                for j in 0..moments.order() {
                    answers.Phi[(i, first + j)] = moments.phi(row, j);
                }
                answers.inputs[(i, 0)] = moments.constant(row, input::DRIVE);
                answers.inputs[(i, 1)] = moments.constant(row, input::MESH_TORQUE);
                for k in 0..NODES.len() {
                    answers.inputs[(i, 2 + k)] = moments.answer(row, input::PLATFORM_RATE, &weights[k]);
                }
                for (p, column) in PORT_INPUTS.into_iter().enumerate() {
                    answers.inputs[(i, 6 + p)] = moments.answer(row, column, &weights[0]);
                    for stage in 0..STAGES {
                        answers.stages[(i, stage * PORTS + p)] =
                            moments.answer(row, column, &weights[stage + 1]);
                    }
                }
            }
        }
        answers.carry(core, node);
        answers
    }

    /// Joints that stick move with the platform: the state is beside y, which flows, by carried x rate.
    fn carry(&mut self, core: &Linear, node: usize) {
        if core.carried.iter().all(|&c| c == 0.0) {
            return;
        }
        let start = &self.Phi * &Mat::col(&core.carried);
        for i in 0..core.order() {
            self.inputs[(i, 2)] -= start[(i, 0)];
            for k in 0..NODES.len() {
                let here = if node == Span::MIDDLE { MIDDLE[k] } else { f64::from(u8::from(k == node)) };
                self.inputs[(i, 2 + k)] += core.carried[i] * here;
            }
        }
    }

    /// C x the answers to the state and the fixed inputs.
    fn fixed(&self, C: &Mat) -> Mat {
        (C * &self.Phi).hstack(&(C * &self.inputs))
    }

    /// C x the answers to the ports at the stages.
    fn ports(&self, C: &Mat) -> Mat {
        C * &self.stages
    }
}
