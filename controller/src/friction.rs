//! Dry friction from a rate, as volts that cancel it.

use serde::{Deserialize, Serialize};

use crate::PathSignal;

/// A friction that follows a rate by one of the laws of dry friction
///
/// ```text
///     F = law(w, level g(|w|)),   output  volts_per_nm F + volts_s_rad w
/// ```
///
/// Every step is implicit or bounded: it needs no exponential, and F stays inside the law's own level at any rate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrictionObserver {
    /// Name: a lower-case identifier.
    pub name: String,
    /// The rate w that the friction follows: a measured one (feedback) or the demand (feedforward).
    pub rate: PathSignal,
    /// The law.
    pub law: ObserverLaw,
    /// Coulomb level F_c, N m.
    pub coulomb_nm: f64,
    /// Rest stiffness sigma, N m/rad; laws that slide alone do not use it.
    pub rest_stiffness_nm_rad: f64,
    /// The level over F_c by the speed, (rad/s, 1), the speeds rising from 0: straight between, constant beyond. Empty
    /// for a constant level.
    pub level: Vec<[f64; 2]>,
    /// Volts that cancel one N m.
    pub volts_per_nm: f64,
    /// Volts for one rad/s of rate: the viscous part; may be 0.
    pub viscous_v_s_rad: f64,
}

/// The level of the friction over that of the observers, learnt from the feedback while the friction slides
///
/// ```text
///     whole = sum of the observers' volts,   phi = whole / volts,   rho = w / rate_scale
///     output = cancelled level whole
///     left = feedback / volts - (1 - cancelled) level phi - slope rho - offset
///     level += gain T left phi,  slope += gain T left rho,  offset += gain T left        while |w| > sliding_rate, over 1 + rho^2
/// ```
///
/// with the level inside its limits. Friction whose level is wrong leaves the feedback a part that follows phi; what follows the
/// rate, and what is constant, is learnt beside it and goes into slope and offset, which act on nothing. It follows the rate of the first observer.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LevelLearning {
    /// Lowest level over that of the observers, and the level at the start.
    pub lowest: f64,
    /// Highest level over that of the observers.
    pub highest: f64,
    /// Part of the level that is cancelled, 0 to 1.
    pub cancelled: f64,
    /// Inverse of the time constant of the learning, 1/s.
    pub gain_per_s: f64,
    /// Volts of the observers while they slide, V.
    pub volts: f64,
    /// The rate above which the friction slides for certain, rad/s: it is learnt in full from twice this rate on.
    pub sliding_rate_rad_s: f64,
    /// The rate that counts as 1, rad/s.
    pub rate_scale_rad_s: f64,
}

/// The laws of an observer, with T the sample period and g the level at the speed of the sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum ObserverLaw {
    /// Dahl with exponent 1: `F[k+1] = (F[k] + sigma T w) / (1 + sigma T |w| / g)`, the implicit step of
    /// dF = sigma (dx - F/g |dx|).
    Dahl,
    /// Dahl with another exponent i: `F[k+1] = F[k] + sigma T w y(1 - F/g sgn w)`, kept inside +/- g, with y(r) = r^i
    /// straight between 14 points.
    DahlPower {
        /// The exponent i, above 0.
        exponent: f64,
    },
    /// LuGre: the bristles' torque as in [`ObserverLaw::Dahl`], and their damping `sigma_1 dz/dt` with it.
    Lugre {
        /// Damping sigma_1 of the bristles, N m s/rad.
        damping_nm_s_rad: f64,
    },
    /// The bond of the reset integrator: it stretches to F_c and slides, with a breakaway above F_c just before.
    ResetIntegrator {
        /// Breakaway over sliding level, 1 or more.
        static_ratio: f64,
        /// Damping of the unbroken bond, N m s/rad.
        damping_nm_s_rad: f64,
    },
    /// `F = g clamp(w / w0)`: Coulomb's law and the Stribeck family, with the sign softened below w0.
    Sliding {
        /// Rate w0 below which the sign is a straight line, rad/s.
        sign_rate_rad_s: f64,
    },
    /// Walrath: `F[k+1] = (F[k] + T/tau F_c tanh(w / w0)) / (1 + T/tau)`, tanh straight between points.
    Walrath {
        /// Rate w0 of the smoothed sign, rad/s.
        sign_rate_rad_s: f64,
        /// Lag tau, s.
        time_constant_s: f64,
    },
}
