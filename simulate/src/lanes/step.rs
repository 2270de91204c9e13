//! One step of a sample's length for several mechanisms at once.
//!
//! The step is that of [`crate::engine::attempt`], with the same operations in the same order in every lane. A lane in which anything happens
//! but a smooth step (an event, an iteration that does not converge, a defect that is too large) is refused: its state stays as it was, and
//! the engine of one mechanism takes it over the sample.

use super::nonlinear_parts::{LaneAngle, LaneMotion, LanePlatform, LanePoint, LanePorts, node_lengths};
use super::number::{LANES, Lane, LaneMask, Lanes, load_registers, store_registers};
use super::state::LaneState;
use super::table::{LaneTable, SEEN, distance, larger_magnitude};
use crate::engine::attempt::repeated_weights;
use crate::engine::linear_core::VOLTAGE;
use crate::engine::moments::{MIDDLE, NODES};
use crate::engine::tables::{FIXED_INPUTS, OUTPUTS, PORTS, STAGES};
use crate::tolerance::{
    ITERATION_SHARE, ITERATION_TOLERANCE, LEAST_CONTRACTION, NEAR_ANGLE_RAD, PORT_ROUNDING, PREDICTED, QUIET,
    STEP_ITERATIONS,
};
use counterpoise_models::Plant;
use counterpoise_models::friction::Real;
use pulp::Simd;

const PORT_COLUMNS: usize = STAGES * PORTS;
const WINDUP: usize = 1;
const HUB_ANGLE: usize = 2;

/// The values that stay the same from step to step.
#[derive(Debug, Clone)]
pub(crate) struct LaneSetup {
    pub table: LaneTable,
    pub ports: LanePorts,
    /// The loop's sensor over a sample: from its state and its input at the nodes to each state; `None` if it is ideal.
    pub gyro: Option<[[Lanes; 6]; 2]>,
    /// Half the gaps between the teeth, rad.
    pub half_gap: Lanes,
    /// Limits of the amplifiers' voltages, V.
    pub bus_v: Lanes,
    pub period_s: f64,
    pub tolerance: f64,
}

/// The inputs over the step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LaneInput<'a> {
    pub plants: [&'a Plant; LANES],
    /// Drives of the amplifiers, V.
    pub drive_v: &'a Lanes,
    /// The platforms at the nodes, then in the middle.
    pub platform: &'a [LanePlatform<Lanes>; STAGES + 2],
}

/// A step that is compiled for each kind of registers.
pub(crate) struct LaneStep<'a> {
    pub setup: &'a LaneSetup,
    pub state: &'a mut LaneState,
    pub work: &'a mut LaneWork,
    pub input: LaneInput<'a>,
}

/// The work space of a step.
#[derive(Debug, Clone)]
pub(crate) struct LaneWork {
    inputs: Vec<Lanes>,
    end: Vec<Lanes>,
    weights: [[f64; STAGES]; STAGES],
}

impl LaneWork {
    pub fn new(order: usize) -> Self {
        let zero = [0.0; LANES];
        Self { inputs: vec![zero; order + FIXED_INPUTS], end: vec![zero; order], weights: repeated_weights() }
    }
}

