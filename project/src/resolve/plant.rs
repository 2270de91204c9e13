//! The `[plant]` section: drive train, sensors, interface, and the structure.

use counterpoise_models::{
    Amplifier, AmplifierDynamics, Friction, FrictionLaw, Gearbox, Interface, MapPoint, Motor, Parameters,
    Ripple, Sensor, Sensors,
};

use super::friction::{friction, ripple};
use super::structure::{beam, blank_beam, blank_configuration, blank_lumped, configuration, lumped};
use crate::file::field::{Field, Limit, TableField};
use crate::file::visit::{Choice, Visit, choose, list, optional, table};

const AT_LEAST_0: Limit = Limit::AtLeast(0.0);
const ABOVE_0: Limit = Limit::Above(0.0);
/// Most bits that a converter may have.
const MOST_BITS: f64 = 32.0;
/// Most samples by which the control may be held back.
const MOST_DELAY: f64 = 1000.0;

/// A mechanism still to be read.
pub(crate) fn blank() -> Parameters {
    Parameters {
        name: String::new(),
        gravity_m_s2: f64::NAN,
        beam: None,
        lumped: None,
        gearbox: blank_gearbox(),
        motor: blank_motor(),
        amplifier: blank_amplifier(),
        motor_friction: Friction::plain(FrictionLaw::None, 0.0),
        pivot_friction: Friction::plain(FrictionLaw::None, 0.0),
        sensors: Sensors {
            hub_gyro: Sensor::IDEAL,
            platform_gyro: Sensor::IDEAL,
            platform_accelerometer: Sensor::IDEAL,
            accelerometer_lever_arm_m: 0.0,
            motor_tachometer: None,
            hub_resolver: None,
        },
        interface: Interface {
            sample_period_s: f64::NAN,
            input_bits: 0,
            output_bits: 0,
            output_delay_samples: 0,
        },
        configurations: Vec::new(),
    }
}

fn blank_gearbox() -> Gearbox {
    Gearbox {
        ratio: f64::NAN,
        stiffness_nm_rad: f64::NAN,
        damping_nm_s_rad: f64::NAN,
        backlash_rad: f64::NAN,
        mesh_ripple: Ripple::NONE,
        mesh_efficiency: 1.0,
    }
}

fn blank_motor() -> Motor {
    Motor {
        inertia_kg_m2: f64::NAN,
        torque_constant_nm_a: f64::NAN,
        back_emf_v_s_rad: f64::NAN,
        resistance_ohm: f64::NAN,
        inductance_h: f64::NAN,
        cogging: Ripple::NONE,
        torque_ripple: Ripple::NONE,
        platform_coupling: 0.0,
    }
}

fn blank_amplifier() -> Amplifier {
    Amplifier {
        gain: f64::NAN,
        current_feedback_v_a: f64::NAN,
        time_constant_s: f64::NAN,
        input_limit_v: f64::NAN,
        bus_voltage_v: f64::NAN,
        map: Vec::new(),
        dead_zone_v: 0.0,
        current_limit_a: f64::INFINITY,
        dynamics: AmplifierDynamics::Modelled,
    }
}

/// Reads or lists the plant.
pub(crate) fn plant(v: &mut dyn Visit, plant: &mut Parameters) {
    v.text(&Field::new("name", "name of the machine"), &mut plant.name);
    v.number(
        &Field::new("gravity", "acceleration of gravity").unit("m/s^2").limit(AT_LEAST_0).or(9.80665),
        &mut plant.gravity_m_s2,
    );
    optional(
        v,
        &TableField::optional("beam", "the structure as a beam"),
        &mut plant.beam,
        blank_beam(),
        beam,
    );
    optional(
        v,
        &TableField::optional("lumped", "the structure as two inertias"),
        &mut plant.lumped,
        blank_lumped(),
        lumped,
    );
    table(v, &TableField::required("gearbox", "gearbox between motor and hub"), &mut plant.gearbox, gearbox);
    table(v, &TableField::required("motor", "motor"), &mut plant.motor, motor);
    table(
        v,
        &TableField::required("amplifier", "amplifier that drives the motor"),
        &mut plant.amplifier,
        amplifier,
    );
    table(v, &TableField::required("friction", "friction at motor and pivot"), plant, frictions);
    table(v, &TableField::required("sensors", "sensors"), &mut plant.sensors, sensors);
    table(
        v,
        &TableField::required("interface", "converters and clock of the controller"),
        &mut plant.interface,
        interface,
    );
    list(
        v,
        &TableField::optional("configuration", "a way to load the mechanism"),
        &mut plant.configurations,
        blank_configuration(),
        configuration,
    );
}

