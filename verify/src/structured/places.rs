//! The places at which a parameter enters the linear plant.

use counterpoise_models::parameters::{FrictionLaw, Parameters};

use crate::robustness::VariedParameter;
use crate::tolerance::STUCK;

/// A place of the linear plant at which a factor acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Inertia of the hub.
    HubInertia,
    /// Inertia of the beam.
    BeamInertia,
    /// Spring between hub and beam.
    StructureStiffness,
    /// Damper between hub and beam.
    StructureDamping,
    /// Viscous friction at the motor.
    MotorViscous,
    /// Viscous friction at the pivot.
    PivotViscous,
    /// Dry friction at the motor, as viscous friction.
    MotorDry,
    /// Dry friction at the pivot, as viscous friction.
    PivotDry,
    /// Spring of the gear.
    GearStiffness,
    /// Inertia of the motor.
    MotorInertia,
    /// Torque per ampere.
    TorqueConstant,
    /// Resistance of the armature.
    Resistance,
    /// Natural frequency of the hub's gyroscope: two places.
    GyroBandwidth,
    /// Presliding stiffness at the motor, at rest.
    MotorPresliding,
    /// Presliding stiffness at the pivot, at rest.
    PivotPresliding,
}

/// Returns the places of a parameter; `None` if it does not enter the loop.
pub fn parameter_places(varied: VariedParameter) -> &'static [Place] {
    match varied {
        VariedParameter::HubInertia => &[Place::HubInertia],
        VariedParameter::BeamInertia => &[Place::BeamInertia],
        VariedParameter::Inertia => &[Place::HubInertia, Place::BeamInertia],
        VariedParameter::MotorFriction => &[Place::MotorDry],
        VariedParameter::PivotFriction => &[Place::PivotDry],
        VariedParameter::Friction => &[Place::MotorDry, Place::PivotDry],
        VariedParameter::Viscous => &[Place::MotorViscous, Place::PivotViscous],
        VariedParameter::GearStiffness => &[Place::GearStiffness],
        VariedParameter::StructureStiffness => &[Place::StructureStiffness],
        VariedParameter::StructureDamping => &[Place::StructureDamping],
        VariedParameter::MotorInertia => &[Place::MotorInertia],
        VariedParameter::TorqueConstant => &[Place::TorqueConstant],
        VariedParameter::Resistance => &[Place::Resistance],
        VariedParameter::GyroBandwidth => &[Place::GyroBandwidth],
        VariedParameter::PreslidingStiffness => &[Place::MotorPresliding, Place::PivotPresliding],
        VariedParameter::OutOfBalance
        | VariedParameter::Backlash
        | VariedParameter::AccelerometerGain
        | VariedParameter::PlatformGyroGain
        | VariedParameter::ObserverLevel
        | VariedParameter::ObserverStiffness
        | VariedParameter::ObserverGain
        | VariedParameter::SampleJitter
        | VariedParameter::MissedSamples
        | VariedParameter::LateSamples
        | VariedParameter::MissingCodes
        | VariedParameter::GyroDrift => &[],
    }
}

/// Linear replacements of dry friction at motor and pivot.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LinearisedDryFriction {
    /// Viscous friction, N m s/rad.
    pub viscous: [f64; 2],
    /// Springs, N m/rad: the presliding stiffness at rest.
    pub springs: [f64; 2],
}

/// State of friction in a linear loop: sliding or at rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Joints {
    /// Friction slides: dry friction is viscous friction of the same work.
    Sliding,
    /// Friction is at rest: dry friction is the spring of its presliding stiffness.
    AtRest,
    /// There is no dry friction, in the mechanism or in the controller.
    Frictionless,
}

/// Returns the presliding stiffness at motor and pivot, N m/rad: 0 for a law that creeps, that of a joint that is all but stuck for
/// one that truly sticks.
pub fn presliding_stiffness(parameters: &Parameters) -> [f64; 2] {
    let inertia = parameters.lumped.as_ref().map_or(0.0, |l| l.inertia_kg_m2());
    let (gear, ratio) = (joint_stiffness(parameters, inertia), parameters.gearbox.ratio);
    let joints = [(&parameters.motor_friction, gear / (ratio * ratio)), (&parameters.pivot_friction, gear)];
    joints.map(|(friction, most)| {
        let stuck = if friction.law.has_true_stick() { STUCK * most } else { 0.0 };
        friction.presliding_stiffness_nm_rad().unwrap_or(stuck)
    })
}

/// Returns the stiffness of the joint at the output, N m/rad, against which a stuck one is stiff: that of the transmission. A rigid one has
/// none: a body of the inertia, kg m^2, and of the rotor's is held as stiffly as half the sample rate shows, `J (pi / T)^2`.
pub fn joint_stiffness(parameters: &Parameters, inertia_kg_m2: f64) -> f64 {
    let gearbox = &parameters.gearbox;
    if !gearbox.is_rigid() {
        return gearbox.stiffness_nm_rad;
    }
    let inertia = inertia_kg_m2 + parameters.reflected_inertia_kg_m2();
    inertia * (std::f64::consts::PI / parameters.interface.sample_period_s).powi(2)
}

/// Returns the viscous friction that takes as much work as the dry friction at a sinusoidal rate of the hub, N m s/rad at the
/// motor and at the pivot: c = 4 F / (pi rate), the motor turning by the gear's ratio faster.
pub fn dry_as_viscous(parameters: &Parameters, hub_rate_rad_s: f64) -> [f64; 2] {
    let damping = |coulomb: f64, rate: f64| 4.0 * coulomb / (std::f64::consts::PI * rate.abs());
    [
        damping(parameters.motor_friction.coulomb_nm(), hub_rate_rad_s * parameters.gearbox.ratio),
        damping(parameters.pivot_friction.coulomb_nm(), hub_rate_rad_s),
    ]
}

/// Returns the mechanism with so much viscous friction added at motor and pivot in the place of dry friction.
pub fn without_dry(parameters: &Parameters, added: [f64; 2]) -> Parameters {
    let mut out = parameters.clone();
    for (friction, more) in [&mut out.motor_friction, &mut out.pivot_friction].into_iter().zip(added) {
        friction.law = FrictionLaw::None;
        friction.viscous_nm_s_rad += more;
    }
    out
}
