//! The derivatives of one step: those of the ports from a linear equation, and with them those of the state at its end.
//!
//! The ports v at the stages solve v = P(y, memory), and the outputs y at the nodes are a matrix times (state, inputs, v). Both are
//! differentiated as they stand. The derivatives by v are further columns at first, one a port; nine equations then give those of v.

use super::block::{Block, add_multiple, pad_width};
use super::core_tables::{CoreTable, CoreTables, STAGE_OUTPUTS, UNKNOWNS};
use super::direction::Family;
use super::friction_slopes::{JointFriction, JointPath};
use super::machine_slopes::{MachineSlopes, Node};
use super::refusal::SensitivityRefusal;
use super::sensor_slopes::LoopSensor;
use crate::PlantState;
use crate::engine::moments::NODES;
use crate::engine::ports::Ports;
use crate::engine::stepper::TakenStep;
use crate::engine::tables::{FIXED_INPUTS, OUTPUTS, PORTS, STAGES};
use counterpoise_models::Plant;

/// Columns of the ports at the stages, padded.
const PORT_COLUMNS: usize = 12;
const MOTOR: usize = 0;
const WINDUP: usize = 1;
const HUB_ANGLE: usize = 2;
const HUB_RATE: usize = 3;
const CURRENT: usize = 4;
/// Rows of the relative motions: rates of motor and pivot, then their angles.
const MOTIONS: usize = 4;

/// The machine and its families.
#[derive(Debug, Clone)]
pub(crate) struct Machine {
    pub plant: Plant,
    pub families: Vec<Family>,
    pub slopes: MachineSlopes,
}

/// The derivatives of a plant's state.
#[derive(Debug, Clone)]
pub(crate) struct StateSlopes {
    /// Physical states of the core.
    pub core: Block,
    /// Dry friction at motor and pivot.
    pub friction: Block,
    /// Angles to which friction has travelled; `None` before the first step.
    pub travelled: Option<Block>,
    /// The loop's sensor: what it shows, and its derivative.
    pub gyro: Block,
    /// Drive of the amplifier.
    pub drive: Vec<f64>,
}

/// The derivatives of a plant along a run.
#[derive(Debug, Clone)]
pub(crate) struct PlantSlopes {
    pub machine: Machine,
    pub tables: CoreTables,
    pub state: StateSlopes,
    /// Drive of the amplifier, V.
    pub drive_v: f64,
    joints: [JointFriction; 2],
    sensor: LoopSensor,
    work: Work,
}

/// The rows along a step. Their columns are the directions, then the ports at the stages.
#[derive(Debug, Clone)]
struct Work {
    outputs: Block,
    motion: Block,
    before: Block,
    memory: Block,
    moved: Block,
    ports: Block,
    start: Block,
    /// Of the directions alone.
    values: Block,
    core: Block,
    felt: Block,
    own: Vec<f64>,
    inputs: Vec<f64>,
}

impl PlantSlopes {
    /// Returns the derivatives of a plant at rest.
    pub fn new(plant: &Plant, families: Vec<Family>, period_s: f64) -> Result<Self, SensitivityRefusal> {
        let ports = Ports::new(plant)?;
        let is_common = |ports: &Ports| ports.common_parts().is_some();
        if !is_common(&ports) || !families.iter().flat_map(|family| &family.ports).all(is_common) {
            let part = "hoses, losses and errors of the mesh, loads, learned functions, cylinders and friction of varying level";
            return Err(SensitivityRefusal::Part { part });
        }
        let models = ports.frictions().map(|model| *model);
        let joint = |k: usize| JointFriction::new(&models[k], k, &families);
        let (n, width) = (plant.core_order(), pad_width(families.len()));
        Ok(Self {
            joints: [joint(0)?, joint(1)?],
            sensor: LoopSensor::new(plant, &families, period_s)?,
            tables: CoreTables::new(plant, &families, period_s),
            state: StateSlopes::new(n, width),
            drive_v: 0.0,
            work: Work::new(n, width),
            machine: Machine { slopes: MachineSlopes::new(plant, &families), plant: plant.clone(), families },
        })
    }

