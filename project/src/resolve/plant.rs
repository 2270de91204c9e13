//! The `[plant]` section: drive train, sensors, interface, and the structure.

use counterpoise_models::{
    AccelerometerAxis, AmplifierDynamics, AxisKind, Clock, DriveLimits, FeedbackSignal, Friction,
    FrictionLaw, Gearbox, IDEAL_CONVERTER_BITS, Interface, Loads, LumpedStructure, Motor, Parameters, Ripple,
    Sensor, Sensors, Transmission,
};

use super::axis_words::{Words, turning_of_motor};
use super::free_functions::learned_functions;
use super::friction::{friction, ripple};
use super::sensor::{accelerometer, gyroscope, sensor};
use super::structure::{beam, blank_beam, blank_configuration, blank_lumped, configuration, lumped_inertias};
use super::{cylinder, drive, loads, loop_sensor, transmission};
use crate::file::field::{Field, NumberRange, TableField, UsualRange};
use crate::file::visit::{NamedChoice, Presence, Visit, choose, list, maybe_number, table, visit_optional};
use crate::tolerance::{MOST_CONTROL_DELAY_SAMPLES, MOST_CONVERTER_BITS, MOST_ERRANT};

const AT_LEAST_0: NumberRange = NumberRange::AtLeast(0.0);
const ABOVE_0: NumberRange = NumberRange::Above(0.0);

/// Advice where an inertia stands on a linear axis.
const MASS_IN_PLACE_OF_INERTIA: &str = "write the moving mass as `mass`, and the inertia of a rotor as [plant.motor] inertia; a hub that turns needs axis = \"rotary\"";

/// Returns a mechanism still to be read.
pub(crate) fn blank_parameters() -> Parameters {
    Parameters {
        name: String::new(),
        axis: AxisKind::Rotary,
        gravity_m_s2: f64::NAN,
        beam: None,
        lumped: None,
        gearbox: Gearbox::DIRECT,
        motor: blank_motor(),
        amplifier: drive::blank_amplifier(),
        cylinder: None,
        motor_friction: Friction::with_viscous_part(FrictionLaw::None, 0.0),
        pivot_friction: Friction::with_viscous_part(FrictionLaw::None, 0.0),
        sensors: Sensors {
            hub_gyro: loop_sensor::UNKNOWN,
            measured: FeedbackSignal::HubRate,
            platform_gyro: Sensor::ABSENT,
            platform_accelerometer: Sensor::ABSENT,
            accelerometer_lever_arm_m: 0.0,
            accelerometer_axis: AccelerometerAxis::Vertical,
            motor_tachometer: None,
            hub_resolver: None,
            surge_accelerometer: None,
        },
        interface: Interface {
            sample_period_s: f64::NAN,
            input_bits: 0,
            output_bits: 0,
            output_delay_samples: 0,
            clock: Clock::IDEAL,
            missing_codes: 0.0,
        },
        configurations: Vec::new(),
        learned: Vec::new(),
        loads: Loads::default(),
        drive_limits: DriveLimits::default(),
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

/// Reads or lists the plant.
pub(crate) fn plant(v: &mut dyn Visit, plant: &mut Parameters) {
    v.text(&Field::new("name", "name of the machine").or_text("machine").show_default(), &mut plant.name);
    choose(v, &Field::new("axis", "whether the hub turns or slides").or_text("rotary"), &mut plant.axis);
    if plant.axis == AxisKind::Rotary && (v.has("mass") || v.has("lumped.mass")) {
        let allowed = "must be \"linear\" where [plant] has a mass: what turns has an inertia";
        v.complain("axis", allowed, Some("write axis = \"linear\"".to_owned()));
        plant.axis = AxisKind::Linear;
    }
    v.number(
        &Field::new("gravity", "acceleration of gravity").unit("m/s^2").limit(AT_LEAST_0).or(9.80665),
        &mut plant.gravity_m_s2,
    );
    let axis = plant.axis;
    if axis == AxisKind::Linear && v.has("inertia") {
        let allowed = "belongs to an axis that turns: what slides has a mass";
        v.complain("inertia", allowed, Some(MASS_IN_PLACE_OF_INERTIA.to_owned()));
    }
    one_inertia(&mut Words::of(axis, v), &mut plant.lumped);
    visit_optional(
        v,
        &TableField::optional("beam", "the structure as a beam"),
        &mut plant.beam,
        blank_beam(),
        beam,
    );
    described_by_inertias(&mut Words::of(axis, v), &mut plant.lumped);
    let driven = Presence::from(v.has("cylinder") || plant.cylinder.is_some());
    if driven == Presence::Absent {
        motor_and_drive(v, plant);
    }
    cylinder::cylinder(v, driven, plant);
    let rotor = turning_of_motor(plant);
    loads::drive_limits(&mut Words::of(rotor, v), plant);
    frictions(v, plant);
    loads::loads(&mut Words::of(axis, v), plant);
    sensors(v, plant);
    drive::without_its_delay(plant);
    table(
        v,
        &TableField::mandatory("interface", "converters and clock of the controller")
            .with_smallest("sample_period = \"1 ms\""),
        &mut plant.interface,
        interface,
    );
    drive::with_its_delay(plant);
    list(
        v,
        &TableField::optional("configuration", "a configuration of the mechanism: which masses are fitted"),
        &mut plant.configurations,
        blank_configuration(),
        configuration,
    );
    learned_functions(v, plant);
}

/// Reads or lists transmission, motor and amplifier.
fn motor_and_drive(v: &mut dyn Visit, plant: &mut Parameters) {
    let axis = plant.axis;
    transmission::gearbox_section(&mut Words::of(axis, v), plant);
    transmission::other_sections(&mut Words::of(axis, v), plant);
    // a linear motor drives the hub without a transmission, and has the hub's units
    let is_direct = plant.gearbox.kind == Transmission::Direct;
    let is_turning = is_direct && axis == AxisKind::Linear && v.has("motor.inertia");
    if is_turning {
        let allowed =
            "must state what lies between a motor with an inertia and a slide: its transmission is missing";
        let hint = "add [plant.ball_screw] with its `lead`, or give the `mass` of a linear motor in place of `inertia`";
        v.complain("motor.inertia", allowed, Some(hint.to_owned()));
    }
    let rotor = if is_turning { AxisKind::Rotary } else { turning_of_motor(plant) };
    // A drive that takes something else asks for the torque constant, also where it is the usual one.
    let takes_torque = plant.amplifier.dynamics == AmplifierDynamics::TorqueCommand;
    let presence = Presence::from(plant.motor != drive::usual_motor() || !takes_torque);
    motor_section(&mut Words::of(rotor, v), &mut plant.motor, presence);
    drive::drive(&mut Words::of(rotor, v), plant);
}

impl NamedChoice for AccelerometerAxis {
    const NAMES: &'static [(&'static str, Self)] =
        &[("vertical", Self::Vertical), ("elevated", Self::Elevated)];
}

