//! Friction between two bodies: a dry law, what modulates it, and drag.

use super::Ripple;

/// Friction between two bodies: a dry part by its law, and a viscous part.
#[derive(Debug, Clone, PartialEq)]
pub struct Friction {
    /// The law of the dry part.
    pub law: FrictionLaw,
    /// Viscous coefficient, N m s/rad.
    pub viscous_nm_s_rad: f64,
    /// Level of dry friction at rest over its Coulomb level: 1 means that it does not grow (Stribeck).
    pub static_ratio: f64,
    /// Rate at which the Stribeck effect has fallen to 1/e, rad/s.
    pub stribeck_rate_rad_s: f64,
    /// Half the difference of the Coulomb level between the two directions, as a fraction.
    pub asymmetry: f64,
    /// Half the difference of the viscous coefficient between the two directions, as a fraction.
    pub viscous_asymmetry: f64,
    /// Quadratic drag, N m s^2/rad^2.
    pub quadratic_nm_s2_rad2: f64,
    /// Relative variation of the Coulomb level with the angle.
    pub position_ripple: Ripple,
    /// Growth of the Coulomb level per N m of load carried, 1 (N m per N m).
    pub load_coefficient: f64,
    /// Relative change of the friction level as it warms up: level x (1 + warm_up (exp(-t / warm_up_time) - 1)).
    pub warm_up: f64,
    /// Time constant of the warm-up, s.
    pub warm_up_time_s: f64,
}

/// The law of dry friction. Levels in N m, rates in rad/s.
#[derive(Debug, Clone, PartialEq)]
pub enum FrictionLaw {
    /// No dry friction.
    None,
    /// Dahl: dF/dt = sigma w (1 - F/F_c sgn w)^exponent.
    Dahl {
        /// Coulomb level, N m.
        coulomb_nm: f64,
        /// Rest stiffness sigma, N m/rad.
        rest_stiffness_nm_rad: f64,
        /// Exponent; 1 is usual.
        exponent: f64,
    },
    /// LuGre.
    Lugre {
        /// Coulomb level, N m.
        coulomb_nm: f64,
        /// Bristle stiffness, N m/rad.
        bristle_stiffness_nm_rad: f64,
        /// Bristle damping, N m s/rad.
        bristle_damping_nm_s_rad: f64,
    },
    /// Coulomb with true stick (Karnopp); with `static_ratio` above 1 the breakaway level is above the sliding one.
    Coulomb {
        /// Coulomb level, N m.
        coulomb_nm: f64,
    },
    /// Reset integrator (Haessig and Friedland).
    ResetIntegrator {
        /// Sliding level, N m.
        coulomb_nm: f64,
        /// Deflection at which the bond breaks, rad.
        deflection_rad: f64,
        /// Damping of the bond, N m s/rad.
        damping_nm_s_rad: f64,
    },
    /// Sliding level that falls with the rate, with true stick at rest: the Tustin family.
    Stribeck {
        /// Coulomb level, N m.
        coulomb_nm: f64,
        /// The fall of the level from `static_ratio` x Coulomb to Coulomb.
        curve: StribeckCurve,
    },
    /// Karnopp: stick inside a band of rates, Coulomb outside; breaks away at `static_ratio` x Coulomb.
    Karnopp {
        /// Coulomb level, N m.
        coulomb_nm: f64,
        /// Half width D_v of the band of rates that counts as rest, rad/s.
        stick_rate_rad_s: f64,
    },
    /// Walrath: T + tau dT/dt = T_c sgn w.
    Walrath {
        /// Coulomb level, N m.
        coulomb_nm: f64,
        /// Time constant tau, s.
        time_constant_s: f64,
        /// Rate at which the smoothed sign has reached tanh 1, rad/s.
        smoothing_rate_rad_s: f64,
    },
    /// Bristles that bend, snap and bond again (Haessig and Friedland).
    Bristle {
        /// Mean sliding level, N m.
        coulomb_nm: f64,
        /// Number of bristles.
        bristles: usize,
        /// Deflection at which a bond snaps, rad.
        bond_rad: f64,
    },
}

impl FrictionLaw {
    /// Returns whether the joint truly sticks at rest, without presliding.
    pub fn sticks(&self) -> bool {
        matches!(self, Self::Coulomb { .. } | Self::Stribeck { .. } | Self::Karnopp { .. })
    }
}

/// Fall of dry friction from its level at rest to its Coulomb level as the rate grows; x is the rate over `stribeck_rate_rad_s`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StribeckCurve {
    /// exp(-|x|).
    Tustin,
    /// exp(-x^2).
    Gaussian,
    /// exp(-|x|^exponent).
    Exponential {
        /// Exponent.
        exponent: f64,
    },
    /// 1 / (1 + x^2).
    Lorentzian,
    /// Level over Coulomb is `static_ratio` + c1 x + c2 x^2 + c3 x^3 up to |x| = 1, constant beyond.
    Polynomial {
        /// c1, c2, c3.
        coefficients: [f64; 3],
    },
}

impl Friction {
    /// Returns a Dahl or other law with a viscous part and nothing else.
    pub fn with_viscous_part(law: FrictionLaw, viscous_nm_s_rad: f64) -> Self {
        Self {
            law,
            viscous_nm_s_rad,
            static_ratio: 1.0,
            stribeck_rate_rad_s: 0.01,
            asymmetry: 0.0,
            viscous_asymmetry: 0.0,
            quadratic_nm_s2_rad2: 0.0,
            position_ripple: Ripple::NONE,
            load_coefficient: 0.0,
            warm_up: 0.0,
            warm_up_time_s: 1.0,
        }
    }
}
