//! The numbers of a plant as C writes them.

use counterpoise_models::friction::{FrictionModel, Law, StribeckLevel};
use counterpoise_models::plant::core::state;
use counterpoise_models::plant::{Hose, OperatingPoint, Plant};
use counterpoise_models::{
    AccelerometerAxis, AmplifierDynamics, AxisKind, CONVERTER_RANGE_V, FeedbackSignal, Friction, FrictionLaw,
    IDEAL_LAG_S, Ripple, Sensor, StribeckCurve,
};

/// Motor rate over which the direction of the power through the mesh changes, rad/s.
pub(crate) const POWER_REVERSAL_RATE: f64 = 0.05;
/// The shortest step is a sample period over this.
const PARTS: u32 = 65_536;
/// The same where bristles snap: each makes a jump, and there are too many to find all.
const BRISTLED_PARTS: u32 = 4096;

/// Returns the states before the modes, in order, as the header's enumeration names them; a transmission with hysteresis and a second accelerometer
/// have one more each.
pub(crate) fn states(plant: &Plant) -> Vec<&'static str> {
    let mut states = STATES.to_vec();
    if plant.parameters().sensors.surge_accelerometer.is_some() {
        states.insert(states.len() - 1, SURGE);
    }
    if plant.gear_hysteresis().is_some() {
        states.insert(states.len() - 1, "GEAR");
    }
    states
}

/// State of the second accelerometer, where the machine has one.
const SURGE: &str = "SURGE_ACCELEROMETER";

const STATES: [&str; 16] = [
    "VOLTAGE",
    "CURRENT",
    "MOTOR",
    "WIND_UP",
    "ANGLE",
    "RATE",
    "MOTOR_DRY",
    "PIVOT_DRY",
    "HOSE",
    "PLATFORM",
    "GYRO",
    "PLATFORM_GYRO",
    "ACCELEROMETER",
    "GYRO_HEAVE",
    "PLATFORM_GYRO_HEAVE",
    "MODES",
];

/// States of the core before the modes; they are the first of [`STATES`].
const CORE: usize = state::MODES;
/// Two of friction, the hose, the platform's angle.
const BESIDE: usize = 4;
/// Five filters of second order, without that of a second accelerometer.
const FILTERS: usize = 5;

/// Returns a number in C.
pub(super) fn number(value: f64) -> String {
    if value.is_infinite() {
        return if value > 0.0 { "HUGE_VAL" } else { "-HUGE_VAL" }.to_owned();
    }
    format!("{value:?}")
}

pub(super) fn list(values: &[f64]) -> String {
    values.iter().copied().map(number).collect::<Vec<_>>().join(", ")
}

/// Returns the name, value and meaning of each constant of the machine.
pub(crate) fn parameters(plant: &Plant) -> Vec<(&'static str, String, &'static str)> {
    let (drive, structure) = (drive(plant), structure(plant));
    drive.into_iter().chain(structure).map(|(name, value, says)| (name, number(value), says)).collect()
}

type Constants = Vec<(&'static str, f64, &'static str)>;

