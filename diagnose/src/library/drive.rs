//! Drive: motor, gearbox, amplifier, and the control's own timing.

use super::amplifier_map::{fraction, static_gain};
use super::effect::{Effect, EffectKind, parameter};
use super::names::{Component, EffectName};
use crate::tolerance::fitting::{FREE_INPUTS_V, USUAL_GAIN_CORNER_V};
use crate::tolerance::fitting::{LEAST_GAIN_LOSS, LEAST_LEVEL_NM};
use counterpoise_models::{AmplifierDynamics, FrictionLaw, MapPoint, Parameters};

/// Returns the input at which the map's shortfall has fallen to 1/e of that at the first point; [`USUAL_GAIN_CORNER_V`] if there is no
/// shortfall.
fn map_corner(p: &Parameters) -> f64 {
    let gain = static_gain(p);
    let short = |point: &MapPoint| (1.0 - point.current_a / (gain * point.input_v)).abs();
    let Some(first) = p.amplifier.map.first().map(short).filter(|s| *s > LEAST_GAIN_LOSS) else {
        return USUAL_GAIN_CORNER_V;
    };
    let below = p.amplifier.map.iter().find(|point| short(point) < first / std::f64::consts::E);
    below.map_or(USUAL_GAIN_CORNER_V, |point| point.input_v)
}

/// Writes the map 1 - depth exp(-(v / corner)^3) at all knots.
fn shape_map(p: &mut Parameters, depth: f64, corner: f64) {
    let gain = static_gain(p);
    let fraction = |v: f64| 1.0 - depth * (-(v / corner).powi(3)).exp();
    let point = |&v: &f64| MapPoint { input_v: v, current_a: fraction(v) * gain * v };
    p.amplifier.map = FREE_INPUTS_V.iter().map(point).collect();
}

/// Returns the time constant of an amplifier, or of the current of a drive that takes a current; 0 of one that takes a torque.
fn lag_of_drive(p: &Parameters) -> f64 {
    match p.amplifier.dynamics {
        AmplifierDynamics::Modelled | AmplifierDynamics::IdealCurrent => p.amplifier.time_constant_s,
        AmplifierDynamics::CurrentLoop { bandwidth_rad_s, .. } => 1.0 / bandwidth_rad_s,
        AmplifierDynamics::TorqueCommand | AmplifierDynamics::CurrentCommand => 0.0,
    }
}

/// Sets that time constant; a drive that takes a torque then follows its command with it.
fn set_lag_of_drive(p: &mut Parameters, lag_s: f64) {
    let delay_s = match p.amplifier.dynamics {
        AmplifierDynamics::Modelled | AmplifierDynamics::IdealCurrent => {
            p.amplifier.time_constant_s = lag_s;
            return;
        }
        AmplifierDynamics::CurrentLoop { delay_s, .. } => delay_s,
        AmplifierDynamics::TorqueCommand | AmplifierDynamics::CurrentCommand => 0.0,
    };
    p.amplifier.dynamics = AmplifierDynamics::CurrentLoop { bandwidth_rad_s: 1.0 / lag_s, delay_s };
}

fn static_ratio(p: &Parameters) -> f64 {
    p.motor_friction.static_ratio
}

fn set_static_ratio(p: &mut Parameters, ratio: f64) {
    p.motor_friction.set_static_ratio(ratio);
}

fn current_limit(p: &Parameters) -> f64 {
    if p.amplifier.current_limit_a.is_finite() { p.amplifier.current_limit_a } else { 1e3 }
}

/// Sets a Coulomb level that may be far from the model's own: the law breaks away at the same deflection as before, because the stiffness of a
/// friction that a textbook nearly leaves out is a placeholder. Where there is no dry friction it becomes Coulomb's.
fn set_own_level(law: &mut FrictionLaw, level_nm: f64) {
    if law.coulomb_nm() > 0.0 {
        law.set_coulomb_at_same_deflection_nm(level_nm.max(LEAST_LEVEL_NM));
    } else {
        law.set_or_add_coulomb_nm(level_nm);
    }
}

/// Sets the torque constant, and the back-EMF constant in the same proportion: both are one constant of the motor.
fn set_motor_constant(p: &mut Parameters, torque_constant_nm_a: f64) {
    p.motor.back_emf_v_s_rad *= torque_constant_nm_a / p.motor.torque_constant_nm_a;
    p.motor.torque_constant_nm_a = torque_constant_nm_a;
}

