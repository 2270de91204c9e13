//! Structure and pivot: imbalance, inertia, springs, friction at the pivot.

use super::effect::{Effect, Kind, parameter};
use counterpoise_models::{FrictionLaw, Lumped, Parameters};

fn lumped(p: &Parameters, read: fn(&Lumped) -> f64) -> f64 {
    p.lumped.as_ref().map_or(0.0, read)
}

fn lumped_set(p: &mut Parameters, write: impl FnOnce(&mut Lumped)) {
    if let Some(structure) = p.lumped.as_mut() {
        write(structure);
    }
}

/// Writes the Coulomb level of a law.
pub(super) fn set_coulomb(law: &mut FrictionLaw, value: f64) {
    match law {
        FrictionLaw::Dahl { coulomb_nm, .. }
        | FrictionLaw::Lugre { coulomb_nm, .. }
        | FrictionLaw::Coulomb { coulomb_nm }
        | FrictionLaw::ResetIntegrator { coulomb_nm, .. } => *coulomb_nm = value,
        _ => {}
    }
}

/// Reads the stiffness of a law at rest.
pub(super) fn rest_stiffness(law: &FrictionLaw) -> f64 {
    match law {
        FrictionLaw::Dahl { rest_stiffness_nm_rad, .. } => *rest_stiffness_nm_rad,
        FrictionLaw::Lugre { bristle_stiffness_nm_rad, .. } => *bristle_stiffness_nm_rad,
        _ => 0.0,
    }
}

/// Writes the stiffness of a law at rest.
pub(super) fn set_rest_stiffness(law: &mut FrictionLaw, value: f64) {
    match law {
        FrictionLaw::Dahl { rest_stiffness_nm_rad, .. } => *rest_stiffness_nm_rad = value,
        FrictionLaw::Lugre { bristle_stiffness_nm_rad, .. } => *bristle_stiffness_nm_rad = value,
        _ => {}
    }
}

