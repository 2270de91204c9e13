//! The ranges in which a mechanism makes sense, checked once, when a plant is built.

use super::{Body, Plant};
use crate::friction::{FrictionModel, Law};
use crate::parameters::{Amplifier, AmplifierDynamics, LumpedStructure, Parameters, Sensor};
use crate::tolerance::MOST_CONVERTER_BITS;
use crate::{Error, Range};

/// Refuses parameters outside their ranges; the first one found is named with its path.
pub(super) fn check(parameters: &Parameters) -> Result<(), Error> {
    require_finite("gravity_m_s2", parameters.gravity_m_s2)?;
    drive(parameters)?;
    sensors(parameters)?;
    super::free_functions::check(parameters)?;
    parameters.cylinder.as_ref().map_or(Ok(()), |cylinder| cylinder.check(parameters))?;
    parameters.loads.check()?;
    drive_limits(parameters)?;
    interface(parameters)
}

/// Refuses a two-inertia structure that has no finite, damped mode.
pub(super) fn check_lumped(parameters: &Parameters, lumped: &LumpedStructure) -> Result<(), Error> {
    require_positive(
        "lumped.hub_inertia_kg_m2",
        lumped.hub_inertia_kg_m2 + parameters.reflected_inertia_kg_m2(),
    )?;
    not_negative("lumped.hub_inertia_kg_m2", lumped.hub_inertia_kg_m2)?;
    not_negative("lumped.beam_inertia_kg_m2", lumped.beam_inertia_kg_m2)?;
    positive_or_infinite("lumped.stiffness_nm_rad", lumped.stiffness_nm_rad)?;
    not_negative("lumped.damping_nm_s_rad", lumped.damping_nm_s_rad)?;
    require_finite("lumped.out_of_balance_kg_m", lumped.out_of_balance_kg_m)?;
    require_finite("lumped.vertical_offset_kg_m", lumped.vertical_offset_kg_m)?;
    // a spring past its unstable point, or a weight above the pivot, has a negative stiffness
    require_finite("lumped.position_stiffness_nm_rad", lumped.position_stiffness_nm_rad)?;
    require_finite("lumped.position_stiffness_centre_rad", lumped.position_stiffness_centre_rad)?;
    not_negative("lumped.hysteresis_nm", lumped.hysteresis_nm)?;
    not_negative("lumped.hysteresis_stiffness_nm_rad", lumped.hysteresis_stiffness_nm_rad)?;
    for (k, link) in lumped.chain.iter().enumerate() {
        require_positive(&format!("lumped.chain[{k}].inertia_kg_m2"), link.inertia_kg_m2)?;
        require_positive(&format!("lumped.chain[{k}].stiffness_nm_rad"), link.stiffness_nm_rad)?;
        not_negative(&format!("lumped.chain[{k}].damping_nm_s_rad"), link.damping_nm_s_rad)?;
    }
    Ok(())
}

/// Refuses a modal structure without inertia or with a mode that is not an oscillator.
pub(super) fn body(body: &Body) -> Result<(), Error> {
    require_positive("body.inertia_kg_m2", body.inertia_kg_m2)?;
    require_finite("body.out_of_balance_kg_m", body.out_of_balance_kg_m)?;
    require_finite("body.vertical_offset_kg_m", body.vertical_offset_kg_m)?;
    for (k, mode) in body.modes.iter().enumerate() {
        require_positive(&format!("body.modes[{k}].frequency_rad_s"), mode.frequency_rad_s)?;
        not_negative(&format!("body.modes[{k}].damping_ratio"), mode.damping_ratio)?;
        require_finite(&format!("body.modes[{k}].hub_shape"), mode.hub_shape)?;
        require_finite(&format!("body.modes[{k}].tip_shape"), mode.tip_shape)?;
        require_finite(&format!("body.modes[{k}].load_share_kg_m"), mode.load_share_kg_m)?;
    }
    Ok(())
}

