//! The machine that a seed gives: what it has that its project does not know, concealed from the diagnosis.

use counterpoise_models::{FrictionLaw, Parameters, Sensor};

use super::experiment::{Dice, Recorder};
use super::machine::{DahlFriction, Gyro, Machine, SLIPS};

/// Something that the project does not know.
#[derive(Debug, Clone, PartialEq)]
pub struct ConcealedEffect {
    pub component: &'static str,
    pub effect: &'static str,
    /// Name and true value of each parameter that a diagnosis should find.
    pub parameters: Vec<(&'static str, f64)>,
    /// Size relative to one that is easily seen.
    pub size: f64,
    /// Names that recordings of this kind cannot tell from it.
    pub also: Vec<(&'static str, &'static str)>,
}

/// Family from which a machine was drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MachineFamily {
    Nothing,
    Single,
    Pair,
    Instrument,
    Outside,
}

/// The sealed answer of one machine.
#[derive(Debug, Clone)]
pub struct SealedAnswer {
    pub family: MachineFamily,
    pub concealed: Vec<ConcealedEffect>,
    pub noise: f64,
    pub motor_rate: bool,
    pub hub_position: bool,
}

/// Returns the machine that a project describes, as this simulator writes it.
pub fn machine(p: &Parameters) -> Machine {
    let l = p.lumped.clone().unwrap_or_else(|| panic!("the sealed machines are lumped"));
    Machine {
        gravity: p.gravity_m_s2,
        hub_inertia: l.hub_inertia_kg_m2,
        beam_inertia: l.beam_inertia_kg_m2,
        beam_stiffness: l.stiffness_nm_rad,
        beam_damping: l.damping_nm_s_rad,
        moment: l.out_of_balance_kg_m,
        moment_above: l.vertical_offset_kg_m,
        spring: 0.0,
        spring_centre: 0.0,
        spring_cubic: 0.0,
        ratio: p.gearbox.ratio,
        gear_stiffness: p.gearbox.stiffness_nm_rad,
        gear_damping: p.gearbox.damping_nm_s_rad,
        backlash: p.gearbox.backlash_rad,
        motor_inertia: p.motor.inertia_kg_m2,
        torque_constant: p.motor.torque_constant_nm_a,
        back_emf: p.motor.back_emf_v_s_rad,
        resistance: p.motor.resistance_ohm,
        inductance: p.motor.inductance_h,
        cogging: [0.0, 1.0, 0.0],
        torque_ripple: [0.0, 1.0, 0.0],
        mesh_ripple: [0.0, 1.0, 0.0],
        mesh_efficiency: 1.0,
        amplifier_gain: p.amplifier.gain,
        current_feedback: p.amplifier.current_feedback_v_a,
        amplifier_time: p.amplifier.time_constant_s,
        amplifier_curve: Vec::new(),
        dead_zone: 0.0,
        current_limit: f64::INFINITY,
        hysteresis: [0.0, 1.0],
        motor_friction: dry_friction(&p.motor_friction),
        pivot_friction: dry_friction(&p.pivot_friction),
        quadratic_drag: 0.0,
        delay_samples: 0,
        hub_gyro: gyro(&p.sensors.hub_gyro),
        platform_gyro: gyro(&p.sensors.platform_gyro),
        accelerometer: gyro(&p.sensors.platform_accelerometer),
        lever_arm: 0.0,
        platform_late: 0,
        hum: [0.0, 1.0, 0.0],
        fading: 0.0,
        hidden: Vec::new(),
        slips: [[0.0; 2]; SLIPS],
    }
}

fn dry_friction(friction: &counterpoise_models::Friction) -> DahlFriction {
    let FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad, .. } = friction.law else {
        panic!("the sealed machines have Dahl friction")
    };
    DahlFriction {
        level: coulomb_nm,
        stiffness: rest_stiffness_nm_rad,
        viscous: friction.viscous_nm_s_rad,
        static_ratio: 1.0,
        stribeck_rate: 0.01,
        asymmetry: 0.0,
        along: [0.0, 1.0, 0.0],
        per_load: 0.0,
        warming: [0.0, 1.0],
    }
}

fn gyro(s: &Sensor) -> Gyro {
    Gyro {
        natural: s.natural_frequency_rad_s,
        damping: s.damping_ratio,
        volts: s.scale_v_unit,
        noise: s.noise_rms,
        gain: 1.0,
        bias: 0.0,
        per_heave: 0.0,
        late: 0,
    }
}

