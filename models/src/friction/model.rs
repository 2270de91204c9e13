//! Friction between two bodies as a whole: a dry law, what modulates it, viscous and quadratic drag.

use super::build::checked_law;
use super::law::Law;
use super::partials::Partials;
use super::ranges;
use super::sliding::Stick;
use crate::Error;
use crate::parameters::{Friction, Ripple};
use crate::tolerance::LEAST_LEVEL;

/// T = dry(w, states; level) + F_v (1 + a_v sgn w) w + F_q w |w|.
///
/// The dry law's level is scaled by
/// `level = [1 + ripple(angle)] [1 + u (exp(-t / tau) - 1)] + c |load| / F_c`, see [`FrictionModel::level`], and in
/// each direction by 1 + asymmetry sgn w. All functions of the rate take that `level`; 1 is nominal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionModel {
    law: Law,
    viscous_nm_s_rad: f64,
    quadratic_nm_s2_rad2: f64,
    asymmetry: f64,
    viscous_asymmetry: f64,
    ripple: Ripple,
    load_per_coulomb: f64,
    warm_up: f64,
    warm_up_time_s: f64,
}

/// Conditions besides the rate on which the level of dry friction may depend.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrictionConditions {
    /// Angle between the bodies, rad.
    pub angle_rad: f64,
    /// Torque that the joint carries, N m.
    pub load_nm: f64,
    /// Time since the cold start, s.
    pub time_s: f64,
}

impl FrictionModel {
    /// No friction.
    pub const NONE: Self = Self {
        law: Law::None,
        viscous_nm_s_rad: 0.0,
        quadratic_nm_s2_rad2: 0.0,
        asymmetry: 0.0,
        viscous_asymmetry: 0.0,
        ripple: Ripple::NONE,
        load_per_coulomb: 0.0,
        warm_up: 0.0,
        warm_up_time_s: 1.0,
    };

    /// Returns the model with these parameters.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first parameter outside its range of [`ranges`], as `friction.` and its field; a load
    /// coefficient needs a Coulomb level, and a polynomial Stribeck curve must stay positive.
    pub fn new(friction: &Friction) -> Result<Self, Error> {
        Self::new_at_path("friction", friction)
    }

    /// Returns the model with these parameters as [`FrictionModel::new`] does; errors name the parameter with its path.
    pub(crate) fn new_at_path(path: &str, friction: &Friction) -> Result<Self, Error> {
        ranges::check_shared(path, friction)?;
        let coulomb = friction.coulomb_nm();
        Ok(Self {
            law: checked_law(path, friction)?,
            viscous_nm_s_rad: friction.viscous_nm_s_rad,
            quadratic_nm_s2_rad2: friction.quadratic_nm_s2_rad2,
            asymmetry: friction.asymmetry,
            viscous_asymmetry: friction.viscous_asymmetry,
            ripple: friction.position_ripple,
            load_per_coulomb: if coulomb > 0.0 { friction.load_coefficient / coulomb } else { 0.0 },
            warm_up: friction.warm_up,
            warm_up_time_s: friction.warm_up_time_s,
        })
    }

    /// Returns the dry law.
    #[inline]
    pub fn law(&self) -> &Law {
        &self.law
    }

    /// Returns half the difference of the Coulomb level between the two directions, as a fraction.
    pub fn asymmetry(&self) -> f64 {
        self.asymmetry
    }

    /// Returns the viscous coefficient, N m s/rad.
    pub fn viscous_nm_s_rad(&self) -> f64 {
        self.viscous_nm_s_rad
    }

    /// Returns the number of states.
    #[inline]
    pub fn states(&self) -> usize {
        self.law.states()
    }

    /// Returns whether the level depends on anything but the rate; if not, [`FrictionModel::level`] is 1.
    #[inline]
    pub fn is_modulated(&self) -> bool {
        self.ripple.amplitude != 0.0 || self.load_per_coulomb != 0.0 || self.warm_up != 0.0
    }

    /// Returns the factor on the Coulomb level.
    pub fn level(&self, at: &FrictionConditions) -> f64 {
        if !self.is_modulated() {
            return 1.0;
        }
        // exponential and sine take most of the time of a step: those of nothing are left out
        let warmth = match self.warm_up {
            0.0 => 1.0,
            warm_up => 1.0 + warm_up * (-at.time_s / self.warm_up_time_s).exp_m1(),
        };
        let ripple = if self.ripple.amplitude == 0.0 { 0.0 } else { self.ripple.at(at.angle_rad) };
        let own = (1.0 + ripple) * warmth;
        (own + self.load_per_coulomb * at.load_nm.abs()).max(LEAST_LEVEL)
    }

