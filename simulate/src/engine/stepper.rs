//! The steps within a sample: their choice, and the events of mesh and amplifier.

use super::attempt::{Attempt, Given, OutputRows};
use super::filter::Filter;
use super::ports::{AngleNearby, FrictionState, PlatformPoint, Point, Ports};
use super::tables::{LEVELS, StepTable, step_tables};
use crate::Error;
use crate::motion::MotionSample;
use counterpoise_models::plant::core::state;
use counterpoise_models::{Mesh, Plant};

/// How far below the tolerance the defect must be for the next step to be twice as long.
const LENGTHEN_BELOW: f64 = 1.0 / 64.0;
/// Shortest steps in a sample period.
const TICKS: u32 = 1 << LEVELS;

/// What moves: the states of the plant between samples.
#[derive(Debug, Clone, PartialEq)]
pub struct PlantState {
    /// States of the linear core, as [`counterpoise_models::plant::core::state`] has them.
    pub core: Vec<f64>,
    /// States of dry friction.
    pub friction: FrictionState,
    /// Hub gyroscope before its gain and bias: rate, rad/s, and its derivative.
    pub hub_gyro: [f64; 2],
}

/// How much work a run was, and whether any of it was done below the accuracy asked for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Effort {
    /// Steps taken.
    pub steps: usize,
    /// Steps tried and shortened.
    pub rejected: usize,
    /// Shortest steps that were taken although their error was above the tolerance: at events and jumps.
    pub forced: usize,
    /// Evaluations of the nonlinear parts along a step.
    pub iterations: usize,
}

/// Steps a plant from sample to sample.
#[derive(Debug, Clone)]
pub(crate) struct Stepper {
    plant: Plant,
    ports: Ports,
    rows: OutputRows,
    filter: Filter,
    period_s: f64,
    tables: [Option<Vec<StepTable>>; 4],
    attempt: Attempt,
    level: usize,
    tolerance: f64,
    pub effort: Effort,
}

/// The mode of the core.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Mode {
    mesh: Mesh,
    /// Torque of half the gap, N m.
    offset: f64,
    /// Sign of the bus limit at which the voltage is held; 0 where it is free.
    held: f64,
}

impl Mode {
    fn index(&self) -> usize {
        usize::from(self.mesh == Mesh::Free) + 2 * usize::from(self.held != 0.0)
    }
}

/// What came of a step that was tried.
enum Tried {
    Good { defect: f64 },
    Event { fraction: f64 },
    Rough,
}

/// The control and the platform over a sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample<'a> {
    pub drive_v: f64,
    pub start_s: f64,
    pub motion: &'a MotionSample,
}

impl Stepper {
    /// A stepper whose steps leave a defect of at most `tolerance`, relative to the ports' scales.
    pub fn new(plant: &Plant, period_s: f64, tolerance: f64) -> Result<Self, Error> {
        Ok(Self {
            plant: plant.clone(),
            ports: Ports::new(plant)?,
            rows: OutputRows::new(plant),
            filter: Filter::new(&plant.parameters().sensors.hub_gyro, period_s),
            period_s,
            tables: [None, None, None, None],
            attempt: Attempt::new(plant.core_order()),
            level: 0,
            tolerance,
            effort: Effort::default(),
        })
    }

    /// Forgets the work and the step size of the run before.
    pub fn restart(&mut self) {
        self.level = 0;
        self.attempt = Attempt::new(self.plant.core_order());
        self.effort = Effort::default();
    }

    /// Dry friction torques at the motor and at the pivot, N m.
    pub fn dry_torques(&self, x: &PlantState, platform: &PlatformPoint, time_s: f64) -> [f64; 2] {
        let outputs = self.rows.outputs(&x.core);
        let about = AngleNearby::new(outputs[2]);
        let point = Point { time_s, outputs: &outputs, platform, about: &about };
        self.ports.dry_torques(&self.plant, &point, &x.friction)
    }

    /// Moves the state over one sample period.
    pub fn advance(&mut self, x: &mut PlantState, sample: &Sample) {
        let mut tick = 0;
        while tick < TICKS {
            while (TICKS >> self.level) > TICKS - tick {
                self.level += 1;
            }
            let mode = self.mode(x, sample.drive_v);
            self.prepare(mode);
            match self.attempt(x, sample, tick, mode) {
                Tried::Good { defect } => {
                    self.commit(x, mode);
                    tick += TICKS >> self.level;
                    if defect < LENGTHEN_BELOW * self.tolerance && self.level > 0 {
                        self.level -= 1;
                    }
                }
                Tried::Event { fraction } => self.shorten_to(fraction),
                Tried::Rough => {
                    self.level += 1;
                    self.effort.rejected += 1;
                }
            }
        }
    }

    /// The mode at a state: the voltage is held where it is at the bus limit and pushed against it.
    fn mode(&self, x: &PlantState, drive_v: f64) -> Mode {
        let (mesh, offset) = self.plant.mesh(x.core[state::WINDUP]);
        let voltage = x.core[state::VOLTAGE];
        let at_limit = voltage.abs() >= self.plant.parameters().amplifier.bus_voltage_v;
        let pushed = self.voltage_push(&x.core, drive_v) * voltage > 0.0;
        Mode { mesh, offset, held: if at_limit && pushed { voltage.signum() } else { 0.0 } }
    }