/// Returns the recorder of a project: its controller, converters and the two sensors that may be missing.
pub fn recorder(p: &Parameters, kp: f64, ki: f64, bias: f64) -> Recorder {
    let ideal = |s: &Option<Sensor>| gyro(s.as_ref().unwrap_or(&Sensor::IDEAL));
    Recorder {
        kp,
        ki,
        bias,
        input_bits: p.interface.input_bits,
        output_bits: p.interface.output_bits,
        tachometer: ideal(&p.sensors.motor_tachometer),
        resolver: ideal(&p.sensors.hub_resolver),
    }
}

/// Draws what a seed conceals and puts it into the machine; also the machines that lack one concealed effect each.
pub fn conceal(seed: u64, machine: &mut Machine) -> (SealedAnswer, Vec<Machine>) {
    let mut dice = Dice::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5ea1);
    let draw = dice.uniform(0.0, 1.0);
    let family = match draw {
        d if d < 0.20 => MachineFamily::Nothing,
        d if d < 0.40 => MachineFamily::Outside,
        d if d < 0.55 => MachineFamily::Pair,
        d if d < 0.68 => MachineFamily::Instrument,
        _ => MachineFamily::Single,
    };
    let noise = [0.5, 1.0, 3.0][dice.draw_below(3)];
    let sensors = dice.draw_below(3);
    let mut without = vec![machine.clone()];
    let concealed = match family {
        MachineFamily::Nothing => Vec::new(),
        MachineFamily::Outside => vec![outside_effect(machine, &mut dice)],
        MachineFamily::Instrument => vec![instrument(machine, &mut dice)],
        MachineFamily::Single => vec![physics(machine, &mut dice, usize::MAX)],
        MachineFamily::Pair => {
            let first = dice.draw_below(PHYSICS);
            let second = (first + 1 + dice.draw_below(PHYSICS - 1)) % PHYSICS;
            let one = physics(machine, &mut dice, first);
            without.push(machine.clone());
            physics(&mut without[0], &mut dice.clone(), second);
            vec![one, physics(machine, &mut dice, second)]
        }
    };
    without.truncate(concealed.len());
    for machine in without.iter_mut().chain([machine]) {
        for gyro in [&mut machine.hub_gyro, &mut machine.platform_gyro, &mut machine.accelerometer] {
            gyro.noise *= noise;
        }
    }
    (SealedAnswer { family, concealed, noise, motor_rate: sensors != 1, hub_position: sensors != 2 }, without)
}

/// Number of kinds of physics that the seeds draw from.
const PHYSICS: usize = 27;
/// All kinds of physics that can be put in, the seeds' first.
const ALL_PHYSICS: usize = 30;
/// All kinds of faults that can be put in, the seeds' first.
const ALL_INSTRUMENTS: usize = 14;

/// Kinds of physics that show where the torques are small: backlash, dead zone, gain curve.
pub const SHOW_WHEN_BALANCED: [usize; 3] = [8, 10, 23];

/// Number of machines of [`conceal_one`].
pub const ALL: usize = ALL_PHYSICS + ALL_INSTRUMENTS;

/// Puts one given effect of a given size into the machine; also the machine without it. All sensors, usual noise.
pub fn conceal_one(which: usize, size: f64, machine: &mut Machine) -> (SealedAnswer, Vec<Machine>) {
    let mut dice = Dice::new(0xe0_0000 + which as u64);
    let without = vec![machine.clone()];
    let concealed = if which < ALL_PHYSICS {
        physics_of(machine, &mut dice, which, size)
    } else {
        let signed = size * sign(&mut dice);
        instrument_of(machine, which - ALL_PHYSICS, size, signed)
    };
    let family = if which < ALL_PHYSICS { MachineFamily::Single } else { MachineFamily::Instrument };
    let sealed =
        SealedAnswer { family, concealed: vec![concealed], noise: 1.0, motor_rate: true, hub_position: true };
    (sealed, without)
}

/// Returns the answer of a machine that is as its project describes it, with all sensors and the usual noise.
pub fn unchanged_machine() -> SealedAnswer {
    let concealed = Vec::new();
    SealedAnswer {
        family: MachineFamily::Nothing,
        concealed,
        noise: 1.0,
        motor_rate: true,
        hub_position: true,
    }
}

