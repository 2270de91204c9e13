//! Four steppers that go through their samples together.

use super::nonlinear_parts::{LanePlatform, LanePorts};
use super::number::{LANES, Lanes};
use super::state::{LaneState, SmoothState};
use super::step::{LaneInput, LaneSetup, LaneStep, LaneWork};
use super::table::{LaneTable, SEEN};
use crate::engine::attempt::Continuation;
use crate::engine::linear_core::ModeOutputs;
use crate::engine::ports::{CommonParts, NearbyAngle, PlatformPoint};
use crate::engine::present_plant::{OrdinaryState, Sample};
use crate::engine::stepper::Stepper;
use crate::engine::tables::STAGES;
use crate::run::PlantSample;
use crate::scenario::Detail;
use crate::tolerance::FEWEST_LANES;
use counterpoise_models::friction::{DryFriction, FrictionModel};
use pulp::Simd;

/// Kind of registers that an ensemble uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Registers {
    /// The widest that the machine has and the engine is compiled for.
    Widest,
    /// None: one number after the other.
    Scalar,
}

/// What mechanisms must have in common to go through their samples together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LaneShape {
    period_s: f64,
    tolerance: f64,
    /// Numbers of states: of all, and of the leading block.
    order: [usize; 2],
    has_gyro: bool,
    parts: CommonParts,
    /// The laws of friction at motor and pivot, without their numbers.
    laws: [DryFriction; 2],
}

impl LaneShape {
    /// Returns the shape of a mechanism; `None` if it has a part that only runs alone have.
    pub fn of(stepper: &mut Stepper) -> Option<Self> {
        stepper.prepare_ordinary();
        let present = stepper.present_plant();
        let core = present.first_core();
        let [motor, pivot] = present.ports.frictions();
        let law = |model: &FrictionModel| {
            DryFriction::join([model]).map(|joined| joined.map_numbers(|_: [f64; 1]| 0.0))
        };
        (core.table(0).is_some() && !core.has_stuck_joint()).then_some(Self {
            period_s: stepper.period_s(),
            tolerance: stepper.tolerance(),
            order: [core.order(), core.leading_size()],
            has_gyro: stepper.filter().rows(0).is_some(),
            parts: present.ports.common_parts()?,
            laws: [law(motor)?, law(pivot)?],
        })
    }
}

/// Four mechanisms of one shape, as far as their samples are smooth.
#[derive(Debug, Clone)]
pub(crate) struct LaneGroup {
    setup: LaneSetup,
    state: LaneState,
    work: LaneWork,
    /// The mechanisms that are in their lanes; the others are in their steppers.
    present: [bool; LANES],
    core: Vec<f64>,
    registers: Registers,
}

impl LaneGroup {
    /// Returns a group of steppers; `None` if they are not of one shape.
    pub fn new(steppers: &mut [&mut Stepper; LANES], registers: Registers) -> Option<Self> {
        steppers.iter_mut().for_each(|stepper| stepper.prepare_ordinary());
        let all = steppers.each_ref().map(|stepper| &**stepper);
        let (period_s, tolerance) = (all[0].period_s(), all[0].tolerance());
        if all.iter().any(|stepper| stepper.period_s() != period_s || stepper.tolerance() != tolerance) {
            return None;
        }
        let present = all.map(Stepper::present_plant);
        let plants = present.map(|present| &present.plant);
        let table = LaneTable::new(present.map(|present| present.first_core()))?;
        let rows = all.map(|stepper| stepper.filter().rows(0));
        let gyro = match rows {
            [Some(a), Some(b), Some(c), Some(d)] => Some(std::array::from_fn(|row| {
                std::array::from_fn(|k| [a[row][k], b[row][k], c[row][k], d[row][k]])
            })),
            [None, None, None, None] => None,
            _ => return None,
        };
        Some(Self {
            state: LaneState::new(table.order),
            work: LaneWork::new(table.order),
            core: vec![0.0; table.order],
            setup: LaneSetup {
                ports: LanePorts::new(present.map(|present| &present.ports), plants)?,
                gyro,
                half_gap: plants.map(|plant| 0.5 * plant.parameters().gearbox.backlash_rad),
                bus_v: plants.map(|plant| plant.parameters().amplifier.bus_voltage_v),
                period_s,
                tolerance,
                table,
            },
            present: [false; LANES],
            registers,
        })
    }

