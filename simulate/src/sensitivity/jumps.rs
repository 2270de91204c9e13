//! The jumps of the derivatives at events.
//!
//! At an event whose instant t depends on the state, the state's slope goes from f- to f+, and the derivatives jump by (f- - f+) dt (the
//! saltation of an event: M. di Bernardo et al., Piecewise-smooth Dynamical Systems, 2008, chapter 2). With g the quantity that is zero at
//! the event, dt = -dg / g'. What jumps here is one acceleration alone, so that the state jumps along the answer to an impulse:
//!
//! ```text
//!     a joint comes to rest           dx+ = dx- - push dw                   w  rate of the joint, a its acceleration
//!     it slides on the other way      dx+ = dx- - push dw (1 - a+ / a-)
//!     it leaves the band at rest      the same with d(w - band)
//!     teeth meet or part              dx+ = dx- +- (mesh input) D dg        D  damping of the mesh, g wind-up beyond the gap
//!     the voltage meets its limit     dV+ = d(limit)
//! ```
//!
//! A joint that breaks away without a jump of its torque, and a voltage that leaves its limit, jump nothing. An event at the start of a
//! sample, where the control steps, has a fixed instant.

use super::block::{Block, add_multiple};
use super::refusal::SensitivityRefusal;
use super::step_slopes::PlantSlopes;
use crate::engine::linear_core::Mode;
use crate::engine::ports::dry_torque;
use crate::engine::present_plant::Instant;
use crate::engine::stepper::TakenStep;
use crate::engine::tables::OUTPUTS;
use crate::tolerance::GRAZING;
use counterpoise_models::Mesh;
use counterpoise_models::friction::Law;
use counterpoise_models::plant::core::{input, state};

/// Rows of the joints' rates among what is seen.
const MOTOR_RATE: usize = 0;
const HUB_RATE: usize = 3;

/// The discrete state of a plant over its last step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DiscreteState {
    mode: Mode,
    /// States of friction that truly sticks.
    joints: [f64; 2],
}

impl DiscreteState {
    /// Returns the discrete state of a step.
    pub fn of(step: &TakenStep) -> Self {
        let friction = step.present.friction();
        let joints = [0, 1].map(|j| if step.present.ports.sticks(j) { friction.get(j) } else { 0.0 });
        Self { mode: *step.mode, joints }
    }
}

impl PlantSlopes {
    /// Carries the derivatives over the events between the last step and one that is about to be taken from a physical state.
    pub fn jump(
        &mut self,
        before: &DiscreteState,
        step: &TakenStep,
        at: &Instant,
        x: &[f64],
    ) -> Result<(), SensitivityRefusal> {
        let now = DiscreteState::of(step);
        if before.joints == now.joints && before.mode == now.mode {
            return Ok(());
        }
        let is_within = step.part.start > 0.0;
        let joints = [0, 1].map(|j| before.joints[j] != now.joints[j]);
        let teeth = before.mode.mesh != now.mode.mesh;
        let meets = now.mode.held != 0.0 && now.mode.held != before.mode.held;
        let events = joints.iter().filter(|one| **one).count() + usize::from(teeth) + usize::from(meets);
        if events > 1 && is_within {
            return Err(SensitivityRefusal::Simultaneous { time_s: at.time_s });
        }
        self.tables.prepare(step.mode, step.level, &self.machine.families);
        if teeth {
            self.jump_at_teeth(&now.mode, x);
        }
        if meets {
            let row = self.state.core.row_mut(state::VOLTAGE);
            row.fill(0.0);
            add_multiple(row, now.mode.held, &self.machine.slopes.bus_v);
        }
        for joint in 0..2 {
            if joints[joint] {
                self.jump_at_joint(joint, before, step, at, x)?;
            }
        }
        Ok(())
    }

