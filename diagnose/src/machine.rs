//! The properties of a machine: its drive in the steady state, how gravity acts on it, the effects that it can have and the balances that its
//! motions can be put into.
//!
//! A part that a machine lacks is exact in the simulator: a rigid transmission, a single inertia, a drive that takes a torque. What
//! presupposes such a part (a gap between teeth, a bending mode, a back-EMF) is no candidate.

use counterpoise_models::parameters::{AmplifierDynamics, FrictionLaw, Transmission};
use counterpoise_models::{AxisKind, FeedbackSignal, Parameters};
use counterpoise_recordings::{Channel, Recording};

use crate::library::{Component, Effect, EffectKind, EffectName};

/// The motor's current in the steady state: i = (gain u - back_emf w_m) / loss, after the static curve of the amplifier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SteadyDrive {
    /// Gain, V/V; A/V of a drive that takes a current or a torque.
    pub gain: f64,
    /// Back-EMF constant, V s/rad; 0 of a drive that takes a current or a torque.
    pub back_emf: f64,
    /// Resistance of the closed amplifier loop, V/A; 1 of a drive that takes a current or a torque.
    pub loss: f64,
}

impl SteadyDrive {
    /// Returns the steady drive of a machine.
    pub fn of(p: &Parameters) -> Self {
        let (amplifier, motor) = (&p.amplifier, &p.motor);
        if amplifier.dynamics == AmplifierDynamics::Modelled {
            let loss = motor.resistance_ohm + amplifier.gain * amplifier.current_feedback_v_a;
            return Self { gain: amplifier.gain, back_emf: motor.back_emf_v_s_rad, loss };
        }
        Self { gain: amplifier.stall_gain_a_v(motor), back_emf: 0.0, loss: 1.0 }
    }

    /// Returns the current, A, of a control, V, at a motor rate, rad/s.
    pub fn current_a(&self, control_v: f64, motor_rate_rad_s: f64) -> f64 {
        (self.gain * control_v - self.back_emf * motor_rate_rad_s) / self.loss
    }
}

/// Returns the cosine that gravity sees at a hub angle: 1 on a linear axis, whose weight is constant.
pub(crate) fn cosine(p: &Parameters, angle_rad: f64) -> f64 {
    if p.axis == AxisKind::Linear { 1.0 } else { angle_rad.cos() }
}

/// Returns the sine that gravity sees at a hub angle: 0 on a linear axis.
pub(crate) fn sine(p: &Parameters, angle_rad: f64) -> f64 {
    if p.axis == AxisKind::Linear { 0.0 } else { angle_rad.sin() }
}

/// Sensors that are present and that a machine can do without.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RedundantSensors {
    /// `true` if the motor's rate was recorded.
    pub motor_rate: bool,
    /// `true` if the hub's angle was recorded.
    pub hub_position: bool,
}

/// Returns the columns that a machine's balances can use: the motor's rate and the hub's angle close balances of their own only across
/// a transmission that yields, and beside a gyroscope.
pub(crate) fn usable_sensors(p: &Parameters, recorded: RedundantSensors) -> RedundantSensors {
    let across = !p.gearbox.is_rigid();
    let has_gyro = p.sensors.measured == FeedbackSignal::HubRate;
    RedundantSensors {
        motor_rate: recorded.motor_rate && across && has_gyro,
        hub_position: recorded.hub_position && has_gyro,
    }
}

/// Returns whether a component is part of a machine.
pub(crate) fn has_component(p: &Parameters, component: Component) -> bool {
    match component {
        Component::Gearbox => p.gearbox.kind != Transmission::Direct || !p.gearbox.is_rigid(),
        Component::PlatformGyro => p.sensors.platform_gyro.is_fitted(),
        Component::PlatformAccelerometer => p.sensors.platform_accelerometer.is_fitted(),
        Component::Platform => {
            p.sensors.platform_gyro.is_fitted() || p.sensors.platform_accelerometer.is_fitted()
        }
        _ => true,
    }
}