    /// Begins with the derivatives of the starts.
    pub fn restart(&mut self, start: &PlantState) {
        let state = &mut self.state;
        for (k, family) in self.machine.families.iter().enumerate() {
            let slope = |value: &dyn Fn(&PlantState) -> f64| {
                family.stencil.derivative(value(start), family.starts.each_ref().map(value))
            };
            for row in 0..start.core.len() {
                state.core.row_mut(row)[k] = slope(&|state| state.core[row]);
            }
            for joint in 0..2 {
                state.friction.row_mut(joint)[k] = slope(&|state| state.friction.get(joint));
                state.gyro.row_mut(joint)[k] = slope(&|state| state.hub_gyro[joint]);
            }
        }
        state.travelled = None;
    }

    /// Computes the derivatives of what is seen of a physical state: outputs, then the tip's rate.
    pub fn seen_slopes(&self, x: &[f64], out: &mut Block) {
        out.clear();
        self.tables.add_seen(OUTPUTS + 1, x, &self.state.core, out);
    }

    /// Moves the derivatives over a step that is about to be taken from a physical state.
    pub fn advance(&mut self, step: &TakenStep, x: &[f64]) {
        pulp::Arch::new().dispatch(Advance { slopes: self, step, x });
    }

    #[inline(always)]
    fn advance_inline(&mut self, step: &TakenStep, x: &[f64]) {
        let Self { machine, tables, state, drive_v, joints, sensor, work } = self;
        tables.prepare(step.mode, step.level, &machine.families);
        let Some(table) = tables.table(step.mode, step.level) else { return };
        let mut along = AlongStep { machine, tables, table, joints, state, work, step, drive_v: *drive_v };
        along.fill_inputs(x);
        along.start(x);
        along.stage_outputs();
        along.stages();
        along.solve_ports();
        along.finish();
        sensor.advance(machine, step, &along.work.felt, &mut along.state.gyro);
    }
}

struct Advance<'a, 'b> {
    slopes: &'a mut PlantSlopes,
    step: &'a TakenStep<'b>,
    x: &'a [f64],
}

impl pulp::NullaryFnOnce for Advance<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.slopes.advance_inline(self.step, self.x);
    }
}

impl StateSlopes {
    fn new(order: usize, width: usize) -> Self {
        Self {
            core: Block::new(order, width),
            friction: Block::new(2, width),
            travelled: None,
            gyro: Block::new(2, width),
            drive: vec![0.0; width],
        }
    }
}

impl Work {
    fn new(order: usize, width: usize) -> Self {
        let all = width + PORT_COLUMNS;
        Self {
            outputs: Block::new((STAGES + 1) * OUTPUTS, all),
            motion: Block::new(MOTIONS, all),
            before: Block::new(MOTIONS, all),
            memory: Block::new(2, all),
            moved: Block::new(2, all),
            ports: Block::new(UNKNOWNS, all),
            start: Block::new(PORTS, all),
            values: Block::new(UNKNOWNS, width),
            core: Block::new(order, width),
            felt: Block::new((STAGES + 1) * OUTPUTS, width),
            own: vec![0.0; width],
            inputs: vec![0.0; order + FIXED_INPUTS + UNKNOWNS],
        }
    }
}

/// One step, as its derivatives see it.
struct AlongStep<'a, 'b> {
    machine: &'a Machine,
    tables: &'a CoreTables,
    table: &'a CoreTable,
    joints: &'a mut [JointFriction; 2],
    state: &'a mut StateSlopes,
    work: &'a mut Work,
    step: &'a TakenStep<'b>,
    drive_v: f64,
}

impl AlongStep<'_, '_> {
    fn width(&self) -> usize {
        self.state.drive.len()
    }

    #[inline(always)]
    fn node(&self, node: usize) -> Node {
        let outputs = &self.step.attempt.outputs()[node];
        Node::new(&self.machine.plant, outputs, self.drive_v, self.step.nodes[node])
    }