/// Effects that only a machine with textbook values is tried with: friction of its own scale, which a textbook leaves out, and parameters
/// of a drive whose textbook values may be wrong as well. Sizes are those of the scaled machine, whose drive has a torque of some hundred
/// N m at the hub, so that a friction may start from nothing.
pub(super) static TEXTBOOK: &[Effect] = &[
    Effect {
        // T_m = K i and e = K w, another K, where the file has one value for both (Dholiwar 2007, (5-22), (5-23))
        effect: EffectName::TorqueConstant,
        component: Component::Motor,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!(
            "torque_constant",
            "N m/A",
            [1e-6, 1e5],
            0.05,
            Log,
            get | p | p.motor.torque_constant_nm_a,
            set | p,
            v | set_motor_constant(p, v)
        )],
        starts: &[],
    },
    Effect {
        // T_2 = K delta + D delta', another D (Dholiwar 2007, (5-22))
        effect: EffectName::Damping,
        component: Component::Gearbox,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!("damping", "N m s/rad", [1e-4, 1e9], 0.5, Log, gearbox.damping_nm_s_rad)],
        starts: &[],
    },
    Effect {
        // J_m w_m' = torques at the motor shaft, another J_m (Dholiwar 2007, (5-23))
        effect: EffectName::Inertia,
        component: Component::Motor,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!("motor_inertia", "kg m^2", [1e-9, 1e4], 0.1, Log, motor.inertia_kg_m2)],
        starts: &[],
    },
    Effect {
        // F_c sgn(w) when sliding, with a scale of its own: also where the model has none (Coulomb 1785; Dahl 1968)
        effect: EffectName::Coulomb,
        component: Component::Pivot,
        kind: EffectKind::MissingPhysics,
        parameters: &[parameter!(
            "coulomb",
            "N m",
            [0.0, 1e4],
            60.0,
            Linear,
            get | p | p.pivot_friction.coulomb_nm(),
            set | p,
            v | set_own_level(&mut p.pivot_friction.law, v)
        )],
        starts: &[],
    },
    Effect {
        // F_c sgn(w_m) at the motor shaft, with a scale of its own (Coulomb 1785; Dahl 1968)
        effect: EffectName::Coulomb,
        component: Component::Motor,
        kind: EffectKind::MissingPhysics,
        parameters: &[parameter!(
            "coulomb",
            "N m",
            [0.0, 50.0],
            0.3,
            Linear,
            get | p | p.motor_friction.coulomb_nm(),
            set | p,
            v | set_own_level(&mut p.motor_friction.law, v)
        )],
        starts: &[],
    },
    Effect {
        // dry friction F_c (1 + a sgn(w_m)) at the motor shaft (Armstrong-Helouvry, Dupont, Canudas de Wit 1994)
        effect: EffectName::AsymmetricFriction,
        component: Component::Motor,
        kind: EffectKind::MissingPhysics,
        parameters: &[parameter!("asymmetry", "1", [-0.9, 0.9], 0.1, Linear, motor_friction.asymmetry)],
        starts: &[],
    },
    Effect {
        // viscous part F_v (1 + a sgn(w_m)) w_m at the motor shaft (Janot, Gautier, Brunot 2019)
        effect: EffectName::AsymmetricFriction,
        component: Component::Motor,
        kind: EffectKind::MissingPhysics,
        parameters: &[parameter!(
            "viscous_asymmetry",
            "1",
            [-0.9, 0.9],
            0.1,
            Linear,
            motor_friction.viscous_asymmetry
        )],
        starts: &[],
    },
    Effect {
        // dry friction F_c (1 + (ratio - 1) exp(-(w_m / v_s)^2)) at the motor shaft (Stribeck 1902; Armstrong-Helouvry 1991)
        effect: EffectName::Stribeck,
        component: Component::Motor,
        kind: EffectKind::MissingPhysics,
        parameters: &[
            parameter!("static_ratio", "1", [1.0, 4.0], 0.2, Linear, get static_ratio, set set_static_ratio),
            parameter!("stribeck_rate", "rad/s", [1e-4, 1e4], 0.3, Log, motor_friction.stribeck_rate_rad_s),
        ],
        starts: &[&[1.3, 2.0], &[1.3, 0.5], &[1.3, 10.0]],
    },
    Effect {
        // e = K_e w_m, another K_e (Hanselman 2003)
        effect: EffectName::BackEmf,
        component: Component::Motor,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!(
            "back_emf_constant",
            "V s/rad",
            [0.0, 100.0],
            0.05,
            Linear,
            motor.back_emf_v_s_rad
        )],
        starts: &[],
    },
    Effect {
        // R i = V - K_e w_m, another R (Hanselman 2003)
        effect: EffectName::Resistance,
        component: Component::Motor,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!("resistance", "ohm", [1e-3, 1e3], 0.1, Log, motor.resistance_ohm)],
        starts: &[],
    },
];

