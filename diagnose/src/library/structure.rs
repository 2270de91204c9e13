//! Structure and pivot: imbalance, inertia, springs, friction at the pivot.

use super::effect::{Effect, EffectKind, EffectParameter, parameter};
use super::names::{Component, EffectName};
use counterpoise_models::{LumpedStructure, Parameters};

fn lumped_value(p: &Parameters, read: fn(&LumpedStructure) -> f64) -> f64 {
    p.lumped.as_ref().map_or(0.0, read)
}

fn lumped_set(p: &mut Parameters, write: impl FnOnce(&mut LumpedStructure)) {
    if let Some(structure) = p.lumped.as_mut() {
        write(structure);
    }
}

fn static_ratio(p: &Parameters) -> f64 {
    p.pivot_friction.static_ratio
}

fn set_static_ratio(p: &mut Parameters, ratio: f64) {
    p.pivot_friction.set_static_ratio(ratio);
}

fn equilibrator_factor(p: &Parameters) -> f64 {
    p.loads.equilibrator.as_ref().map_or(1.0, |equilibrator| equilibrator.factor)
}

fn stop_stiffness(p: &Parameters) -> f64 {
    p.loads.end_stops.as_ref().map_or(1.0, |stops| stops.stiffness_nm_rad)
}

fn recoil_height(p: &Parameters) -> f64 {
    p.loads.recoil.as_ref().map_or(0.0, |recoil| recoil.height_m)
}

/// Stiffness of a cable or hose between hub and platform.
const POSITION_STIFFNESS: EffectParameter = parameter!(
    "stiffness",
    "N m/rad",
    [-2.0e4, 2.0e4],
    300.0,
    Linear,
    get | p | lumped_value(p, |l| l.position_stiffness_nm_rad),
    set | p,
    v | lumped_set(p, |l| l.position_stiffness_nm_rad = v)
);

