//! The nonlinear plant: amplifier, motor, gear mesh with a gap, the structure, dry friction, gravity and heave.
//!
//! A [`Plant`] is [`Parameters`] whose ranges have been checked, with the structure in modal coordinates. From it:
//! the linear [`core`] that a simulator steps exactly (its [`rows`] say which states a machine has), the [`equilibrium`], the right-hand side ([`dynamics`]) and
//! the linearisation ([`linearisation`]).

mod amplifier;
pub mod body;
pub mod core;
pub mod cylinder;
mod drag;
pub mod dynamics;
pub mod equilibrium;
pub mod free_functions;
pub mod hose;
pub mod impedance;
pub mod linearisation;
mod local_plant;
pub mod mesh_loss;
mod outputs;
mod ranges;
pub mod rows;
mod sensor;
pub mod sensor_errors;

pub use self::body::{Body, BodyMode};
pub use self::core::{Core, Mesh};
pub use self::cylinder::{CylinderParts, CylinderPoint};
pub use self::dynamics::{Excitation, SinCos};
pub use self::equilibrium::{Equilibrium, OperatingPoint};
pub use self::free_functions::{
    JointMotion, LearnedFunction, LearnedFunctions, LearnedRefusal, LearnedRegime, LearnedTable,
};
pub use self::hose::Hose;
pub use self::impedance::Impedance;
pub use self::linearisation::{Angles, FrictionLinearisation, LinearPlant, OutputRow, friction_impedance};
pub use self::sensor_errors::{SensorErrors, SensorRegime};

use crate::Error;
use crate::friction::FrictionModel;
use crate::loads::Loads;
use crate::parameters::Parameters;

/// A mechanism that has been checked and can be simulated or linearised.
#[derive(Debug, Clone, PartialEq)]
pub struct Plant {
    pub(crate) parameters: Parameters,
    pub(crate) body: Body,
    pub(crate) motor_friction: FrictionModel,
    pub(crate) pivot_friction: FrictionModel,
    /// Spring between hub and platform, N m/rad, and the relative angle at which it is slack, rad.
    pub(crate) spring: (f64, f64),
    pub(crate) hose: Option<Hose>,
    /// Hysteresis of the transmission's compliance.
    pub(crate) gear_hysteresis: Option<Hose>,
    /// Free functions.
    pub(crate) learned: Option<LearnedFunctions>,
    /// Equilibrator, stops and recoil.
    pub(crate) loads: Option<Loads>,
    /// Current per drive, A/V, and per platform rate, A s/rad, that needs no state.
    pub(crate) direct_current: [f64; 2],
}

impl Plant {
    /// Returns the plant with the inertias of its parameters: one, two or a chain.
    ///
    /// # Errors
    /// [`Error::NoStructure`] without lumped inertias, [`Error::Parameter`] for the first parameter out of range.
    pub fn from_lumped(parameters: &Parameters) -> Result<Self, Error> {
        let lumped = parameters.lumped.as_ref().ok_or(Error::NoStructure)?;
        ranges::check_lumped(parameters, lumped)?;
        let mut whole = lumped.clone();
        whole.hub_inertia_kg_m2 += parameters.reflected_inertia_kg_m2();
        Self::with_whole_body(parameters, Body::chain(&whole)?)
    }

    /// Returns the plant with a structure in modal coordinates, for instance from finite elements; the drive, the friction,
    /// the sensors and the position spring are those of the parameters. With a rigid transmission the rotor's inertia is added at
    /// the hub, and the modes are found anew.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the first parameter out of range.
    pub fn with_body(parameters: &Parameters, body: Body) -> Result<Self, Error> {
        ranges::check(parameters)?;
        ranges::body(&body)?;
        let reflected = parameters.reflected_inertia_kg_m2();
        let body = if reflected > 0.0 { body.with_hub_inertia(reflected)? } else { body };
        Self::with_whole_body(parameters, body)
    }

    /// Returns the plant with a structure that holds the rotor of a rigid transmission already, as that of another plant does.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the first parameter out of range.
    pub fn with_whole_body(parameters: &Parameters, body: Body) -> Result<Self, Error> {
        ranges::check(parameters)?;
        ranges::body(&body)?;
        let spring = parameters
            .lumped
            .as_ref()
            .map_or((0.0, 0.0), |l| (l.position_stiffness_nm_rad, l.position_stiffness_centre_rad));
        let mut plant = Self {
            motor_friction: FrictionModel::new_at_path("motor_friction", &parameters.motor_friction)?,
            pivot_friction: FrictionModel::new_at_path("pivot_friction", &parameters.pivot_friction)?,
            parameters: parameters.clone(),
            body,
            spring,
            hose: parameters.lumped.as_ref().and_then(Hose::of),
            gear_hysteresis: Hose::of_gearbox(&parameters.gearbox),
            learned: LearnedFunctions::of(parameters),
            loads: Some(parameters.loads.clone()).filter(|loads| !loads.is_empty()),
            direct_current: [0.0; 2],
        };
        ranges::joints(&plant)?;
        plant.direct_current = plant.direct_current_of();
        Ok(plant)
    }

    /// Returns the parameters that the plant was built from.
    #[inline]
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Returns the structure in modal coordinates.
    #[inline]
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// Returns the hose between hub and platform that remembers how it was bent; `None` if there is none.
    pub fn hose(&self) -> Option<Hose> {
        self.hose
    }

    /// Returns the hysteresis of the transmission's compliance; `None` if there is none.
    pub fn gear_hysteresis(&self) -> Option<Hose> {
        self.gear_hysteresis
    }

    /// Returns the torque of the position spring on the hub at a hub angle relative to the platform, N m.
    pub fn spring_torque_nm(&self, relative_angle_rad: f64) -> f64 {
        -self.spring.0 * (relative_angle_rad - self.spring.1)
    }

    /// Returns the torque of spring, equilibrator and stops on the hub at rest, at a hub angle relative to the platform, N m.
    pub fn support_torque_nm(&self, relative_angle_rad: f64) -> f64 {
        let spring = self.spring_torque_nm(relative_angle_rad);
        match &self.loads {
            Some(loads) => spring + loads.torque_at_rest_nm(relative_angle_rad),
            None => spring,
        }
    }

    /// Returns the stiffness of spring, equilibrator and stops at a hub angle relative to the platform, N m/rad.
    pub fn support_stiffness_nm_rad(&self, relative_angle_rad: f64) -> f64 {
        match &self.loads {
            Some(loads) => self.spring.0 + loads.stiffness_nm_rad(relative_angle_rad),
            None => self.spring.0,
        }
    }

    /// Returns equilibrator, stops and recoil; `None` if there is none of them.
    #[inline]
    pub fn loads(&self) -> Option<&Loads> {
        self.loads.as_ref()
    }
}