/// A size spread evenly in its logarithm around one that is easily seen.
fn size(dice: &mut Dice) -> f64 {
    10f64.powf(dice.uniform(-1.3, 0.3))
}

fn sign(dice: &mut Dice) -> f64 {
    if dice.draw_below(2) == 0 { 1.0 } else { -1.0 }
}

/// Any kind of physics, or a given one, of any size.
fn physics(m: &mut Machine, dice: &mut Dice, which: usize) -> ConcealedEffect {
    let s = size(dice);
    let which = if which == usize::MAX { dice.draw_below(PHYSICS) } else { which };
    physics_of(m, dice, which, s)
}

fn physics_of(m: &mut Machine, dice: &mut Dice, which: usize, s: f64) -> ConcealedEffect {
    let concealed = match which {
        0..=5 => friction_of(m, dice, which, s),
        6..=11 => drive_of(m, dice, which, s),
        12..=14 => structure_of(m, dice, which, s),
        _ => further_effect(m, dice, which, s),
    };
    ConcealedEffect { size: s, ..concealed }
}

/// Changes `value` by `share` of it, up or down.
fn scale_value(dice: &mut Dice, value: &mut f64, share: f64) -> f64 {
    *value *= 1.0 + share * sign(dice);
    *value
}

fn friction_of(m: &mut Machine, dice: &mut Dice, which: usize, s: f64) -> ConcealedEffect {
    let pivot = &mut m.pivot_friction;
    match which {
        0 => one("pivot", "coulomb", "coulomb", scale_value(dice, &mut pivot.level, 0.4 * s)),
        1 => {
            pivot.viscous += 300.0 * s;
            one("pivot", "viscous", "viscous", pivot.viscous)
        }
        2 => {
            pivot.static_ratio = 1.0 + 0.5 * s;
            pivot.stribeck_rate = dice.uniform(0.006, 0.03);
            let mut stribeck = one("pivot", "stribeck", "static_ratio", pivot.static_ratio);
            stribeck.parameters.push(("stribeck_rate", pivot.stribeck_rate));
            stribeck
        }
        3 => {
            pivot.asymmetry = (0.3 * s * sign(dice)).clamp(-0.8, 0.8);
            one("pivot", "asymmetric_friction", "asymmetry", pivot.asymmetry)
        }
        4 => {
            m.quadratic_drag = 1500.0 * s;
            one("pivot", "quadratic_drag", "quadratic", m.quadratic_drag)
        }
        _ => one("motor", "coulomb", "coulomb", scale_value(dice, &mut m.motor_friction.level, 0.4 * s)),
    }
}

fn drive_of(m: &mut Machine, dice: &mut Dice, which: usize, s: f64) -> ConcealedEffect {
    match which {
        6 => {
            m.cogging = [0.12 * s, [4.0, 6.0, 8.0, 12.0, 24.0][dice.draw_below(5)], dice.uniform(-3.0, 3.0)];
            let mut cogging = one("motor", "cogging", "amplitude", m.cogging[0]);
            cogging.parameters.extend([("order", m.cogging[1]), ("phase", m.cogging[2])]);
            cogging
        }
        7 => {
            let constant = scale_value(dice, &mut m.torque_constant, 0.15 * s);
            one("motor", "torque_constant", "torque_constant", constant)
        }
        8 => {
            m.backlash += 3e-3 * s;
            one("gearbox", "backlash", "backlash", m.backlash)
        }
        9 => one("gearbox", "stiffness", "stiffness", scale_value(dice, &mut m.gear_stiffness, 0.35 * s)),
        10 => {
            m.dead_zone = 0.1 * s;
            let dead_zone = one("amplifier", "dead_zone", "dead_zone", m.dead_zone);
            ConcealedEffect { also: vec![("amplifier", "gain_curve")], ..dead_zone }
        }
        _ => {
            m.delay_samples = 1 + (5.0 * s) as usize;
            let delay = one("control", "delay", "delay", m.delay_samples as f64);
            ConcealedEffect { also: vec![("hub_gyro", "delay")], ..delay }
        }
    }
}

fn structure_of(m: &mut Machine, dice: &mut Dice, which: usize, s: f64) -> ConcealedEffect {
    match which {
        12 => {
            m.moment += 40.0 * s * sign(dice);
            one("structure", "out_of_balance", "out_of_balance", m.moment)
        }
        13 => one("structure", "inertia", "beam_inertia", scale_value(dice, &mut m.beam_inertia, 0.3 * s)),
        _ => {
            (m.spring, m.spring_centre) = (900.0 * s, dice.uniform(-0.06, 0.06));
            one("structure", "position_stiffness", "stiffness", m.spring)
        }
    }
}

