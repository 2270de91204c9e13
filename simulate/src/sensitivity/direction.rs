//! Directions in which a run is varied: families of machines along one number.

use super::refusal::SensitivityRefusal;
use super::stencil::{MEMBERS, Side, Stencil};
use crate::engine::ports::Ports;
use crate::engine::state::PlantState;
use crate::run::initial_state;
use crate::{Error, Scenario};
use counterpoise_models::friction::{FrictionModel, Law};
use counterpoise_models::{LearnedElement, Mesh, Parameters, Plant};

/// A machine of a family, and where its run starts.
#[derive(Debug, Clone)]
pub struct Member {
    /// The machine.
    pub plant: Plant,
    /// The state at the start; `None` if the scenario gives it.
    pub start: Option<PlantState>,
}

/// A direction in which a run is varied: a parameter of the machine, a freedom of its start, or any mixture of both.
pub struct Direction<'a> {
    /// Returns the machine at a distance from the nominal one, which is at 0.
    pub member: &'a dyn Fn(f64) -> Result<Member, Error>,
    /// Distance over which the machine's stored numbers are differenced: about a thousandth of a typical value.
    pub step: f64,
    /// The side on which the family exists.
    pub side: Side,
}

/// A direction made ready: its members, and what differs between them.
#[derive(Debug, Clone)]
pub(crate) struct Family {
    pub stencil: Stencil,
    pub plants: [Plant; MEMBERS],
    pub ports: [Ports; MEMBERS],
    pub starts: [PlantState; MEMBERS],
    /// `true` if the linear core or what is seen of it differs.
    pub has_other_core: bool,
    /// `true` if torques of angle, rate and current differ.
    pub has_other_parts: bool,
    /// `true` if the static part of the amplifier may differ.
    pub has_other_amplifier: bool,
    /// `true` for each joint whose dry friction differs.
    pub has_other_friction: [bool; 2],
}

impl Family {
    /// Returns the members of a direction beside a nominal plant.
    pub fn new(
        nominal: &Plant,
        direction: &Direction,
        scenario: &Scenario,
        place: usize,
    ) -> Result<Self, SensitivityRefusal> {
        let stencil = Stencil::new(direction.side, direction.step);
        let mut plants = Vec::with_capacity(MEMBERS);
        let mut starts = Vec::with_capacity(MEMBERS);
        for distance in stencil.distances {
            let member = (direction.member)(distance)?;
            check_structure(nominal, &member.plant, place)?;
            starts.push(match member.start {
                Some(start) => start,
                None => start_of(&member.plant, scenario)?,
            });
            plants.push(member.plant);
        }
        let ports = plants.iter().map(Ports::new).collect::<Result<Vec<_>, Error>>()?;
        let of = |what: &'static str| Error::Length { what, found: 0, expected: MEMBERS };
        let plants: [Plant; MEMBERS] = plants.try_into().map_err(|_| of("plants of a family"))?;
        let ports: [Ports; MEMBERS] = ports.try_into().map_err(|_| of("parts of a family"))?;
        let starts: [PlantState; MEMBERS] = starts.try_into().map_err(|_| of("starts of a family"))?;
        let own = Ports::new(nominal)?;
        let frictions = own.frictions();
        let has_other_friction =
            [0, 1].map(|joint| ports.iter().any(|p| p.frictions()[joint] != frictions[joint]));
        Ok(Self {
            has_other_core: plants.iter().any(|plant| !has_same_core(plant, nominal)),
            has_other_parts: plants.iter().any(|plant| !has_same_parts(plant, nominal)),
            has_other_amplifier: plants.iter().any(|plant| !has_same_amplifier(plant, nominal)),
            has_other_friction,
            stencil,
            plants,
            ports,
            starts,
        })
    }

    /// Returns the derivative of a number of the plant.
    pub fn slope_of(&self, nominal: &Plant, value: impl Fn(&Plant) -> f64) -> f64 {
        let own = value(nominal);
        self.stencil.derivative(own, self.plants.each_ref().map(value))
    }
}

/// Returns the state from which a scenario starts a plant.
pub(crate) fn start_of(plant: &Plant, scenario: &Scenario) -> Result<PlantState, Error> {
    let platform = &scenario.platform;
    initial_state(plant, scenario, platform.initial_angle_rad, platform.pitch_rate_rad_s.at(0.0))
}

