//! A step of the linear core as one matrix: from the state and its inputs to what the nonlinear parts see at the
//! nodes of the step, and to the state at its end.

use super::moments::{Moments, NODES};
use counterpoise_lti::Mat;
use counterpoise_models::plant::core::{input, state};
use counterpoise_models::{Mesh, Plant};

/// What the nonlinear parts see at a node: motor state, wind-up, hub angle, hub rate, current.
pub(crate) const OUTPUTS: usize = 5;
/// Nonlinear inputs ("ports"): torque at the motor, torque at the hub, load.
pub(crate) const PORTS: usize = 3;
/// Unknown nodes of a step.
pub(crate) const STAGES: usize = 3;
/// Rows and columns of the coupling between the ports at the unknown nodes and the outputs there.
pub(crate) const STAGE_ROWS: usize = 16;
/// Rows that are worked on at a time: eight independent chains of two lanes keep a plain SSE2 core busy.
const LANES: usize = 16;
/// Number of halvings of a sample period down to the shortest step.
pub(crate) const LEVELS: usize = 8;
/// Fixed inputs of a step behind the state: drive, half gap, platform rate at four nodes, ports at the first node.
pub(crate) const FIXED_INPUTS: usize = 2 + 4 + PORTS;

const PORT_INPUTS: [usize; PORTS] = [input::MOTOR_TORQUE, input::HUB_TORQUE, input::LOAD];

/// A matrix stored in strips of [`LANES`] rows, column by column within a strip.
#[derive(Debug, Clone)]
pub(crate) struct Strips {
    columns: usize,
    data: Vec<f64>,
}

impl Strips {
    fn new(M: &Mat) -> Self {
        let strips = M.nrows().div_ceil(LANES);
        let mut data = Vec::with_capacity(strips * LANES * M.ncols());
        for strip in 0..strips {
            for j in 0..M.ncols() {
                for lane in 0..LANES {
                    let i = strip * LANES + lane;
                    data.push(if i < M.nrows() { M[(i, j)] } else { 0.0 });
                }
            }
        }
        Self { columns: M.ncols(), data }
    }

    /// out = start + M v, where `out` and `start` are as long as the padded rows.
    #[inline]
    pub fn multiply_add(&self, v: &[f64], out: &mut [f64]) {
        let v = &v[..self.columns];
        let strips = self.data.chunks_exact(LANES * self.columns);
        for (strip, target) in strips.zip(out.chunks_exact_mut(LANES)) {
            let mut sum = [0.0; LANES];
            sum.copy_from_slice(target);
            for (column, &factor) in strip.chunks_exact(LANES).zip(v) {
                for lane in 0..LANES {
                    sum[lane] += column[lane] * factor;
                }
            }
            target.copy_from_slice(&sum);
        }
    }
}

/// One step of a given length from a given core.
#[derive(Debug, Clone)]
pub(crate) struct StepTable {
    /// Length of the step, s.
    pub step_s: f64,
    /// From \[state, fixed inputs\] to \[outputs at the stages (16 rows); outputs at the middle (5), state at the end\].
    pub fixed: Strips,
    /// From the ports at the stages to the outputs at the stages.
    pub stages: Strips,
    /// From the ports at the stages to the outputs at the middle and the state at the end.
    pub end: Strips,
}

/// Length of a vector of the results of [`StepTable::fixed`], padded.
pub(crate) fn result_length(order: usize) -> usize {
    STAGE_ROWS + (OUTPUTS + order).div_ceil(LANES) * LANES
}