/// One effect with one parameter.
fn one(
    component: &'static str,
    effect: &'static str,
    parameter: &'static str,
    value: f64,
) -> ConcealedEffect {
    ConcealedEffect { component, effect, parameters: vec![(parameter, value)], size: 1.0, also: Vec::new() }
}

/// The rest of the vocabulary: what modulates friction, ripples, and the amplifier's limits.
fn further_effect(m: &mut Machine, dice: &mut Dice, which: usize, s: f64) -> ConcealedEffect {
    let order = [4.0, 6.0, 8.0, 12.0, 24.0][dice.draw_below(5)];
    let phase = dice.uniform(-3.0, 3.0);
    match which {
        15 => {
            m.pivot_friction.along =
                [(0.3 * s).min(0.8), [4.0, 8.0, 15.0, 30.0, 45.0][dice.draw_below(5)], phase];
            one("pivot", "position_dependent_friction", "amplitude", m.pivot_friction.along[0])
        }
        16 => {
            m.pivot_friction.stiffness *= 2f64.powf(s * sign(dice));
            one("pivot", "presliding_stiffness", "rest_stiffness", m.pivot_friction.stiffness)
        }
        17 => {
            m.pivot_friction.per_load = 0.04 * s;
            one("pivot", "load_dependent_friction", "load_coefficient", m.pivot_friction.per_load)
        }
        18 => {
            m.pivot_friction.warming = [(0.3 * s).min(0.8), dice.uniform(1.5, 5.0)];
            one("pivot", "warm_up", "warm_up", m.pivot_friction.warming[0])
        }
        19 => {
            m.motor_friction.viscous += 0.004 * s;
            one("motor", "viscous", "viscous", m.motor_friction.viscous)
        }
        20 => {
            m.torque_ripple = [0.05 * s, order, phase];
            one("motor", "torque_ripple", "amplitude", m.torque_ripple[0])
        }
        21 => {
            m.mesh_ripple = [15.0 * s, order, phase];
            one("gearbox", "mesh_ripple", "amplitude", m.mesh_ripple[0])
        }
        22 => {
            m.mesh_efficiency = 1.0 - 0.08 * s;
            one("gearbox", "mesh_efficiency", "efficiency", m.mesh_efficiency)
        }
        _ => drive_or_structure(m, dice, which, s),
    }
}

fn drive_or_structure(m: &mut Machine, dice: &mut Dice, which: usize, s: f64) -> ConcealedEffect {
    match which {
        23 => {
            let (depth, corner) = ((0.3 * s).min(0.8), dice.uniform(0.4, 1.4));
            let stalled = m.amplifier_gain / (m.resistance + m.amplifier_gain * m.current_feedback);
            let point = |v: f64| [v, stalled * v * (1.0 - depth * (-(v / corner).powi(3)).exp())];
            m.amplifier_curve = (1..=40).map(|k| point(0.05 * f64::from(k))).collect();
            let mut curve = one("amplifier", "gain_curve", "depth", depth);
            curve.parameters.clear();
            curve
        }
        24 => {
            m.amplifier_time *= 1.0 + 1.5 * s;
            one("amplifier", "bandwidth", "time_constant", m.amplifier_time)
        }
        25 => {
            m.moment_above += 30.0 * s * sign(dice);
            one("structure", "vertical_offset", "vertical_offset", m.moment_above)
        }
        26 => {
            m.beam_stiffness *= 2f64.powf(s * sign(dice));
            one("structure", "flexible_mode", "stiffness", m.beam_stiffness)
        }
        27 => {
            m.current_limit = 9.0 + 1.0 / s;
            one("amplifier", "current_limit", "current_limit", m.current_limit)
        }
        28 => {
            m.hysteresis = [60.0 * s, 1500.0 * s];
            one("structure", "hysteresis", "level", m.hysteresis[0])
        }
        _ => {
            m.hub_inertia *= 1.0 + s * sign(dice).max(-0.5);
            one("structure", "inertia", "hub_inertia", m.hub_inertia)
        }
    }
}

/// Number of kinds of faults that `instrument` can put in.
const INSTRUMENTS: usize = 12;