fn drive(plant: &Plant) -> Constants {
    let p = plant.parameters();
    let rest = plant.equilibrium(&OperatingPoint::default());
    let (voltage, current) = (rest.core_state[state::VOLTAGE], rest.core_state[state::CURRENT]);
    let holding = match plant.has_state(state::CURRENT) && plant.has_state(state::VOLTAGE) {
        true => p.amplifier.control_v(p.amplifier.holding_drive_v(voltage, current, &p.motor), &p.motor),
        false => rest.control_v,
    };
    let delay = p.interface.output_delay_samples as f64 * p.interface.sample_period_s;
    vec![
        ("amplifier_gain", p.amplifier.gain, "V/V"),
        ("current_feedback", p.amplifier.current_feedback_v_a, "V/A"),
        ("amplifier_time", p.amplifier.time_constant_s, "s"),
        ("input_limit", p.amplifier.input_limit_v, "V"),
        ("dead_zone", p.amplifier.dead_zone_v, "V, half"),
        ("bus_voltage", p.amplifier.bus_voltage_v, "V"),
        ("current_limit", p.amplifier.current_limit_a, "A"),
        ("stall_gain", p.amplifier.stall_gain_a_v(&p.motor), "A/V, of a current source"),
        ("current_lag", current_lag_s(plant), "s, of a current source"),
        ("motor_inertia", p.motor.inertia_kg_m2, "kg m^2"),
        ("torque_constant", p.motor.torque_constant_nm_a, "N m/A"),
        ("back_emf", p.motor.back_emf_v_s_rad, "V s/rad"),
        ("resistance", p.motor.resistance_ohm, "ohm"),
        ("inductance", p.motor.inductance_h, "H"),
        ("platform_coupling", p.motor.platform_coupling, "of the rotor: 0, 1 or -1"),
        ("ratio", p.gearbox.ratio, "motor turns per hub turn"),
        ("mesh_stiffness", p.gearbox.stiffness_nm_rad, "N m/rad, at the output"),
        ("mesh_damping", p.gearbox.damping_nm_s_rad, "N m s/rad"),
        ("backlash", p.gearbox.backlash_rad, "rad, total"),
        ("mesh_efficiency", p.gearbox.mesh_efficiency, "1: ideal"),
        ("output_delay", delay, "s, of the control"),
        ("holding_control", holding, "V, until the first delayed one"),
        ("motor_angle", rest.motor_angle_rad, "rad, at rest"),
    ]
}

fn structure(plant: &Plant) -> Constants {
    let (p, body) = (plant.parameters(), plant.body());
    let spring = p.lumped.as_ref().map(|l| (l.position_stiffness_nm_rad, l.position_stiffness_centre_rad));
    let (spring, centre) = spring.unwrap_or_default();
    let hose = plant.hose().map(|hose| (hose.level_nm, hose.stiffness_nm_rad)).unwrap_or_default();
    vec![
        ("gravity", p.gravity_m_s2, "m/s^2"),
        ("inertia", body.inertia_kg_m2, "kg m^2, about the pivot"),
        ("out_of_balance", body.out_of_balance_kg_m, "kg m"),
        ("vertical_offset", body.vertical_offset_kg_m, "kg m"),
        ("spring", spring, "N m/rad, hub to platform"),
        ("spring_centre", centre, "rad"),
        ("hose_level", hose.0, "N m"),
        ("hose_stiffness", hose.1, "N m/rad"),
        ("lever_arm", p.sensors.accelerometer_lever_arm_m, "m, of the accelerometer"),
    ]
}

/// Cogging, torque ripple, mesh ripple, and the kinematic error if there is one.
pub(crate) fn ripples(plant: &Plant) -> Vec<String> {
    let p = plant.parameters();
    let error = p.gearbox.kinematic_error;
    let wavy = (error.amplitude != 0.0).then_some(error);
    let all = [p.motor.cogging, p.motor.torque_ripple, p.gearbox.mesh_ripple].into_iter().chain(wavy);
    all.map(|ripple| list(&three(&ripple))).collect()
}

/// Returns the tilt of an accelerometer as C writes it; `None` if its axis is the nominal one.
fn tilt(accelerometer: Option<&Sensor>) -> Option<String> {
    let tilt_rad = accelerometer?.alignment.tilt_rad;
    (tilt_rad != 0.0).then(|| number(tilt_rad))
}