/// The tables of one core at every level; level 0 is the whole sample period.
pub(crate) fn step_tables(plant: &Plant, mesh: Mesh, clamped: bool, period_s: f64) -> Vec<StepTable> {
    let mut core = plant.core(mesh);
    if clamped {
        hold_voltage(&mut core.A, &mut core.B);
    }
    let finest = period_s / f64::from(1u32 << LEVELS);
    let at = |fraction: f64| Moments::family(&core.A, &core.B, finest * fraction, LEVELS + 1);
    let middles = Moments::family(&core.A, &core.B, 0.5 * finest, LEVELS + 2);
    let (first, second) = (at(NODES[1]), at(NODES[2]));
    let C = output_rows(plant);
    let finest_first = (0..=LEVELS).map(|k| {
        let step = finest * f64::from(1u32 << k);
        Spans { C: &C, step, stages: [&first[k], &second[k], &middles[k + 1]], middle: &middles[k] }.table()
    });
    let mut tables: Vec<StepTable> = finest_first.collect();
    tables.reverse();
    tables
}

/// The moments of one step at its nodes.
struct Spans<'a> {
    C: &'a Mat,
    step: f64,
    stages: [&'a Moments; STAGES],
    middle: &'a Moments,
}

impl Spans<'_> {
    fn table(&self) -> StepTable {
        let end = self.stages[STAGES - 1];
        let n = end.Phi.nrows();
        let eye = Mat::eye(n);
        let mut stage_fixed = Mat::zeros(STAGE_ROWS, n + FIXED_INPUTS);
        let mut stage_ports = Mat::zeros(STAGE_ROWS, STAGES * PORTS);
        for (s, span) in self.stages.iter().enumerate() {
            stage_fixed.set_block(s * OUTPUTS, 0, &self.fixed(self.C, span));
            stage_ports.set_block(s * OUTPUTS, 0, &self.ports(self.C, span));
        }
        let fixed = stage_fixed.vstack(&self.fixed(self.C, self.middle)).vstack(&self.fixed(&eye, end));
        let end_ports = self.ports(self.C, self.middle).vstack(&self.ports(&eye, end));
        StepTable {
            step_s: self.step,
            fixed: Strips::new(&fixed),
            stages: Strips::new(&stage_ports),
            end: Strips::new(&end_ports),
        }
    }

    /// C x the answers to the state and the fixed inputs.
    fn fixed(&self, C: &Mat, span: &Moments) -> Mat {
        let n = span.Phi.nrows();
        let mut M = Mat::zeros(n, n + FIXED_INPUTS);
        M.set_block(0, 0, &span.Phi);
        let mut put = |j: usize, answer: &[f64]| M.column_mut(n + j).copy_from_slice(answer);
        put(0, span.P[0].column(input::DRIVE));
        put(1, span.P[0].column(input::MESH_TORQUE));
        for node in 0..NODES.len() {
            put(2 + node, &span.cardinal(input::PLATFORM_RATE, node, self.step));
        }
        for (p, column) in PORT_INPUTS.into_iter().enumerate() {
            put(6 + p, &span.cardinal(column, 0, self.step));
        }
        C * &M
    }

    /// C x the answers to the ports at the stages.
    fn ports(&self, C: &Mat, span: &Moments) -> Mat {
        let mut M = Mat::zeros(span.Phi.nrows(), STAGES * PORTS);
        for stage in 0..STAGES {
            for (p, column) in PORT_INPUTS.into_iter().enumerate() {
                let answer = span.cardinal(column, stage + 1, self.step);
                M.column_mut(stage * PORTS + p).copy_from_slice(&answer);
            }
        }
        C * &M
    }
}

fn output_rows(plant: &Plant) -> Mat {
    let n = plant.core_order();
    let unit = |k: usize| -> Vec<f64> { (0..n).map(|j| f64::from(u8::from(j == k))).collect() };
    Mat::from_rows(&[
        unit(state::MOTOR),
        unit(state::WINDUP),
        plant.hub_angle_row(),
        plant.hub_rate_row(),
        unit(state::CURRENT),
    ])
}

/// The amplifier's voltage at its limit: it neither follows the drive nor relaxes.
fn hold_voltage(A: &mut Mat, B: &mut Mat) {
    for j in 0..A.ncols() {
        A[(state::VOLTAGE, j)] = 0.0;
    }
    for j in 0..B.ncols() {
        B[(state::VOLTAGE, j)] = 0.0;
    }
}
