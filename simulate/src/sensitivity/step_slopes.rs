//! The derivatives of one step: those of the ports from a linear equation, and with them those of the state at its end.
//!
//! The ports v at the stages solve v = P(y, given), and the outputs y at the stages are a matrix times (state, inputs, v). Both are
//! differentiated as they stand: with dP = C dy + D d(given) and dy = S dv + the rest, (1 - C S) dv = C (the rest) + D d(given).

use super::block::{Block, GroupedMatrix, add_multiple, pad_width};
use super::core_tables::{CoreTable, CoreTables, STATE_ROW, result_rows};
use super::direction::Family;
use super::friction_slopes::{JointFriction, JointPath, JointSlopes};
use super::machine_slopes::{Machine, MachineSlopes, Node};
use super::port_rows::{FrictionRows, Place, Row, STAGE_OUTPUTS, UNKNOWNS, given};
use super::refusal::SensitivityRefusal;
use super::sensor_slopes::LoopSensor;
use crate::PlantState;
use crate::engine::moments::NODES;
use crate::engine::ports::Ports;
use crate::engine::stepper::TakenStep;
use crate::engine::tables::{FIXED_INPUTS, OUTPUTS, PORTS, STAGES};
use counterpoise_models::Plant;

/// Rows and columns of the equation for the ports, padded.
const PORT_COLUMNS: usize = 12;

/// The derivatives of a plant's state.
#[derive(Debug, Clone)]
pub(crate) struct StateSlopes {
    /// Physical states of the core.
    pub core: Block,
    /// What a step is given beside them: see [`given`].
    pub given: Block,
    /// `false` before the first step, when friction has travelled nowhere.
    has_travelled: bool,
    /// The loop's sensor: what it shows, and its derivative.
    pub gyro: Block,
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

/// Work space of a step.
#[derive(Debug, Clone)]
struct Work {
    /// Outputs at the start, then the tip's rate.
    start: Block,
    /// Outputs at the stages, then the state at the end.
    result: Block,
    /// The right side of the ports' equation, and its solution.
    ports: Block,
    values: Block,
    equation: Block,
    answers: GroupedMatrix,
    by_outputs: GroupedMatrix,
    by_given: GroupedMatrix,
    friction: Block,
    felt: Block,
    inputs: Vec<f64>,
}

/// The slopes of a step's ports.
struct PortSlopes {
    rows: [Row; UNKNOWNS],
    /// Friction at the end.
    friction: FrictionRows,
    end: Node,
}

impl PlantSlopes {
    /// Returns the derivatives of a plant at rest; families that change the core are the first ones.
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
        let slopes = MachineSlopes::new(plant, &families);
        Ok(Self {
            joints: [joint(0)?, joint(1)?],
            sensor: LoopSensor::new(plant, &families, period_s)?,
            tables: CoreTables::new(plant, &families, period_s),
            state: StateSlopes::new(n, &slopes, width),
            drive_v: 0.0,
            work: Work::new(n, width),
            machine: Machine { slopes, plant: plant.clone(), families },
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
                state.given.row_mut(given::FRICTION + joint)[k] = slope(&|state| state.friction.get(joint));
                state.gyro.row_mut(joint)[k] = slope(&|state| state.hub_gyro[joint]);
            }
        }
        state.has_travelled = false;
    }