fn gearbox(v: &mut dyn Visit, gearbox: &mut Gearbox) {
    v.number(&Field::new("ratio", "motor turns per hub turn").limit(ABOVE_0), &mut gearbox.ratio);
    v.number(
        &Field::new("stiffness", "of the mesh, at the output").unit("N m/rad").limit(ABOVE_0),
        &mut gearbox.stiffness_nm_rad,
    );
    let damping = Field::new("damping", "at the output, only while the teeth touch")
        .unit("N m s/rad")
        .limit(AT_LEAST_0);
    v.number(&damping.or(0.0), &mut gearbox.damping_nm_s_rad);
    v.number(
        &Field::new("backlash", "total gap at the output").unit("rad").limit(AT_LEAST_0).or(0.0),
        &mut gearbox.backlash_rad,
    );
    let efficiency =
        Field::new("mesh_efficiency", "fraction of the mesh torque that arrives while it drives");
    v.number(&efficiency.limit(Limit::AboveTo(0.0, 1.0)).or(1.0), &mut gearbox.mesh_efficiency);
    table(
        v,
        &TableField::inline("mesh_ripple", "torque on the hub that repeats with the motor angle, N m"),
        &mut gearbox.mesh_ripple,
        ripple,
    );
}

fn motor(v: &mut dyn Visit, motor: &mut Motor) {
    v.number(
        &Field::new("inertia", "rotor and gearbox input").unit("kg m^2").limit(ABOVE_0),
        &mut motor.inertia_kg_m2,
    );
    v.number(
        &Field::new("torque_constant", "torque per current").unit("N m/A").limit(ABOVE_0),
        &mut motor.torque_constant_nm_a,
    );
    v.number(
        &Field::new("back_emf_constant", "voltage per speed").unit("V s/rad").limit(AT_LEAST_0),
        &mut motor.back_emf_v_s_rad,
    );
    v.number(
        &Field::new("resistance", "of the armature").unit("ohm").limit(ABOVE_0),
        &mut motor.resistance_ohm,
    );
    v.number(&Field::new("inductance", "of the armature").unit("H").limit(ABOVE_0), &mut motor.inductance_h);
    let coupling = Field::new("platform_coupling", "sense in which the platform turns the rotor: -1, 0 or 1");
    v.number(&coupling.limit(Limit::Between(-1.0, 1.0)).or(0.0), &mut motor.platform_coupling);
    table(
        v,
        &TableField::inline("cogging", "torque on the shaft that repeats with its angle, N m"),
        &mut motor.cogging,
        ripple,
    );
    table(
        v,
        &TableField::inline("torque_ripple", "variation of the torque constant, as a fraction"),
        &mut motor.torque_ripple,
        ripple,
    );
}

fn amplifier(v: &mut dyn Visit, amplifier: &mut Amplifier) {
    v.number(&Field::new("gain", "voltage gain").unit("V/V").limit(ABOVE_0), &mut amplifier.gain);
    v.number(
        &Field::new("current_feedback", "current feedback").unit("V/A").limit(AT_LEAST_0),
        &mut amplifier.current_feedback_v_a,
    );
    v.number(&Field::new("time_constant", "lag").unit("s").limit(ABOVE_0), &mut amplifier.time_constant_s);
    v.number(
        &Field::new("input_limit", "input is clipped to +/- this").unit("V").limit(ABOVE_0),
        &mut amplifier.input_limit_v,
    );
    v.number(
        &Field::new("bus_voltage", "output is clipped to +/- this").unit("V").limit(ABOVE_0),
        &mut amplifier.bus_voltage_v,
    );
    v.number(
        &Field::new("dead_zone", "half width of a dead zone at the input")
            .unit("V")
            .limit(AT_LEAST_0)
            .or(0.0),
        &mut amplifier.dead_zone_v,
    );
    let limit = Field::new("current_limit", "current is clipped to +/- this; none if absent")
        .unit("A")
        .limit(ABOVE_0);
    v.number(&limit.or(f64::INFINITY), &mut amplifier.current_limit_a);
    let dynamics = "modelled: lag, feedbacks, armature and back-EMF; ideal-current: the current follows the input at once";
    choose(v, &Field::new("dynamics", dynamics).or_text("modelled"), &mut amplifier.dynamics);
    map(v, &mut amplifier.map);
}

impl Choice for AmplifierDynamics {
    const NAMES: &'static [(&'static str, Self)] =
        &[("modelled", Self::Modelled), ("ideal-current", Self::IdealCurrent)];
}

