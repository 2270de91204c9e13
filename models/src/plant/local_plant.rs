//! The plant at an operating point: its equilibrium, and the plant that has the values of its free functions there as ordinary
//! parameters.

use super::Plant;
use super::core::state;
use super::equilibrium::{Equilibrium, OperatingPoint};
use super::free_functions::{JointMotion, LearnedFunction, LearnedFunctions, LearnedRegime};
use super::impedance::Impedance;
use super::mesh_loss::MeshLoss;
use crate::parameters::{Friction, LearnedPlace, LearnedQuantity, Parameters, RegimeVariable};
use crate::tolerance::{LEARNED_ITERATIONS, LEAST_LEVEL};

/// The choice whether a local plant has a function's slope along its own angle or rate, as small motion feels it, or its value alone, as a
/// machine at rest does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FunctionTreatment {
    SmallMotion,
    Rest,
}

impl Plant {
    /// Returns the equilibrium at an operating point, in closed form:
    ///
    /// ```text
    ///     T_2 = mu g cos theta_h - nu g sin theta_h + K_s (theta_h - theta_p - theta_0) - equilibrator - mesh ripple
    ///     delta = T_2 / K_gb + sgn(T_2) b / 2,   K_t i = T_2 / N - cogging,   v = V / K_v + K_ifb i,  V = R i
    /// ```
    ///
    /// Wherever the mesh ripple and the cogging depend on the motor angle, the angle at T_2 without ripple is taken.
    pub fn equilibrium(&self, point: &OperatingPoint) -> Equilibrium {
        if let Some(cylinder) = &self.parameters.cylinder {
            return self.cylinder_equilibrium(cylinder, point);
        }
        let bare = self.equilibrium_under(point, MeshLoss::default());
        match self.learned_functions() {
            Some(functions) => self.learned_equilibrium(functions, bare),
            None => bare,
        }
    }

    /// Returns the equilibrium of a plant with free functions, by iteration: each plant has as ordinary parameters and constant
    /// torques what the functions are at the equilibrium before.
    fn learned_equilibrium(&self, functions: &LearnedFunctions, from: Equilibrium) -> Equilibrium {
        (0..LEARNED_ITERATIONS).fold(from, |before, _| {
            let at = self.regime_at(&before);
            let added = functions.constant_torques(&at);
            match self.local(functions, &at, FunctionTreatment::Rest) {
                Some(local) => local.equilibrium_under(&before.point, added),
                None => before,
            }
        })
    }

    /// Returns the plant that moves a little about an equilibrium as this one does, without free functions, and the stiffness and
    /// damping that the added torques have there at the motor and at the pivot; `None` if a function leaves no sound plant.
    ///
    /// Functions of an angle or a rate keep their slope; those of load, control and time their value, and those over a turn, as
    /// cogging, have none.
    pub(super) fn linearise_learned(&self, at: &Equilibrium) -> Option<(Self, [Impedance; 2])> {
        let functions = self.learned.as_ref()?;
        let regime = self.regime_at(at);
        let local = self.local(functions, &regime, FunctionTreatment::SmallMotion)?;
        let mut added = [Impedance::default(); 2];
        for function in functions.all.iter().filter(|f| f.quantity == LearnedQuantity::Torque) {
            let slope = function.table.slope_at(functions.variable(function, &regime));
            let joint = match function.place {
                LearnedPlace::Motor => 0,
                LearnedPlace::Pivot => 1,
                _ => continue,
            };
            match function.variable {
                RegimeVariable::Angle => added[joint].stiffness -= slope,
                RegimeVariable::Rate => added[joint].damping -= slope,
                _ => {}
            }
        }
        Some((local, added))
    }

    /// Returns where a plant at rest is.
    fn regime_at(&self, at: &Equilibrium) -> LearnedRegime {
        let joint = |angle_rad: f64| JointMotion { angle_rad, rate_rad_s: 0.0 };
        LearnedRegime {
            time_s: 0.0,
            drive_v: at.drive_v,
            current_a: at.current_a,
            motor: joint(at.motor_angle_rad),
            hub: joint(at.point.hub_angle_rad - at.point.platform_angle_rad),
            wind_up_rad: at.core_state[state::WINDUP],
            mesh_torque_nm: at.mesh_torque_nm,
        }
    }

    /// Returns the plant with the functions' factors at a regime in its parameters, and without functions.
    fn local(
        &self,
        functions: &LearnedFunctions,
        at: &LearnedRegime,
        around: FunctionTreatment,
    ) -> Option<Self> {
        let mut p = self.parameters.clone();
        p.learned.clear();
        for function in &functions.all {
            let variable = functions.variable(function, at);
            let (value, slope) = (function.table.at(variable), function.table.slope_at(variable));
            let tangent = Tangent { variable, value, slope, around };
            function.apply(&mut p, &tangent);
        }
        Self::with_whole_body(&p, self.body.clone()).ok()
    }
}

/// A function at a place of its variable.
struct Tangent {
    variable: f64,
    value: f64,
    slope: f64,
    around: FunctionTreatment,
}

impl LearnedFunction {
    /// Puts the function's value and slope at a place of its variable into ordinary parameters.
    fn apply(&self, p: &mut Parameters, at: &Tangent) {
        let Tangent { variable, value, slope, .. } = *at;
        let moves = at.around == FunctionTreatment::SmallMotion;
        let of_angle = moves && self.variable == RegimeVariable::Angle;
        let of_rate = moves && self.variable == RegimeVariable::Rate;
        let (gear, factor) = (&mut p.gearbox, value.max(0.0));
        match (self.quantity, self.place) {
            (LearnedQuantity::Torque, LearnedPlace::Gearbox) if of_angle => gear.stiffness_nm_rad += slope,
            (LearnedQuantity::Torque, LearnedPlace::Gearbox) if of_rate => gear.damping_nm_s_rad += slope,
            (LearnedQuantity::Stiffness, LearnedPlace::Gearbox) => {
                let tangent = if of_angle { variable * slope } else { 0.0 };
                gear.stiffness_nm_rad *= factor + tangent;
            }
            (LearnedQuantity::Damping, LearnedPlace::Gearbox) => gear.damping_nm_s_rad *= factor,
            (LearnedQuantity::Stiffness, _) => {
                if let Some(lumped) = &mut p.lumped {
                    let bent = variable - lumped.position_stiffness_centre_rad;
                    lumped.position_stiffness_nm_rad *= factor + if of_angle { bent * slope } else { 0.0 };
                }
            }
            (LearnedQuantity::Damping, place) => joint_friction(p, place).viscous_nm_s_rad *= factor,
            (LearnedQuantity::FrictionLevel, place) => {
                joint_friction(p, place).law.scale_coulomb(value.max(LEAST_LEVEL));
            }
            (LearnedQuantity::TorqueConstant, _) => p.motor.torque_constant_nm_a *= value,
            (LearnedQuantity::Torque | LearnedQuantity::Error, _) => {}
        }
    }
}

impl LearnedFunctions {
    /// Returns the added torques at rest.
    fn constant_torques(&self, at: &LearnedRegime) -> MeshLoss {
        let mut sum = MeshLoss::default();
        for function in self.all.iter().filter(|f| f.quantity == LearnedQuantity::Torque) {
            let torque = function.table.at(self.variable(function, at));
            self.add(function.place, torque, &mut sum);
        }
        sum
    }
}

fn joint_friction(p: &mut Parameters, place: LearnedPlace) -> &mut Friction {
    if place == LearnedPlace::Motor { &mut p.motor_friction } else { &mut p.pivot_friction }
}
