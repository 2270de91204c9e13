//! A hose or cable between hub and platform that remembers how it was bent: a spring that yields.
//!
//! ```text
//!     dT/dt = k (w - |w| T / (2 T_max) - w |T| / (2 T_max))        Bouc 1967; Wen 1976, with n = 1
//! ```
//!
//! w is the hub's rate on the platform, and -T acts on the hub. Bent further, T comes nearer to T_max as an exponential of the
//! angle; bent back, it falls along the spring k. In small motion it is a spring, in large motion a friction.

use crate::parameters::{Gearbox, LumpedStructure};

/// A spring that yields.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hose {
    /// Largest torque, N m.
    pub level_nm: f64,
    /// Stiffness when it springs back, N m/rad.
    pub stiffness_nm_rad: f64,
}

impl Hose {
    /// Returns the hose of a structure; `None` if its torque or its stiffness is 0.
    pub fn of(lumped: &LumpedStructure) -> Option<Self> {
        let hose =
            Self { level_nm: lumped.hysteresis_nm, stiffness_nm_rad: lumped.hysteresis_stiffness_nm_rad };
        (hose.level_nm > 0.0 && hose.stiffness_nm_rad > 0.0).then_some(hose)
    }

    /// Returns the hysteresis of a transmission's compliance, which the wind-up bends; `None` if its torque or its stiffness is 0.
    pub fn of_gearbox(gearbox: &Gearbox) -> Option<Self> {
        let hose =
            Self { level_nm: gearbox.hysteresis_nm, stiffness_nm_rad: gearbox.hysteresis_stiffness_nm_rad };
        (hose.level_nm > 0.0 && hose.stiffness_nm_rad > 0.0).then_some(hose)
    }

    /// Returns the torque after the hub has turned by an angle, N m: exact, whatever the rate was, as long as it kept its sign.
    #[inline]
    pub fn torque_after_nm(&self, torque_nm: f64, travel_rad: f64) -> f64 {
        let (sense, mut left) = (travel_rad.signum(), travel_rad.abs());
        let mut along = torque_nm * sense;
        if along < 0.0 {
            let back = -along / self.stiffness_nm_rad;
            if left <= back {
                return sense * (along + self.stiffness_nm_rad * left);
            }
            left -= back;
            along = 0.0;
        }
        let rest = (self.level_nm - along) * (-self.stiffness_nm_rad * left / self.level_nm).exp();
        sense * (self.level_nm - rest)
    }

    /// Returns the derivative of the torque at a rate of the hub on the platform, N m/s.
    pub fn slope(&self, torque_nm: f64, rate_rad_s: f64) -> f64 {
        let bent = torque_nm / self.level_nm;
        self.stiffness_nm_rad * (rate_rad_s - 0.5 * rate_rad_s.abs() * bent - 0.5 * rate_rad_s * bent.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closed_form_is_the_equation_s_solution() {
        let hose = Hose { level_nm: 40.0, stiffness_nm_rad: 900.0 };
        let (mut torque, mut marched, mut angle) = (0.0, 0.0, 0.0_f64);
        let step = 1e-5;
        for k in 0..400_000 {
            let rate = 0.2 * (1.5 * f64::from(k) * step).cos();
            let turned = 0.2 / 1.5 * (1.5 * f64::from(k + 1) * step).sin();
            torque = hose.torque_after_nm(torque, turned - angle);
            angle = turned;
            let middle = marched + 0.5 * step * hose.slope(marched, rate);
            marched += step * hose.slope(middle, 0.2 * (1.5 * (f64::from(k) + 0.5) * step).cos());
        }
        assert!((torque - marched).abs() < 1e-3 * hose.level_nm, "{torque} {marched}");
        assert!(hose.torque_after_nm(0.0, 10.0) <= 40.0 && hose.torque_after_nm(0.0, -10.0) >= -40.0);
    }
}