fn map(v: &mut dyn Visit, map: &mut Vec<MapPoint>) {
    let field =
        Field::new("map", "measured input voltage and stalled current, [V, A], or the name of a CSV file")
            .limit(ABOVE_0)
            .or_empty();
    let mut pairs: Vec<[f64; 2]> = map.iter().map(|p| [p.input_v, p.current_a]).collect();
    v.pairs(&field, &mut pairs);
    *map = merged(pairs);
}

/// The points in order of voltage; points at one voltage become their mean.
fn merged(mut pairs: Vec<[f64; 2]>) -> Vec<MapPoint> {
    pairs.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mean = |points: &[[f64; 2]]| points.iter().map(|p| p[1]).sum::<f64>() / points.len() as f64;
    pairs
        .chunk_by(|a, b| a[0] == b[0])
        .map(|same| MapPoint { input_v: same[0][0], current_a: mean(same) })
        .collect()
}

fn frictions(v: &mut dyn Visit, plant: &mut Parameters) {
    table(
        v,
        &TableField::required("motor", "friction at the motor shaft"),
        &mut plant.motor_friction,
        friction,
    );
    table(
        v,
        &TableField::required("pivot", "friction at the hub pivot"),
        &mut plant.pivot_friction,
        friction,
    );
}

fn sensors(v: &mut dyn Visit, sensors: &mut Sensors) {
    table(v, &TableField::required("hub_gyro", "rate of the hub"), &mut sensors.hub_gyro, |v, s| {
        sensor(v, s, "rad/s")
    });
    table(
        v,
        &TableField::required("platform_gyro", "rate of the platform"),
        &mut sensors.platform_gyro,
        |v, s| sensor(v, s, "rad/s"),
    );
    table(v, &TableField::required("platform_accelerometer", "heave, gravity removed"), sensors, |v, all| {
        sensor(v, &mut all.platform_accelerometer, "m/s^2");
        v.number(
            &Field::new("lever_arm", "distance from the pivot").unit("m").or(0.0),
            &mut all.accelerometer_lever_arm_m,
        );
    });
    let tachometer = TableField::optional("motor_tachometer", "rate of the motor on the platform");
    optional(v, &tachometer, &mut sensors.motor_tachometer, Sensor::IDEAL, |v, s| sensor(v, s, "rad/s"));
    let resolver = TableField::optional("hub_resolver", "angle of the hub on the platform");
    optional(v, &resolver, &mut sensors.hub_resolver, Sensor::IDEAL, |v, s| sensor(v, s, "rad"));
}

fn sensor(v: &mut dyn Visit, sensor: &mut Sensor, unit: &'static str) {
    let frequency =
        Field::new("natural_frequency", "of the sensor; ideal if absent").unit("rad/s").limit(ABOVE_0);
    v.number(&frequency.or(f64::INFINITY), &mut sensor.natural_frequency_rad_s);
    v.number(&Field::new("damping_ratio", "of the sensor").limit(ABOVE_0).or(0.7), &mut sensor.damping_ratio);
    v.number(
        &Field::new("scale", "volts at the converter per unit").limit(ABOVE_0),
        &mut sensor.scale_v_unit,
    );
    v.number(
        &Field::new("noise", "RMS, white at the sample rate").unit(unit).limit(AT_LEAST_0).or(0.0),
        &mut sensor.noise_rms,
    );
    v.number(
        &Field::new("gain", "error of the gain; 1 is none").limit(Limit::Not0).or(1.0),
        &mut sensor.gain,
    );
    v.number(&Field::new("bias", "bias").unit(unit).or(0.0), &mut sensor.bias);
    v.number(&Field::new("delay", "delay").unit("s").limit(AT_LEAST_0).or(0.0), &mut sensor.delay_s);
    v.number(&Field::new("g_sensitivity", "reading per m/s^2 of heave").or(0.0), &mut sensor.g_sensitivity);
}

fn interface(v: &mut dyn Visit, interface: &mut Interface) {
    v.number(
        &Field::new("sample_period", "sample period").unit("s").limit(Limit::AboveTo(0.0, 1.0)),
        &mut interface.sample_period_s,
    );
    let bits = Limit::Between(1.0, MOST_BITS);
    v.whole(&Field::new("input_bits", "over +/- 10 V").unit("bits").limit(bits), &mut interface.input_bits);
    v.whole(&Field::new("output_bits", "over +/- 10 V").unit("bits").limit(bits), &mut interface.output_bits);
    let mut delay = u32::try_from(interface.output_delay_samples).unwrap_or(u32::MAX);
    let field = Field::new("output_delay_samples", "whole samples by which the control is held back")
        .limit(Limit::Between(0.0, MOST_DELAY));
    v.whole(&field.or(0.0), &mut delay);
    interface.output_delay_samples = delay as usize;
}
