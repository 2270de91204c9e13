//! The state of the plant within a run, and the linear cores of the modes in which it has been so far.

use super::attempt::{Attempt, HeldInputs, StepProblem};
use super::linear_core::{Mode, ModeDynamics, ModeOutputs, TIP, VOLTAGE, outputs};
use super::ports::{
    Bonds, FrictionState, FurtherPoint, NearbyAngle, PlatformPoint, PlatformSpan, Point, Ports,
};
use super::state::PlantState;
use super::tables::{OUTPUTS, PORTS, StepTable};
use crate::Error;
use crate::motion::MotionSample;
use counterpoise_models::{Mesh, Plant};

/// The control and the platform over a sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample<'a> {
    pub drive_v: f64,
    pub start_s: f64,
    pub motion: &'a MotionSample,
}

/// The instant at which a joint is looked at.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Instant {
    pub platform: PlatformPoint,
    /// `None` if the platform only heaves and pitches.
    pub further: Option<FurtherPoint>,
    /// Pitch acceleration of the platform, rad/s^2.
    pub acceleration: f64,
    pub time_s: f64,
    pub drive_v: f64,
    /// Torque of half the gap, N m.
    pub offset: f64,
}

impl Instant {
    /// Returns what the ports see at this instant beside some outputs of the core.
    pub fn point<'a>(&'a self, outputs: &'a [f64; OUTPUTS], about: &'a NearbyAngle) -> Point<'a> {
        Point {
            time_s: self.time_s,
            outputs,
            platform: &self.platform,
            further: self.further.as_ref(),
            drive_v: self.drive_v,
            about,
        }
    }
}

/// The mode of a plant whose teeth touch, whose voltage is free and whose joints do not stick.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OrdinaryState<'a> {
    /// State of the core in its coordinates.
    pub core: &'a [f64],
    pub seen: &'a ModeOutputs,
    /// Dry friction at motor and pivot.
    pub friction: [f64; 2],
    /// Angles of motor and pivot to which friction has travelled, rad.
    pub travelled: [f64; 2],
    /// The loop's sensor: what it shows, and its derivative.
    pub gyro: [f64; 2],
    /// Torque of half the gap, N m.
    pub offset_nm: f64,
}

/// The state of the plant, with all that its next step needs to know of it.
#[derive(Debug, Clone)]
pub(crate) struct PresentPlant {
    pub plant: Plant,
    pub ports: Ports,
    /// Turns of each joint per turn of the hub.
    pub turns: [f64; 2],
    /// Changes of joints that truly stick since the start.
    pub changes: usize,
    period_s: f64,
    /// The cores that were needed so far, the one at hand first of them all at the start.
    cores: Vec<ModeDynamics>,
    index: [Option<usize>; Mode::COUNT],
    core: usize,
    z: Vec<f64>,
    seen: ModeOutputs,
    friction: FrictionState,
    bonds: Bonds,
    /// Angles of motor and pivot to which friction has travelled, rad; those of the core at the start.
    travelled: Option<[f64; 2]>,
    /// The loop's sensor: what it shows, and its derivative.
    pub hub_gyro: [f64; 2],
    answers: HubAnswers,
}

/// The answers of a core's states to a torque on the hub over a sample, at its nodes.
#[derive(Debug, Clone, Default)]
struct HubAnswers {
    /// The core to which they belong.
    core: Option<usize>,
    rows: Vec<[f64; 4]>,
}

impl PresentPlant {
    /// Returns a plant with all states at 0.
    pub fn new(plant: &Plant, period_s: f64) -> Result<Self, Error> {
        let mode = Mode { mesh: Mesh::Touching, offset: 0.0, held: 0.0, stuck: [false; 2] };
        let mut index = [None; Mode::COUNT];
        index[mode.index()] = Some(0);
        Ok(Self {
            plant: plant.clone(),
            ports: Ports::new(plant)?,
            turns: [plant.parameters().gearbox.ratio, 1.0],
            changes: 0,
            period_s,
            cores: vec![ModeDynamics::new(plant, &mode, period_s)],
            index,
            core: 0,
            z: vec![0.0; plant.core_order()],
            seen: ModeOutputs::default(),
            friction: FrictionState::default(),
            bonds: Bonds::default(),
            travelled: None,
            hub_gyro: [0.0; 2],
            answers: HubAnswers::default(),
        })
    }

    /// Begins a run in a state.
    pub fn restart(&mut self, start: &PlantState) {
        self.changes = 0;
        self.z = self.linear().coordinates(&start.core);
        self.seen = self.linear().outputs_at(&self.z);
        self.friction = start.friction;
        self.bonds = start.bonds.clone();
        self.travelled = None;
        self.hub_gyro = start.hub_gyro;
    }

