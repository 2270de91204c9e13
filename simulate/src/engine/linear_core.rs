//! The linear core in one of its modes: which equations hold while the teeth touch or not, the voltage is at its limit
//! or not, and either joint sticks or not.

use super::modal_transform::modal;
use super::moments::{Moments, NODES};
use super::strips::{NARROW, Strips};
use super::tables::{DEEPEST, LEVELS, OUTPUTS, PORTS, STAGES, StepTable};
use counterpoise_linalg::Mat;
use counterpoise_models::plant::Core;
use counterpoise_models::plant::core::{input, state};
use counterpoise_models::{Mesh, Plant};

/// Motor state, wind-up, hub angle, hub rate, current; amplifier voltage, tip rate; nothing.
pub(crate) type ModeOutputs = [f64; NARROW];

/// Index of the voltage among what is seen.
pub(crate) const VOLTAGE: usize = OUTPUTS;
/// Index of the tip rate among what is seen.
pub(crate) const TIP: usize = OUTPUTS + 1;

/// Returns what the nonlinear parts see of it.
pub(crate) fn outputs(seen: &ModeOutputs) -> &[f64; OUTPUTS] {
    seen.first_chunk().unwrap_or(&[0.0; OUTPUTS])
}

/// The mode of the core.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mode {
    pub mesh: Mesh,
    /// Torque of half the gap, N m.
    pub offset: f64,
    /// Sign of the bus limit at which the voltage is held; 0 if it is free.
    pub held: f64,
    /// `true` if the motor's and if the pivot's friction sticks.
    pub stuck: [bool; 2],
}

impl Mode {
    /// Number of cores.
    pub const COUNT: usize = 16;

    /// Returns the index of the core of this mode.
    pub fn index(&self) -> usize {
        usize::from(self.mesh == Mesh::Free)
            + 2 * usize::from(self.held != 0.0)
            + 4 * usize::from(self.stuck[0])
            + 8 * usize::from(self.stuck[1])
    }
}

/// The torque that a joint's friction must have for the joint to stay at rest:
/// `T = row z + inputs u - inertia x (its rate relative to the platform's acceleration)`.
#[derive(Debug, Clone)]
pub(crate) struct Hold {
    pub row: Vec<f64>,
    pub inputs: [f64; input::COUNT],
    /// Places of the ports among them.
    pub ports: [usize; PORTS],
    /// Torque per angular acceleration of the platform, kg m^2.
    pub platform: f64,
}

/// x' = A x + B u in one mode, in coordinates z in which A is a block and pairs on the diagonal.
#[derive(Debug, Clone)]
pub(crate) struct ModeDynamics {
    pub(super) blocks: Vec<Block>,
    firsts: Vec<usize>,
    n: usize,
    /// The coordinates z; `None` if they are the physical state itself.
    coordinates: Option<Coordinates>,
    /// Rows of the inputs of the nonlinear parts, from z.
    pub outputs: Mat,
    /// That, the voltage and the rate of the tip, stored for products.
    seen: Strips,
    /// z per platform rate that joints at rest carry.
    pub carried: Vec<f64>,
    /// Torques that hold the joints; for any mode, stuck or not.
    pub holds: [Hold; 2],
    /// Joints that stick.
    pub stuck: [bool; 2],
    /// Change of z that changes the joints' rates by one, as an impulse on the joint does.
    pub pushes: [Vec<f64>; 2],
    /// Inputs of the core that the nonlinear parts give.
    pub port_inputs: [usize; PORTS],
    /// Change of z that changes the voltage by one.
    pub lift: Vec<f64>,
    pub(super) coarse: Chain,
    pub(super) deep: Option<Chain>,
    pub(super) period_s: f64,
    pub(super) tables: Vec<Option<StepTable>>,
}

/// A diagonal block of the core, and its rows of the input matrix.
#[derive(Debug, Clone)]
pub(super) struct Block {
    A: Mat,
    B: Mat,
}

/// x = V z and z = W x.
#[derive(Debug, Clone)]
struct Coordinates {
    V: Mat,
    W: Mat,
}

/// The moments of all blocks at times that double.
#[derive(Debug, Clone)]
pub(super) struct Chain {
    finest: f64,
    /// For the first and second inner node and for the middle of each step, and the end of the last: time by time, block by block.
    nodes: [Vec<Vec<Moments>>; 3],
}

impl Chain {
    pub(super) fn new(blocks: &[Block], finest: f64, count: usize) -> Self {
        let family = |fraction: f64, count: usize| {
            let families: Vec<Vec<Moments>> = blocks
                .iter()
                .map(|block| Moments::family(&block.A, &block.B, finest * fraction, count))
                .collect();
            (0..count).map(|k| families.iter().map(|family| family[k].clone()).collect()).collect()
        };
        Self { finest, nodes: [family(NODES[1], count), family(NODES[2], count), family(0.5, count + 1)] }
    }

    pub(super) fn span(&self, k: usize) -> Span<'_> {
        let [first, second, middle] = &self.nodes;
        Span {
            step_s: self.finest * f64::from(1u32 << k),
            nodes: [&first[k], &second[k], &middle[k + 1], &middle[k]],
        }
    }
}