impl NamedChoice for AxisKind {
    const NAMES: &'static [(&'static str, Self)] = &[("rotary", Self::Rotary), ("linear", Self::Linear)];
}

/// Reads or lists the structure as one rigid, balanced inertia.
fn one_inertia(v: &mut dyn Visit, lumped: &mut Option<LumpedStructure>) {
    let known = lumped.as_ref().map(|l| l.hub_inertia_kg_m2);
    let mut inertia = known.filter(|inertia| *lumped == Some(LumpedStructure::rigid(*inertia)));
    let field = Field::new("inertia", "of a structure that is one rigid, balanced body").unit("kg m^2");
    maybe_number(v, &field.limit(ABOVE_0), &mut inertia);
    if let Some(inertia) = inertia {
        *lumped = Some(LumpedStructure::rigid(inertia));
        let stiffness = Field::new("lumped.stiffness", "of the structure").unit("N m/rad").with_assumption(
            "rigid: one body",
            "what is left out is ideal; a first design stays slower, because every structure yields",
            UsualRange::Unknown,
        );
        v.assume(&stiffness, f64::INFINITY);
    }
}

/// Reads or lists the structure as one or two inertias with more than that.
fn described_by_inertias(v: &mut dyn Visit, inertias: &mut Option<LumpedStructure>) {
    let short = inertias.as_ref().is_some_and(|l| *l == LumpedStructure::rigid(l.hub_inertia_kg_m2));
    let section = TableField::optional("lumped", "the structure as one inertia, two, or more in a chain");
    if v.has("inertia") && v.has("lumped") {
        let allowed = "must not stand beside [plant.lumped], which describes the structure";
        v.complain("inertia", allowed, Some("write it there, as `hub_inertia`".to_owned()));
    }
    if v.enter(&section, Presence::from(inertias.is_some() && !short)) {
        let mut value = inertias.take().filter(|_| !short).unwrap_or_else(blank_lumped);
        lumped_inertias(v, &mut value);
        v.leave();
        *inertias = Some(value);
    }
}

fn motor_section(v: &mut dyn Visit, value: &mut Motor, presence: Presence) {
    let usual = drive::usual_motor();
    if v.enter(&TableField::optional("motor", "motor"), presence) {
        motor(v, value);
        v.leave();
    } else {
        *value = usual;
    }
}