impl pulp::WithSimd for LaneStep<'_> {
    /// Lane by lane, whether the step was taken.
    type Output = [bool; LANES];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [bool; LANES] {
        let Self { setup, state, work, input } = self;
        let span = Span {
            simd,
            setup,
            ports: setup.ports.load_registers(simd),
            platform: platforms(simd, input.platform),
            about: near_angle(simd, state),
            input,
            friction: load_registers(simd, &state.friction),
        };
        let [outputs @ .., _, _] = load_registers(simd, &state.seen);
        let first = span.point(&outputs, 0);
        let motion = span.ports.motion(&first);
        let at_start = span.ports.values(&first, &motion, span.friction);
        state.dry_nm = store_registers(&span.ports.dry_torques(&motion, span.friction));
        span.fill_inputs(state, work, &at_start);
        let fixed = setup.table.fixed_outputs(simd, &work.inputs);
        setup.table.advance_state(simd, &work.inputs, &mut work.end);
        let guess = span.guess(state, work, outputs[HUB_ANGLE], &at_start);
        let motion = motion.at_angles(load_registers(simd, &state.travelled));
        let begin = IterationStart { outputs, motion, contraction: Lane::new(simd, state.contraction) };
        let tried = span.iterate_ports(&fixed, &begin, guess);
        setup.table.add_ports(simd, &tried.values, &mut work.end);
        let middle = setup.table.middle_outputs(simd, fixed[STAGES], &tried.values);
        let end = setup.table.outputs_at(simd, &work.end);
        let mut accepted = tried.converged & is_finite(simd, &work.end);
        accepted = accepted & tried.reach.is_at_most(span.splat(NEAR_ANGLE_RAD));
        accepted = accepted & span.is_free_of_events(&tried, &middle, &end, Lane::new(simd, state.offset_nm));
        if !(accepted & tried.predicted.invert()).is_nowhere() {
            let defect = span.defect(&tried, &middle, &at_start);
            accepted = accepted & (tried.predicted | defect.is_at_most(span.splat(setup.tolerance)));
            let reach = span.ports.reach(&span.about, middle[HUB_ANGLE]);
            accepted = accepted & reach.is_at_most(span.splat(NEAR_ANGLE_RAD));
        }
        span.commit(&tried, &end, accepted, state, &work.end);
        accepted.lanes()
    }
}

#[inline(always)]
fn platforms<S: Simd>(
    simd: S,
    at: &[LanePlatform<Lanes>; STAGES + 2],
) -> [LanePlatform<Lane<S>>; STAGES + 2] {
    let zero = Lane::splat(simd, 0.0);
    let mut platforms = [LanePlatform { angle: zero, rate: zero, heave: zero }; STAGES + 2];
    for (platform, at) in platforms.iter_mut().zip(at) {
        platform.angle = Lane::new(simd, at.angle);
        platform.rate = Lane::new(simd, at.rate);
        platform.heave = Lane::new(simd, at.heave);
    }
    platforms
}

/// Returns the angles whose sine is known, renewed where the hub has left their surroundings.
#[inline(always)]
fn near_angle<S: Simd>(simd: S, state: &LaneState) -> LaneAngle<Lane<S>> {
    let [mut angle, mut sin, mut cos] = state.about;
    let hub = Lane::new(simd, state.seen[HUB_ANGLE]);
    let limit = Lane::splat(simd, 0.5 * NEAR_ANGLE_RAD);
    let far = (hub - Lane::new(simd, angle)).abs().is_below(limit).invert();
    if !far.is_nowhere() {
        for lane in (0..LANES).filter(|lane| far.lanes()[*lane]) {
            angle[lane] = state.seen[HUB_ANGLE][lane];
            (sin[lane], cos[lane]) = angle[lane].sin_cos();
        }
    }
    LaneAngle { angle: Lane::new(simd, angle), sin: Lane::new(simd, sin), cos: Lane::new(simd, cos) }
}

#[inline(always)]
fn is_finite<S: Simd>(simd: S, core: &[Lanes]) -> LaneMask<S> {
    let zero = Lane::splat(simd, 0.0);
    let mut sum = zero;
    for value in core {
        // 0 unless the number is infinite or none
        sum = sum + Lane::new(simd, *value) * zero;
    }
    sum.is_zero()
}

/// A step, as everything that is evaluated along it sees it.
struct Span<'a, S: Simd> {
    simd: S,
    setup: &'a LaneSetup,
    ports: LanePorts<Lane<S>>,
    platform: [LanePlatform<Lane<S>>; STAGES + 2],
    about: LaneAngle<Lane<S>>,
    input: LaneInput<'a>,
    /// Dry friction at the start.
    friction: [Lane<S>; 2],
}

