//! The plant's linear core: everything but dry friction, gravity's angle, the gap and the static amplifier map.

use super::Plant;
use crate::parameters::{AmplifierDynamics, IDEAL_LAG_S};
use counterpoise_linalg::Mat;

/// Index of each state of the core, the same for every machine (see [`Plant::has_state`]); the modes follow from [`state::MODES`] on as pairs (q, q').
pub mod state {
    /// Amplifier voltage V, V.
    pub const VOLTAGE: usize = 0;
    /// Armature current i, A.
    pub const CURRENT: usize = 1;
    /// Motor speed dtheta_m/dt + s dtheta_p/dt, rad/s (s: the motor's platform coupling); with a hydraulic cylinder, whose piston moves with the
    /// hub, the rate of the valve's opening, L/s^2.
    pub const MOTOR: usize = 2;
    /// Gear wind-up delta = theta_m / N + theta_p - theta_h, rad.
    pub const WINDUP: usize = 3;
    /// Angle of the rigid rotation theta_r, rad, inertial.
    pub const ANGLE: usize = 4;
    /// Rate of the rigid rotation, rad/s, inertial.
    pub const RATE: usize = 5;
    /// First of the pairs (q_k, q_k') of the flexible modes.
    pub const MODES: usize = 6;
}

/// Index of each input of the core.
pub mod input {
    /// Drive of the linear amplifier, V, after limit, dead zone and map.
    pub const DRIVE: usize = 0;
    /// Platform pitch rate, rad/s.
    pub const PLATFORM_RATE: usize = 1;
    /// Torque on the motor shaft, N m, beside those of current, gear and viscous friction.
    pub const MOTOR_TORQUE: usize = 2;
    /// Torque on the hub, N m, beside those of gear and viscous friction.
    pub const HUB_TORQUE: usize = 3;
    /// Load G = (g + a_p) cos theta_h, m/s^2, which acts on every mass.
    pub const LOAD: usize = 4;
    /// Torque added to the gear's, N m: raises the hub, brakes the motor.
    pub const MESH_TORQUE: usize = 5;
    /// Flow into a hydraulic cylinder beside that of the linear valve, L/s.
    pub const FLOW: usize = 6;
    /// Number of states.
    pub const COUNT: usize = 7;
}

/// Contact state of the gear's teeth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Mesh {
    /// The mesh is a spring and a damper on the wind-up.
    Touching,
    /// Inside the gap: no torque passes.
    Free,
}

/// x' = A x + B u + c w_p' with the layouts [`state`] and [`input`].
#[derive(Debug, Clone, PartialEq)]
pub struct Core {
    /// State matrix.
    pub A: Mat,
    /// Input matrix.
    pub B: Mat,
    /// c: change of the state per change of the platform's rate w_p; zeros unless a rigid transmission turns a rotor.
    pub carried: Vec<f64>,
}

impl Plant {
    /// Returns the number of states of the linear core.
    pub fn core_order(&self) -> usize {
        state::MODES + 2 * self.body.modes.len()
    }

    /// Returns the linear core with the teeth touching or apart:
    ///
    /// ```text
    ///     tau_a V'  = -V + K_v (v - K_ifb i)                   L i' = V - R i - K_e w_m
    ///     J_m (w_m + s w_p)' = K_t i - F_v w_m + T_x - T_2 / N     T_2 = K_gb delta + D_gb delta' + T_mesh
    ///     delta'    = w_m / N + w_p - w_h
    ///     J w_r'    = T_hub - mu G,   q'' + 2 zeta w q' + w^2 q = phi T_hub - p G
    ///     T_hub     = T_2 - F_v (w_h - w_p) + T_y
    /// ```
    ///
    /// T_x, T_y, T_mesh, G are the inputs. With an ideal current source the first line is t i' = v K_v / (R + K_v K_ifb) - i with
    /// t = [`IDEAL_LAG_S`], and the voltage stays 0. Half the gap is not subtracted here: it enters by T_mesh.
    ///
    /// With a rigid transmission the rotor is part of the structure, and T_2 = N (K_t i - F_v w_m + T_x) acts on it, with
    /// w_m = N (w_h - w_p). A hydraulic cylinder has the same equations with a valve of second order in place of the voltage's lag. A lag or an inductance of 0 leaves its state out: see [`Plant::current_row`].
    pub fn core(&self, mesh: Mesh) -> Core {
        let n = self.core_order();
        let mut core =
            Core { A: Mat::zeros(n, n), B: Mat::zeros(n, input::COUNT), carried: self.carried_moments() };
        self.electrical_rows(&mut core);
        self.mechanical_rows(&mut core, mesh);
        core
    }

    /// Returns the row c of the hub rate: w_h = c x.
    pub fn hub_rate_row(&self) -> Vec<f64> {
        self.body_row(1, |mode| mode.hub_shape)
    }

