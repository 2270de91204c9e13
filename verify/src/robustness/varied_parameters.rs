//! The parameters of mechanism and controller that a robustness test varies, each by a factor on its nominal value.

use counterpoise_controller::Controller;
use counterpoise_models::parameters::Parameters;

use crate::Error;

/// A parameter, or parameters that vary together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum VariedParameter {
    /// Inertia at the hub.
    HubInertia,
    /// Inertia of the beam.
    BeamInertia,
    /// Inertia of hub and beam together.
    Inertia,
    /// First moment of mass about the pivot.
    OutOfBalance,
    /// Dry friction at the motor shaft.
    MotorFriction,
    /// Dry friction at the pivot.
    PivotFriction,
    /// Dry friction at both.
    Friction,
    /// Viscous friction at both.
    Viscous,
    /// Gap of the gear.
    Backlash,
    /// Stiffness of the gear.
    GearStiffness,
    /// Stiffness between hub and beam.
    StructureStiffness,
    /// Damping between hub and beam.
    StructureDamping,
    /// Inertia of the motor.
    MotorInertia,
    /// Torque per ampere.
    TorqueConstant,
    /// Resistance of the armature.
    Resistance,
    /// Natural frequency of the hub's gyroscope.
    GyroBandwidth,
    /// Gain of the platform's accelerometer.
    AccelerometerGain,
    /// Gain of the platform's gyroscope.
    PlatformGyroGain,
    /// Presliding stiffness of the friction at motor and pivot; a law that truly sticks has none.
    PreslidingStiffness,
    /// Coulomb level that the controller's friction observers use.
    ObserverLevel,
    /// Presliding stiffness that the controller's friction observers use.
    ObserverStiffness,
    /// Volts that the controller's friction observers give for a torque: the share of friction that is cancelled.
    ObserverGain,
    /// Jitter of the instants at which the sensors are read.
    SampleJitter,
    /// Share of the samples that the controller misses.
    MissedSamples,
    /// Share of the samples whose control is late.
    LateSamples,
    /// Share of the converters' codes that are missing.
    MissingCodes,
    /// Slow errors of both gyroscopes.
    GyroDrift,
}

/// Every parameter with its key in a project file.
pub const ALL: [(VariedParameter, &str); 27] = [
    (VariedParameter::HubInertia, "hub_inertia"),
    (VariedParameter::BeamInertia, "beam_inertia"),
    (VariedParameter::Inertia, "inertia"),
    (VariedParameter::OutOfBalance, "out_of_balance"),
    (VariedParameter::MotorFriction, "motor_friction"),
    (VariedParameter::PivotFriction, "pivot_friction"),
    (VariedParameter::Friction, "friction"),
    (VariedParameter::Viscous, "viscous"),
    (VariedParameter::Backlash, "backlash"),
    (VariedParameter::GearStiffness, "gear_stiffness"),
    (VariedParameter::StructureStiffness, "structure_stiffness"),
    (VariedParameter::StructureDamping, "structure_damping"),
    (VariedParameter::MotorInertia, "motor_inertia"),
    (VariedParameter::TorqueConstant, "torque_constant"),
    (VariedParameter::Resistance, "resistance"),
    (VariedParameter::GyroBandwidth, "gyro_bandwidth"),
    (VariedParameter::AccelerometerGain, "accelerometer_gain"),
    (VariedParameter::PlatformGyroGain, "platform_gyro_gain"),
    (VariedParameter::PreslidingStiffness, "presliding_stiffness"),
    (VariedParameter::ObserverLevel, "observer_level"),
    (VariedParameter::ObserverStiffness, "observer_stiffness"),
    (VariedParameter::ObserverGain, "observer_gain"),
    (VariedParameter::SampleJitter, "sample_jitter"),
    (VariedParameter::MissedSamples, "missed_samples"),
    (VariedParameter::LateSamples, "late_samples"),
    (VariedParameter::MissingCodes, "missing_codes"),
    (VariedParameter::GyroDrift, "gyro_drift"),
];