    /// Moves the mechanisms over one sample; those without one are left where they are. Returns the dry friction torques at motor and
    /// pivot at its start, N m, of those that keep everything.
    pub fn advance(
        &mut self,
        steppers: &mut [&mut Stepper; LANES],
        samples: &[Option<Sample>; LANES],
        details: &[Detail; LANES],
    ) -> [Option<[f64; 2]>; LANES] {
        let mut dry_nm = [None; LANES];
        for lane in 0..LANES {
            match samples[lane] {
                Some(_) if !self.present[lane] => self.enter(lane, steppers[lane]),
                Some(_) => {}
                None => self.leave(lane, steppers[lane]),
            }
        }
        let mut taken = [false; LANES];
        if self.present.iter().filter(|present| **present).count() >= FEWEST_LANES {
            taken = self.step(steppers, samples);
        }
        for (lane, sample) in samples.iter().enumerate() {
            let Some(sample) = sample else { continue };
            let keeps = details[lane] == Detail::Everything;
            if taken[lane] && self.present[lane] {
                steppers[lane].count(1, self.state.iterations[lane] as usize);
                dry_nm[lane] = keeps.then(|| self.state.dry_nm.map(|torque| torque[lane]));
                continue;
            }
            self.leave(lane, steppers[lane]);
            dry_nm[lane] = keeps.then(|| steppers[lane].dry_torques(sample));
            steppers[lane].advance(sample);
        }
        dry_nm
    }

    /// Returns what a mechanism shows.
    pub fn outputs_of(&self, lane: usize, stepper: &Stepper) -> PlantSample {
        if !self.present[lane] {
            return PlantSample::of(stepper);
        }
        let [outputs @ .., voltage, tip_rate] = self.state.seen.map(|values| values[lane]);
        PlantSample { outputs, voltage_and_tip: [voltage, tip_rate], hub_gyro: self.state.gyro[0][lane] }
    }

    /// Puts a mechanism into its stepper.
    pub fn leave(&mut self, lane: usize, stepper: &mut Stepper) {
        if !std::mem::take(&mut self.present[lane]) {
            return;
        }
        let state = self.state.take(lane, &mut self.core);
        let mut seen = ModeOutputs::default();
        seen[..SEEN].copy_from_slice(&state.seen);
        let at = OrdinaryState {
            core: state.core,
            seen: &seen,
            friction: state.friction,
            travelled: state.travelled,
            gyro: state.gyro,
            offset_nm: state.offset_nm,
        };
        let about = NearbyAngle::from_parts(state.about);
        stepper
            .go_on_from(&at, &Continuation { before: state.before, contraction: state.contraction, about });
    }

    /// Puts a mechanism into its lane, if its next step may be smooth.
    fn enter(&mut self, lane: usize, stepper: &Stepper) {
        let Some((at, from)) = stepper.smooth() else { return };
        let state = SmoothState {
            core: at.core,
            seen: std::array::from_fn(|k| at.seen[k]),
            friction: at.friction,
            travelled: at.travelled,
            gyro: at.gyro,
            before: from.before,
            contraction: from.contraction,
            about: from.about.parts(),
            offset_nm: at.offset_nm,
        };
        self.state.put(lane, &state);
        self.present[lane] = true;
    }

    /// Tries a step of a whole sample in every lane; returns in which it was taken.
    fn step(&mut self, steppers: &[&mut Stepper; LANES], samples: &[Option<Sample>; LANES]) -> [bool; LANES] {
        let drive_v = samples.map(|sample| sample.map_or(0.0, |sample| sample.drive_v));
        let platform = platforms(samples);
        let step = LaneStep {
            setup: &self.setup,
            state: &mut self.state,
            work: &mut self.work,
            input: LaneInput {
                plants: steppers.each_ref().map(|stepper| &stepper.present_plant().plant),
                drive_v: &drive_v,
                platform: &platform,
            },
        };
        self.registers.run(step)
    }
}

impl Registers {
    /// Runs a step in these registers.
    fn run(self, step: LaneStep) -> [bool; LANES] {
        match (self, pulp::Arch::new()) {
            #[cfg(target_arch = "x86_64")]
            (Self::Widest, pulp::Arch::V3(simd)) => Simd::vectorize(simd, step),
            _ => Simd::vectorize(pulp::Scalar256b, step),
        }
    }
}

/// Returns the platforms at the nodes of the sample and in its middle; mechanisms on one platform share its motion.
fn platforms(samples: &[Option<Sample>; LANES]) -> [LanePlatform<Lanes>; STAGES + 2] {
    let zero = [0.0; LANES];
    let mut all = [LanePlatform { angle: zero, rate: zero, heave: zero }; STAGES + 2];
    let mut before: Option<(&Sample, [PlatformPoint; STAGES + 2])> = None;
    for (lane, sample) in samples.iter().enumerate() {
        let Some(sample) = sample else { continue };
        let points = match &before {
            Some((other, points)) if std::ptr::eq(other.motion, sample.motion) => *points,
            _ => {
                let span = sample.motion.span(0.0, 1.0);
                let [a, b, c, d] = span.nodes;
                [a, b, c, d, span.middle]
            }
        };
        before = Some((sample, points));
        for (at, point) in all.iter_mut().zip(points) {
            at.angle[lane] = point.angle;
            at.rate[lane] = point.rate;
            at.heave[lane] = point.heave;
        }
    }
    all
}