    /// Writes the time derivative of the states.
    #[inline]
    pub fn derivative(&self, rate_rad_s: f64, level: f64, states: &[f64], slopes: &mut [f64]) {
        self.law.derivative(rate_rad_s, self.directed_level(rate_rad_s, level), states, slopes);
    }

    /// Returns the torque that opposes a positive rate, N m.
    #[inline]
    pub fn torque(&self, rate_rad_s: f64, level: f64, states: &[f64]) -> f64 {
        self.dry_torque(rate_rad_s, level, states) + self.drag(rate_rad_s)
    }

    /// Returns the torque without viscous and quadratic drag, N m.
    #[inline]
    pub fn dry_torque(&self, rate_rad_s: f64, level: f64, states: &[f64]) -> f64 {
        self.law.torque(rate_rad_s, self.directed_level(rate_rad_s, level), states)
    }

    /// Returns the states after a time at constant rate: exact.
    #[inline]
    pub fn advance(&self, rate_rad_s: f64, time_s: f64, level: f64, states: &mut [f64]) {
        self.law.advance(rate_rad_s, time_s, self.directed_level(rate_rad_s, level), states);
    }

    /// Puts states that a step of an integrator left outside their limits back onto them.
    #[inline]
    pub fn project(&self, states: &mut [f64]) {
        self.law.project(states);
    }

    /// Returns the torque after a long time at constant rate and nominal level, N m.
    pub fn steady_torque(&self, rate_rad_s: f64) -> f64 {
        self.law.steady_torque(rate_rad_s, self.directed_level(rate_rad_s, 1.0)) + self.drag(rate_rad_s)
    }

    /// Returns the derivative of the steady torque with the rate at nominal level, N m s/rad, away from rest.
    pub fn steady_slope(&self, rate_rad_s: f64) -> f64 {
        self.law.steady_slope(rate_rad_s, self.directed_level(rate_rad_s, 1.0)) + self.drag_slope(rate_rad_s)
    }

    /// Returns the partial derivatives of a law with exactly one state, drag included; `None` for the others.
    #[inline]
    pub fn partials(&self, rate_rad_s: f64, level: f64, states: &[f64]) -> Option<Partials> {
        let mut partials = self.law.partials(rate_rad_s, self.directed_level(rate_rad_s, level), states)?;
        partials.torque_by_rate += self.drag_slope(rate_rad_s);
        Some(partials)
    }

    /// Returns what a law that truly sticks holds at rest; `None` for laws that do not.
    #[inline]
    pub fn stick(&self, level: f64) -> Option<Stick> {
        let Law::Sliding(law) = &self.law else { return None };
        let breakaway = level * law.breakaway_nm();
        Some(Stick {
            positive_nm: breakaway * (1.0 + self.asymmetry),
            negative_nm: breakaway * (1.0 - self.asymmetry),
            rest_rate_rad_s: law.rest_rate_rad_s,
        })
    }

    /// Returns the stiffness at rest, N m/rad: what a linearisation in presliding sees; infinite for true stick.
    pub fn rest_stiffness_nm_rad(&self) -> f64 {
        self.law.rest_stiffness_nm_rad()
    }

    /// Returns the damping at rest, N m s/rad, the viscous part included.
    pub fn rest_damping_nm_s_rad(&self) -> f64 {
        self.law.rest_damping_nm_s_rad() + self.viscous_nm_s_rad
    }

    #[inline]
    fn directed_level(&self, rate_rad_s: f64, level: f64) -> f64 {
        level * (1.0 + self.asymmetry * rate_rad_s.signum())
    }

    #[inline]
    fn drag(&self, rate_rad_s: f64) -> f64 {
        (self.viscous_along(rate_rad_s) + self.quadratic_nm_s2_rad2 * rate_rad_s.abs()) * rate_rad_s
    }

    #[inline]
    fn drag_slope(&self, rate_rad_s: f64) -> f64 {
        self.viscous_along(rate_rad_s) + 2.0 * self.quadratic_nm_s2_rad2 * rate_rad_s.abs()
    }

    /// Returns the viscous coefficient in the direction of motion; the mean of both at rest.
    #[inline]
    fn viscous_along(&self, rate_rad_s: f64) -> f64 {
        let direction = if rate_rad_s == 0.0 { 0.0 } else { rate_rad_s.signum() };
        self.viscous_nm_s_rad * (1.0 + self.viscous_asymmetry * direction)
    }
}