    /// Returns the row c of the tip rate: w_t = c x.
    pub fn tip_rate_row(&self) -> Vec<f64> {
        self.body_row(1, |mode| mode.tip_shape)
    }

    /// Returns the row c of the hub angle: theta_h = c x.
    pub fn hub_angle_row(&self) -> Vec<f64> {
        self.body_row(0, |mode| mode.hub_shape)
    }

    fn body_row(&self, derivative: usize, shape: impl Fn(&super::BodyMode) -> f64) -> Vec<f64> {
        let mut row = vec![0.0; self.core_order()];
        row[state::ANGLE + derivative] = 1.0;
        for (k, mode) in self.body.modes.iter().enumerate() {
            row[state::MODES + 2 * k + derivative] = shape(mode);
        }
        row
    }

    fn electrical_rows(&self, core: &mut Core) {
        let amplifier = &self.parameters.amplifier;
        if self.has_state(state::VOLTAGE) && self.parameters.cylinder.is_none() {
            core.A[(state::VOLTAGE, state::VOLTAGE)] = -1.0 / amplifier.time_constant_s;
        }
        match amplifier.dynamics {
            AmplifierDynamics::Modelled => self.armature_rows(core),
            AmplifierDynamics::IdealCurrent => self.current_source(core, IDEAL_LAG_S),
            AmplifierDynamics::CurrentLoop { bandwidth_rad_s, .. } => {
                self.current_source(core, 1.0 / bandwidth_rad_s);
            }
            AmplifierDynamics::TorqueCommand | AmplifierDynamics::CurrentCommand => {}
        }
    }

    /// The current follows the drive with a lag.
    fn current_source(&self, core: &mut Core, lag_s: f64) {
        core.A[(state::CURRENT, state::CURRENT)] = -1.0 / lag_s;
        let gain = self.parameters.amplifier.stall_gain_a_v(&self.parameters.motor);
        core.B[(state::CURRENT, input::DRIVE)] = gain / lag_s;
    }

    /// The voltage with its lag, and the current through the inductance; each only if it is a state.
    fn armature_rows(&self, core: &mut Core) {
        let (amplifier, motor) = (&self.parameters.amplifier, &self.parameters.motor);
        let rate = 1.0 / amplifier.time_constant_s;
        if let Some(cylinder) = &self.parameters.cylinder {
            self.valve_rows(core, cylinder);
        } else if self.has_state(state::VOLTAGE) {
            for (j, entry) in self.current_row().into_iter().enumerate().filter(|(_, entry)| *entry != 0.0) {
                add(core, state::VOLTAGE, j, -rate * amplifier.gain * amplifier.current_feedback_v_a * entry);
            }
            core.B[(state::VOLTAGE, input::DRIVE)] = rate * amplifier.gain;
        }
        if !self.has_state(state::CURRENT) {
            return;
        }
        let per_henry = 1.0 / motor.inductance_h;
        core.A[(state::CURRENT, state::CURRENT)] = -motor.resistance_ohm * per_henry;
        if self.has_state(state::VOLTAGE) {
            core.A[(state::CURRENT, state::VOLTAGE)] = per_henry;
        } else {
            core.A[(state::CURRENT, state::CURRENT)] -=
                amplifier.gain * amplifier.current_feedback_v_a * per_henry;
            core.B[(state::CURRENT, input::DRIVE)] = amplifier.gain * per_henry;
        }
        for (j, turns) in self.motor_rate_row().into_iter().enumerate().filter(|(_, turns)| *turns != 0.0) {
            core.A[(state::CURRENT, j)] = -motor.back_emf_v_s_rad * per_henry * turns;
        }
        core.B[(state::CURRENT, input::PLATFORM_RATE)] =
            motor.back_emf_v_s_rad * self.motor_share() * per_henry;
    }

    fn mechanical_rows(&self, core: &mut Core, mesh: Mesh) {
        if self.is_rigid() {
            let hub_torque = self.hub_torque_row(&self.rigid_torque_row());
            return self.body_rows(core, &hub_torque);
        }
        let n = self.core_order();
        let wind_up_rate = self.wind_up_rate_row();
        for j in 0..n + input::COUNT {
            set(core, state::WINDUP, j, wind_up_rate[j]);
        }
        let mesh_torque = self.mesh_torque_row(mesh, &wind_up_rate);
        let hub_torque = self.hub_torque_row(&mesh_torque);
        self.motor_row(core, &mesh_torque);
        self.body_rows(core, &hub_torque);
    }

