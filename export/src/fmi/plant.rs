//! The nonlinear plant as a co-simulation unit.

use counterpoise_models::parameters::{AmplifierDynamics, Friction, FrictionLaw, Parameters, Sensor};
use counterpoise_models::plant::Plant;
use minijinja::{Environment, context};

use crate::fmi::{Unit, Variable};
use crate::{Error, File, Provenance, check_name};

/// Longest step of the generated integrator, s.
const SUBSTEP_S: f64 = 5e-5;
/// Most sensor states per substep: a natural frequency above this would need shorter ones, rad/s.
const FASTEST_RAD_S: f64 = 10_000.0;

/// A plant unit that was asked for.
#[derive(Debug, Clone, Copy)]
pub struct PlantUnit<'a> {
    /// The plant.
    pub plant: &'a Plant,
    /// Name of the unit: a lower-case identifier.
    pub name: &'a str,
}

/// Why a plant has no unit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlantUnitError {
    /// Physics that the generated code does not hold.
    #[error(
        "the generated plant has no {what}: leave \"fmi\" out of export.languages, or describe the plant without it"
    )]
    Physics {
        /// What the plant has.
        what: &'static str,
    },
    /// The unit could not be written.
    #[error(transparent)]
    Export(#[from] Error),
}

/// The lumped nonlinear plant as an FMI 3.0 co-simulation unit in C99 (with the mathematical library), in a folder of its
/// name: amplifier with limits and map, armature, gear with backlash, two inertias, gravity, Dahl friction, second-order
/// sensors. Inputs: control, heave, pitch rate. Outputs: readings without noise or quantisation, true rates, current.
///
/// # Errors
/// [`PlantUnitError::Physics`] for a plant with other physics, [`PlantUnitError::Export`] for a bad name.
pub fn plant_unit(asked: PlantUnit, provenance: &Provenance) -> Result<Vec<File>, PlantUnitError> {
    let PlantUnit { plant, name } = asked;
    check_name(name)?;
    let parameters = plant.parameters();
    if let Some(what) = missing(parameters) {
        return Err(PlantUnitError::Physics { what });
    }
    let numbers = numbers(parameters).ok_or(PlantUnitError::Physics { what: "beam with several modes" })?;
    let map: Vec<(String, String)> = map(parameters);
    let data = context! {
        name, NAME => name.to_uppercase(), provenance => provenance.lines(),
        substep => format!("{SUBSTEP_S:?}"), parameters => numbers, map,
    };
    let environment = Environment::new();
    let fill = |ending: &str, template: &str| -> Result<File, Error> {
        let text = environment.render_str(template, &data)?.trim_end().to_owned() + "\n";
        Ok(File { name: format!("{name}/sources/{name}.{ending}"), text })
    };
    let mut files = vec![
        fill("h", include_str!("../../templates/plant.h.jinja"))?,
        fill("c", include_str!("../../templates/plant.c.jinja"))?,
    ];
    let behaviour = environment.render_str(include_str!("../../templates/fmu_plant.c.jinja"), &data);
    let unit = Unit {
        name,
        description: "nonlinear plant of a stabilised, out-of-balance servo mechanism",
        tool: &provenance.generator,
        provenance: &provenance.lines(),
        variables: &variables(),
        period_s: parameters.interface.sample_period_s,
        behaviour: behaviour.map_err(Error::from)?,
    };
    files.extend(unit.files()?);
    Ok(files)
}

fn variables() -> Vec<Variable> {
    let local =
        |name, unit, says| Variable { causality: "local", start: None, ..Variable::output(name, unit, says) };
    vec![
        Variable::time(),
        Variable::input("control_v", "V", "control after the output converter, held over a step"),
        Variable::input("heave_m_s2", "m/s2", "upward acceleration of the pivot, without gravity"),
        Variable::input("pitch_rate_rad_s", "rad/s", "pitch rate of the platform"),
        Variable::output("hub_rate_rad_s", "rad/s", "hub gyroscope"),
        Variable::output("platform_rate_rad_s", "rad/s", "platform gyroscope"),
        Variable::output("platform_accel_m_s2", "m/s2", "platform accelerometer"),
        Variable::output("motor_rate_rad_s", "rad/s", "motor tachometer"),
        Variable::output("hub_position_rad", "rad", "hub angle relative to the platform"),
        Variable::output("true_hub_rate_rad_s", "rad/s", "hub rate"),
        Variable::output("true_tip_rate_rad_s", "rad/s", "tip rate"),
        Variable::output("current_a", "A", "armature current"),
        local("last_heave_m_s2", "m/s2", "heave of the step before"),
        local("last_pitch_rate_rad_s", "rad/s", "pitch rate of the step before"),
    ]
}