    /// Teeth meet or part: with a damped mesh its torque jumps.
    fn jump_at_teeth(&mut self, mode: &Mode, x: &[f64]) {
        let Some(dynamics) = self.tables.dynamics(mode) else { return };
        let damping = self.machine.plant.parameters().gearbox.damping_nm_s_rad;
        let mut beyond = self.state.core.row(state::WINDUP).to_vec();
        add_multiple(&mut beyond, -x[state::WINDUP].signum(), &self.machine.slopes.half_gap);
        let sense = if mode.mesh == Mesh::Touching { damping } else { -damping };
        for (row, answer) in dynamics.input_column(input::MESH_TORQUE).into_iter().enumerate() {
            self.state.core.add(row, sense * answer, &beyond);
        }
    }

    /// A joint comes to rest, breaks away, reverses or leaves its band.
    fn jump_at_joint(
        &mut self,
        joint: usize,
        before: &DiscreteState,
        step: &TakenStep,
        at: &Instant,
        x: &[f64],
    ) -> Result<(), SensitivityRefusal> {
        let (was, is) = (before.joints[joint], step.present.friction().get(joint));
        if was == 0.0 {
            return self.check_breakaway(joint);
        }
        let mut rate = self.rate_slopes(joint, at.platform.rate, x);
        let mut share = 1.0;
        if is != 0.0 {
            if was.signum() == is.signum() {
                add_multiple(&mut rate, -was.signum(), &self.machine.slopes.bands[joint]);
            }
            share = self.acceleration_share(joint, [was, is], step, at)?;
        }
        let Some(dynamics) = self.tables.dynamics(step.mode) else { return Ok(()) };
        for (row, push) in dynamics.pushes[joint].iter().enumerate() {
            self.state.core.add(row, -push * share, &rate);
        }
        Ok(())
    }

    /// A joint that breaks away jumps nothing unless its torque does.
    fn check_breakaway(&self, joint: usize) -> Result<(), SensitivityRefusal> {
        let parameters = self.machine.plant.parameters();
        let friction = [&parameters.motor_friction, &parameters.pivot_friction][joint];
        match counterpoise_models::friction::FrictionModel::new(friction).map(|model| *model.law()) {
            Ok(Law::Sliding(law)) if law.breakaway_ratio > 1.0 && law.rest_rate_rad_s == 0.0 => {
                Err(SensitivityRefusal::Jump { law: "Coulomb's law with a breakaway level" })
            }
            _ => Ok(()),
        }
    }

    /// Returns the derivatives of a joint's rate relative to the platform, at a physical state.
    fn rate_slopes(&self, joint: usize, platform_rate: f64, x: &[f64]) -> Vec<f64> {
        let mut seen = Block::new(OUTPUTS + 1, self.width());
        self.seen_slopes(x, &mut seen);
        let mut rate = seen.row([MOTOR_RATE, HUB_RATE][joint]).to_vec();
        if joint == 0 {
            add_multiple(&mut rate, -platform_rate, &self.machine.slopes.coupling);
        }
        rate
    }

    /// Returns 1 - a+ / a- of a joint that slides on with another torque.
    fn acceleration_share(
        &self,
        joint: usize,
        [was, is]: [f64; 2],
        step: &TakenStep,
        at: &Instant,
    ) -> Result<f64, SensitivityRefusal> {
        let present = step.present;
        let model = present.ports.frictions()[joint];
        let rate = present.ports.rates(present.outputs(), at.platform.rate)[joint];
        let [torque_before, torque_after] = [was, is].map(|state| dry_torque(model, rate, 1.0, state));
        // the ports hold the torque that acts now
        let mut ports = present.ports_at(at);
        ports[joint] += torque_after;
        let held = present.load(joint, present.core(), &ports, at).torque_nm;
        let (a_before, a_after) = (held - torque_before, held - torque_after);
        if a_before.abs() < GRAZING * (held.abs() + torque_before.abs()) {
            let event = "a joint that changes its direction or leaves its band";
            return Err(SensitivityRefusal::Grazing { time_s: at.time_s, event });
        }
        Ok(1.0 - a_after / a_before)
    }
}