fn motor(v: &mut dyn Visit, motor: &mut Motor) {
    let inertia = Field::new("inertia", "rotor and gearbox input").unit("kg m^2").limit(AT_LEAST_0);
    let inertia = inertia.or(0.0).with_assumption(
        "part of the hub's inertia",
        "a rigid transmission adds nothing else",
        UsualRange::Unknown,
    );
    v.number(&inertia, &mut motor.inertia_kg_m2);
    let constant = Field::new("torque_constant", "torque per current").unit("N m/A").limit(ABOVE_0);
    let constant = constant.or(1.0).with_assumption(
        "1: the drive's current is its torque",
        "a drive that takes a torque hides its current",
        UsualRange::Unknown,
    );
    v.number(&constant, &mut motor.torque_constant_nm_a);
    let constant = motor.torque_constant_nm_a;
    let emf = Field::new("back_emf_constant", "back-EMF per angular rate of the motor").unit("V s/rad");
    let emf = emf.limit(AT_LEAST_0).or(constant).with_assumption(
        "equal to the torque constant in SI units",
        "conservation of energy in a motor without losses",
        UsualRange::Factors(0.9, 1.1),
    );
    v.number(&emf, &mut motor.back_emf_v_s_rad);
    let resistance = Field::new("resistance", "of the armature").unit("ohm").limit(ABOVE_0).or(1.0);
    let resistance = resistance.with_assumption(
        "1 ohm",
        "a drive that controls the current hides it; a voltage amplifier needs it",
        UsualRange::Factors(0.1, 10.0),
    );
    v.number(&resistance, &mut motor.resistance_ohm);
    let inductance = Field::new("inductance", "of the armature").unit("H").limit(AT_LEAST_0).or(0.0);
    let inductance = inductance.with_assumption(
        "0: the current follows the voltage at once",
        "what is left out is ideal; the electrical time constants of servo motors are usually up to 5 ms",
        UsualRange::Values(0.0, drive::SLOWEST_USUAL_ARMATURE_S * motor.resistance_ohm),
    );
    v.number(&inductance, &mut motor.inductance_h);
    let coupling = Field::new("platform_coupling", "sense in which the platform turns the rotor: -1, 0 or 1");
    v.number(&coupling.limit(NumberRange::Between(-1.0, 1.0)).or(0.0), &mut motor.platform_coupling);
    ripple(
        v,
        &TableField::inline("cogging", "cogging torque on the shaft, periodic in its angle"),
        &mut motor.cogging,
        "N m",
    );
    ripple(
        v,
        &TableField::inline(
            "torque_ripple",
            "variation of the torque constant with the angle, as a fraction",
        ),
        &mut motor.torque_ripple,
        "",
    );
}

fn frictions(v: &mut dyn Visit, plant: &mut Parameters) {
    let none = Friction::with_viscous_part(FrictionLaw::None, 0.0);
    let there = plant.motor_friction != none || plant.pivot_friction != none;
    if !v.enter(&TableField::optional("friction", "friction at motor and pivot"), Presence::from(there)) {
        (plant.motor_friction, plant.pivot_friction) = (none.clone(), none);
        return;
    }
    let rotor = turning_of_motor(plant);
    let motor = TableField::optional("motor", "friction at the motor shaft, or of the seals of a cylinder");
    one_friction(&mut Words::of(rotor, v), &motor, &mut plant.motor_friction);
    let place = if plant.axis == AxisKind::Linear {
        "friction of the slide on its guide"
    } else {
        "friction at the hub pivot"
    };
    let pivot = TableField::optional("pivot", place);
    one_friction(&mut Words::of(plant.axis, v), &pivot, &mut plant.pivot_friction);
    v.leave();
}

fn one_friction(v: &mut dyn Visit, section: &TableField, value: &mut Friction) {
    let none = Friction::with_viscous_part(FrictionLaw::None, 0.0);
    if v.enter(section, Presence::from(*value != none)) {
        friction(v, value);
        v.leave();
    } else {
        *value = none;
    }
}

fn sensors(v: &mut dyn Visit, plant: &mut Parameters) {
    let there = plant.sensors != blank_parameters().sensors;
    if !v.enter(&TableField::optional("sensors", "sensors"), Presence::from(there)) {
        plant.sensors = blank_parameters().sensors;
        let keys = ["sensors.hub_gyro.noise", "sensors.hub_gyro.delay", "sensors.hub_gyro.natural_frequency"];
        loop_sensor::assume_gyroscope(&mut Words::of(plant.axis, v), keys);
        return;
    }
    loop_sensor::loop_sensor(v, plant);
    let (axis, rotor) = (plant.axis, turning_of_motor(plant));
    let sensors = &mut plant.sensors;
    sensors_of_base(&mut Words::of(axis, v), sensors);
    let tachometer = TableField::optional("motor_tachometer", "rate of the motor on the platform");
    let of_motor = |v: &mut dyn Visit, s: &mut Sensor| sensor(&mut Words::of(rotor, v), s, "rad/s");
    visit_optional(v, &tachometer, &mut sensors.motor_tachometer, Sensor::IDEAL, of_motor);
    let v = &mut Words::of(axis, v);
    let resolver = TableField::optional("hub_resolver", "angle of the hub on the platform");
    visit_optional(v, &resolver, &mut sensors.hub_resolver, Sensor::IDEAL, |v, s| sensor(v, s, "rad"));
    let surge =
        "surge, gravity removed: the controller projects heave and surge across the beam by the hub's angle";
    let surge = TableField::optional("surge_accelerometer", surge);
    visit_optional(v, &surge, &mut sensors.surge_accelerometer, Sensor::IDEAL, accelerometer);
    v.leave();
}

