//! The LuGre law: an average bristle deflection with a Stribeck level.

use super::law::Partials;
use super::stribeck::StribeckLevel;

/// dz/dt = w - sigma_0 |w| z / g(w), T = sigma_0 z + sigma_1 dz/dt; the state is the deflection z, rad.
///
/// The viscous part sigma_2 w belongs to the whole [`super::FrictionModel`]. Steady: T = g(w) sgn w. C. Canudas de
/// Wit, H. Olsson, K. Astrom, P. Lischinsky, "A new model for control of systems with friction", IEEE TAC 40, 1995.
/// Known defect: a load below breakaway with a small dither on it drifts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lugre {
    /// Level by the rate.
    pub level: StribeckLevel,
    /// Bristle stiffness sigma_0, N m/rad.
    pub stiffness_nm_rad: f64,
    /// Bristle damping sigma_1, N m s/rad.
    pub damping_nm_s_rad: f64,
}

impl Lugre {
    /// dz/dt, rad/s.
    #[inline]
    pub fn derivative(&self, rate_rad_s: f64, level: f64, deflection_rad: f64) -> f64 {
        rate_rad_s
            - self.stiffness_nm_rad * rate_rad_s.abs() * deflection_rad / self.level_at(rate_rad_s, level)
    }

    /// Returns the torque, N m.
    #[inline]
    pub fn torque(&self, rate_rad_s: f64, level: f64, deflection_rad: f64) -> f64 {
        let bending = self.derivative(rate_rad_s, level, deflection_rad);
        self.stiffness_nm_rad * deflection_rad + self.damping_nm_s_rad * bending
    }

    /// Returns the deflection after a time at constant rate: exact.
    #[inline]
    pub fn advance(&self, rate_rad_s: f64, time_s: f64, level: f64, deflection_rad: f64) -> f64 {
        if rate_rad_s == 0.0 {
            return deflection_rad;
        }
        let g = self.level_at(rate_rad_s, level);
        let steady = g * rate_rad_s.signum() / self.stiffness_nm_rad;
        steady + (deflection_rad - steady) * (-self.stiffness_nm_rad * rate_rad_s.abs() * time_s / g).exp()
    }

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

    #[inline]
    fn level_at(&self, rate_rad_s: f64, level: f64) -> f64 {
        level * self.level.at(rate_rad_s)
    }
}
