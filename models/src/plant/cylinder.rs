//! A hydraulic cylinder in place of motor and gear: what the valve's orifices and a lever that follows the angle add to the linear core.
//!
//! ```text
//!     o'' = w^2 (K u - o) - 2 d w o'                       spool, as the flow that it passes without load
//!     V/(4 b) p' = Q(o, p) - C p - A r(phi) phi'           H. Merritt 1967, equation 6-10
//!     T = r(phi) (A p + F)                                 F: friction of the seals
//! ```
//!
//! p is the load pressure, the difference between both sides; the core has Q = o, and r at the angle 0.

use super::core::{Core, input, state};
use super::impedance::Impedance;
use super::{Equilibrium, OperatingPoint, Plant};
use crate::parameters::Parameters;
use crate::parameters::cylinder::{Cylinder, LeverPoint};

/// The cylinder at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CylinderPoint {
    /// Opening of the valve: its flow without load and overlap, L/s.
    pub opening_l_s: f64,
    /// Load pressure, MPa.
    pub pressure_mpa: f64,
    /// Hub angle on the platform, rad.
    pub angle_rad: f64,
    /// Hub rate on the platform, rad/s.
    pub rate_rad_s: f64,
    /// Force on the piston beside pressure and viscous friction, N.
    pub force_n: f64,
}

/// Rows that a cylinder adds to the linear core.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CylinderParts {
    /// Into the cylinder, L/s.
    pub flow_l_s: f64,
    /// On the hub, N m.
    pub hub_nm: f64,
}

impl Parameters {
    /// Returns the largest torque with which the drive can hold the hub at rest, at the angle 0 of the hub on the platform, N m: that of the supply
    /// pressure with a cylinder, of the current limit with a motor.
    pub fn largest_hold_nm(&self) -> f64 {
        let largest = self.cylinder.as_ref().map_or(self.amplifier.current_limit_a, |it| it.supply_mpa);
        self.gearbox.ratio * self.motor.torque_constant_nm_a * largest
    }
}

impl Plant {
    /// Returns the lever of the cylinder at an angle of the hub on the platform; `None` without a cylinder.
    #[inline]
    pub fn lever_at(&self, angle_rad: f64) -> Option<LeverPoint> {
        self.parameters.cylinder.as_ref().map(|cylinder| cylinder.lever.at(angle_rad))
    }

    /// Returns what the cylinder adds to the linear core; nothing without one.
    #[inline]
    pub fn cylinder_parts(&self, at: &CylinderPoint) -> CylinderParts {
        let Some(cylinder) = &self.parameters.cylinder else { return CylinderParts::default() };
        let (motor, reference) = (&self.parameters.motor, self.parameters.gearbox.ratio);
        let arm = cylinder.lever.at(at.angle_rad).arm_m;
        let (more, squares) = (arm - reference, arm * arm - reference * reference);
        CylinderParts {
            flow_l_s: cylinder.flow_l_s(at.opening_l_s, at.pressure_mpa)
                - at.opening_l_s
                - motor.back_emf_v_s_rad * more * at.rate_rad_s,
            hub_nm: motor.torque_constant_nm_a * more * at.pressure_mpa + arm * at.force_n
                - self.parameters.motor_friction.viscous_nm_s_rad * squares * at.rate_rad_s,
        }
    }

    /// Returns the inputs of the core through which what is not linear acts: first what acts at the drive, then at the hub, then the load.
    pub fn port_inputs(&self) -> [usize; 3] {
        let drive = if self.parameters.cylinder.is_some() { input::FLOW } else { input::MOTOR_TORQUE };
        [drive, input::HUB_TORQUE, input::LOAD]
    }

    /// Returns the states of the core that belong to the drive: voltage and current where there are such, and the spool of a valve.
    pub fn drive_states(&self) -> impl Iterator<Item = usize> {
        let spool = self.parameters.cylinder.is_some();
        [(state::VOLTAGE, true), (state::CURRENT, true), (state::MOTOR, spool)]
            .map(|(index, is_drive)| (index, is_drive && self.has_state(index)))
            .into_iter()
            .filter_map(|(index, is_there)| is_there.then_some(index))
    }

    /// Returns the plant whose linear core holds about an equilibrium: that of a cylinder has its lever and its valve's slopes there.
    pub fn local_at(&self, at: &Equilibrium) -> Self {
        self.cylinder_local(at).map_or_else(|| self.clone(), |(local, _)| local)
    }

    /// The spool in the places of the voltage and its rate, and the flow into the cylinder.
    pub(super) fn valve_rows(&self, core: &mut Core, cylinder: &Cylinder) {
        let square = cylinder.valve_frequency_rad_s.powi(2);
        core.A[(state::VOLTAGE, state::MOTOR)] = 1.0;
        core.A[(state::MOTOR, state::VOLTAGE)] = -square;
        core.A[(state::MOTOR, state::MOTOR)] = -2.0 * cylinder.valve_damping * cylinder.valve_frequency_rad_s;
        core.B[(state::MOTOR, input::DRIVE)] = square * self.parameters.amplifier.gain;
        core.B[(state::CURRENT, input::FLOW)] = 1.0 / self.parameters.motor.inductance_h;
    }

    /// Returns the equilibrium with the lever at its angle: the valve passes what leaks.
    pub(super) fn cylinder_equilibrium(&self, cylinder: &Cylinder, point: &OperatingPoint) -> Equilibrium {
        let mut local = self.clone();
        let lever = cylinder.lever.at(point.hub_angle_rad - point.platform_angle_rad);
        local.parameters.gearbox.ratio = lever.arm_m;
        let mut at = local.equilibrium_under(point, super::mesh_loss::MeshLoss::default());
        let leak = self.parameters.motor.resistance_ohm * at.current_a;
        let opening = cylinder.opening_l_s(leak, at.current_a);
        let (amplifier, motor) = (&self.parameters.amplifier, &self.parameters.motor);
        at.motor_angle_rad = lever.travel_m;
        at.drive_v = opening / amplifier.gain;
        at.control_v = amplifier.control_v(at.drive_v, motor);
        at.core_state[state::VOLTAGE] = if opening.is_finite() { opening } else { leak };
        at
    }

    /// Returns the plant whose linear core moves a little about an equilibrium as this one does (the opening counts as the flow that it passes there), and what
    /// the changing lever adds as a stiffness at the pivot; `None` without a cylinder.
    pub(super) fn cylinder_local(&self, at: &Equilibrium) -> Option<(Self, [Impedance; 2])> {
        let cylinder = self.parameters.cylinder.as_ref()?;
        let lever = cylinder.lever.at(at.point.hub_angle_rad - at.point.platform_angle_rad);
        let slopes = cylinder.valve_slopes(at.core_state[state::VOLTAGE], at.current_a);
        let mut local = self.clone();
        local.parameters.gearbox.ratio = lever.arm_m;
        local.parameters.motor.resistance_ohm += slopes.pressure_l_s_mpa;
        local.parameters.amplifier.gain *= slopes.flow_gain;
        let force = self.parameters.motor.torque_constant_nm_a * at.current_a;
        let mut added = [Impedance::default(); 2];
        added[1].stiffness = -force * lever.slope_m_rad;
        Some((local, added))
    }
}
