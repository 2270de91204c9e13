//! The LuGre law: an average bristle deflection with a Stribeck level.

use super::partials::Partials;
use super::real::Real;
use super::stribeck::StribeckLevel;

/// dz/dt = w - sigma_0 |w| z / g(w), T = sigma_0 z + sigma_1 dz/dt; the state is the deflection z, rad.
///
/// The viscous part sigma_2 w belongs to the whole [`super::FrictionModel`]. Steady: T = g(w) sgn w. C. Canudas de
/// Wit, H. Olsson, K. Astrom, P. Lischinsky, "A new model for control of systems with friction", IEEE TAC 40, 1995.
/// Known defect: a load below breakaway with a small dither on it drifts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lugre<R = f64> {
    /// Level by the rate.
    pub level: StribeckLevel<R>,
    /// Bristle stiffness sigma_0, N m/rad.
    pub stiffness_nm_rad: R,
    /// Bristle damping sigma_1, N m s/rad.
    pub damping_nm_s_rad: R,
}

impl<R: Copy> Lugre<R> {
    /// Returns the law in other numbers: each of its numbers as `convert` has it.
    #[inline(always)]
    pub fn map_numbers<T>(&self, convert: impl Fn(R) -> T) -> Lugre<T> {
        Lugre {
            level: self.level.map_numbers(&convert),
            stiffness_nm_rad: convert(self.stiffness_nm_rad),
            damping_nm_s_rad: convert(self.damping_nm_s_rad),
        }
    }
}

impl<R: Real> Lugre<R> {
    /// Returns dz/dt, rad/s.
    #[inline(always)]
    pub fn derivative(&self, rate_rad_s: R, level: R, deflection_rad: R) -> R {
        rate_rad_s
            - self.stiffness_nm_rad * rate_rad_s.abs() * deflection_rad / self.level_at(rate_rad_s, level)
    }

    /// Returns the torque, N m.
    #[inline(always)]
    pub fn torque(&self, rate_rad_s: R, level: R, deflection_rad: R) -> R {
        let bending = self.derivative(rate_rad_s, level, deflection_rad);
        self.stiffness_nm_rad * deflection_rad + self.damping_nm_s_rad * bending
    }

    /// Returns the deflection after a time at constant rate: exact.
    #[inline(always)]
    pub fn advance(&self, rate_rad_s: R, time_s: R, level: R, deflection_rad: R) -> R {
        let g = self.level_at(rate_rad_s, level);
        let steady = g * rate_rad_s.signum() / self.stiffness_nm_rad;
        let spent = -self.stiffness_nm_rad * rate_rad_s.abs() * time_s / g;
        let moved = steady + (deflection_rad - steady) * spent.exp();
        R::choose(rate_rad_s.is_zero(), deflection_rad, moved)
    }

    #[inline(always)]
    fn level_at(&self, rate_rad_s: R, level: R) -> R {
        level * self.level.at(rate_rad_s)
    }
}

impl Lugre {
    /// Returns the partial derivatives of dz/dt and of the torque.
    #[inline]
    pub fn partials(&self, rate_rad_s: f64, level: f64, deflection_rad: f64) -> Partials {
        let g = self.level_at(rate_rad_s, level);
        let drawn = self.stiffness_nm_rad * deflection_rad / g;
        let falling = drawn * rate_rad_s.abs() * level * self.level.slope(rate_rad_s) / g;
        let state_by_rate = 1.0 - drawn * rate_rad_s.signum() + falling;
        let state_by_state = -self.stiffness_nm_rad * rate_rad_s.abs() / g;
        Partials {
            state_by_rate,
            state_by_state,
            torque_by_rate: self.damping_nm_s_rad * state_by_rate,
            torque_by_state: self.stiffness_nm_rad + self.damping_nm_s_rad * state_by_state,
        }
    }
}