    /// Writes state, fixed inputs and ports of the step, by which the derivatives of the matrices are multiplied.
    #[inline(always)]
    fn fill_inputs(&mut self, x: &[f64]) {
        let (n, attempt) = (x.len(), &self.step.attempt);
        let inputs = &mut self.work.inputs;
        inputs[..n].copy_from_slice(x);
        inputs[n] = self.drive_v;
        inputs[n + 1] = self.step.mode.offset;
        for (input, point) in inputs[n + 2..n + 6].iter_mut().zip(self.step.nodes) {
            *input = point.rate;
        }
        inputs[n + 6..n + FIXED_INPUTS].copy_from_slice(attempt.start_ports());
        inputs[n + FIXED_INPUTS..].copy_from_slice(attempt.port_values());
    }

    /// Computes outputs, motion, friction and ports at the start.
    #[inline(always)]
    fn start(&mut self, x: &[f64]) {
        self.work.outputs.clear();
        self.tables.add_seen(OUTPUTS, x, &self.state.core, &mut self.work.outputs);
        let width = self.width();
        self.move_joints(0);
        if let Some(travelled) = &self.state.travelled {
            for joint in 0..2 {
                self.work.motion.row_mut(2 + joint)[..width].copy_from_slice(travelled.row(joint));
            }
        }
        self.work.memory.clear();
        for joint in 0..2 {
            self.work.memory.row_mut(joint)[..width].copy_from_slice(self.state.friction.row(joint));
        }
        let friction = self.step.present.friction();
        let node = self.node(0);
        let slopes =
            [0, 1].map(|joint| self.joints[joint].slopes_at_start(node.rates()[joint], friction.get(joint)));
        self.ports_of_node(0, &node, slopes);
        for p in 0..PORTS {
            let Work { start, ports, .. } = &mut *self.work;
            start.row_mut(p).copy_from_slice(ports.row(p));
        }
    }

    /// Computes the relative motions at a node.
    #[inline(always)]
    fn move_joints(&mut self, node: usize) {
        let at = self.node(node);
        let (slopes, plant) = (&self.machine.slopes, &self.machine.plant);
        let Work { outputs, motion, .. } = &mut *self.work;
        let row = |k: usize| outputs.row(node * OUTPUTS + k);
        motion.clear();
        motion.add(0, 1.0, row(MOTOR));
        motion.add(0, -at.platform.rate, &slopes.coupling);
        motion.add(1, 1.0, row(HUB_RATE));
        let ratio = plant.parameters().gearbox.ratio;
        motion.add(2, ratio, row(WINDUP));
        motion.add(2, ratio, row(HUB_ANGLE));
        motion.add(2, at.wind_up_rad + at.pivot_angle_rad, &slopes.ratio);
        motion.add(3, 1.0, row(HUB_ANGLE));
    }

    /// Computes the outputs at the stages, but for the ports' columns of the directions.
    #[inline(always)]
    fn stage_outputs(&mut self) {
        let width = self.width();
        for row in 0..STAGE_OUTPUTS {
            self.add_inputs(row);
            let n = self.state_count();
            let Work { outputs, own, .. } = &mut *self.work;
            let to = outputs.row_mut(OUTPUTS + row);
            add_multiple(&mut to[..width], 1.0, own);
            to[width..width + UNKNOWNS].copy_from_slice(&self.table.all.row(row)[n + FIXED_INPUTS..]);
        }
    }

    fn state_count(&self) -> usize {
        self.work.inputs.len() - FIXED_INPUTS - UNKNOWNS
    }