/// Returns what kind of machine it is: which of its states exist, and what the loop's sensor shows.
pub(crate) fn kind(plant: &Plant) -> minijinja::Value {
    let p = plant.parameters();
    let gear = plant.gear_hysteresis();
    let of_gear = |part: fn(Hose) -> f64| number(gear.map_or(0.0, part));
    let modelled = p.amplifier.dynamics == AmplifierDynamics::Modelled;
    let rest = plant.equilibrium(&OperatingPoint::default());
    let current = match p.amplifier.dynamics {
        _ if plant.has_state(state::CURRENT) => "state",
        dynamics if dynamics.is_command() => "command",
        _ => "armature",
    };
    let (measured, shown, shown_at_rest) = match p.sensors.measured {
        FeedbackSignal::HubRate => ("hub_rate", "v.hub_rate", "pitch_rate_rad_s".to_owned()),
        FeedbackSignal::RelativeRate => ("relative_rate", "v.rate[1]", number(0.0)),
        FeedbackSignal::MotorRate if p.cylinder.is_some() => ("motor_rate", "v.rate[1]", number(0.0)),
        FeedbackSignal::MotorPosition if p.cylinder.is_some() => {
            ("motor_position", "v.angle[1]", number(0.0))
        }
        FeedbackSignal::MotorRate => ("motor_rate", "v.rate[0] / m.ratio", number(0.0)),
        FeedbackSignal::HubPosition => ("hub_position", "v.angle[1]", number(0.0)),
        FeedbackSignal::MotorPosition => {
            ("motor_position", "v.angle[0] / m.ratio", number(rest.core_state[state::WINDUP]))
        }
        FeedbackSignal::Torque => {
            let at_rest = plant.transmitted_torque_at_rest_nm(rest.core_state[state::WINDUP], 0.0);
            ("torque", transmitted_torque(plant), number(at_rest))
        }
        FeedbackSignal::Current => ("current", "x[CURRENT]", number(rest.core_state[state::CURRENT])),
    };
    let unlimited = plant.has_state(state::VOLTAGE) || p.amplifier.bus_voltage_v.is_infinite();
    minijinja::context! {
        rigid => plant.is_rigid(),
        linear => p.axis == AxisKind::Linear,
        surge => p.sensors.reads_surge() && p.axis == AxisKind::Rotary,
        elevated => p.sensors.accelerometer_axis == AccelerometerAxis::Elevated,
        tilt => tilt(Some(&p.sensors.platform_accelerometer)),
        surge_tilt => tilt(p.sensors.surge_accelerometer.as_ref()),
        projected => p.sensors.surge_accelerometer.is_some(),
        last_sensor => if p.sensors.surge_accelerometer.is_some() { SURGE } else { "PLATFORM_GYRO_HEAVE" },
        wavy => p.gearbox.kinematic_error.amplitude != 0.0,
        hysteresis => gear.is_some(),
        gear_level => of_gear(|hose| hose.level_nm),
        gear_stiffness => of_gear(|hose| hose.stiffness_nm_rad),
        voltage_state => plant.has_state(state::VOLTAGE),
        bus_limits_drive => modelled && !unlimited,
        current, measured, shown, shown_at_rest,
    }
}

/// Returns the torque that the transmission passes to the hub, as an expression of the generated code.
fn transmitted_torque(plant: &Plant) -> &'static str {
    let is_wavy = plant.parameters().gearbox.kinematic_error.amplitude != 0.0;
    match (plant.gear_hysteresis().is_some(), is_wavy) {
        (false, false) => "v.mesh",
        (true, false) => "v.mesh + x[GEAR]",
        (false, true) => "v.mesh + wave_torque(&v)",
        (true, true) => "v.mesh + x[GEAR] + wave_torque(&v)",
    }
}

fn three(ripple: &Ripple) -> [f64; 3] {
    [ripple.amplitude, ripple.order, ripple.phase_rad]
}

/// Returns whether the amplifier is a current source.
pub(crate) fn ideal_current(plant: &Plant) -> &'static str {
    match plant.parameters().amplifier.dynamics {
        AmplifierDynamics::IdealCurrent | AmplifierDynamics::CurrentLoop { .. } => "true",
        AmplifierDynamics::Modelled
        | AmplifierDynamics::TorqueCommand
        | AmplifierDynamics::CurrentCommand => "false",
    }
}

/// Returns the time constant with which a current source follows its input, s.
fn current_lag_s(plant: &Plant) -> f64 {
    match plant.parameters().amplifier.dynamics {
        AmplifierDynamics::CurrentLoop { bandwidth_rad_s, .. } => 1.0 / bandwidth_rad_s,
        _ => IDEAL_LAG_S,
    }
}

