//! One step: the linear core's answer, and the iteration on the port values at the nodes.

use super::crossing::Margin;
use super::moments::{MIDDLE, NODES};
use super::ports::{Bonds, FrictionState, NearbyAngle, PlatformSpan, Point, Ports, StepSpan};
use super::strips::Strips;
use super::tables::{
    FIXED_INPUTS, HOLD_ROWS, OUTPUTS, PORTS, STAGE_ROWS, STAGES, STATE, StepTable, result_length,
};
use crate::tolerance::{
    ITERATION_SHARE, ITERATION_TOLERANCE, LEAST_CONTRACTION, PORT_ROUNDING, PREDICTED, QUIET, STEP_ITERATIONS,
};
use counterpoise_models::Plant;

/// The values that stay over a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HeldInputs {
    /// Drive of the amplifier, V.
    pub drive_v: f64,
    /// Torque of half the gap, N m.
    pub offset_nm: f64,
}

/// The inputs of a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepProblem<'a> {
    /// The plant.
    pub plant: &'a Plant,
    /// Nonlinear parts.
    pub ports: &'a Ports,
    /// The matrices of this step.
    pub table: &'a StepTable,
    /// The core's state at its start.
    pub core: &'a [f64],
    /// Friction's state at its start.
    pub friction: &'a FrictionState,
    /// The bonds of bristles at its start.
    pub bonds: &'a Bonds,
    /// Angles of motor and pivot to which friction has travelled before it, rad.
    pub travelled: Option<[f64; 2]>,
    /// Inputs of the nonlinear parts at its start.
    pub outputs: [f64; OUTPUTS],
    /// Inputs that are constant over the step.
    pub held: HeldInputs,
    /// The platform along it.
    pub platform: &'a PlatformSpan,
    /// Start, s.
    pub time_s: f64,
    /// Defect that is allowed.
    pub tolerance: f64,
}

/// The work space of a step, and its result.
#[derive(Debug, Clone)]
pub(crate) struct Attempt {
    inputs: Vec<f64>,
    result: Vec<f64>,
    values: [f64; STAGES * PORTS],
    start: [f64; PORTS],
    outputs: [[f64; OUTPUTS]; 4],
    memory: [FrictionState; STAGES],
    bonds: Bonds,
    travelled: [f64; 2],
    about: NearbyAngle,
    before: PreviousStep,
    /// Torque of another axis at the stages of the step before, N m.
    other: [f64; STAGES],
    /// Factor from the change in one iteration to that in the next.
    contraction: f64,
    /// Evaluations of the ports.
    pub iterations: usize,
    /// `true` if the ports went on as in the step before.
    pub predicted: bool,
    order: usize,
}

impl Attempt {
    pub fn new(order: usize) -> Self {
        Self {
            inputs: vec![0.0; order + FIXED_INPUTS],
            result: vec![0.0; result_length(order)],
            values: [0.0; STAGES * PORTS],
            start: [0.0; PORTS],
            outputs: [[0.0; OUTPUTS]; 4],
            memory: [FrictionState::default(); STAGES],
            bonds: Bonds::default(),
            travelled: [0.0; 2],
            about: NearbyAngle::new(0.0),
            before: PreviousStep::default(),
            other: [0.0; STAGES],
            contraction: 1.0,
            iterations: 0,
            predicted: false,
            order,
        }
    }

    /// Takes the step, in the widest registers of the machine and with the same sums in the same order on every machine; says
    /// whether the ports have converged.
    pub fn solve(&mut self, given: &StepProblem) -> bool {
        pulp::Arch::new().dispatch(Solution { attempt: self, given })
    }

    /// Takes the step in the registers of the function that it becomes part of.
    #[inline(always)]
    pub fn solve_inline(&mut self, given: &StepProblem) -> bool {
        self.outputs[0] = given.outputs;
        self.about = self.about.move_to(self.outputs[0][2]);
        let first = Point {
            time_s: given.time_s,
            outputs: &self.outputs[0],
            platform: &given.platform.nodes[0],
            further: given.platform.further_at(0),
            drive_v: given.held.drive_v,
            about: &self.about,
        };
        self.start = given.ports.at(given.plant, &first, given.friction);
        self.fill_inputs(given);
        let (seen, state) = self.result.split_at_mut(STATE);
        seen.fill(0.0);
        given.table.fixed.multiply_add_inline(&self.inputs, seen);
        given.table.flow.multiply_inline(given.core, state);
        given.table.drive.multiply_add_inline(&self.inputs[self.order..], state);
        self.guess(given);
        let converged = self.iterate(given);
        given.table.end.multiply_add_inline(&self.values, &mut self.result[STAGE_ROWS..]);
        converged
    }