fn instrument(m: &mut Machine, dice: &mut Dice) -> ConcealedEffect {
    let s = size(dice);
    let signed = s * sign(dice);
    let which = dice.draw_below(INSTRUMENTS);
    instrument_of(m, which, s, signed)
}

fn instrument_of(m: &mut Machine, which: usize, s: f64, signed: f64) -> ConcealedEffect {
    let concealed = match which {
        0 | 1 | 7..=9 => hub_gyro_of(m, which, s, signed),
        4..=6 | 11 => heave_or_clock_of(m, which, s, signed),
        _ => platform_gyro_of(m, which, s, signed),
    };
    ConcealedEffect { size: s, ..concealed }
}

fn hub_gyro_of(m: &mut Machine, which: usize, s: f64, signed: f64) -> ConcealedEffect {
    match which {
        0 => {
            m.hub_gyro.gain = 1.0 + 0.1 * signed;
            one("hub_gyro", "scale", "gain", m.hub_gyro.gain)
        }
        1 => {
            m.hub_gyro.bias = 0.01 * signed;
            one("hub_gyro", "bias", "bias", m.hub_gyro.bias)
        }
        7 => {
            m.hub_gyro.natural /= 1.0 + s;
            one("hub_gyro", "bandwidth", "natural_frequency", m.hub_gyro.natural)
        }
        8 => {
            m.hub_gyro.late = 1 + (5.0 * s) as usize;
            let late = one("hub_gyro", "delay", "delay", m.hub_gyro.late as f64 * 1e-3);
            ConcealedEffect { also: vec![("control", "delay")], ..late }
        }
        _ => {
            m.hub_gyro.per_heave = 3e-3 * signed;
            one("hub_gyro", "g_sensitivity", "g_sensitivity", m.hub_gyro.per_heave)
        }
    }
}

fn heave_or_clock_of(m: &mut Machine, which: usize, s: f64, signed: f64) -> ConcealedEffect {
    match which {
        4 => {
            m.accelerometer.gain = 1.0 + 0.2 * signed;
            one("platform_accelerometer", "scale", "gain", m.accelerometer.gain)
        }
        5 => {
            m.lever_arm = 1.0 * signed;
            one("platform_accelerometer", "lever_arm", "lever_arm", m.lever_arm)
        }
        11 => {
            m.accelerometer.bias = 0.3 * signed;
            one("platform_accelerometer", "bias", "bias", m.accelerometer.bias)
        }
        _ => {
            m.platform_late = 4 + (20.0 * s) as usize;
            one("platform", "channel_skew", "skew", m.platform_late as f64 * 1e-3)
        }
    }
}

fn platform_gyro_of(m: &mut Machine, which: usize, s: f64, signed: f64) -> ConcealedEffect {
    match which {
        2 => {
            m.platform_gyro.gain = 1.0 + 0.15 * signed;
            one("platform_gyro", "scale", "gain", m.platform_gyro.gain)
        }
        3 => {
            m.platform_gyro.bias = 0.01 * signed;
            one("platform_gyro", "bias", "bias", m.platform_gyro.bias)
        }
        10 => {
            m.platform_gyro.per_heave = 3e-3 * signed;
            one("platform_gyro", "g_sensitivity", "g_sensitivity", m.platform_gyro.per_heave)
        }
        12 => {
            m.platform_gyro.natural /= 1.0 + 10.0 * s;
            one("platform_gyro", "bandwidth", "natural_frequency", m.platform_gyro.natural)
        }
        _ => {
            m.platform_gyro.late = 4 + (20.0 * s) as usize;
            one("platform_gyro", "delay", "delay", m.platform_gyro.late as f64 * 1e-3)
        }
    }
}

/// Physics that no entry of the library has.
fn outside_effect(m: &mut Machine, dice: &mut Dice) -> ConcealedEffect {
    let s = 10f64.powf(dice.uniform(-0.5, 0.5));
    let component = match dice.draw_below(3) {
        0 => {
            m.hum = [60.0 * s, dice.uniform(0.7, 6.0), dice.uniform(0.0, 6.0)];
            "structure"
        }
        1 => {
            m.spring_cubic = 6e5 * s;
            "structure"
        }
        _ => {
            m.fading = 0.01 * s;
            "motor"
        }
    };
    ConcealedEffect { component, effect: "unknown", parameters: Vec::new(), size: s, also: Vec::new() }
}