/// The result of a step.
struct LaneStepResult<S: Simd> {
    /// The inputs of the nonlinear parts at the nodes.
    outputs: [[Lane<S>; OUTPUTS]; STAGES + 1],
    /// The ports at the stages.
    values: [Lanes; PORT_COLUMNS],
    /// Dry friction at the first stage and at the end.
    friction: [[Lane<S>; 2]; 2],
    travelled: [Lane<S>; 2],
    contraction: Lane<S>,
    iterations: Lane<S>,
    /// Largest distance of a hub angle from the one whose sine is known, rad.
    reach: Lane<S>,
    converged: LaneMask<S>,
    /// The lanes in which the ports went on as in the step before.
    predicted: LaneMask<S>,
}

/// The result of one evaluation of the ports along the step.
struct PortEvaluation<S: Simd> {
    values: [Lane<S>; PORT_COLUMNS],
    friction: [[Lane<S>; 2]; 2],
    travelled: [Lane<S>; 2],
    reach: Lane<S>,
}

impl<S: Simd> Span<'_, S> {
    #[inline(always)]
    fn splat(&self, value: f64) -> Lane<S> {
        Lane::splat(self.simd, value)
    }

    #[inline(always)]
    fn point<'b>(&'b self, outputs: &'b [Lane<S>; OUTPUTS], node: usize) -> LanePoint<'b, S> {
        LanePoint {
            outputs,
            platform: &self.platform[node],
            about: &self.about,
            drive_v: self.input.drive_v,
            plants: self.input.plants,
        }
    }

    #[inline(always)]
    fn fill_inputs(&self, state: &LaneState, work: &mut LaneWork, at_start: &[Lane<S>; PORTS]) {
        let n = state.core.len();
        work.inputs[..n].copy_from_slice(&state.core);
        work.inputs[n] = *self.input.drive_v;
        work.inputs[n + 1] = state.offset_nm;
        for (input, at) in work.inputs[n + 2..n + 6].iter_mut().zip(self.input.platform) {
            *input = at.rate;
        }
        for (input, value) in work.inputs[n + 6..].iter_mut().zip(at_start) {
            *input = value.values();
        }
    }

    /// Returns the first values of the ports at the stages: the torques as the step before would go on, the load as the platform has it.
    #[inline(always)]
    fn guess(
        &self,
        state: &LaneState,
        work: &LaneWork,
        hub_angle: Lane<S>,
        at_start: &[Lane<S>; PORTS],
    ) -> [Lane<S>; PORT_COLUMNS] {
        let mut values = [self.splat(0.0); PORT_COLUMNS];
        let tilt = self.ports.tilt(&self.about, hub_angle);
        for stage in 0..STAGES {
            values[stage * PORTS + 2] = self.ports.load(tilt, self.platform[stage + 1].heave);
        }
        for p in 0..2 {
            let before = [state.before[0][p], state.before[1][p], state.before[2][p]];
            let [first, second, end] = load_registers(self.simd, &before);
            let change = (second - first).abs().max((end - first).abs());
            let quiet = change.is_below(self.splat(QUIET) * self.ports.scales[p]);
            for stage in 0..STAGES {
                let [a, b, c] = work.weights[stage];
                let inner = self.splat(a) * first + self.splat(b) * second + self.splat(c) * end;
                values[stage * PORTS + p] = quiet.select(at_start[p], at_start[p] + inner);
            }
        }
        values
    }

    /// Iterates on the ports until every lane has converged, or for as long as a step of one mechanism does.
    #[inline(always)]
    fn iterate_ports(
        &self,
        fixed: &[[Lane<S>; OUTPUTS]; STAGES + 1],
        begin: &IterationStart<S>,
        guess: [Lane<S>; PORT_COLUMNS],
    ) -> LaneStepResult<S> {
        let allowed = self.splat((ITERATION_SHARE * self.setup.tolerance).min(ITERATION_TOLERANCE));
        let foreseen = self.splat(self.setup.tolerance.min(PREDICTED));
        let mut last = self.splat(f64::INFINITY);
        let mut old = guess;
        let mut tried = LaneStepResult {
            outputs: [begin.outputs; STAGES + 1],
            values: store_registers(&guess),
            friction: [self.friction; 2],
            travelled: begin.motion.angles(),
            contraction: begin.contraction,
            iterations: self.splat(0.0),
            reach: self.splat(0.0),
            converged: allowed.is_above(allowed),
            predicted: allowed.is_above(allowed),
        };
        for iteration in 1..=STEP_ITERATIONS {
            let stages = self.setup.table.stage_outputs(self.simd, fixed, &tried.values);
            let along = self.ports_along(begin, &stages);
            let mut change = self.splat(0.0);
            for (k, (new, old)) in along.values.iter().zip(&old).enumerate() {
                change = larger_magnitude(change, distance(*new, *old, self.ports.scales[k % PORTS]));
            }
            tried.keep(&stages, &along, &mut old);
            tried.iterations = tried.converged.select(tried.iterations, self.splat(iteration as f64));
            if iteration == 1 {
                tried.predicted = change.is_below(foreseen);
            } else {
                let (least, most) = (self.splat(LEAST_CONTRACTION), self.splat(1.0));
                let ratio = (self.splat(2.0) * change / last).max(least).min(most);
                let clear = last.is_above(self.splat(PORT_ROUNDING)) & tried.converged.invert();
                tried.contraction = clear.select(ratio, tried.contraction);
            }
            let done = (change * tried.contraction).is_below(allowed);
            tried.converged = tried.converged | done;
            if tried.converged.invert().is_nowhere() {
                break;
            }
            last = change;
        }
        tried
    }

    /// Evaluates the ports along the step, friction from node to node.
    #[inline(always)]
    fn ports_along(
        &self,
        begin: &IterationStart<S>,
        stages: &[[Lane<S>; OUTPUTS]; STAGES],
    ) -> PortEvaluation<S> {
        let lengths = node_lengths(self.setup.period_s);
        let zero = self.splat(0.0);
        let (mut before, mut friction) = (begin.motion, self.friction);
        let mut along = PortEvaluation {
            values: [zero; PORT_COLUMNS],
            friction: [friction; 2],
            travelled: [zero; 2],
            reach: zero,
        };
        for stage in 0..STAGES {
            let at = self.point(&stages[stage], stage + 1);
            let after = self.ports.motion(&at);
            friction = self.ports.advance(&before, &after, self.splat(lengths[stage]), friction);
            let values = self.ports.values(&at, &after, friction);
            along.values[stage * PORTS..(stage + 1) * PORTS].copy_from_slice(&values);
            along.friction[usize::from(stage > 0)] = friction;
            along.reach =
                larger_magnitude(along.reach, self.ports.reach(&self.about, stages[stage][HUB_ANGLE]));
            before = after;
        }
        along.travelled = before.angles();
        along
    }

    /// Returns how far the ports in the middle are from the cubics through their nodes, relative to their scales.
    #[inline(always)]
    fn defect(
        &self,
        tried: &LaneStepResult<S>,
        middle: &[Lane<S>; OUTPUTS],
        at_start: &[Lane<S>; PORTS],
    ) -> Lane<S> {
        let before = self.ports.motion(&self.point(&tried.outputs[1], 1));
        let at = self.point(middle, STAGES + 1);
        let after = self.ports.motion(&at);
        let length = self.splat((0.5 - NODES[1]) * self.setup.period_s);
        let friction = self.ports.advance(&before, &after, length, tried.friction[0]);
        let found = self.ports.values(&at, &after, friction);
        let values = load_registers(self.simd, &tried.values);
        let mut worst = self.splat(0.0);
        for p in 0..PORTS {
            let mut expected = self.splat(MIDDLE[0]) * at_start[p];
            for stage in 0..STAGES {
                expected = expected + self.splat(MIDDLE[stage + 1]) * values[stage * PORTS + p];
            }
            worst = larger_magnitude(worst, distance(found[p], expected, self.ports.scales[p]));
        }
        worst
    }

    /// Returns where the teeth stay in touch at the nodes and in the middle, and the voltage below its limit at the end.
    #[inline(always)]
    fn is_free_of_events(
        &self,
        tried: &LaneStepResult<S>,
        middle: &[Lane<S>; OUTPUTS],
        end: &[Lane<S>; SEEN],
        offset_nm: Lane<S>,
    ) -> LaneMask<S> {
        let zero = self.splat(0.0);
        let half = Lane::new(self.simd, self.setup.half_gap);
        let has_gap = half.is_above(zero);
        let mut free = Lane::new(self.simd, self.setup.bus_v).is_above(end[VOLTAGE].abs());
        for node in 0..STAGES + 2 {
            let outputs = if node > STAGES { middle } else { &tried.outputs[node] };
            let margin = -offset_nm.signum() * outputs[WINDUP] - half;
            free = free & has_gap.select(margin, zero).is_at_least(zero);
        }
        free
    }

    /// Writes the end of the step where it was accepted.
    #[inline(always)]
    fn commit(
        &self,
        tried: &LaneStepResult<S>,
        end: &[Lane<S>; SEEN],
        accepted: LaneMask<S>,
        state: &mut LaneState,
        core: &[Lanes],
    ) {
        let shown = self.lane_readings(tried, state);
        for (place, value) in state.core.iter_mut().zip(core) {
            accepted.keep(place, Lane::new(self.simd, *value));
        }
        for (place, value) in state.seen.iter_mut().zip(end) {
            accepted.keep(place, *value);
        }
        for joint in 0..2 {
            accepted.keep(&mut state.friction[joint], tried.friction[1][joint]);
            accepted.keep(&mut state.travelled[joint], tried.travelled[joint]);
            accepted.keep(&mut state.gyro[joint], shown[joint]);
            for stage in 0..STAGES {
                let value = Lane::new(self.simd, tried.values[stage * PORTS + joint]);
                accepted.keep(&mut state.before[stage][joint], value);
            }
        }
        accepted.keep(&mut state.contraction, tried.contraction);
        accepted.keep(&mut state.about[0], self.about.angle);
        accepted.keep(&mut state.about[1], self.about.sin);
        accepted.keep(&mut state.about[2], self.about.cos);
        state.iterations = tried.iterations.values();
    }

    /// Returns what the loop's sensor shows at the end of the step, and its derivative.
    #[inline(always)]
    fn lane_readings(&self, tried: &LaneStepResult<S>, state: &LaneState) -> [Lane<S>; 2] {
        let mut felt = [self.splat(0.0); STAGES + 1];
        for (k, felt) in felt.iter_mut().enumerate() {
            *felt = self.ports.sensor_reading(&tried.outputs[k], &self.platform[k]);
        }
        let [a, b, c, d] = felt;
        let Some(rows) = &self.setup.gyro else { return [d, self.splat(0.0)] };
        let [shown, slope] = load_registers(self.simd, &state.gyro);
        let mut next = [shown, slope];
        for (next, row) in next.iter_mut().zip(rows) {
            let row = load_registers(self.simd, row);
            *next = row[0] * shown + row[1] * slope + row[2] * a + row[3] * b + row[4] * c + row[5] * d;
        }
        next
    }
}