    /// Computes a row of the matrix times the derivatives of state and fixed inputs, with the derivatives of the row; into `own`.
    #[inline(always)]
    fn add_inputs(&mut self, row: usize) {
        let (n, width) = (self.state_count(), self.width());
        let entries = self.table.all.row(row);
        let Work { own, inputs, start, .. } = &mut *self.work;
        own.fill(0.0);
        for (j, entry) in entries[..n].iter().enumerate() {
            add_multiple(own, *entry, self.state.core.row(j));
        }
        add_multiple(own, entries[n], &self.state.drive);
        if self.step.mode.offset != 0.0 {
            add_multiple(own, entries[n + 1] * self.step.mode.offset.signum(), &self.machine.slopes.gap_torque);
        }
        for p in 0..PORTS {
            add_multiple(own, entries[n + 6 + p], &start.row(p)[..width]);
        }
        self.tables.add_row_slopes(self.table, row, inputs, own);
    }

    /// Goes from node to node: motion, friction, ports.
    #[inline(always)]
    fn stages(&mut self) {
        let mut before = self.node(0);
        let mut angles = self.step.present.travelled().unwrap_or(before.angles());
        let mut states = [0, 1].map(|joint| self.step.present.friction().get(joint));
        for stage in 1..=STAGES {
            let Work { before: rows, motion, .. } = &mut *self.work;
            rows.copy(motion);
            self.move_joints(stage);
            let node = self.node(stage);
            let after = self.step.attempt.stage_friction()[stage - 1];
            let time_s = (NODES[stage] - NODES[stage - 1]) * self.step.table.step_s;
            let mut torques = [[0.0; 2]; 2];
            for joint in 0..2 {
                let path = JointPath {
                    rates: [before.rates()[joint], node.rates()[joint]],
                    travel: node.angles()[joint] - angles[joint],
                    time_s,
                    states: [states[joint], after.get(joint)],
                };
                torques[joint] = self.advance_friction(joint, &path);
            }
            self.ports_of_node(stage, &node, torques);
            (before, angles) = (node, node.angles());
            states = [0, 1].map(|joint| after.get(joint));
        }
    }

    /// Computes the state of a joint's friction after a path; returns the slopes of its torque over rate and state.
    #[inline(always)]
    fn advance_friction(&mut self, joint: usize, path: &JointPath) -> [f64; 2] {
        let slopes = self.joints[joint].slopes(path);
        let Work { before, motion, memory, moved, .. } = &mut *self.work;
        let [by_before, by_after, by_travel, by_state] = slopes.state;
        moved.row_mut(joint).fill(0.0);
        moved.add(joint, by_before, before.row(joint));
        moved.add(joint, by_after, motion.row(joint));
        moved.add(joint, by_travel, motion.row(2 + joint));
        moved.add(joint, -by_travel, before.row(2 + joint));
        moved.add(joint, by_state, memory.row(joint));
        let friction = &self.joints[joint];
        for (k, own) in friction.directions.iter().zip(&friction.own) {
            moved.row_mut(joint)[*k] += own[0];
        }
        memory.row_mut(joint).copy_from_slice(moved.row(joint));
        slopes.torque
    }

    /// Computes the ports at a node from its motion and friction: at the start into the first rows.
    #[inline(always)]
    fn ports_of_node(&mut self, node: usize, at: &Node, torques: [[f64; 2]; 2]) {
        let (plant, slopes) = (&self.machine.plant, &self.machine.slopes);
        let first = node.saturating_sub(1) * PORTS;
        let parts = at.slopes(plant);
        let Work { outputs, motion, memory, ports, .. } = &mut *self.work;
        for p in 0..PORTS {
            ports.row_mut(first + p).fill(0.0);
        }
        for joint in 0..2 {
            let [by_rate, by_state] = torques[joint];
            ports.add(first + joint, -by_rate, motion.row(joint));
            ports.add(first + joint, -by_state, memory.row(joint));
            let friction = &self.joints[joint];
            for (k, own) in friction.directions.iter().zip(&friction.own) {
                ports.row_mut(first + joint)[*k] -= own[1];
            }
        }
        let [by_current, by_angle, by_rate] = parts.motor;
        ports.add(first, by_current, outputs.row(node * OUTPUTS + CURRENT));
        ports.add(first, by_current * plant.direct_current_a(1.0, 0.0), &self.state.drive);
        ports.add(first, by_current * self.drive_v, &slopes.direct_current[0]);
        ports.add(first, by_current * at.platform.rate, &slopes.direct_current[1]);
        ports.add(first, by_angle, motion.row(2));
        ports.add(first, by_rate, motion.row(0));
        let [by_angle, by_motor, by_rate] = parts.hub;
        ports.add(first + 1, by_angle, outputs.row(node * OUTPUTS + HUB_ANGLE));
        ports.add(first + 1, by_motor, motion.row(2));
        ports.add(first + 1, by_rate, motion.row(1));
        ports.add(first + 2, parts.load, outputs.row(node * OUTPUTS + HUB_ANGLE));
        for (k, family) in self.machine.families.iter().enumerate().filter(|(_, family)| family.has_other_parts) {
            for (p, slope) in at.slopes_along(plant, family).into_iter().enumerate() {
                ports.row_mut(first + p)[k] += slope;
            }
        }
    }