    /// Returns the number of columns: the directions, padded.
    pub fn width(&self) -> usize {
        self.state.gyro.row(0).len()
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
        let slopes = along.port_slopes();
        along.solve_ports(&slopes.rows);
        along.finish(&slopes, sensor.felt_outputs());
        sensor.advance(machine, step, &mut along.work.felt, &mut along.state.gyro);
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
    fn new(order: usize, slopes: &MachineSlopes, width: usize) -> Self {
        let mut given = Block::new(given::COUNT, width);
        given.row_mut(given::COUPLING).copy_from_slice(&slopes.coupling);
        given.row_mut(given::RATIO).copy_from_slice(&slopes.ratio);
        for (k, current) in slopes.direct_current.iter().enumerate() {
            given.row_mut(given::CURRENT + k).copy_from_slice(current);
        }
        Self { core: Block::new(order, width), given, has_travelled: false, gyro: Block::new(2, width) }
    }
}

impl Work {
    fn new(order: usize, width: usize) -> Self {
        Self {
            start: Block::new(OUTPUTS + 1, width),
            result: Block::new(result_rows(order), width),
            ports: Block::new(PORT_COLUMNS, width),
            values: Block::new(PORT_COLUMNS, width),
            answers: GroupedMatrix::new(UNKNOWNS, UNKNOWNS),
            equation: Block::new(PORT_COLUMNS, PORT_COLUMNS),
            by_outputs: GroupedMatrix::new(UNKNOWNS, STAGE_OUTPUTS),
            by_given: GroupedMatrix::new(UNKNOWNS, given::COUNT),
            friction: Block::new(2, width),
            felt: Block::new(STAGES + 1, width),
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

    /// Computes what the step is given: motion and ports at the start, and the torque of half the gap.
    #[inline(always)]
    fn start(&mut self, x: &[f64]) {
        let node = self.node(0);
        let friction = self.step.present.friction();
        let torques =
            [0, 1].map(|joint| self.joints[joint].slopes_at_start(node.rates()[joint], friction.get(joint)));
        let ratio = self.machine.plant.parameters().gearbox.ratio;
        let at = Place { stage: Some(0), node: &node, ratio };
        let rows = FrictionRows::at_start().ports(&self.machine.plant, &at, 0, torques);
        let (offset, slopes) = (self.step.mode.offset, &self.machine.slopes);
        let Work { start, .. } = &mut *self.work;
        start.clear();
        self.tables.add_seen(OUTPUTS, x, &self.state.core, start);
        let StateSlopes { given: rows_given, has_travelled, .. } = &mut *self.state;
        rows_given.row_mut(given::GAP).fill(0.0);
        if offset != 0.0 {
            rows_given.add(given::GAP, offset.signum(), &slopes.gap_torque);
        }
        for joint in 0..2 {
            let rate = rows_given.row_mut(given::RATES + joint);
            rate.copy_from_slice(start.row([0, 3][joint]));
            if joint == 0 {
                add_multiple(rate, -node.platform.rate, &slopes.coupling);
            }
        }
        if !*has_travelled {
            let motor = rows_given.row_mut(given::ANGLES);
            motor.fill(0.0);
            start.combine_from(1, &[ratio, ratio], motor);
            add_multiple(motor, node.wind_up_rad + node.pivot_angle_rad, &slopes.ratio);
            rows_given.row_mut(given::ANGLES + 1).copy_from_slice(start.row(2));
            *has_travelled = true;
        }
        let Work { ports, start, .. } = &mut *self.work;
        for (p, row) in rows.iter().enumerate() {
            let port = ports.row_mut(p);
            port.fill(0.0);
            start.combine(&row.outputs[..OUTPUTS], port);
            self.state.given.combine(&row.given, port);
        }
        self.add_own(0, &node, torques);
        for p in 0..PORTS {
            self.state.given.row_mut(given::PORTS + p).copy_from_slice(self.work.ports.row(p));
        }
    }

    /// Adds to the ports of a stage what the directions change of them at the same motion.
    #[inline(always)]
    fn add_own(&mut self, stage: usize, node: &Node, torques: [[f64; 2]; 2]) {
        let first = stage * PORTS;
        let ports = &mut self.work.ports;
        for (joint, friction) in self.joints.iter().enumerate() {
            for (k, own) in friction.directions.iter().zip(&friction.own) {
                ports.row_mut(first + joint)[*k] -= torques[joint][1] * own.carried + own.torque;
            }
        }
        for (k, family) in
            self.machine.families.iter().enumerate().filter(|(_, family)| family.has_other_parts)
        {
            for (p, slope) in node.slopes_along(&self.machine.plant, family).into_iter().enumerate() {
                ports.row_mut(first + p)[k] += slope;
            }
        }
    }

    /// Computes the result of the step without the share of the ports at the stages.
    #[inline(always)]
    fn stage_outputs(&mut self) {
        let Work { result, inputs, .. } = &mut *self.work;
        let StateSlopes { core, given, .. } = &*self.state;
        result.clear();
        self.table.state.multiply_add(core, 0, result, 0);
        self.table.given.multiply_add(given, given::DRIVE, result, 0);
        self.tables.add_slopes(self.table, inputs, result);
    }

    /// Goes from node to node: motion, friction, ports. What the directions change of the ports at the same motion goes into their rows.
    #[inline(always)]
    fn port_slopes(&mut self) -> PortSlopes {
        self.work.ports.clear();
        let ratio = self.machine.plant.parameters().gearbox.ratio;
        let mut before = self.node(0);
        let mut angles = self.step.present.friction_travel().unwrap_or(before.angles());
        let mut states = [0, 1].map(|joint| self.step.present.friction().get(joint));
        let mut friction = FrictionRows::at_start();
        let mut rows = [Row::ZERO; UNKNOWNS];
        self.joints.iter_mut().for_each(JointFriction::begin_step);
        for stage in 0..STAGES {
            let node = self.node(stage + 1);
            let from = Place { stage: stage.checked_sub(1), node: &before, ratio };
            let to = Place { stage: Some(stage), node: &node, ratio };
            let after = self.step.attempt.stage_friction()[stage];
            let time_s = (NODES[stage + 1] - NODES[stage]) * self.step.table.step_s;
            let mut torques = [[0.0; 2]; 2];
            for joint in 0..2 {
                let path = JointPath {
                    rates: [before.rates()[joint], node.rates()[joint]],
                    travel: node.angles()[joint] - angles[joint],
                    time_s,
                    states: [states[joint], after.get(joint)],
                };
                let slopes: JointSlopes = self.joints[joint].slopes(&path);
                friction.advance(joint, &slopes, &from, &to);
                torques[joint] = slopes.torque;
            }
            let found = friction.ports(&self.machine.plant, &to, stage, torques);
            rows[stage * PORTS..(stage + 1) * PORTS].copy_from_slice(&found);
            self.add_own(stage, &node, torques);
            (before, angles) = (node, node.angles());
            states = [0, 1].map(|joint| after.get(joint));
        }
        PortSlopes { rows, friction, end: before }
    }

    /// Solves the equation for the ports.
    #[inline(always)]
    fn solve_ports(&mut self, rows: &[Row; UNKNOWNS]) {
        let Work { ports, values, result, equation, by_outputs, by_given, answers, .. } = &mut *self.work;
        for (p, row) in rows.iter().enumerate() {
            for k in 0..STAGE_OUTPUTS {
                by_outputs.set(p, k, row.outputs[k]);
            }
            for k in 0..given::COUNT {
                by_given.set(p, k, row.given[k]);
            }
        }
        by_outputs.multiply_add(result, 0, ports, 0);
        by_given.multiply_add(&self.state.given, 0, ports, 0);
        equation.clear();
        by_outputs.multiply_add(&self.table.stages, 0, equation, 0);
        let mut left = [[0.0; PORT_COLUMNS]; UNKNOWNS];
        for p in 0..UNKNOWNS {
            let row = equation.row(p);
            for k in 0..PORT_COLUMNS {
                left[p][k] = -row[k];
            }
            left[p][p] += 1.0;
        }
        let right = inverse_of(left);
        for p in 0..UNKNOWNS {
            for k in 0..UNKNOWNS {
                answers.set(p, k, right[p][k]);
            }
        }
        values.clear();
        answers.multiply_add(ports, 0, values, 0);
    }

    /// Computes what follows of the ports: the state at the end, friction, and what the loop's sensor feels of the outputs at the nodes.
    #[inline(always)]
    fn finish(&mut self, slopes: &PortSlopes, seen: &[f64; OUTPUTS]) {
        let Work { result, values, felt, start, friction, .. } = &mut *self.work;
        self.table.ports.multiply_add(values, 0, result, 0);
        for row in 0..self.machine.plant.core_order() {
            self.state.core.row_mut(row).copy_from_slice(result.row(STATE_ROW + row));
        }
        let outputs = &*result;
        for node in 0..STAGES + 1 {
            let out = felt.row_mut(node);
            out.fill(0.0);
            match node {
                0 => start.combine(seen, out),
                _ => outputs.combine_from((node - 1) * OUTPUTS, seen, out),
            }
        }
        let rows = &mut self.state.given;
        for (joint, row) in slopes.friction.0.iter().enumerate() {
            let out = friction.row_mut(joint);
            out.fill(0.0);
            outputs.combine(&row.outputs, out);
            rows.combine(&row.given, out);
            let own = &self.joints[joint];
            own.directions.iter().zip(&own.own).for_each(|(k, own)| out[*k] += own.carried);
        }
        for joint in 0..2 {
            rows.row_mut(given::FRICTION + joint).copy_from_slice(friction.row(joint));
        }
        let last = (STAGES - 1) * OUTPUTS;
        let ratio = self.machine.plant.parameters().gearbox.ratio;
        let motor = rows.row_mut(given::ANGLES);
        motor.fill(0.0);
        outputs.combine_from(last + 1, &[ratio, ratio], motor);
        add_multiple(motor, slopes.end.wind_up_rad + slopes.end.pivot_angle_rad, &self.machine.slopes.ratio);
        rows.row_mut(given::ANGLES + 1).copy_from_slice(outputs.row(last + 2));
    }
}

/// Returns the inverse of a matrix by Gauss's and Jordan's elimination with the largest pivot.
#[inline(always)]
fn inverse_of(mut left: [[f64; PORT_COLUMNS]; UNKNOWNS]) -> [[f64; PORT_COLUMNS]; UNKNOWNS] {
    let mut right = [[0.0; PORT_COLUMNS]; UNKNOWNS];
    for (k, row) in right.iter_mut().enumerate() {
        row[k] = 1.0;
    }
    for column in 0..UNKNOWNS {
        let mut pivot = column;
        for row in column + 1..UNKNOWNS {
            if left[row][column].abs() > left[pivot][column].abs() {
                pivot = row;
            }
        }
        left.swap(column, pivot);
        right.swap(column, pivot);
        let per = left[column][column].recip();
        for k in 0..PORT_COLUMNS {
            left[column][k] *= per;
            right[column][k] *= per;
        }
        let (own, answer) = (left[column], right[column]);
        for row in 0..UNKNOWNS {
            let factor = if row == column { 0.0 } else { left[row][column] };
            for k in 0..PORT_COLUMNS {
                left[row][k] -= factor * own[k];
                right[row][k] -= factor * answer[k];
            }
        }
    }
    right
}