/// Returns the structure's flexible modes.
pub(crate) fn modes(plant: &Plant) -> Vec<String> {
    let modes = plant.body().modes.iter();
    let line = |m: &counterpoise_models::plant::BodyMode| {
        list(&[m.frequency_rad_s, m.damping_ratio, m.hub_shape, m.tip_shape, m.load_share_kg_m])
    };
    modes.map(line).collect()
}

/// Returns the amplifier's map: volts in, and the volts that a linear amplifier would need.
pub(crate) fn map(plant: &Plant) -> Vec<(String, String)> {
    let p = plant.parameters();
    let gain = p.amplifier.stall_gain_a_v(&p.motor);
    p.amplifier.map.iter().map(|point| (number(point.input_v), number(point.current_a / gain))).collect()
}

/// Friction at the motor and at the pivot, as the structure `friction` lists it.
pub(crate) fn joints(plant: &Plant) -> Vec<String> {
    laws(plant).iter().map(|(friction, law)| joint(friction, law)).collect()
}

/// Returns the joints' friction; a law that was checked with the plant.
fn laws(plant: &Plant) -> [(&Friction, Law); 2] {
    let p = plant.parameters();
    [&p.motor_friction, &p.pivot_friction]
        .map(|f| (f, FrictionModel::new(f).map_or(Law::None, |model| *model.law())))
}

/// The properties that the laws have in different ways.
struct FrictionConstants {
    kind: &'static str,
    level: Option<StribeckLevel>,
    coulomb_nm: f64,
    breakaway_ratio: f64,
    rest_rate: f64,
    stiffness: f64,
    exponent: f64,
    damping: f64,
    deflection: f64,
    lag: f64,
    smoothing: f64,
    bristles: usize,
}

impl FrictionConstants {
    fn new(kind: &'static str, level: Option<StribeckLevel>) -> Self {
        Self {
            kind,
            level,
            coulomb_nm: level.map_or(0.0, |level| level.coulomb_nm()),
            breakaway_ratio: 1.0,
            rest_rate: 0.0,
            stiffness: 0.0,
            exponent: 1.0,
            damping: 0.0,
            deflection: 1.0,
            lag: 1.0,
            smoothing: 1.0,
            bristles: 0,
        }
    }

    fn of(law: &Law) -> Self {
        match law {
            Law::None => Self::new("NO_FRICTION", None),
            Law::Sliding(law) => Self {
                breakaway_ratio: law.breakaway_ratio,
                rest_rate: law.rest_rate_rad_s,
                ..Self::new("SLIDING", Some(law.level))
            },
            Law::Dahl(law) => Self {
                stiffness: law.rest_stiffness_nm_rad,
                exponent: law.exponent,
                ..Self::new("DAHL", Some(law.level))
            },
            Law::Lugre(law) => Self {
                stiffness: law.stiffness_nm_rad,
                damping: law.damping_nm_s_rad,
                ..Self::new("LUGRE", Some(law.level))
            },
            Law::ResetIntegrator(law) => Self {
                coulomb_nm: law.coulomb_nm,
                stiffness: law.bond_stiffness_nm_rad(),
                damping: law.damping_nm_s_rad,
                deflection: law.deflection_rad,
                ..Self::new("RESET", None)
            },
            Law::Walrath(law) => Self {
                coulomb_nm: law.coulomb_nm,
                lag: law.time_constant_s,
                smoothing: law.smoothing_rate_rad_s,
                ..Self::new("WALRATH", None)
            },
            Law::Bristle(law) => Self {
                deflection: law.bond_rad,
                bristles: law.bristles,
                ..Self::new("BRISTLES", Some(law.level))
            },
        }
    }
}