/// Motor, gearbox, amplifier, control.
pub(super) static EFFECTS: &[Effect] = &[
    Effect {
        // F_c sgn(w_m) at the motor shaft, another level (Dahl 1968)
        effect: EffectName::Coulomb,
        component: Component::Motor,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!(
            "coulomb",
            "N m",
            [1e-4, 1e3],
            0.1,
            Log,
            get | p | p.motor_friction.coulomb_nm(),
            set | p,
            v | p.motor_friction.law.set_coulomb_nm(v)
        )],
        starts: &[],
    },
    Effect {
        // F_v w_m at the motor shaft, another coefficient (Dholiwar 2007, 5.2.6)
        effect: EffectName::Viscous,
        component: Component::Motor,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!(
            "viscous",
            "N m s/rad",
            [0.0, 10.0],
            0.002,
            Linear,
            motor_friction.viscous_nm_s_rad
        )],
        starts: &[],
    },
    Effect {
        // torque A sin(n theta_m + phase) on the motor shaft, with or without current (Hanselman 2003; Proca et al. 2003)
        effect: EffectName::Cogging,
        component: Component::Motor,
        kind: EffectKind::MissingPhysics,
        parameters: &[
            parameter!("amplitude", "N m", [0.0, 10.0], 0.03, Linear, motor.cogging.amplitude),
            parameter!("order", "1/turn", [0.004, 100.0], 0.01, Log, motor.cogging.order),
            parameter!("phase", "rad", [-40.0, 40.0], 0.3, Linear, motor.cogging.phase_rad),
        ],
        starts: &[],
    },
    Effect {
        // torque constant K_t (1 + A sin(n theta_m + phase)) (Jahns and Soong 1996)
        effect: EffectName::TorqueRipple,
        component: Component::Motor,
        kind: EffectKind::MissingPhysics,
        parameters: &[
            parameter!("amplitude", "1", [0.0, 0.9], 0.02, Linear, motor.torque_ripple.amplitude),
            parameter!("order", "1/turn", [0.004, 100.0], 0.01, Log, motor.torque_ripple.order),
            parameter!("phase", "rad", [-40.0, 40.0], 0.3, Linear, motor.torque_ripple.phase_rad),
        ],
        starts: &[],
    },
    Effect {
        // T_m = K_t i, another K_t (Dholiwar 2007, (5-23))
        effect: EffectName::TorqueConstant,
        component: Component::Motor,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!(
            "torque_constant",
            "N m/A",
            [1e-3, 100.0],
            0.05,
            Log,
            motor.torque_constant_nm_a
        )],
        starts: &[],
    },
    Effect {
        // T_2 = K deadzone(delta, b / 2), another gap b (Nordin and Gutman 2002)
        effect: EffectName::Backlash,
        component: Component::Gearbox,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!("backlash", "rad", [0.0, 0.1], 1e-3, Linear, gearbox.backlash_rad)],
        starts: &[&[0.0], &[0.001], &[0.002], &[0.004], &[0.007], &[0.012]],
    },
    Effect {
        // T_2 = K deadzone(delta, b / 2), another K (Dholiwar 2007, (5-22))
        effect: EffectName::Stiffness,
        component: Component::Gearbox,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!("stiffness", "N m/rad", [1e3, 1e10], 0.1, Log, gearbox.stiffness_nm_rad)],
        starts: &[],
    },
    Effect {
        // torque A sin(n theta_m + phase) on the hub (Smith 2003 on gear transmission error)
        effect: EffectName::MeshRipple,
        component: Component::Gearbox,
        kind: EffectKind::MissingPhysics,
        parameters: &[
            parameter!("amplitude", "N m", [0.0, 2e3], 6.0, Linear, gearbox.mesh_ripple.amplitude),
            parameter!("order", "1/turn", [0.005, 100.0], 0.01, Log, gearbox.mesh_ripple.order),
            parameter!("phase", "rad", [-40.0, 40.0], 0.3, Linear, gearbox.mesh_ripple.phase_rad),
        ],
        starts: &[],
    },
    Effect {
        // a fraction of the mesh torque is lost on the driven side (Pelchen, Schweiger, Otter 2002)
        effect: EffectName::MeshEfficiency,
        component: Component::Gearbox,
        kind: EffectKind::MissingPhysics,
        parameters: &[parameter!("efficiency", "1", [0.3, 1.0], 0.03, Linear, gearbox.mesh_efficiency)],
        starts: &[&[0.95], &[0.85]],
    },
    Effect {
        // gain of the amplifier x (1 - depth exp(-(|v| / corner)^3)): another gain at small inputs (Dholiwar 2007, tables 7-1 and 7-2)
        effect: EffectName::GainCurve,
        component: Component::Amplifier,
        kind: EffectKind::MissingPhysics,
        parameters: &[
            parameter!(
                "depth",
                "1",
                [-2.0, 0.95],
                0.1,
                Linear,
                get | p | 1.0 - fraction(p, FREE_INPUTS_V[0]),
                set | p,
                depth | shape_map(p, depth, map_corner(p))
            ),
            parameter!("corner", "V", [0.1, 1.9], 0.2, Log,
                get map_corner, set |p, corner| shape_map(p, 1.0 - fraction(p, FREE_INPUTS_V[0]), corner)),
        ],
        starts: &[&[0.3, 0.4], &[0.3, 0.8], &[0.3, 1.4], &[-0.3, 0.8]],
    },
    Effect {
        // no output for |v| below c, v - c sgn(v) beyond (Tao and Kokotovic 1996)
        effect: EffectName::DeadZone,
        component: Component::Amplifier,
        kind: EffectKind::MissingPhysics,
        parameters: &[parameter!("dead_zone", "V", [0.0, 2.0], 0.03, Linear, amplifier.dead_zone_v)],
        starts: &[&[0.03], &[0.15]],
    },
    Effect {
        // |i| does not exceed a limit (Dholiwar 2007, 5.2.4)
        effect: EffectName::CurrentLimit,
        component: Component::Amplifier,
        kind: EffectKind::MissingPhysics,
        parameters: &[parameter!("current_limit", "A", [1e-3, 1e4], 0.1, Log,
            get current_limit, set |p, v| p.amplifier.current_limit_a = v)],
        starts: &[&[30.0], &[20.0], &[13.0], &[9.0]],
    },
    Effect {
        // i^2 <= i_c^2 + f (i_p^2 - i_c^2), another i_c: the drive folds its current back (i^2 t)
        effect: EffectName::ContinuousCurrent,
        component: Component::Amplifier,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!(
            "continuous_current",
            "A",
            [0.05, 1e3],
            0.05,
            Log,
            drive_limits.continuous_current_a
        )],
        starts: &[],
    },
    Effect {
        // tau_a dV/dt = -V + ..., another tau_a (Dholiwar 2007, (5-21)); of a drive that takes a current or a torque, t di/dt = -i + ...
        effect: EffectName::Bandwidth,
        component: Component::Amplifier,
        kind: EffectKind::ParameterChange,
        parameters: &[
            parameter!("time_constant", "s", [1e-5, 0.5], 0.3, Log, get lag_of_drive, set set_lag_of_drive),
        ],
        starts: &[&[1.5e-3], &[0.01], &[0.04]],
    },
    Effect {
        // the control reaches the amplifier d samples late (Astrom and Wittenmark 1997)
        effect: EffectName::Delay,
        component: Component::Control,
        kind: EffectKind::MissingPhysics,
        parameters: &[parameter!(
            "delay",
            "samples",
            [0.0, 30.0],
            1.0,
            Whole,
            get | p | p.interface.output_delay_samples as f64,
            set | p,
            v | p.interface.output_delay_samples = v.round().max(0.0) as usize
        )],
        starts: &[],
    },
];
