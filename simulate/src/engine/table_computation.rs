//! The tables of a core, computed from the moments of its blocks.

use super::linear_core::{Chain, ModeDynamics, Span};
use super::moments::{MIDDLE, NODES, cardinal_weights};
use super::strips::{Strips, pad_rows};
use super::tables::{
    DEEPEST, FIXED_INPUTS, Flow, HOLD_ROWS, LEVELS, MIDDLE_ROWS, OUTPUTS, PORTS, STAGE_ROWS, STAGES, STATE,
    StepTable,
};
use counterpoise_linalg::Mat;
use counterpoise_models::plant::core::input;
use nalgebra::Matrix2;

impl ModeDynamics {
    /// Makes the table of a level, if it is not there yet.
    pub fn prepare(&mut self, level: usize) {
        if self.tables[level].is_some() {
            return;
        }
        let table = if level <= LEVELS {
            step_table(self, &self.coarse.span(LEVELS - level))
        } else {
            let deep = self.deep.take().unwrap_or_else(|| {
                Chain::new(&self.blocks, self.period_s / f64::from(1u32 << DEEPEST), DEEPEST - LEVELS)
            });
            let table = step_table(self, &deep.span(DEEPEST - level));
            self.deep = Some(deep);
            table
        };
        self.tables[level] = Some(table);
    }
}

/// Returns the table of a step.
fn step_table(core: &ModeDynamics, span: &Span) -> StepTable {
    let n = core.order();
    let end = Answers::new(core, span, STAGES);
    let eye = Mat::eye(n);
    let mut fixed = Mat::zeros(STATE, n + FIXED_INPUTS);
    let mut stages = Mat::zeros(STAGE_ROWS, STAGES * PORTS);
    for stage in 1..=STAGES {
        let answers = Answers::new(core, span, stage);
        fixed.set_block((stage - 1) * OUTPUTS, 0, &answers.fixed_answers(&core.outputs));
        stages.set_block((stage - 1) * OUTPUTS, 0, &answers.ports(&core.outputs));
    }
    let middle = Answers::new(core, span, Span::MIDDLE);
    fixed.set_block(STAGE_ROWS, 0, &middle.fixed_answers(&core.outputs));
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
fn hold(core: &ModeDynamics, span: &Span) -> Option<Strips> {
    if core.stuck == [false; 2] {
        return None;
    }
    let rows = Mat::from_rows(&[&core.holds[0].row, &core.holds[1].row]);
    let mut all = Mat::zeros(HOLD_ROWS, core.order() + FIXED_INPUTS + STAGES * PORTS);
    for (k, node) in [1, 2, Span::MIDDLE].into_iter().enumerate() {
        let answers = Answers::new(core, span, node);
        let found = answers.fixed_answers(&rows).hstack(&answers.ports(&rows));
        for joint in [0, 1] {
            all.set_block(joint * HOLD_ROWS / 2 + k, 0, &found.block(joint, 0, 1, found.ncols()));
        }
    }
    Some(Strips::new(&all))
}

fn flow(core: &ModeDynamics, span: &Span) -> Flow {
    let from = core.leading_size();
    let phi = |block: usize, i: usize, j: usize| span.at(STAGES)[block].phi(i, j);
    let first = usize::from(from > 0);
    let head = Mat::from_fn(from, from, |i, j| phi(0, i, j));
    let pairs = (first..core.blocks()).map(|b| Matrix2::from_fn(|i, j| phi(b, i, j))).collect();
    Flow { pairs, from, head: Strips::new(&head), head_rows: pad_rows(from) }
}

/// The state's answers at one node: to the state at the start, to the fixed inputs, to the ports at the stages.
struct Answers {
    Phi: Mat,
    inputs: Mat,
    stages: Mat,
}

impl Answers {
    fn new(core: &ModeDynamics, span: &Span, node: usize) -> Self {
        let n = core.order();
        let mut answers = Self {
            Phi: Mat::zeros(n, n),
            inputs: Mat::zeros(n, FIXED_INPUTS),
            stages: Mat::zeros(n, STAGES * PORTS),
        };
        let weights = cardinal_weights(span.step_s);
        for (block, moments) in span.at(node).iter().enumerate() {
            let first = core.first_state(block);
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
                for (p, &column) in core.port_inputs.iter().enumerate() {
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
    fn carry(&mut self, core: &ModeDynamics, node: usize) {
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
    fn fixed_answers(&self, C: &Mat) -> Mat {
        (C * &self.Phi).hstack(&(C * &self.inputs))
    }

    /// C x the answers to the ports at the stages.
    fn ports(&self, C: &Mat) -> Mat {
        C * &self.stages
    }
}