    /// Adds the answer to a torque on the hub over a whole sample that has just been taken: the cubic through its values at the nodes.
    pub fn add_hub_torque(&mut self, torque_nm: &[f64; 4]) {
        let Self { cores, core, z, seen, travelled, answers, .. } = self;
        let linear = &cores[*core];
        let Some(table) = linear.table(0) else { return };
        if answers.core != Some(*core) {
            answers.rows = (0..z.len()).map(|row| table.hub_answers(row)).collect();
            answers.core = Some(*core);
        }
        for (z, [a, b, c, d]) in z.iter_mut().zip(&answers.rows) {
            *z += a * torque_nm[0] + b * torque_nm[1] + c * torque_nm[2] + d * torque_nm[3];
        }
        let before = *seen;
        *seen = linear.outputs_at(z);
        if let Some([motor, pivot]) = travelled {
            let hub = seen[2] - before[2];
            *pivot += hub;
            *motor += self.turns[0] * (seen[1] - before[1] + hub);
        }
    }

    /// Writes where the plant is.
    pub fn save(&self, to: &mut Place) {
        to.core = self.core;
        to.z.clone_from(&self.z);
        to.bonds.copy(&self.bonds);
        (to.seen, to.friction, to.travelled) = (self.seen, self.friction, self.travelled);
        (to.hub_gyro, to.changes) = (self.hub_gyro, self.changes);
    }

    /// Puts the plant back to a place that was saved in the same run.
    pub fn restore(&mut self, from: &Place) {
        self.core = from.core;
        self.z.clone_from(&from.z);
        self.bonds.copy(&from.bonds);
        (self.seen, self.friction, self.travelled) = (from.seen, from.friction, from.travelled);
        (self.hub_gyro, self.changes) = (from.hub_gyro, from.changes);
    }

    /// Returns the state of the plant.
    pub fn state(&self) -> PlantState {
        PlantState {
            core: self.linear().physical_state(&self.z),
            friction: self.friction,
            bonds: self.bonds.clone(),
            hub_gyro: self.hub_gyro,
        }
    }

    /// Returns whether the motion is still finite.
    pub fn is_finite(&self) -> bool {
        self.z.iter().all(|x| x.is_finite())
    }

    /// Returns the core that every run begins with: the teeth touch, the voltage is free, no joint sticks.
    pub fn first_core(&self) -> &ModeDynamics {
        &self.cores[0]
    }

    /// Makes the table of a whole sample of that core, if it is not there yet.
    pub fn prepare_ordinary(&mut self) {
        self.cores[0].prepare(0);
    }