    /// tau_a V', were the voltage free.
    fn voltage_push(&self, core: &[f64], drive_v: f64) -> f64 {
        let amplifier = &self.plant.parameters().amplifier;
        amplifier.gain * (drive_v - amplifier.current_feedback_v_a * core[state::CURRENT])
            - core[state::VOLTAGE]
    }

    fn prepare(&mut self, mode: Mode) {
        let slot = &mut self.tables[mode.index()];
        if slot.is_none() {
            *slot = Some(step_tables(&self.plant, mode.mesh, mode.held != 0.0, self.period_s));
        }
    }

    fn attempt(&mut self, x: &PlantState, sample: &Sample, tick: u32, mode: Mode) -> Tried {
        let Some(table) = self.tables[mode.index()].as_ref().map(|levels| &levels[self.level]) else {
            return Tried::Rough;
        };
        let (start, share) = (fraction(tick), fraction(TICKS >> self.level));
        let platform = sample.motion.span(start, share);
        let given = Given {
            plant: &self.plant,
            ports: &self.ports,
            table,
            core: &x.core,
            friction: &x.friction,
            held: [sample.drive_v, mode.offset],
            platform: &platform,
            time_s: sample.start_s + start * self.period_s,
        };
        let converged = self.attempt.solve(&given, &self.rows);
        self.effort.iterations += self.attempt.iterations;
        let defect = self.attempt.defect(&given) * share;
        let finest = self.level == LEVELS;
        let fine = converged && defect <= self.tolerance;
        self.effort.forced += usize::from(finest && !fine);
        if finest {
            return Tried::Good { defect };
        }
        if !converged {
            return Tried::Rough;
        }
        let event = self.mesh_event(mode).min(self.bus_event(mode, x, sample.drive_v));
        match (event <= 1.0, fine) {
            (true, _) => Tried::Event { fraction: event },
            (false, true) => Tried::Good { defect },
            (false, false) => Tried::Rough,
        }
    }

    /// Takes the step that was tried last.
    fn commit(&mut self, x: &mut PlantState, mode: Mode) {
        x.core.copy_from_slice(self.attempt.end());
        x.friction = self.attempt.friction();
        self.filter.advance(self.level, &mut x.hub_gyro, &self.attempt.hub_rate());
        let bus = self.plant.parameters().amplifier.bus_voltage_v;
        let voltage = &mut x.core[state::VOLTAGE];
        *voltage = if mode.held != 0.0 { mode.held * bus } else { voltage.clamp(-bus, bus) };
        self.attempt.accept(self.period_s * fraction(TICKS >> self.level));
        self.effort.steps += 1;
    }

    /// Chooses the longest step that ends before an event at a fraction of the one that was tried.
    fn shorten_to(&mut self, fraction: f64) {
        self.effort.rejected += 1;
        let limit = f64::from(TICKS >> self.level) * fraction;
        self.level += 1;
        while self.level < LEVELS && f64::from(TICKS >> self.level) > limit {
            self.level += 1;
        }
    }

    /// Fraction of the step at which the teeth part or meet; infinite if they do not.
    fn mesh_event(&self, mode: Mode) -> f64 {
        let half = 0.5 * self.plant.parameters().gearbox.backlash_rad;
        if half == 0.0 {
            return f64::INFINITY;
        }
        // positive while the mode holds
        let holds = |wind_up: f64| match mode.mesh {
            Mesh::Free => half - wind_up.abs(),
            Mesh::Touching => -mode.offset.signum() * wind_up - half,
        };
        let wind_up = self.attempt.wind_up();
        for pair in wind_up.windows(2) {
            let (before, after) = (holds(pair[0].1), holds(pair[1].1));
            if after < 0.0 {
                return crossing((pair[0].0, before), (pair[1].0, after));
            }
        }
        f64::INFINITY
    }

    /// Fraction of the step at which the voltage reaches or leaves the bus limit; infinite if it does not.
    fn bus_event(&self, mode: Mode, x: &PlantState, drive_v: f64) -> f64 {
        let end = self.attempt.end();
        let bus = self.plant.parameters().amplifier.bus_voltage_v;
        let holds = |core: &[f64]| {
            if mode.held == 0.0 {
                bus - core[state::VOLTAGE].abs()
            } else {
                mode.held * self.voltage_push(core, drive_v)
            }
        };
        let after = holds(end);
        if after >= 0.0 { f64::INFINITY } else { crossing((0.0, holds(&x.core)), (1.0, after)) }
    }
}

/// Ticks as a fraction of a sample.
fn fraction(ticks: u32) -> f64 {
    f64::from(ticks) / f64::from(TICKS)
}

/// Where the straight line between a value that holds and one below zero is zero.
fn crossing(before: (f64, f64), after: (f64, f64)) -> f64 {
    let from = before.1.max(0.0);
    before.0 + (after.0 - before.0) * from / (from - after.1)
}