/// Returns whether a machine can have an effect.
pub fn can_have(p: &Parameters, effect: &Effect) -> bool {
    has_component(p, effect.component)
        && !replaced_by_cylinder(p, effect.component)
        && match effect.component {
            Component::Structure => structure_can_have(p, effect),
            Component::Gearbox => !p.gearbox.is_rigid() || effect.effect == EffectName::MeshRipple,
            Component::Motor => motor_can_have(p, effect.effect),
            Component::Amplifier => amplifier_can_have(p, effect.effect),
            Component::Pivot => friction_can_have(&p.pivot_friction.law, effect),
            Component::HubGyro => sensor_can_have(p.sensors.measured, effect),
            _ => true,
        }
}

/// Returns whether recordings have what an effect acts on: a misaligned gyroscope reads the base's roll and yaw, a tilted accelerometer its surge.
pub(crate) fn can_show(p: &Parameters, recordings: &[Recording], effect: &Effect) -> bool {
    let recorded = |channel| recordings.iter().all(|recording| recording.has(channel));
    match effect.effect {
        EffectName::Misalignment => recorded(Channel::PlatformRoll) && recorded(Channel::PlatformYaw),
        EffectName::PositionStiffness => {
            let is_shown = recorded(Channel::HubPosition) || acts_along_angle(p);
            (effect.parameters.len() > 1) == is_shown
        }
        EffectName::Tilt => p.sensors.surge_accelerometer.is_some() && recorded(Channel::PlatformSurge),
        _ => true,
    }
}

/// Returns whether something of the machine depends on the angle itself and not only on how far it turns: gravity, a spring, a free function.
fn acts_along_angle(p: &Parameters) -> bool {
    let lumped = p.lumped.as_ref();
    let along = lumped.is_none_or(|l| {
        l.out_of_balance_kg_m != 0.0 || l.vertical_offset_kg_m != 0.0 || l.position_stiffness_nm_rad != 0.0
    });
    along || !p.learned.is_empty()
}

/// Returns whether a machine with textbook values can have an effect of the textbook's own list: friction there has a scale of its own, whatever the
/// model's law is, but the rotor of a direct drive has none apart from the hub's.
pub(crate) fn can_have_textbook(p: &Parameters, effect: &Effect) -> bool {
    has_component(p, effect.component)
        && !replaced_by_cylinder(p, effect.component)
        && (effect.component != Component::Motor
            || effect.kind != EffectKind::MissingPhysics
            || !is_direct(p))
}

/// Returns whether a hydraulic cylinder drives in the place of a component, whose effects are then those of another machine.
fn replaced_by_cylinder(p: &Parameters, component: Component) -> bool {
    p.cylinder.is_some() && matches!(component, Component::Motor | Component::Amplifier | Component::Gearbox)
}

fn is_direct(p: &Parameters) -> bool {
    p.gearbox.is_rigid() && p.gearbox.kind == Transmission::Direct
}

fn structure_can_have(p: &Parameters, effect: &Effect) -> bool {
    let Some(lumped) = &p.lumped else { return false };
    let of_beam = effect.effect == EffectName::FlexibleMode || effect.parameters[0].name == "beam_inertia";
    match effect.effect {
        EffectName::VerticalOffset => p.axis == AxisKind::Rotary,
        EffectName::Equilibrator => p.loads.equilibrator.is_some(),
        EffectName::EndStops => p.loads.end_stops.is_some(),
        EffectName::Recoil => p.loads.recoil.is_some(),
        _ => !(of_beam && lumped.is_rigid()),
    }
}

/// Only a gyroscope has a sensitivity to other axes; the bias of a torque and that of a current have sizes and units of their own.
fn sensor_can_have(measured: FeedbackSignal, effect: &Effect) -> bool {
    match effect.effect {
        EffectName::GSensitivity | EffectName::Misalignment => measured == FeedbackSignal::HubRate,
        EffectName::Bias => {
            let unit = match measured {
                FeedbackSignal::Torque => "N m",
                FeedbackSignal::Current => "A",
                _ => "rad/s",
            };
            effect.parameters[0].unit == unit
        }
        _ => true,
    }
}

/// The rotor of a direct drive is part of the hub, and so is its friction.
fn motor_can_have(p: &Parameters, effect: EffectName) -> bool {
    let is_direct = is_direct(p);
    match effect {
        EffectName::Coulomb => !is_direct && p.motor_friction.law != FrictionLaw::None,
        EffectName::Viscous => !is_direct,
        EffectName::Inertia => !is_direct && p.motor.inertia_kg_m2 > 0.0,
        _ => true,
    }
}