fn drive(parameters: &Parameters) -> Result<(), Error> {
    let (gearbox, motor, amplifier) = (&parameters.gearbox, &parameters.motor, &parameters.amplifier);
    require_positive("gearbox.ratio", gearbox.ratio)?;
    positive_or_infinite("gearbox.stiffness_nm_rad", gearbox.stiffness_nm_rad)?;
    not_negative("gearbox.damping_nm_s_rad", gearbox.damping_nm_s_rad)?;
    not_negative("gearbox.backlash_rad", gearbox.backlash_rad)?;
    require(Range::AboveTo(0.0, 1.0), "gearbox.mesh_efficiency", gearbox.mesh_efficiency)?;
    require_finite("gearbox.kinematic_error.amplitude", gearbox.kinematic_error.amplitude)?;
    not_negative("gearbox.hysteresis_nm", gearbox.hysteresis_nm)?;
    not_negative("gearbox.hysteresis_stiffness_nm_rad", gearbox.hysteresis_stiffness_nm_rad)?;
    match gearbox.is_rigid() {
        true => check_rigid(parameters)?,
        false => require_positive("motor.inertia_kg_m2", motor.inertia_kg_m2)?,
    }
    not_negative("motor.inertia_kg_m2", motor.inertia_kg_m2)?;
    require_positive("motor.torque_constant_nm_a", motor.torque_constant_nm_a)?;
    not_negative("motor.back_emf_v_s_rad", motor.back_emf_v_s_rad)?;
    require_positive("motor.resistance_ohm", motor.resistance_ohm)?;
    not_negative("motor.inductance_h", motor.inductance_h)?;
    require_finite("motor.platform_coupling", motor.platform_coupling)?;
    require_positive("amplifier.gain", amplifier.gain)?;
    not_negative("amplifier.current_feedback_v_a", amplifier.current_feedback_v_a)?;
    not_negative("amplifier.time_constant_s", amplifier.time_constant_s)?;
    if let AmplifierDynamics::CurrentLoop { bandwidth_rad_s, delay_s } = amplifier.dynamics {
        require_positive("drive.bandwidth_rad_s", bandwidth_rad_s)?;
        not_negative("drive.delay_s", delay_s)?;
    }
    voltage_without_lag(amplifier)?;
    positive_or_infinite("amplifier.input_limit_v", amplifier.input_limit_v)?;
    positive_or_infinite("amplifier.bus_voltage_v", amplifier.bus_voltage_v)?;
    positive_or_infinite("amplifier.current_limit_a", amplifier.current_limit_a)?;
    not_negative("amplifier.dead_zone_v", amplifier.dead_zone_v)?;
    map(parameters)
}

/// Refuses with a rigid transmission what only a torque through a mesh that gives can have.
fn check_rigid(parameters: &Parameters) -> Result<(), Error> {
    let gearbox = &parameters.gearbox;
    let loads = [
        ("motor_friction.load_coefficient", parameters.motor_friction.load_coefficient),
        ("pivot_friction.load_coefficient", parameters.pivot_friction.load_coefficient),
    ];
    let of_mesh = [
        ("gearbox.backlash_rad", gearbox.backlash_rad),
        ("gearbox.mesh_efficiency", 1.0 - gearbox.mesh_efficiency),
        ("gearbox.kinematic_error.amplitude", gearbox.kinematic_error.amplitude),
        ("gearbox.hysteresis_nm", gearbox.hysteresis_nm),
    ];
    let needs = of_mesh.into_iter().chain(loads).find(|(_, value)| *value != 0.0);
    needs.map_or(Ok(()), |(parameter, value)| {
        Err(Error::Parameter {
            parameter: parameter.to_owned(),
            value,
            allowed: "needs a transmission that gives: state gearbox.stiffness as well".into(),
        })
    })
}

/// Refuses a limit of the voltage where neither a lag nor the drive alone decides the voltage.
fn voltage_without_lag(amplifier: &Amplifier) -> Result<(), Error> {
    let free = amplifier.time_constant_s > 0.0
        || amplifier.dynamics != AmplifierDynamics::Modelled
        || amplifier.current_feedback_v_a == 0.0
        || amplifier.bus_voltage_v == f64::INFINITY;
    if free {
        return Ok(());
    }
    let allowed = "must be above 0 if the amplifier has current feedback and a bus voltage".into();
    Err(Error::Parameter { parameter: "amplifier.time_constant_s".to_owned(), value: 0.0, allowed })
}

/// Refuses two laws that truly stick on one body.
pub(super) fn joints(plant: &Plant) -> Result<(), Error> {
    let sticks = |model: &FrictionModel| matches!(model.law(), Law::Sliding(_));
    if !(plant.is_rigid() && sticks(&plant.motor_friction) && sticks(&plant.pivot_friction)) {
        return Ok(());
    }
    let allowed = "must be 0 behind a rigid transmission if the pivot's law truly sticks as well: add it, times the ratio, to the pivot's";
    let value = plant.parameters.motor_friction.coulomb_nm();
    Err(Error::Parameter { parameter: "motor_friction.coulomb".to_owned(), value, allowed: allowed.into() })
}

fn map(parameters: &Parameters) -> Result<(), Error> {
    let mut last = (0.0, 0.0);
    for (k, point) in parameters.amplifier.map.iter().enumerate() {
        let rises = point.input_v > last.0 && point.current_a >= last.1 && point.current_a.is_finite();
        if !rises {
            return Err(Error::Parameter {
                parameter: format!("amplifier.map[{k}].input_v"),
                value: point.input_v,
                allowed: "must be positive and above the point before, and its current must not fall".into(),
            });
        }
        last = (point.input_v, point.current_a);
    }
    Ok(())
}