impl VariedParameter {
    /// Returns the key in a project file.
    pub fn key(self) -> &'static str {
        ALL.iter().find(|row| row.0 == self).map_or("", |row| row.1)
    }

    /// Returns the parameter with the given key.
    pub fn from_key(key: &str) -> Option<Self> {
        ALL.iter().find(|row| row.1 == key).map(|row| row.0)
    }

    /// Returns whether the parameter belongs to the controller, not to the mechanism.
    pub fn is_of_controller(self) -> bool {
        matches!(
            self,
            VariedParameter::ObserverLevel
                | VariedParameter::ObserverStiffness
                | VariedParameter::ObserverGain
        )
    }

    /// Returns the controller with its friction observers' parameter multiplied by `factor`; the controller as it is for a
    /// parameter of the mechanism.
    ///
    /// # Errors
    /// [`Error::Range`] for a factor that is negative or not finite, and those of the controller: a level of 0 is none.
    pub fn scaled_controller(self, controller: &Controller, factor: f64) -> Result<Controller, Error> {
        check(factor)?;
        if !self.is_of_controller() || controller.parts().observers.is_empty() {
            return Ok(controller.clone());
        }
        Ok(controller.with(|parts| {
            for observer in &mut parts.observers {
                match self {
                    VariedParameter::ObserverLevel => observer.coulomb_nm *= factor,
                    VariedParameter::ObserverStiffness => observer.rest_stiffness_nm_rad *= factor,
                    _ => {
                        observer.volts_per_nm *= factor;
                        observer.viscous_v_s_rad *= factor;
                    }
                }
            }
        })?)
    }

    /// Multiplies the parameter of the mechanism by `factor`; those of the controller leave the mechanism as it is. Inertias and
    /// stiffnesses of the structure are those of the lumped description.
    ///
    /// # Errors
    /// [`Error::Range`] for a factor that is negative or not finite, or 0 for the presliding stiffness.
    pub fn scale(self, parameters: &mut Parameters, factor: f64) -> Result<(), Error> {
        check(factor)?;
        match self {
            VariedParameter::PreslidingStiffness if factor == 0.0 => {
                return Err(Error::Range {
                    what: "factor of the presliding stiffness",
                    value: factor,
                    allowed: "above 0",
                });
            }
            VariedParameter::PreslidingStiffness => {
                parameters.motor_friction.scale_presliding_stiffness(factor);
                parameters.pivot_friction.scale_presliding_stiffness(factor);
            }
            VariedParameter::Friction => {
                VariedParameter::MotorFriction.scale(parameters, factor)?;
                VariedParameter::PivotFriction.scale(parameters, factor)?;
            }
            VariedParameter::MotorFriction => parameters.motor_friction.law.scale_coulomb(factor),
            VariedParameter::PivotFriction => parameters.pivot_friction.law.scale_coulomb(factor),
            _ => self.places(parameters).into_iter().for_each(|place| *place *= factor),
        }
        Ok(())
    }

    fn places(self, p: &mut Parameters) -> Vec<&mut f64> {
        let lumped = p.lumped.as_mut();
        match self {
            VariedParameter::HubInertia => lumped.map(|l| &mut l.hub_inertia_kg_m2).into_iter().collect(),
            VariedParameter::BeamInertia => lumped.map(|l| &mut l.beam_inertia_kg_m2).into_iter().collect(),
            VariedParameter::Inertia => lumped
                .map(|l| [&mut l.hub_inertia_kg_m2, &mut l.beam_inertia_kg_m2])
                .into_iter()
                .flatten()
                .collect(),
            VariedParameter::OutOfBalance => lumped.map(|l| &mut l.out_of_balance_kg_m).into_iter().collect(),
            VariedParameter::StructureStiffness => {
                lumped.map(|l| &mut l.stiffness_nm_rad).into_iter().collect()
            }
            VariedParameter::StructureDamping => {
                lumped.map(|l| &mut l.damping_nm_s_rad).into_iter().collect()
            }
            VariedParameter::Viscous => {
                vec![&mut p.motor_friction.viscous_nm_s_rad, &mut p.pivot_friction.viscous_nm_s_rad]
            }
            VariedParameter::Backlash => vec![&mut p.gearbox.backlash_rad],
            VariedParameter::GearStiffness => vec![&mut p.gearbox.stiffness_nm_rad],
            VariedParameter::MotorInertia => vec![&mut p.motor.inertia_kg_m2],
            VariedParameter::TorqueConstant => vec![&mut p.motor.torque_constant_nm_a],
            VariedParameter::Resistance => vec![&mut p.motor.resistance_ohm],
            VariedParameter::GyroBandwidth => vec![&mut p.sensors.hub_gyro.natural_frequency_rad_s],
            VariedParameter::AccelerometerGain => vec![&mut p.sensors.platform_accelerometer.gain],
            VariedParameter::PlatformGyroGain => vec![&mut p.sensors.platform_gyro.gain],
            VariedParameter::SampleJitter => vec![&mut p.interface.clock.jitter_s],
            VariedParameter::MissedSamples => vec![&mut p.interface.clock.missed_samples],
            VariedParameter::LateSamples => vec![&mut p.interface.clock.late_samples],
            VariedParameter::MissingCodes => vec![&mut p.interface.missing_codes],
            VariedParameter::GyroDrift => [&mut p.sensors.hub_gyro.drift, &mut p.sensors.platform_gyro.drift]
                .into_iter()
                .flat_map(|drift| {
                    [&mut drift.angle_random_walk, &mut drift.bias_instability, &mut drift.rate_random_walk]
                })
                .collect(),
            VariedParameter::MotorFriction
            | VariedParameter::PivotFriction
            | VariedParameter::Friction
            | VariedParameter::PreslidingStiffness
            | VariedParameter::ObserverLevel
            | VariedParameter::ObserverStiffness
            | VariedParameter::ObserverGain => Vec::new(),
        }
    }
}

fn check(factor: f64) -> Result<(), Error> {
    if factor >= 0.0 && factor.is_finite() {
        return Ok(());
    }
    Err(Error::Range { what: "factor of a varied parameter", value: factor, allowed: "0 or more" })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use counterpoise_models::{Clock, Drift, FrictionLaw};

    #[test]
    fn every_parameter_can_be_varied_and_a_factor_of_one_changes_nothing() {
        let mut rig = counterpoise_models::reference::rig();
        rig.interface.clock = Clock { jitter_s: 1e-5, missed_samples: 1e-3, late_samples: 1e-2 };
        rig.interface.missing_codes = 0.01;
        rig.sensors.hub_gyro.drift = Drift { bias_instability: 1e-5, ..Drift::NONE };
        for (varied, key) in ALL {
            let (mut same, mut other) = (rig.clone(), rig.clone());
            varied.scale(&mut same, 1.0).unwrap();
            varied.scale(&mut other, 1.5).unwrap();
            assert_eq!(same, rig, "{key}");
            assert_eq!(other == rig, varied.is_of_controller(), "{key}");
            assert_eq!(VariedParameter::from_key(key), Some(varied));
        }
    }

    #[test]
    fn friction_can_be_taken_away_but_not_made_negative() {
        let mut rig = counterpoise_models::reference::rig();
        VariedParameter::Friction.scale(&mut rig, 0.0).unwrap();
        assert_eq!(rig.pivot_friction.law, FrictionLaw::None);
        assert!(VariedParameter::Friction.scale(&mut rig, -1.0).is_err());
    }
}