fn has_same_core(a: &Plant, b: &Plant) -> bool {
    let rows = |plant: &Plant| {
        [plant.motor_rate_row(), plant.hub_angle_row(), plant.tip_rate_row(), plant.current_row()]
    };
    rows(a) == rows(b) && [Mesh::Touching, Mesh::Free].into_iter().all(|mesh| a.core(mesh) == b.core(mesh))
}

/// Returns whether the static part of the amplifier is the same; that of a current source has the motor's resistance.
fn has_same_amplifier(a: &Plant, b: &Plant) -> bool {
    let [own, other] = [a, b].map(Plant::parameters);
    own.amplifier == other.amplifier && own.motor.resistance_ohm == other.motor.resistance_ohm
}

/// Returns whether the torques of angle, rate and current are the same: those of drag, ripples, spring, weight and limit of the current.
fn has_same_parts(a: &Plant, b: &Plant) -> bool {
    let [own, other] = [a, b].map(Plant::parameters);
    let numbers = |plant: &Plant| {
        let parameters = plant.parameters();
        let (motor, hub) = (&parameters.motor_friction, &parameters.pivot_friction);
        [
            parameters.motor.torque_constant_nm_a,
            parameters.amplifier.current_limit_a,
            motor.drag_nm(1.0),
            motor.drag_nm(-1.0),
            hub.drag_nm(1.0),
            hub.drag_nm(-1.0),
            plant.spring_torque_nm(0.0),
            plant.spring_torque_nm(1.0),
            parameters.gravity_m_s2,
            plant.body().vertical_offset_kg_m,
        ]
    };
    numbers(a) == numbers(b)
        && own.motor.cogging == other.motor.cogging
        && own.motor.torque_ripple == other.motor.torque_ripple
        && own.gearbox.mesh_ripple == other.gearbox.mesh_ripple
}

/// Returns the errors of the platform's sensors.
fn platform_errors(of: &Parameters) -> Vec<&LearnedElement> {
    of.learned.iter().filter(|element| element.place.is_platform_sensor()).collect()
}

/// Checks that a member differs from the nominal plant by degree only.
fn check_structure(nominal: &Plant, member: &Plant, direction: usize) -> Result<(), SensitivityRefusal> {
    let (own, other) = (nominal.parameters(), member.parameters());
    let gap = |plant: &Plant| plant.parameters().gearbox.backlash_rad > 0.0;
    let shape = |friction: &counterpoise_models::Friction| {
        FrictionModel::new(friction).map(|model| std::mem::discriminant(model.law())).ok()
    };
    let band = |friction: &counterpoise_models::Friction| match FrictionModel::new(friction).map(|m| *m.law())
    {
        Ok(Law::Sliding(law)) => law.breakaway_ratio > 1.0,
        _ => false,
    };
    let checks = [
        (
            "the states of the machine",
            nominal.core_order() == member.core_order() && nominal.is_rigid() == member.is_rigid(),
        ),
        ("whether there is a gap between the teeth", gap(nominal) == gap(member)),
        ("the law of the motor's friction", shape(&own.motor_friction) == shape(&other.motor_friction)),
        ("the law of the pivot's friction", shape(&own.pivot_friction) == shape(&other.pivot_friction)),
        (
            "whether the motor's friction is larger at rest",
            band(&own.motor_friction) == band(&other.motor_friction),
        ),
        (
            "whether the pivot's friction is larger at rest",
            band(&own.pivot_friction) == band(&other.pivot_friction),
        ),
        ("the interface", own.interface == other.interface),
        (
            "the sensors of the platform",
            own.sensors.platform_gyro == other.sensors.platform_gyro
                && own.sensors.platform_accelerometer == other.sensors.platform_accelerometer
                && own.sensors.surge_accelerometer == other.sensors.surge_accelerometer
                && platform_errors(own) == platform_errors(other),
        ),
        (
            "what the loop's sensor measures",
            own.sensors.measured == other.sensors.measured && own.axis == other.axis,
        ),
    ];
    match checks.into_iter().find(|(_, same)| !same) {
        Some((what, _)) => Err(SensitivityRefusal::Structure { direction, what }),
        None => Ok(()),
    }
}