    /// First values of the ports at the stages: the torques as the step before would go on, the load as the platform
    /// has it.
    fn guess(&mut self, given: &StepProblem) {
        let weights = self.before.weights(given.table.step_s);
        let quiet = [0, 1].map(|p| self.before.change(p) < QUIET * given.ports.scales[p]);
        let tilt = given.ports.tilt(&self.about, self.outputs[0][2]);
        for stage in 0..STAGES {
            let at = stage * PORTS;
            for p in 0..2 {
                let inner: f64 = (0..STAGES).map(|k| weights[stage][k] * self.before.values[k][p]).sum();
                self.values[at + p] = if quiet[p] { self.start[p] } else { self.start[p] + inner };
            }
            if let Some(further) = &given.platform.further {
                // the torque of another axis is known; what went on of it does not count
                let went: f64 = (0..STAGES).map(|k| weights[stage][k] * self.other[k]).sum();
                let change = further[stage + 1].torque - further[0].torque;
                self.values[at + 1] += if quiet[1] { change } else { change - went };
            }
            let (heave, further) =
                (given.platform.nodes[stage + 1].heave, given.platform.further_at(stage + 1));
            self.values[at + 2] = given.ports.load(tilt, heave, further);
        }
    }

    /// Returns what the next step continues from, if the one before was of a length: the torques at its stages, the contraction, and the
    /// angle whose sine is known.
    pub fn continuation(&self, step_s: f64) -> Option<Continuation> {
        (self.before.step_s == step_s).then_some(Continuation {
            before: self.before.values,
            contraction: self.contraction,
            about: self.about,
        })
    }

    /// Continues from a step of a length.
    pub fn continue_from(&mut self, step_s: f64, from: &Continuation) {
        self.before.keep(step_s, from.before);
        self.contraction = from.contraction;
        self.about = from.about;
    }

    /// Returns what the next step continues from, whatever the length of the one before.
    pub fn resumption(&self) -> Resumption {
        let from =
            Continuation { before: self.before.values, contraction: self.contraction, about: self.about };
        Resumption { step_s: self.before.step_s, from, other: self.other }
    }

    /// Continues from there again.
    pub fn resume(&mut self, from: &Resumption) {
        self.continue_from(from.step_s, &from.from);
        self.other = from.other;
    }

    /// Keeps the torques of the step that was just taken.
    pub fn accept(&mut self, step_s: f64) {
        let values = std::array::from_fn(|k| [self.values[k * PORTS], self.values[k * PORTS + 1]]);
        self.before.keep(step_s, values);
    }

    fn fill_inputs(&mut self, given: &StepProblem) {
        let n = self.order;
        self.inputs[..n].copy_from_slice(given.core);
        self.inputs[n..n + 2].copy_from_slice(&[given.held.drive_v, given.held.offset_nm]);
        for (input, point) in self.inputs[n + 2..n + 6].iter_mut().zip(&given.platform.nodes) {
            *input = point.rate;
        }
        self.inputs[n + 6..n + FIXED_INPUTS].copy_from_slice(&self.start);
    }

    #[inline(always)]
    fn iterate(&mut self, given: &StepProblem) -> bool {
        let allowed = (ITERATION_SHARE * given.tolerance).min(ITERATION_TOLERANCE);
        let mut last = f64::INFINITY;
        self.predicted = false;
        for iteration in 1..=STEP_ITERATIONS {
            let change = self.iteration(given);
            self.iterations = iteration;
            if iteration == 1 {
                self.predicted = change < given.tolerance.min(PREDICTED);
            } else if last > PORT_ROUNDING {
                self.contraction = (2.0 * change / last).clamp(LEAST_CONTRACTION, 1.0);
            }
            if change * self.contraction < allowed {
                return true;
            }
            last = change;
        }
        false
    }

    /// Evaluates the ports along the step; returns their largest change.
    #[inline(always)]
    fn iteration(&mut self, given: &StepProblem) -> f64 {
        let mut rows = [0.0; STAGE_ROWS];
        rows.copy_from_slice(&self.result[..STAGE_ROWS]);
        given.table.stages.multiply_add_inline(&self.values, &mut rows);
        for stage in 0..STAGES {
            self.outputs[stage + 1].copy_from_slice(&rows[stage * OUTPUTS..(stage + 1) * OUTPUTS]);
        }
        self.bonds.copy(given.bonds);
        let mut bonds = std::mem::take(&mut self.bonds);
        let found = given.ports.advance_over_step(given.plant, &self.span(given), &mut bonds);
        self.bonds = bonds;
        let change = largest_change(&found.values, &self.values, &given.ports.scales);
        self.values = found.values;
        self.memory = found.memory;
        self.travelled = found.travelled;
        change
    }