/// Out-of-balance, inertia, springs and pivot friction.
pub(super) static EFFECTS: &[Effect] = &[
    Effect {
        effect: "out_of_balance",
        component: "structure",
        kind: Kind::ParameterChange,
        equation: "T_oob = (g + a_p) (mu cos theta_h - nu sin theta_h), another mu",
        source: "Dholiwar 2007, (5-22)",
        when: "always: constant torque at rest, and in proportion to heave",
        experiment: "hold still at two elevations, or drive the platform in heave",
        parameters: &[parameter!(
            "out_of_balance",
            "kg m",
            [-2000.0, 2000.0],
            10.0,
            Linear,
            get | p | lumped(p, |l| l.out_of_balance_kg_m),
            set | p,
            v | lumped_set(p, |l| l.out_of_balance_kg_m = v)
        )],
        starts: &[],
    },
    Effect {
        effect: "vertical_offset",
        component: "structure",
        kind: Kind::ParameterChange,
        equation: "T_oob = (g + a_p) (mu cos theta_h - nu sin theta_h), another nu",
        source: "Dholiwar 2007, (5-22)",
        when: "away from level: torque in proportion to the inertial hub angle",
        experiment: "slow travel over the whole elevation range, with the platform level and tilted",
        parameters: &[parameter!(
            "vertical_offset",
            "kg m",
            [-500.0, 500.0],
            10.0,
            Linear,
            get | p | lumped(p, |l| l.vertical_offset_kg_m),
            set | p,
            v | lumped_set(p, |l| l.vertical_offset_kg_m = v)
        )],
        starts: &[],
    },
    Effect {
        effect: "inertia",
        component: "structure",
        kind: Kind::ParameterChange,
        equation: "J theta'' = torques, another beam inertia",
        source: "Dholiwar 2007, (5-24)",
        when: "in proportion to angular acceleration",
        experiment: "multisine or triangle demand with the platform still",
        parameters: &[parameter!(
            "beam_inertia",
            "kg m^2",
            [1e-4, 5000.0],
            0.1,
            Log,
            get | p | lumped(p, |l| l.beam_inertia_kg_m2),
            set | p,
            v | lumped_set(p, |l| l.beam_inertia_kg_m2 = v)
        )],
        starts: &[],
    },
    Effect {
        effect: "inertia",
        component: "structure",
        kind: Kind::ParameterChange,
        equation: "J theta'' = torques, another hub inertia",
        source: "Dholiwar 2007, (5-24)",
        when: "in proportion to angular acceleration",
        experiment: "multisine or triangle demand with the platform still",
        parameters: &[parameter!(
            "hub_inertia",
            "kg m^2",
            [1e-4, 5000.0],
            0.1,
            Log,
            get | p | lumped(p, |l| l.hub_inertia_kg_m2),
            set | p,
            v | lumped_set(p, |l| l.hub_inertia_kg_m2 = v)
        )],
        starts: &[],
    },
    Effect {
        effect: "position_stiffness",
        component: "structure",
        kind: Kind::MissingPhysics,
        equation: "T = -k (theta_h - theta_p - centre): a cable or hose between hub and platform",
        source: "Hooke; Armstrong-Helouvry, Dupont, Canudas de Wit 1994 on cable drag",
        when: "in proportion to the hub's position on the platform",
        experiment: "slow travel over the whole range; tilt of the platform tells it from gravity",
        parameters: &[
            parameter!(
                "stiffness",
                "N m/rad",
                [-2.0e4, 2.0e4],
                300.0,
                Linear,
                get | p | lumped(p, |l| l.position_stiffness_nm_rad),
                set | p,
                v | lumped_set(p, |l| l.position_stiffness_nm_rad = v)
            ),
            parameter!(
                "centre",
                "rad",
                [-1.5, 1.5],
                0.05,
                Linear,
                get | p | lumped(p, |l| l.position_stiffness_centre_rad),
                set | p,
                v | lumped_set(p, |l| l.position_stiffness_centre_rad = v)
            ),
        ],
        starts: &[&[400.0, 0.02], &[400.0, -0.1], &[400.0, 0.1]],
    },
    Effect {
        effect: "hysteresis",
        component: "structure",
        kind: Kind::MissingPhysics,
        equation: "dT/dt = k (w - |w| T / (2 T_max) - w |T| / (2 T_max)): a hose between hub and platform that yields",
        source: "Bouc 1967; Wen 1976",
        when: "after a reversal, over an angle that does not depend on the rate",
        experiment: "slow travel with reversals after long and after short ways",
        parameters: &[
            parameter!(
                "level",
                "N m",
                [0.0, 5e3],
                20.0,
                Linear,
                get | p | lumped(p, |l| l.hysteresis_nm),
                set | p,
                v | lumped_set(p, |l| l.hysteresis_nm = v)
            ),
            parameter!(
                "stiffness",
                "N m/rad",
                [10.0, 1e6],
                0.4,
                Log,
                get | p | lumped(p, |l| l.hysteresis_stiffness_nm_rad),
                set | p,
                v | lumped_set(p, |l| l.hysteresis_stiffness_nm_rad = v)
            ),
        ],
        starts: &[&[30.0, 300.0], &[30.0, 1500.0], &[30.0, 8000.0]],
    },
    Effect {
        effect: "flexible_mode",
        component: "structure",
        kind: Kind::ParameterChange,
        equation: "K_h (theta_h - theta_b) between hub and beam, another stiffness",
        source: "Dholiwar 2007, (5-24), (5-25)",
        when: "near the structure's first resonance",
        experiment: "multisine around the first resonance",
        parameters: &[parameter!(
            "stiffness",
            "N m/rad",
            [1e4, 1e9],
            0.1,
            Log,
            get | p | lumped(p, |l| l.stiffness_nm_rad),
            set | p,
            v | lumped_set(p, |l| l.stiffness_nm_rad = v)
        )],
        starts: &[],
    },
    Effect {
        effect: "flexible_mode",
        component: "structure",
        kind: Kind::ParameterChange,
        equation: "D_h (theta_h' - theta_b') between hub and beam, another damping",
        source: "Dholiwar 2007, (5-24), (5-25)",
        when: "near the structure's first resonance",
        experiment: "multisine around the first resonance",
        parameters: &[parameter!(
            "damping",
            "N m s/rad",
            [0.1, 1e6],
            0.5,
            Log,
            get | p | lumped(p, |l| l.damping_nm_s_rad),
            set | p,
            v | lumped_set(p, |l| l.damping_nm_s_rad = v)
        )],
        starts: &[],
    },
    Effect {
        effect: "coulomb",
        component: "pivot",
        kind: Kind::ParameterChange,
        equation: "F_c sgn(w) when sliding, another level",
        source: "Dahl 1968",
        when: "at every reversal of the hub's motion on the platform",
        experiment: "triangle demand; platform motion with the hub held still",
        parameters: &[parameter!(
            "coulomb",
            "N m",
            [0.1, 1e5],
            0.1,
            Log,
            get | p | p.pivot_friction.coulomb_nm(),
            set | p,
            v | set_coulomb(&mut p.pivot_friction.law, v)
        )],
        starts: &[],
    },
    Effect {
        effect: "viscous",
        component: "pivot",
        kind: Kind::ParameterChange,
        equation: "F_v w, another coefficient",
        source: "Dholiwar 2007, 5.2.6",
        when: "in proportion to the hub's rate on the platform",
        experiment: "constant rates, both ways, several speeds",
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
        effect: "stribeck",
        component: "pivot",
        kind: Kind::MissingPhysics,
        equation: "dry level F_c (1 + (ratio - 1) exp(-(w / v_s)^2))",
        source: "Stribeck 1902; Bo and Pavelescu 1982; Armstrong-Helouvry 1991",
        when: "near zero rate of the hub on the platform, below about v_s",
        experiment: "constant-rate ladder from well below to well above v_s",
        parameters: &[
            parameter!("static_ratio", "1", [1.0, 4.0], 0.2, Linear, pivot_friction.static_ratio),
            parameter!("stribeck_rate", "rad/s", [5e-4, 0.5], 0.3, Log, pivot_friction.stribeck_rate_rad_s),
        ],
        starts: &[&[1.3, 0.01], &[1.3, 0.003], &[1.3, 0.04]],
    },
    Effect {
        effect: "asymmetric_friction",
        component: "pivot",
        kind: Kind::MissingPhysics,
        equation: "dry level F_c (1 + a sgn(w))",
        source: "Armstrong-Helouvry, Dupont, Canudas de Wit 1994",
        when: "different in the two directions of motion",
        experiment: "triangle demand at two out-of-balances",
        parameters: &[parameter!("asymmetry", "1", [-0.9, 0.9], 0.1, Linear, pivot_friction.asymmetry)],
        starts: &[],
    },
    Effect {
        effect: "asymmetric_friction",
        component: "pivot",
        kind: Kind::MissingPhysics,
        equation: "viscous part F_v (1 + a sgn(w)) w",
        source: "Janot, Gautier, Brunot 2019 on the EMPS axis; Armstrong-Helouvry, Dupont, Canudas de Wit 1994",
        when: "different in the two directions of motion, in proportion to the rate",
        experiment: "constant rates, both ways, several speeds",
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
        effect: "position_dependent_friction",
        component: "pivot",
        kind: Kind::MissingPhysics,
        equation: "dry level F_c (1 + a sin(n theta + phase)), theta the hub's angle on the platform",
        source: "Armstrong-Helouvry 1991; Popovic and Goldenberg 1998",
        when: "repeats with the hub's angle on the platform",
        experiment: "slow travel over the whole range, both ways",
        parameters: &[
            parameter!("amplitude", "1", [0.0, 0.95], 0.1, Linear, pivot_friction.position_ripple.amplitude),
            parameter!("order", "1/turn", [2.0, 400.0], 0.02, Log, pivot_friction.position_ripple.order),
            parameter!("phase", "rad", [-40.0, 40.0], 0.3, Linear, pivot_friction.position_ripple.phase_rad),
        ],
        starts: &[],
    },
    Effect {
        effect: "presliding_stiffness",
        component: "pivot",
        kind: Kind::ParameterChange,
        equation: "sigma of Dahl's law, another value",
        source: "Dahl 1968",
        when: "in the first fraction of a milliradian after every reversal",
        experiment: "sine below breakaway at several amplitudes",
        parameters: &[parameter!(
            "rest_stiffness",
            "N m/rad",
            [1e3, 1e9],
            0.3,
            Log,
            get | p | rest_stiffness(&p.pivot_friction.law),
            set | p,
            v | set_rest_stiffness(&mut p.pivot_friction.law, v)
        )],
        starts: &[],
    },
    Effect {
        effect: "quadratic_drag",
        component: "pivot",
        kind: Kind::MissingPhysics,
        equation: "c w |w|",
        source: "turbulent drag; Armstrong-Helouvry 1991",
        when: "at the highest rates of the hub on the platform",
        experiment: "constant-rate ladder up to the highest rate",
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
        effect: "load_dependent_friction",
        component: "pivot",
        kind: Kind::MissingPhysics,
        equation: "dry level F_c + c |T|, T the torque carried",
        source: "Pelchen, Schweiger, Otter 2002; Hamon et al. 2011",
        when: "where the torque carried varies: heave, or several out-of-balances",
        experiment: "the same triangle at several out-of-balances",
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
        effect: "warm_up",
        component: "pivot",
        kind: Kind::MissingPhysics,
        equation: "level (1 + a (exp(-t / tau) - 1))",
        source: "Bittencourt, Wernholt 2012 on friction and temperature",
        when: "drifts over the recording, whatever the motion",
        experiment: "the same triangle after rest and after ten minutes of motion",
        parameters: &[
            parameter!("warm_up", "1", [-1.0, 0.95], 0.1, Linear, pivot_friction.warm_up),
            parameter!("time_constant", "s", [0.5, 200.0], 0.4, Log, pivot_friction.warm_up_time_s),
        ],
        starts: &[&[0.2, 4.0], &[-0.2, 4.0], &[0.2, 15.0]],
    },
];