/// Out-of-balance, inertia, springs and pivot friction.
pub(super) static EFFECTS: &[Effect] = &[
    Effect {
        // T_oob = (g + a_p) (mu cos theta_h - nu sin theta_h), another mu (Dholiwar 2007, (5-22))
        effect: EffectName::OutOfBalance,
        component: Component::Structure,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!(
            "out_of_balance",
            "kg m",
            [-2000.0, 2000.0],
            10.0,
            Linear,
            get | p | lumped_value(p, |l| l.out_of_balance_kg_m),
            set | p,
            v | lumped_set(p, |l| l.out_of_balance_kg_m = v)
        )],
        starts: &[],
    },
    Effect {
        // T_oob = (g + a_p) (mu cos theta_h - nu sin theta_h), another nu (Dholiwar 2007, (5-22))
        effect: EffectName::VerticalOffset,
        component: Component::Structure,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!(
            "vertical_offset",
            "kg m",
            [-500.0, 500.0],
            10.0,
            Linear,
            get | p | lumped_value(p, |l| l.vertical_offset_kg_m),
            set | p,
            v | lumped_set(p, |l| l.vertical_offset_kg_m = v)
        )],
        starts: &[],
    },
    Effect {
        // J theta'' = torques, another beam inertia (Dholiwar 2007, (5-24))
        effect: EffectName::Inertia,
        component: Component::Structure,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!(
            "beam_inertia",
            "kg m^2",
            [1e-4, 5000.0],
            0.1,
            Log,
            get | p | lumped_value(p, |l| l.beam_inertia_kg_m2),
            set | p,
            v | lumped_set(p, |l| l.beam_inertia_kg_m2 = v)
        )],
        starts: &[],
    },
    Effect {
        // J theta'' = torques, another hub inertia (Dholiwar 2007, (5-24))
        effect: EffectName::Inertia,
        component: Component::Structure,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!(
            "hub_inertia",
            "kg m^2",
            [1e-4, 5000.0],
            0.1,
            Log,
            get | p | lumped_value(p, |l| l.hub_inertia_kg_m2),
            set | p,
            v | lumped_set(p, |l| l.hub_inertia_kg_m2 = v)
        )],
        starts: &[],
    },
    Effect {
        // T = -k (theta_h - theta_p - centre): a cable or hose between hub and platform (Hooke; Armstrong-Helouvry, Dupont, Canudas de Wit 1994 on cable drag)
        effect: EffectName::PositionStiffness,
        component: Component::Structure,
        kind: EffectKind::MissingPhysics,
        parameters: &[
            POSITION_STIFFNESS,
            parameter!(
                "centre",
                "rad",
                [-1.5, 1.5],
                0.05,
                Linear,
                get | p | lumped_value(p, |l| l.position_stiffness_centre_rad),
                set | p,
                v | lumped_set(p, |l| l.position_stiffness_centre_rad = v)
            ),
        ],
        starts: &[&[400.0, 0.02], &[400.0, -0.1], &[400.0, 0.1]],
    },
    Effect {
        // the same where nothing shows the angle itself: its zero is then that of the spring
        effect: EffectName::PositionStiffness,
        component: Component::Structure,
        kind: EffectKind::MissingPhysics,
        parameters: &[POSITION_STIFFNESS],
        starts: &[&[400.0]],
    },
    Effect {
        // dT/dt = k (w - |w| T / (2 T_max) - w |T| / (2 T_max)): a hose between hub and platform that yields (Bouc 1967; Wen 1976)
        effect: EffectName::Hysteresis,
        component: Component::Structure,
        kind: EffectKind::MissingPhysics,
        parameters: &[
            parameter!(
                "level",
                "N m",
                [0.0, 5e3],
                20.0,
                Linear,
                get | p | lumped_value(p, |l| l.hysteresis_nm),
                set | p,
                v | lumped_set(p, |l| l.hysteresis_nm = v)
            ),
            parameter!(
                "stiffness",
                "N m/rad",
                [10.0, 1e6],
                0.4,
                Log,
                get | p | lumped_value(p, |l| l.hysteresis_stiffness_nm_rad),
                set | p,
                v | lumped_set(p, |l| l.hysteresis_stiffness_nm_rad = v)
            ),
        ],
        starts: &[&[30.0, 300.0], &[30.0, 1500.0], &[30.0, 8000.0]],
    },
    Effect {
        // K_h (theta_h - theta_b) between hub and beam, another stiffness (Dholiwar 2007, (5-24), (5-25))
        effect: EffectName::FlexibleMode,
        component: Component::Structure,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!(
            "stiffness",
            "N m/rad",
            [1e4, 1e9],
            0.1,
            Log,
            get | p | lumped_value(p, |l| l.stiffness_nm_rad),
            set | p,
            v | lumped_set(p, |l| l.stiffness_nm_rad = v)
        )],
        starts: &[],
    },
    Effect {
        // D_h (theta_h' - theta_b') between hub and beam, another damping (Dholiwar 2007, (5-24), (5-25))
        effect: EffectName::FlexibleMode,
        component: Component::Structure,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!(
            "damping",
            "N m s/rad",
            [0.1, 1e6],
            0.5,
            Log,
            get | p | lumped_value(p, |l| l.damping_nm_s_rad),
            set | p,
            v | lumped_set(p, |l| l.damping_nm_s_rad = v)
        )],
        starts: &[],
    },
    Effect {
        // F_c sgn(w) when sliding, another level (Dahl 1968)
        effect: EffectName::Coulomb,
        component: Component::Pivot,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!(
            "coulomb",
            "N m",
            [0.1, 1e5],
            0.1,
            Log,
            get | p | p.pivot_friction.coulomb_nm(),
            set | p,
            v | p.pivot_friction.law.set_coulomb_nm(v)
        )],
        starts: &[],
    },
    Effect {
        // F_c sgn(w) on a machine whose model has no dry friction (Coulomb 1785)
        effect: EffectName::Coulomb,
        component: Component::Pivot,
        kind: EffectKind::MissingPhysics,
        parameters: &[parameter!(
            "coulomb",
            "N m",
            [0.0, 1e5],
            10.0,
            Linear,
            get | p | p.pivot_friction.coulomb_nm(),
            set | p,
            v | p.pivot_friction.law.set_or_add_coulomb_nm(v)
        )],
        starts: &[&[30.0]],
    },
    Effect {
        // F_v w, another coefficient (Dholiwar 2007, 5.2.6)
        effect: EffectName::Viscous,
        component: Component::Pivot,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!(
            "viscous",
            "N m s/rad",
            [0.0, 1e5],
            100.0,
            Linear,
            pivot_friction.viscous_nm_s_rad
        )],
        starts: &[],
    },
    Effect {
        // dry friction F_c (1 + (ratio - 1) exp(-(w / v_s)^2)) (Stribeck 1902; Bo and Pavelescu 1982; Armstrong-Helouvry 1991)
        effect: EffectName::Stribeck,
        component: Component::Pivot,
        kind: EffectKind::MissingPhysics,
        parameters: &[
            parameter!("static_ratio", "1", [1.0, 4.0], 0.2, Linear, get static_ratio, set set_static_ratio),
            parameter!("stribeck_rate", "rad/s", [1e-4, 50.0], 0.3, Log, pivot_friction.stribeck_rate_rad_s),
        ],
        starts: &[&[1.3, 0.01], &[1.3, 0.003], &[1.3, 0.04]],
    },
    Effect {
        // dry friction F_c (1 + a sgn(w)) (Armstrong-Helouvry, Dupont, Canudas de Wit 1994)
        effect: EffectName::AsymmetricFriction,
        component: Component::Pivot,
        kind: EffectKind::MissingPhysics,
        parameters: &[parameter!("asymmetry", "1", [-0.9, 0.9], 0.1, Linear, pivot_friction.asymmetry)],
        starts: &[],
    },
    Effect {
        // viscous part F_v (1 + a sgn(w)) w (Janot, Gautier, Brunot 2019 on the EMPS axis; Armstrong-Helouvry, Dupont, Canudas de Wit 1994)
        effect: EffectName::AsymmetricFriction,
        component: Component::Pivot,
        kind: EffectKind::MissingPhysics,
        parameters: &[parameter!(
            "viscous_asymmetry",
            "1",
            [-0.9, 0.9],
            0.1,
            Linear,
            pivot_friction.viscous_asymmetry
        )],
        starts: &[],
    },
    Effect {
        // dry friction F_c (1 + a sin(n theta + phase)), theta the hub's angle on the platform (Armstrong-Helouvry 1991; Popovic and Goldenberg 1998)
        effect: EffectName::PositionDependentFriction,
        component: Component::Pivot,
        kind: EffectKind::MissingPhysics,
        parameters: &[
            parameter!("amplitude", "1", [0.0, 0.95], 0.1, Linear, pivot_friction.position_ripple.amplitude),
            parameter!("order", "1/turn", [2.0, 400.0], 0.02, Log, pivot_friction.position_ripple.order),
            parameter!("phase", "rad", [-40.0, 40.0], 0.3, Linear, pivot_friction.position_ripple.phase_rad),
        ],
        starts: &[],
    },
    Effect {
        // sigma of Dahl's law, another value (Dahl 1968)
        effect: EffectName::PreslidingStiffness,
        component: Component::Pivot,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!(
            "rest_stiffness",
            "N m/rad",
            [1e3, 1e9],
            0.3,
            Log,
            get | p | p.pivot_friction.presliding_stiffness_nm_rad().unwrap_or(0.0),
            set | p,
            v | p.pivot_friction.set_presliding_stiffness_nm_rad(v)
        )],
        starts: &[],
    },
    Effect {
        // c w |w| (turbulent drag; Armstrong-Helouvry 1991)
        effect: EffectName::QuadraticDrag,
        component: Component::Pivot,
        kind: EffectKind::MissingPhysics,
        parameters: &[parameter!(
            "quadratic",
            "N m s^2/rad^2",
            [-5e4, 5e4],
            300.0,
            Linear,
            pivot_friction.quadratic_nm_s2_rad2
        )],
        starts: &[],
    },
    Effect {
        // dry friction F_c + c |T|, T the torque carried (Pelchen, Schweiger, Otter 2002; Hamon et al. 2011)
        effect: EffectName::LoadDependentFriction,
        component: Component::Pivot,
        kind: EffectKind::MissingPhysics,
        parameters: &[parameter!(
            "load_coefficient",
            "1",
            [-0.2, 1.0],
            0.02,
            Linear,
            pivot_friction.load_coefficient
        )],
        starts: &[],
    },
    Effect {
        // level (1 + a (exp(-t / tau) - 1)) (Bittencourt, Wernholt 2012 on friction and temperature)
        effect: EffectName::WarmUp,
        component: Component::Pivot,
        kind: EffectKind::MissingPhysics,
        parameters: &[
            parameter!("warm_up", "1", [-15.0, 0.95], 0.1, Linear, pivot_friction.warm_up),
            parameter!("time_constant", "s", [0.5, 200.0], 0.4, Log, pivot_friction.warm_up_time_s),
        ],
        starts: &[&[0.2, 4.0], &[-0.2, 4.0], &[0.2, 15.0], &[-2.0, 60.0]],
    },
    Effect {
        // T = f F r R sin(c) / L, another force: a gas of another temperature, another spring (AMCP 706-345, 1960)
        effect: EffectName::Equilibrator,
        component: Component::Structure,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!(
            "factor",
            "",
            [0.0, 3.0],
            0.02,
            Linear,
            get equilibrator_factor,
            set |p, v| p.loads.equilibrator.iter_mut().for_each(|equilibrator| equilibrator.factor = v)
        )],
        starts: &[],
    },
    Effect {
        // T = k d (1 + c v), another k (Hunt and Crossley 1975)
        effect: EffectName::EndStops,
        component: Component::Structure,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!(
            "stop_stiffness",
            "N m/rad",
            [1e2, 1e9],
            0.1,
            Log,
            get stop_stiffness,
            set |p, v| p.loads.end_stops.iter_mut().for_each(|stops| stops.stiffness_nm_rad = v)
        )],
        starts: &[],
    },
    Effect {
        // T = e K + ..., another height e of the recoiling mass above the trunnion (AMCP 706-342, 1963)
        effect: EffectName::Recoil,
        component: Component::Structure,
        kind: EffectKind::ParameterChange,
        parameters: &[parameter!(
            "recoil_height",
            "m",
            [-2.0, 2.0],
            0.005,
            Linear,
            get recoil_height,
            set |p, v| p.loads.recoil.iter_mut().for_each(|recoil| recoil.height_m = v)
        )],
        starts: &[],
    },
];