/// Reads or lists the gyroscope of the platform and the accelerometer of its heave.
fn sensors_of_base(v: &mut dyn Visit, sensors: &mut Sensors) {
    let gyro = TableField::optional("platform_gyro", "rate of the platform");
    visit_sensor(v, &gyro, &mut sensors.platform_gyro, gyroscope);
    let section = TableField::optional("platform_accelerometer", "heave, gravity removed");
    if v.enter(&section, Presence::from(sensors.platform_accelerometer.is_fitted())) {
        accelerometer(v, &mut sensors.platform_accelerometer);
        v.number(
            &Field::new("lever_arm", "distance from the pivot").unit("m").or(0.0),
            &mut sensors.accelerometer_lever_arm_m,
        );
        let axis = Field::new(
            "axis",
            "along which it measures: vertical (heave), or elevated (on the elevated mass, along the normal of the beam: heave and surge as the out-of-balance feels them)",
        );
        choose(v, &axis.or_text("vertical"), &mut sensors.accelerometer_axis);
        v.leave();
    } else {
        sensors.platform_accelerometer = Sensor::ABSENT;
    }
}

/// A sensor whose absence means that none is fitted.
fn visit_sensor(
    v: &mut dyn Visit,
    section: &TableField,
    value: &mut Sensor,
    walk: impl FnOnce(&mut dyn Visit, &mut Sensor),
) {
    if v.enter(section, Presence::from(value.is_fitted())) {
        walk(v, value);
        v.leave();
    } else {
        *value = Sensor::ABSENT;
    }
}

/// The errors of a real clock.
fn clock(v: &mut dyn Visit, clock: &mut Clock) {
    let jitter = Field::new("sample_jitter", "RMS of the jitter of the instants at which sensors are read");
    v.number(&jitter.unit("s").limit(AT_LEAST_0).or(0.0), &mut clock.jitter_s);
    let share = |key, meaning| Field::new(key, meaning).limit(NumberRange::Between(0.0, MOST_ERRANT)).or(0.0);
    let missed = "share of the samples in which the controller does not run and its control stays";
    v.number(&share("missed_samples", missed), &mut clock.missed_samples);
    let late = "share of the samples whose control acts one period later";
    v.number(&share("late_samples", late), &mut clock.late_samples);
}

fn interface(v: &mut dyn Visit, interface: &mut Interface) {
    v.number(
        &Field::new("sample_period", "sample period of the controller")
            .if_unknown("take a twentieth of the time in which the loop is to settle, or what the target's timer gives")
            .unit("s")
            .limit(NumberRange::Between(crate::tolerance::SHORTEST_PERIOD_S, 1.0)),
        &mut interface.sample_period_s,
    );
    let bits = NumberRange::Between(1.0, MOST_CONVERTER_BITS);
    let fine = |key| {
        Field::new(key, "over +/- 10 V")
            .unit("bits")
            .limit(bits)
            .or(f64::from(IDEAL_CONVERTER_BITS))
            .with_assumption(
                "48: steps that nothing feels",
                "an ideal converter has no steps",
                UsualRange::Values(10.0, 24.0),
            )
    };
    v.whole_number(&fine("input_bits"), &mut interface.input_bits);
    v.whole_number(&fine("output_bits"), &mut interface.output_bits);
    let mut delay = u32::try_from(interface.output_delay_samples).unwrap_or(u32::MAX);
    let field = Field::new("output_delay_samples", "whole sample periods by which the control is delayed")
        .limit(NumberRange::Between(0.0, MOST_CONTROL_DELAY_SAMPLES))
        .or(0.0)
        .with_assumption(
            "none, as if the control acted at once",
            "what is left out is ideal; computing takes a real controller up to one sample period",
            UsualRange::Values(0.0, 1.0),
        );
    v.whole_number(&field, &mut delay);
    interface.output_delay_samples = delay as usize;
    clock(v, &mut interface.clock);
    let missing = Field::new("missing_codes", "share of the codes that the input converters never give");
    v.number(&missing.limit(NumberRange::Between(0.0, MOST_ERRANT)).or(0.0), &mut interface.missing_codes);
}