/// What the plant has and the generated code does not.
fn missing(p: &Parameters) -> Option<&'static str> {
    let s = &p.sensors;
    let spring = p.lumped.as_ref().is_some_and(|lumped| lumped.position_stiffness_nm_rad != 0.0);
    let sensors = [&s.hub_gyro, &s.platform_gyro, &s.platform_accelerometer];
    let ideal = [s.motor_tachometer.as_ref(), s.hub_resolver.as_ref()];
    let all = sensors.into_iter().chain(ideal.into_iter().flatten());
    let faulty = |sensor: &Sensor| {
        sensor.gain != 1.0 || sensor.bias != 0.0 || sensor.delay_s != 0.0 || sensor.g_sensitivity != 0.0
    };
    let checks = [
        (p.gearbox.mesh_ripple.amplitude != 0.0, "mesh ripple"),
        (p.gearbox.mesh_efficiency != 1.0, "mesh efficiency"),
        (p.motor.cogging.amplitude != 0.0, "cogging"),
        (p.motor.torque_ripple.amplitude != 0.0, "torque ripple"),
        (p.motor.platform_coupling != 0.0, "coupling of the rotor to the platform"),
        (p.amplifier.current_limit_a.is_finite(), "current limit"),
        (p.amplifier.dynamics == AmplifierDynamics::IdealCurrent, "ideal current source"),
        (spring, "position spring"),
        (p.lumped.as_ref().is_some_and(|lumped| lumped.hysteresis_nm != 0.0), "hose with hysteresis"),
        (
            !dahl_or_none(&p.motor_friction) || !dahl_or_none(&p.pivot_friction),
            "friction but Dahl's and viscous",
        ),
        (all.clone().any(faulty) || s.accelerometer_lever_arm_m != 0.0, "sensor faults"),
        (sensors.iter().any(|sensor| sensor.natural_frequency_rad_s > FASTEST_RAD_S), "ideal gyroscopes"),
        (
            ideal.iter().flatten().any(|sensor| sensor.natural_frequency_rad_s.is_finite()),
            "slow tachometer or resolver",
        ),
        (p.interface.output_delay_samples != 0, "output delay"),
    ];
    checks.into_iter().find(|(has, _)| *has).map(|(_, what)| what)
}

fn dahl_or_none(friction: &Friction) -> bool {
    let law = match friction.law {
        FrictionLaw::None => true,
        FrictionLaw::Dahl { exponent, .. } => exponent == 1.0,
        _ => false,
    };
    let plain = Friction::plain(friction.law.clone(), friction.viscous_nm_s_rad);
    let ignoring_unused = Friction {
        stribeck_rate_rad_s: plain.stribeck_rate_rad_s,
        warm_up_time_s: plain.warm_up_time_s,
        position_ripple: plain.position_ripple,
        ..friction.clone()
    };
    law && ignoring_unused == plain && friction.position_ripple.amplitude == 0.0
}

fn dahl(friction: &Friction) -> (f64, f64) {
    match friction.law {
        FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad, .. } => (coulomb_nm, rest_stiffness_nm_rad),
        _ => (0.0, 0.0),
    }
}

/// Name, value and unit of each constant of the code; nothing where the structure is not lumped.
fn numbers(p: &Parameters) -> Option<Vec<(&'static str, String, &'static str)>> {
    let lumped = p.lumped.as_ref()?;
    let (motor_coulomb, motor_sigma) = dahl(&p.motor_friction);
    let (pivot_coulomb, pivot_sigma) = dahl(&p.pivot_friction);
    let s = &p.sensors;
    let all = [
        ("gravity", p.gravity_m_s2, "m/s^2"),
        ("hub_inertia", lumped.hub_inertia_kg_m2, "kg m^2"),
        ("beam_inertia", lumped.beam_inertia_kg_m2, "kg m^2"),
        ("shaft_stiffness", lumped.stiffness_nm_rad, "N m/rad, hub to beam"),
        ("shaft_damping", lumped.damping_nm_s_rad, "N m s/rad"),
        ("out_of_balance", lumped.out_of_balance_kg_m, "kg m"),
        ("vertical_offset", lumped.vertical_offset_kg_m, "kg m"),
        ("ratio", p.gearbox.ratio, "motor turns per hub turn"),
        ("mesh_stiffness", p.gearbox.stiffness_nm_rad, "N m/rad, at the output"),
        ("mesh_damping", p.gearbox.damping_nm_s_rad, "N m s/rad"),
        ("backlash", p.gearbox.backlash_rad, "rad, total"),
        ("motor_inertia", p.motor.inertia_kg_m2, "kg m^2"),
        ("torque_constant", p.motor.torque_constant_nm_a, "N m/A"),
        ("back_emf", p.motor.back_emf_v_s_rad, "V s/rad"),
        ("resistance", p.motor.resistance_ohm, "ohm"),
        ("inductance", p.motor.inductance_h, "H"),
        ("amplifier_gain", p.amplifier.gain, "V/V"),
        ("current_feedback", p.amplifier.current_feedback_v_a, "V/A"),
        ("amplifier_time", p.amplifier.time_constant_s, "s"),
        ("input_limit", p.amplifier.input_limit_v, "V"),
        ("dead_zone", p.amplifier.dead_zone_v, "V"),
        ("bus_voltage", p.amplifier.bus_voltage_v, "V"),
        ("motor_coulomb", motor_coulomb, "N m"),
        ("motor_sigma", motor_sigma, "N m/rad"),
        ("motor_viscous", p.motor_friction.viscous_nm_s_rad, "N m s/rad"),
        ("pivot_coulomb", pivot_coulomb, "N m"),
        ("pivot_sigma", pivot_sigma, "N m/rad"),
        ("pivot_viscous", p.pivot_friction.viscous_nm_s_rad, "N m s/rad"),
        ("hub_gyro_rad_s", s.hub_gyro.natural_frequency_rad_s, "rad/s"),
        ("hub_gyro_damping", s.hub_gyro.damping_ratio, "1"),
        ("platform_gyro_rad_s", s.platform_gyro.natural_frequency_rad_s, "rad/s"),
        ("platform_gyro_damping", s.platform_gyro.damping_ratio, "1"),
        ("accelerometer_rad_s", s.platform_accelerometer.natural_frequency_rad_s, "rad/s"),
        ("accelerometer_damping", s.platform_accelerometer.damping_ratio, "1"),
    ];
    Some(all.map(|(name, value, unit)| (name, format!("{value:?}"), unit)).to_vec())
}

fn map(p: &Parameters) -> Vec<(String, String)> {
    let gain = p.amplifier.stall_gain_a_v(&p.motor);
    let points = p.amplifier.map.iter();
    points.map(|point| (format!("{:?}", point.input_v), format!("{:?}", point.current_a / gain))).collect()
}