/// The start of the iteration.
struct IterationStart<S: Simd> {
    outputs: [Lane<S>; OUTPUTS],
    /// The relative motions there, with the angles to which friction has travelled.
    motion: LaneMotion<S>,
    contraction: Lane<S>,
}

impl<S: Simd> LaneStepResult<S> {
    /// Keeps an evaluation in the lanes that had not converged before it; `old` are the values of the ports.
    #[inline(always)]
    fn keep(
        &mut self,
        stages: &[[Lane<S>; OUTPUTS]; STAGES],
        along: &PortEvaluation<S>,
        old: &mut [Lane<S>; PORT_COLUMNS],
    ) {
        let converged = self.converged;
        for stage in 0..STAGES {
            for k in 0..OUTPUTS {
                self.outputs[stage + 1][k] = converged.select(self.outputs[stage + 1][k], stages[stage][k]);
            }
        }
        for (place, value) in old.iter_mut().zip(&along.values) {
            *place = converged.select(*place, *value);
        }
        self.values = store_registers(old);
        for joint in 0..2 {
            for node in 0..2 {
                self.friction[node][joint] =
                    converged.select(self.friction[node][joint], along.friction[node][joint]);
            }
            self.travelled[joint] = converged.select(self.travelled[joint], along.travelled[joint]);
        }
        self.reach = converged.select(self.reach, larger_magnitude(self.reach, along.reach));
    }
}