    fn span<'a>(&'a self, given: &StepProblem<'a>) -> StepSpan<'a> {
        StepSpan {
            time_s: given.time_s,
            step_s: given.table.step_s,
            outputs: &self.outputs,
            platform: given.platform,
            drive_v: given.held.drive_v,
            memory: given.friction,
            travelled: given.travelled,
            about: &self.about,
        }
    }

    /// Returns how far the ports in the middle of the step are from the cubics through their nodes, relative to their scales.
    pub fn defect(&self, given: &StepProblem) -> f64 {
        let mut bonds = given.bonds.clone();
        let middle = self.middle_outputs();
        let time_s = given.time_s + 0.5 * given.table.step_s;
        let point = Point {
            time_s,
            outputs: &middle,
            platform: &given.platform.middle,
            further: given.platform.further_amid(),
            drive_v: given.held.drive_v,
            about: &self.about,
        };
        let found =
            given.ports.middle_values(given.plant, &self.span(given), &self.memory[0], &mut bonds, &point);
        let mut worst: f64 = 0.0;
        for p in 0..PORTS {
            let mut expected = MIDDLE[0] * self.start[p];
            for stage in 0..STAGES {
                expected += MIDDLE[stage + 1] * self.values[stage * PORTS + p];
            }
            let defect = (found[p] - expected).abs() / given.ports.scales[p];
            worst = if defect <= worst { worst } else { defect };
        }
        worst
    }

    /// Returns the state's share of the torque that holds a joint, at the first and second inner node and in the middle.
    pub fn holding_torque_share(&self, hold: &Strips, joint: usize) -> [f64; 3] {
        let mut given = self.inputs.clone();
        given.extend(self.values);
        let mut shares = [0.0; HOLD_ROWS];
        hold.multiply_add(&given, &mut shares);
        std::array::from_fn(|k| shares[joint * HOLD_ROWS / 2 + k])
    }

    /// Returns the values of the ports at the first and second inner node and in the middle.
    pub fn inner_ports(&self) -> [[f64; PORTS]; 3] {
        let at = |stage: usize, p: usize| self.values[stage * PORTS + p];
        let middle =
            |p: usize| MIDDLE[0] * self.start[p] + (0..STAGES).map(|k| MIDDLE[k + 1] * at(k, p)).sum::<f64>();
        [std::array::from_fn(|p| at(0, p)), std::array::from_fn(|p| at(1, p)), std::array::from_fn(middle)]
    }

    /// Returns what the nonlinear parts see in the middle.
    pub fn middle_outputs(&self) -> [f64; OUTPUTS] {
        let mut middle = [0.0; OUTPUTS];
        middle.copy_from_slice(&self.result[STAGE_ROWS..STAGE_ROWS + OUTPUTS]);
        middle
    }

    /// Returns the margins of the wind-up along the step, at its nodes and in its middle; `holds` gives the margin of a wind-up.
    pub fn wind_up_margins(&self, holds: impl Fn(f64) -> f64) -> [Margin; 5] {
        let at = |node: usize| Margin { part: NODES[node], value: holds(self.outputs[node][1]) };
        let middle = Margin { part: 0.5, value: holds(self.result[STAGE_ROWS + 1]) };
        [at(0), at(1), middle, at(2), at(3)]
    }

    /// Keeps the torque of another axis in the step that was just taken, at its stages.
    pub fn accept_torque(&mut self, torque_nm: [f64; STAGES]) {
        self.other = torque_nm;
    }

    /// Returns what is seen at the nodes under the values of the ports that the iteration ended with: [`Self::outputs`] are those that they
    /// were computed from.
    pub fn settled_outputs(&self, table: &StepTable) -> [[f64; OUTPUTS]; 4] {
        let mut rows = [0.0; STAGE_ROWS];
        rows.copy_from_slice(&self.result[..STAGE_ROWS]);
        table.stages.multiply_add(&self.values, &mut rows);
        std::array::from_fn(|node| match node {
            0 => self.outputs[0],
            _ => std::array::from_fn(|row| rows[(node - 1) * OUTPUTS + row]),
        })
    }

    /// Returns what the nonlinear parts see at the nodes.
    pub fn outputs(&self) -> &[[f64; OUTPUTS]; 4] {
        &self.outputs
    }

    /// Returns the values of the ports at the start.
    pub fn start_ports(&self) -> &[f64; PORTS] {
        &self.start
    }