fn joint(friction: &Friction, law: &Law) -> String {
    let dry = FrictionConstants::of(law);
    let (shape, exponent, cubic) = curve(friction, dry.level.as_ref());
    let excess = dry.level.map_or(0.0, |level| level.static_nm() - level.coulomb_nm());
    let load = if dry.coulomb_nm > 0.0 { friction.load_coefficient / dry.coulomb_nm } else { 0.0 };
    let first = list(&[dry.coulomb_nm, excess, friction.stribeck_rate_rad_s.recip(), exponent]);
    let own = [
        dry.breakaway_ratio,
        dry.rest_rate,
        dry.stiffness,
        dry.exponent,
        dry.damping,
        dry.deflection,
        dry.lag,
        dry.smoothing,
    ];
    let shared = [
        friction.viscous_nm_s_rad,
        friction.quadratic_nm_s2_rad2,
        friction.asymmetry,
        friction.viscous_asymmetry,
    ];
    let wave = list(&three(&friction.position_ripple));
    let last = list(&[load, friction.warm_up, friction.warm_up_time_s]);
    format!(
        "{}, {shape}, {first}, {{ {} }}, {}, {}U, {}, {{ {wave} }}, {last}",
        dry.kind,
        list(&cubic),
        list(&own),
        dry.bristles,
        list(&shared)
    )
}

/// Returns how the level falls with the rate: the curve's name in C, its exponent and its cubic.
fn curve(friction: &Friction, level: Option<&StribeckLevel>) -> (&'static str, f64, [f64; 3]) {
    let none = [0.0; 3];
    let Some(level) = level else { return ("CONSTANT", 1.0, none) };
    let curve = match friction.law {
        FrictionLaw::Stribeck { curve, .. } => curve,
        _ => StribeckCurve::Gaussian,
    };
    match curve {
        StribeckCurve::Polynomial { coefficients } => ("POLYNOMIAL", 1.0, coefficients),
        _ if level.static_nm() == level.coulomb_nm() => ("CONSTANT", 1.0, none),
        StribeckCurve::Tustin => ("TUSTIN", 1.0, none),
        StribeckCurve::Gaussian => ("GAUSSIAN", 1.0, none),
        StribeckCurve::Exponential { exponent } => ("EXPONENTIAL", exponent, none),
        StribeckCurve::Lorentzian => ("LORENTZIAN", 1.0, none),
    }
}

/// Most bristles of a joint.
pub(crate) fn bristles(plant: &Plant) -> usize {
    let count = |(_, law): &(&Friction, Law)| match law {
        Law::Bristle(law) => law.bristles,
        _ => 0,
    };
    laws(plant).iter().map(count).max().unwrap_or(0)
}

/// Parts of a sample period that the shortest step is one of.
pub(crate) fn shortest_parts(plant: &Plant) -> String {
    let parts = if bristles(plant) > 0 { BRISTLED_PARTS } else { PARTS };
    format!("{:?}", f64::from(parts))
}

/// Returns the hub gyroscope, platform gyroscope, accelerometer, tachometer, resolver, and the second accelerometer if there is one; another
/// sensor that is not fitted reads 0.
fn fitted_sensors(plant: &Plant) -> Vec<Sensor> {
    let s = &plant.parameters().sensors;
    let absent = Sensor { gain: 0.0, ..Sensor::IDEAL };
    let optional = |sensor: &Option<Sensor>| sensor.clone().unwrap_or_else(|| absent.clone());
    let mut all = vec![
        s.hub_gyro.clone(),
        s.platform_gyro.clone(),
        s.platform_accelerometer.clone(),
        optional(&s.motor_tachometer),
        optional(&s.hub_resolver),
    ];
    all.extend(s.surge_accelerometer.clone());
    all
}

/// Returns the sensors, as the structure `sensor` lists them.
pub(crate) fn sensors(plant: &Plant) -> Vec<String> {
    let line = |s: &Sensor| {
        let own = [frequency(s), s.damping_ratio, s.gain, s.bias, s.g_sensitivity];
        list(&[&own[..], &[delay_s(plant, s), CONVERTER_RANGE_V / s.scale_v_unit]].concat())
    };
    fitted_sensors(plant).iter().map(line).collect()
}