    /// Solves (1 - dP/dv) dv = dP for the ports at the stages, by Gauss's elimination with the largest pivot.
    #[inline(always)]
    fn solve_ports(&mut self) {
        let width = self.width();
        let Work { ports, values, .. } = &mut *self.work;
        let mut left = [[0.0; UNKNOWNS]; UNKNOWNS];
        for (row, left) in left.iter_mut().enumerate() {
            let (own, by_ports) = ports.row(row).split_at(width);
            values.row_mut(row).copy_from_slice(own);
            for (column, entry) in left.iter_mut().enumerate() {
                *entry = f64::from(u8::from(row == column)) - by_ports[column];
            }
        }
        for column in 0..UNKNOWNS {
            let size = |row: &usize| left[*row][column].abs();
            let pivot = (column..UNKNOWNS).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(column);
            left.swap(column, pivot);
            values.swap_rows(column, pivot);
            for row in column + 1..UNKNOWNS {
                let factor = left[row][column] / left[column][column];
                if factor != 0.0 {
                    for k in column..UNKNOWNS {
                        left[row][k] -= factor * left[column][k];
                    }
                    values.add_row(row, -factor, column);
                }
            }
        }
        for row in (0..UNKNOWNS).rev() {
            for k in row + 1..UNKNOWNS {
                values.add_row(row, -left[row][k], k);
            }
            values.scale_row(row, left[row][row].recip());
        }
    }

    /// Computes what follows of the ports: the state at the end, friction, and what is seen at the nodes.
    #[inline(always)]
    fn finish(&mut self) {
        let (n, width) = (self.state_count(), self.width());
        for row in 0..n {
            self.add_inputs(STAGE_OUTPUTS + row);
            let Work { core, own, values, .. } = &mut *self.work;
            let entries = &self.table.all.row(STAGE_OUTPUTS + row)[n + FIXED_INPUTS..];
            for (p, entry) in entries.iter().enumerate() {
                add_multiple(own, *entry, values.row(p));
            }
            core.row_mut(row).copy_from_slice(own);
        }
        self.state.core.copy(&self.work.core);
        let Work { memory, motion, outputs, values, felt, .. } = &mut *self.work;
        let travelled = self.state.travelled.get_or_insert_with(|| Block::new(2, width));
        for joint in 0..2 {
            complete(self.state.friction.row_mut(joint), memory.row(joint), values);
            complete(travelled.row_mut(joint), motion.row(2 + joint), values);
        }
        for row in 0..(STAGES + 1) * OUTPUTS {
            complete(felt.row_mut(row), outputs.row(row), values);
        }
    }
}

/// Computes a row of the directions from one that has columns of the ports, too.
#[inline(always)]
fn complete(to: &mut [f64], row: &[f64], values: &Block) {
    let (own, by_ports) = row.split_at(to.len());
    to.copy_from_slice(own);
    for (p, factor) in by_ports[..UNKNOWNS].iter().enumerate() {
        add_multiple(to, *factor, values.row(p));
    }
}
