//! The parameters of a mechanism: plain data in SI units, checked when a plant is built from it.
//!
//! Frames and signs: angles are positive nose-up; `out_of_balance` is the first moment of mass about the pivot,
//! positive nose-heavy; gear quantities are at the output (hub) side, motor quantities at the motor shaft.
//! A linear axis has the same parameters in other units: kg for kg m^2, N for N m, m for rad, and a ratio in rad/m.
//! Effects that a plain machine does not have (cogging, springs, mesh ripple, sensor faults) are present as fields
//! whose default value means "absent".

mod controlled_quantity;
pub mod cylinder;
mod drive;
mod drive_limits;
mod free_functions;
mod friction;
mod sensing;
mod structure;

use crate::loads::Loads;

pub use controlled_quantity::{ControlledQuantity, DriveQuantity, QuantityKind};
pub use cylinder::Cylinder;
pub use drive::{Amplifier, AmplifierDynamics, Gearbox, IDEAL_LAG_S, MapPoint, Motor, Transmission};
pub use drive_limits::{
    COPPER_PER_K, DriveHeat, DriveLimits, FOLD_K, FOLD_SHARE, MotorHeat, RESISTANCE_AT_K, resistance_factor,
};
pub use free_functions::{Interpolation, LearnedElement, LearnedPlace, LearnedQuantity, RegimeVariable};
pub use friction::{Friction, FrictionLaw, StribeckCurve};
pub use sensing::{
    AccelerometerAxis, Alignment, CONVERTER_RANGE_V, Clock, Drift, FeedbackSignal, IDEAL_CONVERTER_BITS,
    Interface, ReadingDelay, Sensor, Sensors, converter_step_v,
};
pub use structure::{
    Beam, BeamSection, Configuration, Link, LumpedStructure, PointMass, SectionShape, StructuralDamping,
};

/// One axis of a cantilever mechanism on a moving platform.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// Name of the machine.
    pub name: String,
    /// The motion of the hub: it turns or slides.
    pub axis: AxisKind,
    /// Acceleration of gravity, m/s^2.
    pub gravity_m_s2: f64,
    /// Distributed description of the structure, if it is known.
    pub beam: Option<Beam>,
    /// Two-inertia description of the structure, if it is given; otherwise it is derived from the beam.
    pub lumped: Option<LumpedStructure>,
    /// Gearbox between motor and hub.
    pub gearbox: Gearbox,
    /// Motor.
    pub motor: Motor,
    /// Amplifier that drives the motor.
    pub amplifier: Amplifier,
    /// A hydraulic cylinder with its valve, whose linear part stands in the places of gearbox, motor and amplifier; `None`: a motor drives.
    pub cylinder: Option<Cylinder>,
    /// Friction at the motor shaft (speed relative to the platform), or of a cylinder's piston in its barrel.
    pub motor_friction: Friction,
    /// Friction at the hub pivot (rate relative to the platform).
    pub pivot_friction: Friction,
    /// Sensors.
    pub sensors: Sensors,
    /// The digital controller's converters and clock.
    pub interface: Interface,
    /// Ways to load the mechanism: which masses are fitted, what is added.
    pub configurations: Vec<Configuration>,
    /// Free functions beside the laws of the library; empty: none.
    pub learned: Vec<LearnedElement>,
    /// Equilibrator, stops and recoil.
    pub loads: Loads,
    /// Limits of the drive beside voltage and peak current.
    pub drive_limits: DriveLimits,
}

/// Kind of the hub's motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AxisKind {
    /// The hub turns: angles in rad, inertias in kg m^2, torques in N m. The weight's torque follows the angle.
    #[default]
    Rotary,
    /// The hub slides: places in m, masses in kg, forces in N. The weight is constant: `out_of_balance` is the mass times the
    /// sine of the slope.
    Linear,
}