/// The delay of a reading before it is sampled, s; the difference of two angles is late by half of the time between them.
fn delay_s(plant: &Plant, sensor: &Sensor) -> f64 {
    let period_s = plant.parameters().interface.sample_period_s;
    sensor.delay_s + sensor.difference_delay_samples(period_s) * period_s
}

/// 0 stands for an ideal sensor.
fn frequency(sensor: &Sensor) -> f64 {
    if sensor.natural_frequency_rad_s.is_finite() { sensor.natural_frequency_rad_s } else { 0.0 }
}

/// Returns how many values a delayed signal keeps.
pub(crate) fn count_delayed_values(plant: &Plant) -> usize {
    let interface = &plant.parameters().interface;
    let late = fitted_sensors(plant)
        .into_iter()
        .map(|sensor| (delay_s(plant, &sensor) / interface.sample_period_s).ceil() as usize);
    2 + late.fold(interface.output_delay_samples, usize::max)
}

/// Returns the states at rest with the hub level.
pub(crate) fn rest_states(plant: &Plant) -> Vec<String> {
    let core = plant.equilibrium(&OperatingPoint::default()).core_state;
    let further = usize::from(plant.parameters().sensors.surge_accelerometer.is_some());
    let beside = vec![0.0; BESIDE + 2 * (FILTERS + further) + usize::from(plant.gear_hysteresis().is_some())];
    let all = core[..CORE].iter().chain(&beside).chain(&core[CORE..]);
    all.copied().map(number).collect()
}

/// A rate and an angle of the hub, rad/s and rad, against which an error is small.
const SIZE: (f64, f64) = (0.1, 1e-3);
/// Voltage, V, current, A, and wind-up, rad, against which an error is small.
const ELECTRICAL: (f64, f64) = (1.0, 0.1);
/// Share of a valve's full opening against which an error is small.
const SMALL_OPENING: f64 = 0.01;
/// See [`ELECTRICAL`].
const WIND_UP: f64 = 1e-5;

/// Returns sizes of the states against which an error is small.
pub(crate) fn sizes(plant: &Plant) -> Vec<String> {
    let ratio = plant.parameters().gearbox.ratio;
    let (rate, angle) = SIZE;
    let mut sizes = vec![ELECTRICAL.0, ELECTRICAL.1, rate * ratio, WIND_UP, angle, rate];
    if let Some(cylinder) = &plant.parameters().cylinder {
        let amplifier = &plant.parameters().amplifier;
        let opening = SMALL_OPENING * amplifier.gain * amplifier.input_limit_v;
        (sizes[state::VOLTAGE], sizes[state::MOTOR]) = (opening, opening * cylinder.valve_frequency_rad_s);
    }
    sizes.extend(laws(plant).iter().map(|(_, law)| dry_size(law)));
    sizes.push(plant.hose().map_or(1.0, |hose| hose.level_nm));
    sizes.push(angle);
    let sensors = fitted_sensors(plant);
    let filtered = [0, 1, 2, 0, 1].into_iter().filter_map(|place| sensors.get(place)).chain(sensors.get(5));
    for sensor in filtered {
        sizes.extend([rate, rate * frequency(sensor).max(1.0)]);
    }
    sizes.extend(plant.gear_hysteresis().map(|hose| hose.level_nm));
    for mode in &plant.body().modes {
        let shape = mode.hub_shape.abs().max(f64::MIN_POSITIVE.sqrt()).max(1e-3 * mode.tip_shape.abs());
        sizes.extend([angle / shape, rate / shape]);
    }
    sizes.into_iter().map(number).collect()
}

/// Returns the largest state of a law of friction.
fn dry_size(law: &Law) -> f64 {
    match law {
        Law::None | Law::Sliding(_) | Law::Bristle(_) => 1.0,
        Law::Dahl(law) => law.level.coulomb_nm(),
        Law::Walrath(law) => law.coulomb_nm,
        Law::Lugre(law) => law.level.coulomb_nm() / law.stiffness_nm_rad,
        Law::ResetIntegrator(law) => law.deflection_rad,
    }
}