    /// The motor's torque at the output of a rigid transmission, less its viscous friction, as a row over [states, inputs].
    fn rigid_torque_row(&self) -> Vec<f64> {
        let (n, ratio) = (self.core_order(), self.parameters.gearbox.ratio);
        let viscous = ratio * self.parameters.motor_friction.viscous_nm_s_rad;
        let constant = ratio * self.parameters.motor.torque_constant_nm_a;
        let mut row: Vec<f64> = self.current_row().iter().map(|entry| constant * entry).collect();
        for (entry, rate) in row.iter_mut().zip(self.motor_rate_row()) {
            *entry -= viscous * rate;
        }
        row[n + input::PLATFORM_RATE] += viscous * self.motor_share();
        row[n + input::MOTOR_TORQUE] = ratio;
        row
    }

    /// delta' as a row over [states, inputs].
    fn wind_up_rate_row(&self) -> Vec<f64> {
        let (n, ratio) = (self.core_order(), self.parameters.gearbox.ratio);
        let mut row: Vec<f64> = self.hub_rate_row().iter().map(|entry| -entry).collect();
        row[state::MOTOR] += 1.0 / ratio;
        row.resize(n + input::COUNT, 0.0);
        row[n + input::PLATFORM_RATE] = 1.0 - self.parameters.motor.platform_coupling / ratio;
        row
    }

    fn mesh_torque_row(&self, mesh: Mesh, wind_up_rate: &[f64]) -> Vec<f64> {
        let gearbox = &self.parameters.gearbox;
        let mut row = vec![0.0; wind_up_rate.len()];
        if mesh == Mesh::Touching {
            row.iter_mut().zip(wind_up_rate).for_each(|(r, w)| *r = gearbox.damping_nm_s_rad * w);
            row[state::WINDUP] += gearbox.stiffness_nm_rad;
        }
        row[self.core_order() + input::MESH_TORQUE] = 1.0;
        row
    }

    fn hub_torque_row(&self, mesh_torque: &[f64]) -> Vec<f64> {
        let (n, viscous) = (self.core_order(), self.parameters.pivot_friction.viscous_nm_s_rad);
        let mut row = mesh_torque.to_vec();
        for (entry, hub) in row.iter_mut().zip(self.hub_rate_row()) {
            *entry -= viscous * hub;
        }
        row[n + input::PLATFORM_RATE] += viscous;
        row[n + input::HUB_TORQUE] = 1.0;
        row
    }

    fn motor_row(&self, core: &mut Core, mesh_torque: &[f64]) {
        let (n, motor) = (self.core_order(), &self.parameters.motor);
        let viscous = self.parameters.motor_friction.viscous_nm_s_rad;
        let mut row: Vec<f64> = mesh_torque.iter().map(|t| -t / self.parameters.gearbox.ratio).collect();
        for (entry, current) in row.iter_mut().zip(self.current_row()).filter(|(_, current)| *current != 0.0)
        {
            *entry += motor.torque_constant_nm_a * current;
        }
        row[state::MOTOR] -= viscous;
        row[n + input::PLATFORM_RATE] += viscous * motor.platform_coupling;
        row[n + input::MOTOR_TORQUE] += 1.0;
        for (j, entry) in row.iter().enumerate() {
            set(core, state::MOTOR, j, entry / motor.inertia_kg_m2);
        }
    }

    fn body_rows(&self, core: &mut Core, hub_torque: &[f64]) {
        let body = &self.body;
        core.A[(state::ANGLE, state::RATE)] = 1.0;
        for (j, torque) in hub_torque.iter().enumerate() {
            set(core, state::RATE, j, torque / body.inertia_kg_m2);
        }
        core.B[(state::RATE, input::LOAD)] = -body.out_of_balance_kg_m / body.inertia_kg_m2;
        for (k, mode) in body.modes.iter().enumerate() {
            let (q, dq) = (state::MODES + 2 * k, state::MODES + 2 * k + 1);
            core.A[(q, dq)] = 1.0;
            for (j, torque) in hub_torque.iter().enumerate() {
                set(core, dq, j, mode.hub_shape * torque);
            }
            core.A[(dq, q)] -= mode.frequency_rad_s.powi(2);
            core.A[(dq, dq)] -= 2.0 * mode.damping_ratio * mode.frequency_rad_s;
            core.B[(dq, input::LOAD)] = -mode.load_share_kg_m;
        }
    }
}

/// Adds to entry `j` of a row over [states, inputs].
fn add(core: &mut Core, row: usize, j: usize, value: f64) {
    let n = core.A.nrows();
    let before = if j < n { core.A[(row, j)] } else { core.B[(row, j - n)] };
    set(core, row, j, if before == 0.0 { value } else { before + value });
}

/// Writes entry `j` of a row over [states, inputs].
fn set(core: &mut Core, row: usize, j: usize, value: f64) {
    let n = core.A.nrows();
    if j < n {
        core.A[(row, j)] = value;
    } else {
        core.B[(row, j - n)] = value;
    }
}
