//! Where a parameter enters the linear plant.

use counterpoise_models::parameters::{FrictionLaw, Parameters};

use crate::robust::Varied;

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
}

/// The places of a parameter; `None` if it does not enter the loop.
pub fn places(varied: Varied) -> &'static [Place] {
    match varied {
        Varied::HubInertia => &[Place::HubInertia],
        Varied::BeamInertia => &[Place::BeamInertia],
        Varied::Inertia => &[Place::HubInertia, Place::BeamInertia],
        Varied::MotorFriction => &[Place::MotorDry],
        Varied::PivotFriction => &[Place::PivotDry],
        Varied::Friction => &[Place::MotorDry, Place::PivotDry],
        Varied::Viscous => &[Place::MotorViscous, Place::PivotViscous],
        Varied::GearStiffness => &[Place::GearStiffness],
        Varied::StructureStiffness => &[Place::StructureStiffness],
        Varied::StructureDamping => &[Place::StructureDamping],
        Varied::MotorInertia => &[Place::MotorInertia],
        Varied::TorqueConstant => &[Place::TorqueConstant],
        Varied::Resistance => &[Place::Resistance],
        Varied::GyroBandwidth => &[Place::GyroBandwidth],
        Varied::OutOfBalance | Varied::Backlash | Varied::AccelerometerGain | Varied::PlatformGyroGain => &[],
    }
}

/// The viscous friction that takes as much work as the dry friction at a sinusoidal rate of the hub, N m s/rad at the motor and at
/// the pivot: c = 4 F / (pi rate), the motor turning by the gear's ratio faster.
pub fn dry_as_viscous(parameters: &Parameters, hub_rate_rad_s: f64) -> [f64; 2] {
    let damping = |coulomb: f64, rate: f64| 4.0 * coulomb / (std::f64::consts::PI * rate.abs());
    [
        damping(parameters.motor_friction.coulomb_nm(), hub_rate_rad_s * parameters.gearbox.ratio),
        damping(parameters.pivot_friction.coulomb_nm(), hub_rate_rad_s),
    ]
}

/// The mechanism with so much viscous friction added at motor and pivot in the place of dry friction.
pub fn without_dry(parameters: &Parameters, added: [f64; 2]) -> Parameters {
    let mut out = parameters.clone();
    for (friction, more) in [&mut out.motor_friction, &mut out.pivot_friction].into_iter().zip(added) {
        friction.law = FrictionLaw::None;
        friction.viscous_nm_s_rad += more;
    }
    out
}