/// The moments of one step at its nodes.
pub(crate) struct Span<'a> {
    pub step_s: f64,
    nodes: [&'a [Moments]; STAGES + 1],
}

impl Span<'_> {
    /// The middle of the step among its nodes.
    pub const MIDDLE: usize = STAGES + 1;

    /// Returns the moments of the blocks at node 1, 2, 3 (the end), or in the middle.
    pub fn at(&self, node: usize) -> &[Moments] {
        self.nodes[node - 1]
    }
}

impl ModeDynamics {
    /// Returns the core of a plant in a mode, for steps of a sample period and its halves.
    pub fn new(plant: &Plant, mode: &Mode, period_s: f64) -> Self {
        let (mut linear, core, others) = Self::without_chain(plant, mode, period_s);
        linear.take_apart(core, &others);
        linear.add_chain()
    }

    /// Returns the same with the physical state as its coordinates, however many states there are.
    pub fn with_physical_coordinates(plant: &Plant, mode: &Mode, period_s: f64) -> Self {
        let (mut linear, core, _) = Self::without_chain(plant, mode, period_s);
        linear.keep_together(core);
        linear.add_chain()
    }

    /// Returns the core without blocks and moments, its equations, and the rows of what is seen beside the outputs.
    fn without_chain(plant: &Plant, mode: &Mode, period_s: f64) -> (Self, Core, Mat) {
        let mut core = plant.core(mode.mesh);
        if mode.held != 0.0 {
            hold_voltage(&mut core);
        }
        let joints = joints(plant);
        let holds = [0, 1].map(|k| joints[k].hold(&core, plant.port_inputs()));
        let pushes = [0, 1].map(|k| joints[k].push(&core));
        let mut carried = core.carried.clone();
        if carried.iter().any(|c| *c != 0.0) {
            carry(&mut core, &carried);
        }
        for (joint, _) in joints.iter().zip(mode.stuck).filter(|(_, stuck)| *stuck) {
            joint.stick(&mut core, &mut carried);
        }
        let n = core.A.nrows();
        let outputs = output_rows(plant);
        let others = Mat::from_rows(&[unit(n, state::VOLTAGE), plant.tip_rate_row()]);
        let linear = Self {
            blocks: Vec::new(),
            firsts: Vec::new(),
            n,
            coordinates: None,
            seen: Strips::new(&outputs.vstack(&others)),
            outputs,
            carried,
            holds,
            stuck: mode.stuck,
            pushes,
            port_inputs: plant.port_inputs(),
            lift: unit(n, state::VOLTAGE),
            coarse: Chain { finest: 0.0, nodes: [Vec::new(), Vec::new(), Vec::new()] },
            deep: None,
            period_s,
            tables: vec![None; DEEPEST + 1],
        };
        (linear, core, others)
    }

    fn add_chain(mut self) -> Self {
        let finest = self.period_s / f64::from(1u32 << LEVELS);
        self.coarse = Chain::new(&self.blocks, finest, LEVELS + 1);
        self
    }

    /// Takes the core as one block.
    fn keep_together(&mut self, core: Core) {
        self.blocks = vec![Block { A: core.A, B: core.B }];
        self.firsts = vec![0];
    }

    /// Changes to coordinates in which the core falls apart into blocks, if there are any and they save work.
    fn take_apart(&mut self, core: Core, others: &Mat) {
        let Some(modal) = modal(&core.A) else { return self.keep_together(core) };
        let column = |v: &[f64]| (&modal.W * &Mat::col(v)).column(0).to_vec();
        self.carried = column(&self.carried);
        self.lift = column(&self.lift);
        self.pushes = [0, 1].map(|k| column(&self.pushes[k]));
        for hold in &mut self.holds {
            hold.row = (&Mat::row(&hold.row) * &modal.V).row_vec(0);
        }
        self.seen = Strips::new(&(&self.outputs.vstack(others) * &modal.V));
        self.outputs = &self.outputs * &modal.V;
        let B = &modal.W * &core.B;
        let mut first = 0;
        for block in modal.blocks {
            let size = block.nrows();
            self.firsts.push(first);
            self.blocks.push(Block { A: block, B: B.block(first, 0, size, B.ncols()) });
            first += size;
        }
        self.coordinates = Some(Coordinates { V: modal.V, W: modal.W });
    }

    /// Returns the number of states.
    pub fn order(&self) -> usize {
        self.n
    }

    /// Returns what is seen at z: what the nonlinear parts see, then voltage and rate of the tip.
    pub fn outputs_at(&self, z: &[f64]) -> ModeOutputs {
        let mut seen = [0.0; NARROW];
        self.seen.multiply_add(z, &mut seen);
        seen
    }

    /// Returns an entry of the matrix from z to what is seen.
    pub fn output_entry(&self, row: usize, column: usize) -> f64 {
        self.seen.entry(row, column)
    }

    /// Returns whether a joint sticks.
    pub fn has_stuck_joint(&self) -> bool {
        self.stuck != [false; 2]
    }