/// Units of a turning axis with those of a sliding one.
const AXIS_UNITS: [(&str, &str); 14] = [
    ("V/rad", "V/m"),
    ("(rad/s)/(m/s^2)", "(m/s)/(m/s^2)"),
    ("rad/(m/s^2)", "m/(m/s^2)"),
    ("kg m^2", "kg"),
    ("kg m", "kg"),
    ("N m", "N"),
    ("N m/rad", "N/m"),
    ("N m s/rad", "N s/m"),
    ("N m s^2/rad^2", "N s^2/m^2"),
    ("N m/A", "N/A"),
    ("V s/rad", "V s/m"),
    ("rad", "m"),
    ("rad/s", "m/s"),
    ("(rad/s)^2 s", "(m/s)^2 s"),
];

impl AxisKind {
    /// Returns the unit of a quantity of the axis that has a given unit on a turning one.
    pub fn unit(self, turning: &'static str) -> &'static str {
        let known = AXIS_UNITS.iter().find(|(unit, _)| *unit == turning && self == Self::Linear);
        known.map_or(turning, |(_, sliding)| sliding)
    }
}

/// A torque that repeats with an angle: amplitude x sin(order x angle + phase).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ripple {
    /// Amplitude in the unit of what it disturbs (N m, or a fraction if it multiplies).
    pub amplitude: f64,
    /// Periods per turn of the angle it follows.
    pub order: f64,
    /// Phase at zero angle, rad.
    pub phase_rad: f64,
}

impl Ripple {
    /// No ripple.
    pub const NONE: Self = Self { amplitude: 0.0, order: 1.0, phase_rad: 0.0 };

    /// Returns the ripple at an angle.
    pub fn at(&self, angle_rad: f64) -> f64 {
        if self.amplitude == 0.0 {
            0.0
        } else {
            self.amplitude * (self.order * angle_rad + self.phase_rad).sin()
        }
    }
}

impl Ripple {
    /// Returns the derivative of the ripple by the angle.
    pub fn slope_at(&self, angle_rad: f64) -> f64 {
        if self.amplitude == 0.0 {
            0.0
        } else {
            self.amplitude * self.order * (self.order * angle_rad + self.phase_rad).cos()
        }
    }
}

impl Parameters {
    /// Returns whether dry friction acts at motor or pivot.
    pub fn has_dry_friction(&self) -> bool {
        self.motor_friction.coulomb_nm() > 0.0 || self.pivot_friction.coulomb_nm() > 0.0
    }

    /// Returns what a rigid transmission adds to the hub's inertia, kg m^2: ratio^2 x rotor; 0 if it is compliant.
    pub fn reflected_inertia_kg_m2(&self) -> f64 {
        if self.gearbox.is_rigid() { self.gearbox.ratio.powi(2) * self.motor.inertia_kg_m2 } else { 0.0 }
    }

    /// Returns the parameters with a configuration applied: fitted masses add mass x position^2 to the hub inertia and
    /// mass x position to the out-of-balance (positions relative to the pivot).
    ///
    /// # Errors
    /// The name of a mass that the beam does not have.
    pub fn with_configuration(&self, configuration: &Configuration) -> Result<Self, crate::Error> {
        let mut out = self.clone();
        let Some(lumped) = out.lumped.as_mut() else { return Ok(out) };
        lumped.hub_inertia_kg_m2 += configuration.added_hub_inertia_kg_m2;
        for name in &configuration.masses {
            let (arm, mass) = self.fitted_mass(name, &configuration.name)?;
            lumped.hub_inertia_kg_m2 += mass * arm * arm;
            lumped.out_of_balance_kg_m += mass * arm;
        }
        Ok(out)
    }

    fn fitted_mass(&self, name: &str, configuration: &str) -> Result<(f64, f64), crate::Error> {
        let beam = self.beam.as_ref();
        let found = beam.and_then(|b| {
            b.masses.iter().find(|m| m.name == name).map(|m| (m.position_m - b.pivot_m, m.mass_kg))
        });
        found.ok_or_else(|| crate::Error::UnknownMass {
            mass: name.to_owned(),
            configuration: configuration.to_owned(),
        })
    }
}
