//! Rows over the core's states and inputs: which states exist, and the current and the motor's rate wherever they come from.
//!
//! The layout of the core is the same for every machine. A part that the machine lacks leaves its state at rest: its row and its
//! column are zero, and linear models leave it out. A rigid transmission has neither wind-up nor a motor of its own: the rotor
//! belongs to the hub, and the motor's rate is the hub's times the ratio. A current without an inductance follows from voltage
//! and speed; without a lag of the amplifier the voltage follows from its input.

use super::Plant;
use super::core::{input, state};
use crate::parameters::AmplifierDynamics;

impl Plant {
    /// Returns whether a state of the core exists in this machine and is that of a motor's mechanism: the spool of a valve, which has the place of
    /// the motor's rate, is not.
    pub fn has_mechanism_state(&self, index: usize) -> bool {
        self.has_state(index) && (index != state::MOTOR || !self.is_rigid())
    }

    /// Returns whether a state of the core ([`state`]) exists in this machine.
    pub fn has_state(&self, index: usize) -> bool {
        let (amplifier, motor) = (&self.parameters.amplifier, &self.parameters.motor);
        match (index, amplifier.dynamics) {
            (state::VOLTAGE, AmplifierDynamics::Modelled | AmplifierDynamics::IdealCurrent) => {
                amplifier.time_constant_s > 0.0
            }
            (state::VOLTAGE, _) => false,
            (state::CURRENT, dynamics) if dynamics.is_command() => false,
            (state::CURRENT, AmplifierDynamics::Modelled) => motor.inductance_h > 0.0,
            (state::MOTOR, _) => !self.is_rigid() || self.parameters.cylinder.is_some(),
            (state::WINDUP, _) => !self.is_rigid(),
            _ => true,
        }
    }

    /// Returns whether motor and hub turn as one body.
    #[inline]
    pub fn is_rigid(&self) -> bool {
        self.parameters.gearbox.is_rigid()
    }

    /// Returns the row c of the motor's rate: it is c x relative to a frame that turns with [`Plant::motor_share`] of the
    /// platform's rate.
    pub fn motor_rate_row(&self) -> Vec<f64> {
        if self.is_rigid() {
            let ratio = self.parameters.gearbox.ratio;
            return self.hub_rate_row().into_iter().map(|entry| ratio * entry).collect();
        }
        let mut row = vec![0.0; self.core_order()];
        row[state::MOTOR] = 1.0;
        row
    }

    /// Returns the share s of the platform's rate in the motor's: its rate relative to the platform is c x - s w_p, with the row c
    /// of [`Plant::motor_rate_row`].
    #[inline]
    pub fn motor_share(&self) -> f64 {
        if self.is_rigid() { self.parameters.gearbox.ratio } else { self.parameters.motor.platform_coupling }
    }

    /// Returns the row of the armature current over \[states, inputs\].
    pub fn current_row(&self) -> Vec<f64> {
        let n = self.core_order();
        let (amplifier, motor) = (&self.parameters.amplifier, &self.parameters.motor);
        let mut row = vec![0.0; n + input::COUNT];
        if self.has_state(state::CURRENT) {
            row[state::CURRENT] = 1.0;
            return row;
        }
        if amplifier.dynamics.is_command() {
            row[n + input::DRIVE] = amplifier.stall_gain_a_v(motor);
            return row;
        }
        let conductance = if self.has_state(state::VOLTAGE) {
            row[state::VOLTAGE] = 1.0 / motor.resistance_ohm;
            1.0 / motor.resistance_ohm
        } else {
            row[n + input::DRIVE] = amplifier.stall_gain_a_v(motor);
            1.0 / (motor.resistance_ohm + amplifier.gain * amplifier.current_feedback_v_a)
        };
        let braked = motor.back_emf_v_s_rad * conductance;
        for (entry, rate) in row.iter_mut().zip(self.motor_rate_row()) {
            *entry -= braked * rate;
        }
        row[n + input::PLATFORM_RATE] += braked * self.motor_share();
        row
    }

    /// Returns the current that a drive and the platform's rate add to that of the states, A: 0 if the current is a state.
    #[inline]
    pub fn direct_current_a(&self, drive_v: f64, platform_rate_rad_s: f64) -> f64 {
        self.direct_current[0] * drive_v + self.direct_current[1] * platform_rate_rad_s
    }

    /// Returns the entries of [`Plant::current_row`] for the drive and the platform's rate.
    pub(super) fn direct_current_of(&self) -> [f64; 2] {
        let (n, row) = (self.core_order(), self.current_row());
        [row[n + input::DRIVE], row[n + input::PLATFORM_RATE]]
    }

    /// Returns the change of the state per change of the platform's rate: the rotor of a rigid transmission turns against the
    /// platform, and its inertia then acts on the hub by ratio (ratio - coupling) J_m x the platform's acceleration.
    pub(super) fn carried_moments(&self) -> Vec<f64> {
        let mut carried = vec![0.0; self.core_order()];
        let (ratio, motor) = (self.parameters.gearbox.ratio, &self.parameters.motor);
        let torque = ratio * (ratio - motor.platform_coupling) * motor.inertia_kg_m2;
        if self.is_rigid() && torque != 0.0 {
            carried[state::RATE] = torque / self.body.inertia_kg_m2;
            for (k, mode) in self.body.modes.iter().enumerate() {
                carried[state::MODES + 2 * k + 1] = mode.hub_shape * torque;
            }
        }
        carried
    }

    /// Returns the sine and cosine that gravity sees at a hub angle; a linear axis has a constant weight.
    #[inline]
    pub fn tilt(&self, hub_angle_rad: f64) -> (f64, f64) {
        match self.parameters.axis {
            crate::AxisKind::Rotary => hub_angle_rad.sin_cos(),
            crate::AxisKind::Linear => (0.0, 1.0),
        }
    }
}