fn amplifier_can_have(p: &Parameters, effect: EffectName) -> bool {
    match effect {
        EffectName::Bandwidth => p.amplifier.dynamics != AmplifierDynamics::IdealCurrent,
        EffectName::ContinuousCurrent => p.drive_limits.continuous_current_a.is_finite(),
        _ => true,
    }
}

/// A level or a stiffness that a law does not have cannot be another one; a law that has no dry friction can lack it.
fn friction_can_have(law: &FrictionLaw, effect: &Effect) -> bool {
    let has_none = *law == FrictionLaw::None;
    match (effect.effect, effect.kind) {
        (EffectName::Coulomb, EffectKind::MissingPhysics) => has_none,
        (
            EffectName::Coulomb
            | EffectName::Stribeck
            | EffectName::PositionDependentFriction
            | EffectName::PreslidingStiffness
            | EffectName::WarmUp,
            _,
        ) => !has_none,
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::library::list_effects;
    use counterpoise_models::Sensor;
    use counterpoise_models::parameters::Gearbox;
    use counterpoise_models::reference::rig;

    fn possible_effects(p: &Parameters) -> Vec<(Component, EffectName)> {
        list_effects().into_iter().filter(|e| can_have(p, e)).map(|e| (e.component, e.effect)).collect()
    }

    #[test]
    fn the_reference_rig_can_have_every_effect_but_those_of_parts_that_it_lacks() {
        let of_parts = [
            EffectName::Equilibrator,
            EffectName::EndStops,
            EffectName::Recoil,
            EffectName::ContinuousCurrent,
        ];
        let absent = |e: &&Effect| {
            let is_second_friction = e.effect == EffectName::Coulomb && e.kind == EffectKind::MissingPhysics;
            let of_other_sensor = e.component == Component::HubGyro
                && e.effect == EffectName::Bias
                && !sensor_can_have(FeedbackSignal::HubRate, e);
            of_parts.contains(&e.effect) || is_second_friction || of_other_sensor
        };
        let expected = list_effects().into_iter().filter(|e| !absent(e)).count();
        assert_eq!(possible_effects(&rig()).len(), expected);
    }

    #[test]
    fn a_spring_has_a_centre_only_where_something_shows_the_angle() {
        let mut recording = Recording::new("rate loop", 1e-3);
        recording.set(Channel::HubRate, vec![0.0; 4]);
        let centred = |p: &Parameters, recording: &Recording| {
            let springs = list_effects().into_iter().filter(|e| e.effect == EffectName::PositionStiffness);
            let shown = springs.filter(|e| can_show(p, std::slice::from_ref(recording), e));
            shown.map(|e| e.parameters.len() == 2).collect::<Vec<bool>>()
        };
        let mut p = rig();
        assert_eq!(centred(&p, &recording), [true]);
        p.lumped.as_mut().unwrap().out_of_balance_kg_m = 0.0;
        p.lumped.as_mut().unwrap().vertical_offset_kg_m = 0.0;
        assert_eq!(centred(&p, &recording), [false]);
        recording.set(Channel::HubPosition, vec![0.0; 4]);
        assert_eq!(centred(&p, &recording), [true]);
    }

    #[test]
    fn a_direct_torque_drive_without_platform_sensors_has_neither_gear_nor_platform_effects() {
        let mut p = rig();
        p.gearbox = Gearbox::DIRECT;
        p.amplifier.dynamics = AmplifierDynamics::TorqueCommand;
        p.sensors.platform_gyro = Sensor::ABSENT;
        p.sensors.platform_accelerometer = Sensor::ABSENT;
        let all = possible_effects(&p);
        let none = [
            Component::Gearbox,
            Component::PlatformGyro,
            Component::PlatformAccelerometer,
            Component::Platform,
        ];
        assert!(all.iter().all(|(component, _)| !none.contains(component)), "{all:?}");
        let drive = SteadyDrive::of(&p);
        assert_eq!(drive.current_a(2.0, 1e3), 2.0 * p.amplifier.gain);
    }
}