fn sensors(parameters: &Parameters) -> Result<(), Error> {
    let sensors = &parameters.sensors;
    let named = [
        ("sensors.hub_gyro", Some(&sensors.hub_gyro)),
        ("sensors.platform_gyro", Some(&sensors.platform_gyro)),
        ("sensors.platform_accelerometer", Some(&sensors.platform_accelerometer)),
        ("sensors.motor_tachometer", sensors.motor_tachometer.as_ref()),
        ("sensors.hub_resolver", sensors.hub_resolver.as_ref()),
        ("sensors.surge_accelerometer", sensors.surge_accelerometer.as_ref()),
    ];
    require_finite("sensors.accelerometer_lever_arm_m", sensors.accelerometer_lever_arm_m)?;
    named.into_iter().filter_map(|(path, sensor)| Some((path, sensor?))).try_for_each(|(p, s)| sensor(p, s))
}

fn sensor(path: &str, sensor: &Sensor) -> Result<(), Error> {
    let at = |name: &str| format!("{path}.{name}");
    positive_or_infinite(&at("natural_frequency_rad_s"), sensor.natural_frequency_rad_s)?;
    require_positive(&at("damping_ratio"), sensor.damping_ratio)?;
    require_positive(&at("scale_v_unit"), sensor.scale_v_unit)?;
    not_negative(&at("noise_rms"), sensor.noise_rms)?;
    require_finite(&at("gain"), sensor.gain)?;
    require_finite(&at("bias"), sensor.bias)?;
    not_negative(&at("delay_s"), sensor.delay_s)?;
    not_negative(&at("resolution"), sensor.resolution)?;
    not_negative(&at("own_period_s"), sensor.own_period_s)?;
    let alignment = &sensor.alignment;
    require_finite(&at("alignment.roll_sensitivity"), alignment.roll_sensitivity)?;
    require_finite(&at("alignment.yaw_sensitivity"), alignment.yaw_sensitivity)?;
    require_finite(&at("alignment.tilt_rad"), alignment.tilt_rad)?;
    require_finite(&at("g_sensitivity"), sensor.g_sensitivity)
}

fn drive_limits(parameters: &Parameters) -> Result<(), Error> {
    let limits = &parameters.drive_limits;
    positive_or_infinite("drive_limits.slew_v_s", limits.slew_v_s)?;
    positive_or_infinite("drive_limits.motor_rate_rad_s", limits.motor_rate_rad_s)?;
    positive_or_infinite("drive_limits.supply_power_w", limits.supply_power_w)?;
    positive_or_infinite("drive_limits.continuous_current_a", limits.continuous_current_a)?;
    require_positive("drive_limits.overload_time_s", limits.overload_time_s)?;
    let Some(heat) = &limits.heat else { return Ok(()) };
    require_positive("drive_limits.heat.winding_k_w", heat.winding_k_w)?;
    require_positive("drive_limits.heat.housing_k_w", heat.housing_k_w)?;
    require_positive("drive_limits.heat.winding_time_s", heat.winding_time_s)?;
    require_positive("drive_limits.heat.housing_time_s", heat.housing_time_s)?;
    require_positive("drive_limits.heat.ambient_k", heat.ambient_k)?;
    require_positive("drive_limits.heat.start_k", heat.start_k)?;
    require_positive("drive_limits.heat.limit_k", heat.limit_k)
}

fn interface(parameters: &Parameters) -> Result<(), Error> {
    let interface = &parameters.interface;
    require_positive("interface.sample_period_s", interface.sample_period_s)?;
    for (path, bits) in
        [("interface.input_bits", interface.input_bits), ("interface.output_bits", interface.output_bits)]
    {
        require(Range::Between(1.0, MOST_CONVERTER_BITS), path, f64::from(bits))?;
    }
    Ok(())
}

fn require_positive(parameter: &str, value: f64) -> Result<(), Error> {
    require(Range::POSITIVE, parameter, value)
}

fn not_negative(parameter: &str, value: f64) -> Result<(), Error> {
    require(Range::NOT_NEGATIVE, parameter, value)
}

fn require_finite(parameter: &str, value: f64) -> Result<(), Error> {
    require(Range::Any, parameter, value)
}

fn require(range: Range, parameter: &str, value: f64) -> Result<(), Error> {
    range.check("", parameter, value).map(|_| ())
}

/// Checks a limit that may be absent: infinity stands for none.
fn positive_or_infinite(parameter: &str, value: f64) -> Result<(), Error> {
    if value > 0.0 {
        return Ok(());
    }
    let allowed = "must be above 0, or infinite if there is no limit".into();
    Err(Error::Parameter { parameter: parameter.to_owned(), value, allowed })
}