    /// Returns the physical state at z.
    pub fn physical_state(&self, z: &[f64]) -> Vec<f64> {
        let coordinates = self.coordinates.as_ref();
        coordinates.map_or_else(|| z.to_vec(), |to| (&to.V * &Mat::col(z)).column(0).to_vec())
    }

    /// Returns the coordinates z of a physical state.
    pub fn coordinates(&self, x: &[f64]) -> Vec<f64> {
        let coordinates = self.coordinates.as_ref();
        coordinates.map_or_else(|| x.to_vec(), |to| (&to.W * &Mat::col(x)).column(0).to_vec())
    }

    /// Returns the slopes of z over an input of the core.
    pub fn input_column(&self, input: usize) -> Vec<f64> {
        self.blocks.iter().flat_map(|block| block.B.column(input).to_vec()).collect()
    }

    /// Returns the number of blocks.
    pub fn blocks(&self) -> usize {
        self.blocks.len()
    }

    /// Returns the first state of a block.
    pub fn first_state(&self, block: usize) -> usize {
        self.firsts[block]
    }

    /// Returns the size of the block before the pairs.
    pub fn leading_size(&self) -> usize {
        self.blocks[0].A.nrows()
    }

    /// Returns the table of a level that `ModeDynamics::prepare` has made.
    pub fn table(&self, level: usize) -> Option<&StepTable> {
        self.tables[level].as_ref()
    }
}

/// A joint between a body and the platform.
struct Joint {
    /// The rate of its body: rate = row x.
    row: Vec<f64>,
    port: usize,
    /// Share of the platform's rate that its body has at rest.
    share: f64,
}

fn joints(plant: &Plant) -> [Joint; 2] {
    [
        Joint { row: plant.motor_rate_row(), port: input::MOTOR_TORQUE, share: plant.motor_share() },
        Joint { row: plant.hub_rate_row(), port: input::HUB_TORQUE, share: 1.0 },
    ]
}

impl Joint {
    /// Acceleration of the joint's body per torque on it, 1/(kg m^2).
    fn mobility(&self, core: &Core) -> f64 {
        dot(&self.row, core.B.column(self.port))
    }

    /// Change of the state that changes the joint's rate by one.
    fn push(&self, core: &Core) -> Vec<f64> {
        core.B.column(self.port).iter().map(|b| b / self.mobility(core)).collect()
    }

    fn hold(&self, core: &Core, ports: [usize; PORTS]) -> Hold {
        let inertia = 1.0 / self.mobility(core);
        let row = (0..core.A.ncols()).map(|j| inertia * dot(&self.row, core.A.column(j))).collect();
        let inputs = std::array::from_fn(|j| inertia * dot(&self.row, core.B.column(j)));
        Hold { row, inputs, ports, platform: inertia * (self.share - dot(&self.row, &core.carried)) }
    }

    /// Takes the joint's freedom from the core. With x = y + carried w_p the rate of y at the joint is zero:
    /// y' = P (A y + B u + A carried w_p), P = I - b c / (c b).
    fn stick(&self, core: &mut Core, carried: &mut [f64]) {
        let push = self.push(core);
        let share = self.share - dot(&self.row, carried);
        let mine: Vec<f64> = push.iter().map(|p| p * share).collect();
        carry(core, &mine);
        carried.iter_mut().zip(&mine).for_each(|(all, mine)| *all += mine);
        for M in [&mut core.A, &mut core.B] {
            for j in 0..M.ncols() {
                let along = dot(&self.row, M.column(j));
                M.column_mut(j).iter_mut().zip(&push).for_each(|(entry, p)| *entry -= along * p);
            }
        }
    }
}

/// With x = y + c w_p the platform's rate drives y by A c.
fn carry(core: &mut Core, c: &[f64]) {
    for i in 0..c.len() {
        let drawn: f64 = (0..c.len()).map(|j| core.A[(i, j)] * c[j]).sum();
        core.B[(i, input::PLATFORM_RATE)] += drawn;
    }
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn unit(n: usize, k: usize) -> Vec<f64> {
    (0..n).map(|j| f64::from(u8::from(j == k))).collect()
}

/// Returns what the nonlinear parts see, from the physical state: with a cylinder the valve's opening in place of the wind-up, which it has not.
fn output_rows(plant: &Plant) -> Mat {
    let n = plant.core_order();
    let mut current = plant.current_row();
    current.truncate(n);
    let rows: [Vec<f64>; OUTPUTS] = [
        plant.motor_rate_row(),
        unit(n, if plant.parameters().cylinder.is_some() { state::VOLTAGE } else { state::WINDUP }),
        plant.hub_angle_row(),
        plant.hub_rate_row(),
        current,
    ];
    Mat::from_rows(&rows)
}

/// The amplifier's voltage at its limit: it neither follows the drive nor relaxes.
fn hold_voltage(core: &mut Core) {
    for M in [&mut core.A, &mut core.B] {
        for j in 0..M.ncols() {
            M[(state::VOLTAGE, j)] = 0.0;
        }
    }
}