    /// Returns the values of the ports at the stages, stage by stage.
    pub fn port_values(&self) -> &[f64; STAGES * PORTS] {
        &self.values
    }

    /// Returns friction's state at the stages.
    pub fn stage_friction(&self) -> &[FrictionState; STAGES] {
        &self.memory
    }

    /// Returns the values of the ports at the end.
    pub fn end_ports(&self) -> [f64; PORTS] {
        std::array::from_fn(|p| self.values[(STAGES - 1) * PORTS + p])
    }

    /// Returns the core's state at the end.
    pub fn end(&self) -> &[f64] {
        &self.result[STATE..STATE + self.order]
    }

    /// Returns the torque of the transmission's hysteresis at the nodes, N m, with the one before the step.
    pub fn gear_hysteresis(&self, before: &FrictionState) -> [f64; STAGES + 1] {
        std::array::from_fn(|node| if node == 0 { before.gear } else { self.memory[node - 1].gear })
    }

    /// Returns friction's state at the end.
    pub fn friction(&self) -> FrictionState {
        self.memory[STAGES - 1]
    }

    /// Returns the angles of motor and pivot to which friction has travelled at the end, rad.
    pub fn friction_angles(&self) -> [f64; 2] {
        self.travelled
    }

    /// Returns the bonds at the end.
    pub fn bonds(&self) -> &Bonds {
        &self.bonds
    }
}

/// The values that a step continues from beside the state of the plant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Continuation {
    /// Torques at motor and hub at the stages of the step before.
    pub before: [[f64; 2]; STAGES],
    /// Factor from the change in one iteration to that in the next.
    pub contraction: f64,
    /// The angle whose sine is known.
    pub about: NearbyAngle,
}

/// A continuation with the length of the step before; 0 at the start of a run.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Resumption {
    step_s: f64,
    from: Continuation,
    other: [f64; STAGES],
}

/// A step that is compiled for every width of registers.
struct Solution<'a, 'b> {
    attempt: &'a mut Attempt,
    given: &'a StepProblem<'b>,
}

impl pulp::NullaryFnOnce for Solution<'_, '_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        self.attempt.solve_inline(self.given)
    }
}

/// The torques at the inner nodes and at the end of the step before.
#[derive(Debug, Clone, Copy, Default)]
struct PreviousStep {
    step_s: f64,
    values: [[f64; 2]; STAGES],
    /// Weights for a step of the same length.
    same: [[f64; STAGES]; STAGES],
}

impl PreviousStep {
    fn keep(&mut self, step_s: f64, values: [[f64; 2]; STAGES]) {
        if self.step_s == 0.0 {
            self.same = extrapolation(1.0);
        }
        self.step_s = step_s;
        self.values = values;
    }

    /// Returns how far a torque went from its first inner node to the others.
    fn change(&self, port: usize) -> f64 {
        let [first, second, end] = self.values.map(|values| values[port]);
        (second - first).abs().max((end - first).abs())
    }

    /// Returns the weights of the values before for the change of the torques to each stage of a step.
    fn weights(&self, step_s: f64) -> [[f64; STAGES]; STAGES] {
        if self.step_s == 0.0 {
            [[0.0; STAGES]; STAGES]
        } else if step_s == self.step_s {
            self.same
        } else {
            extrapolation(step_s / self.step_s)
        }
    }
}

/// Returns the weights of the torques before for a step of the same length as the one before; see [`PreviousStep::weights`].
pub(crate) fn repeated_weights() -> [[f64; STAGES]; STAGES] {
    extrapolation(1.0)
}

/// Returns the parabola through the last three nodes of a step, at the stages of the next, less its end.
fn extrapolation(ratio: f64) -> [[f64; STAGES]; STAGES] {
    std::array::from_fn(|stage| {
        let at = 1.0 + ratio * NODES[stage + 1];
        std::array::from_fn(|k| {
            let others = (1..=STAGES).filter(|&j| j != k + 1);
            let cardinal: f64 = others.map(|j| (at - NODES[j]) / (NODES[k + 1] - NODES[j])).product();
            if k + 1 == STAGES { cardinal - 1.0 } else { cardinal }
        })
    })
}

/// Returns the largest change relative to the scales; NaN counts as large.
#[inline]
fn largest_change(new: &[f64], old: &[f64], scales: &[f64; PORTS]) -> f64 {
    let mut largest: f64 = 0.0;
    for (k, (a, b)) in new.iter().zip(old).enumerate() {
        let change = (a - b).abs() / scales[k % PORTS];
        largest = if change <= largest { largest } else { change };
    }
    largest
}