    /// Returns the state of the core in its coordinates, dry friction and its travel, if the mode is that of [`Self::first_core`] and the
    /// voltage below its limit.
    pub fn ordinary_state(&self) -> Option<OrdinaryState<'_>> {
        let (mesh, offset_nm) = self.plant.mesh(self.seen[1]);
        let is_ordinary =
            self.core == 0 && mesh == Mesh::Touching && self.seen[VOLTAGE].abs() < self.bus_voltage_v();
        let travelled = self.travelled.filter(|_| is_ordinary)?;
        Some(OrdinaryState {
            core: &self.z,
            seen: &self.seen,
            friction: [self.friction.motor, self.friction.pivot],
            travelled,
            gyro: self.hub_gyro,
            offset_nm,
        })
    }

    /// Goes on from a state in the mode of [`Self::first_core`].
    pub fn go_on_from(&mut self, from: &OrdinaryState) {
        self.core = 0;
        self.z.copy_from_slice(from.core);
        self.seen = *from.seen;
        [self.friction.motor, self.friction.pivot] = from.friction;
        self.travelled = Some(from.travelled);
        self.hub_gyro = from.gyro;
    }

    /// Returns what is seen: motor state, wind-up, hub angle, hub rate, current; voltage, rate of the tip.
    pub fn all_outputs(&self) -> &ModeOutputs {
        &self.seen
    }

    /// Returns the motor state, wind-up, hub angle, hub rate, current.
    pub fn outputs(&self) -> &[f64; OUTPUTS] {
        outputs(&self.seen)
    }

    /// Returns the voltage of the amplifier and rate of the tip.
    pub fn voltage_and_tip(&self) -> [f64; 2] {
        [self.seen[VOLTAGE], self.seen[TIP]]
    }

    /// Returns the core of the mode that was entered last.
    pub fn linear(&self) -> &ModeDynamics {
        &self.cores[self.core]
    }

    /// Returns the state of the core in its coordinates.
    pub fn core(&self) -> &[f64] {
        &self.z
    }

    /// Returns the angles of motor and pivot to which friction has travelled, rad; `None` before the first step of a run.
    pub fn friction_travel(&self) -> Option<[f64; 2]> {
        self.travelled
    }

    /// Returns the states of dry friction.
    pub fn friction(&self) -> &FrictionState {
        &self.friction
    }

    /// Sets the state of a joint's friction.
    pub fn set_friction(&mut self, joint: usize, value: f64) {
        self.changes += usize::from(self.friction.get(joint) != value);
        self.friction.set(joint, value);
    }

    /// Brings a joint to rest: takes its rate relative to the platform by an impulse.
    pub fn stop_joint(&mut self, joint: usize, rate: f64) {
        let Self { cores, core, z, seen, .. } = self;
        let linear = &cores[*core];
        z.iter_mut().zip(&linear.pushes[joint]).for_each(|(z, push)| *z -= rate * push);
        *seen = linear.outputs_at(z);
    }

    /// Returns the values of the ports where the plant is.
    pub fn ports_at(&self, at: &Instant) -> [f64; PORTS] {
        let about = NearbyAngle::new(self.seen[2]);
        self.ports.at(&self.plant, &at.point(self.outputs(), &about), &self.friction)
    }

    /// Returns the dry friction torques at the motor and at the pivot where the plant is, N m; 0 for joints at rest.
    pub fn dry_torques(&self, at: &Instant) -> [f64; 2] {
        let about = NearbyAngle::new(self.seen[2]);
        self.ports.dry_torques(&self.plant, &at.point(self.outputs(), &about), &self.friction)
    }

    /// Returns the instant at a fraction of a sample.
    pub fn instant(&self, sample: &Sample, part: f64, mode: &Mode) -> Instant {
        Instant {
            platform: sample.motion.at(part),
            further: sample.motion.further_at(part),
            acceleration: sample.motion.pitch_acceleration_at(part),
            time_s: sample.start_s + part * self.period_s,
            drive_v: sample.drive_v,
            offset: mode.offset,
        }
    }

    /// Returns the mode at the state: the voltage is held while it is at the bus limit and pushed against it.
    pub fn mode(&self, drive_v: f64) -> Mode {
        let (mesh, offset) = self.plant.mesh(self.seen[1]);
        let voltage = self.seen[VOLTAGE];
        let at_limit = voltage.abs() >= self.bus_voltage_v();
        let pushed = at_limit && self.voltage_push(&self.seen, drive_v) * voltage > 0.0;
        let stuck = [0, 1].map(|j| self.ports.sticks(j) && self.friction.get(j) == 0.0);
        Mode { mesh, offset, held: if pushed { voltage.signum() } else { 0.0 }, stuck }
    }

    /// Returns tau_a V' as it would be with a free voltage, V.
    pub fn voltage_push(&self, seen: &ModeOutputs, drive_v: f64) -> f64 {
        let amplifier = &self.plant.parameters().amplifier;
        amplifier.gain * (drive_v - amplifier.current_feedback_v_a * seen[4]) - seen[VOLTAGE]
    }

    /// Returns the limit of the amplifier's voltage, V.
    pub fn bus_voltage_v(&self) -> f64 {
        self.plant.parameters().amplifier.bus_voltage_v
    }

    /// Makes the mode's core the one at hand, with the table of the level.
    pub fn enter(&mut self, mode: &Mode, level: usize) {
        let core = match self.index[mode.index()] {
            Some(core) => core,
            None => {
                self.cores.push(ModeDynamics::new(&self.plant, mode, self.period_s));
                self.index[mode.index()] = Some(self.cores.len() - 1);
                self.cores.len() - 1
            }
        };
        if core != self.core {
            let physical = self.linear().physical_state(&self.z);
            self.core = core;
            self.z = self.linear().coordinates(&physical);
        }
        self.cores[core].prepare(level);
    }

    /// Returns the input of a step from here.
    pub fn start_step<'a>(&'a self, table: &'a StepTable, step: &StepInput<'a>) -> StepProblem<'a> {
        StepProblem {
            plant: &self.plant,
            ports: &self.ports,
            table,
            core: &self.z,
            friction: &self.friction,
            bonds: &self.bonds,
            travelled: self.travelled,
            outputs: *self.outputs(),
            held: step.held,
            platform: step.platform,
            time_s: step.time_s,
            tolerance: step.tolerance,
        }
    }

    /// Takes the step that was tried last, at whose end `ahead` is seen.
    pub fn take(&mut self, attempt: &Attempt, ahead: &ModeOutputs, mode: &Mode) {
        self.z.copy_from_slice(attempt.end());
        self.friction = attempt.friction();
        self.bonds.copy(attempt.bonds());
        self.seen = *ahead;
        self.travelled = Some(attempt.friction_angles());
        let bus = self.bus_voltage_v();
        let voltage = self.seen[VOLTAGE];
        let wanted = if mode.held != 0.0 { mode.held * bus } else { voltage.clamp(-bus, bus) };
        if wanted != voltage {
            let Self { cores, core, z, seen, .. } = self;
            let linear = &cores[*core];
            z.iter_mut().zip(&linear.lift).for_each(|(z, lift)| *z += lift * (wanted - voltage));
            *seen = linear.outputs_at(z);
        }
    }
}

/// The state of a plant at an instant of a run: what changes along it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Place {
    core: usize,
    z: Vec<f64>,
    seen: ModeOutputs,
    friction: FrictionState,
    bonds: Bonds,
    travelled: Option<[f64; 2]>,
    hub_gyro: [f64; 2],
    changes: usize,
}

/// The inputs of a step besides the present.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepInput<'a> {
    /// Inputs that are constant over the step.
    pub held: HeldInputs,
    /// The platform along the step.
    pub platform: &'a PlatformSpan,
    /// Start of the step, s.
    pub time_s: f64,
    /// Defect that is allowed.
    pub tolerance: f64,
}
