//! The reset integrator: a bond that stretches to its limit and then slides.

use super::law::Partials;

/// dz/dt = 0 while w pushes z beyond +/- z_0, w otherwise;
/// T = (1 + a) k z + d dz/dt while |z| < z_0, k z_0 sgn z while sliding; the state is the deflection z, rad.
///
/// k z_0 is the sliding level F_c, (1 + a) k z_0 the breakaway level F_s. D. Haessig and B. Friedland, "On the
/// modeling and simulation of friction", ASME JDSMC 113, 1991; (5-42), (5-43).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResetIntegrator {
    /// Sliding level F_c, N m.
    pub coulomb_nm: f64,
    /// F_s / F_c = 1 + a.
    pub static_ratio: f64,
    /// Deflection z_0 at which the bond breaks, rad.
    pub deflection_rad: f64,
    /// Damping d of the bond, N m s/rad.
    pub damping_nm_s_rad: f64,
}

impl ResetIntegrator {
    /// dz/dt, rad/s.
    #[inline]
    pub fn derivative(&self, rate_rad_s: f64, deflection_rad: f64) -> f64 {
        if self.slides(rate_rad_s, deflection_rad) { 0.0 } else { rate_rad_s }
    }

    /// Returns the torque, N m.
    #[inline]
    pub fn torque(&self, rate_rad_s: f64, level: f64, deflection_rad: f64) -> f64 {
        if deflection_rad.abs() >= self.deflection_rad {
            let damped = self.damping_nm_s_rad * self.derivative(rate_rad_s, deflection_rad);
            return level * self.coulomb_nm.copysign(deflection_rad) + damped;
        }
        level * self.bond_stiffness_nm_rad() * deflection_rad + self.damping_nm_s_rad * rate_rad_s
    }

    /// Returns the deflection after a time at constant rate: exact.
    #[inline]
    pub fn advance(&self, rate_rad_s: f64, time_s: f64, deflection_rad: f64) -> f64 {
        self.project(deflection_rad + rate_rad_s * time_s)
    }

    /// Returns the deflection within its limits; an integrator calls it after each step.
    #[inline]
    pub fn project(&self, deflection_rad: f64) -> f64 {
        deflection_rad.clamp(-self.deflection_rad, self.deflection_rad)
    }

    /// Returns the partial derivatives of dz/dt and of the torque, away from the limits.
    #[inline]
    pub fn partials(&self, rate_rad_s: f64, level: f64, deflection_rad: f64) -> Partials {
        if self.slides(rate_rad_s, deflection_rad) {
            return Partials::default();
        }
        Partials {
            state_by_rate: 1.0,
            state_by_state: 0.0,
            torque_by_rate: self.damping_nm_s_rad,
            torque_by_state: level * self.bond_stiffness_nm_rad(),
        }
    }

    /// Returns the stiffness (1 + a) k of the unbroken bond, N m/rad.
    pub fn bond_stiffness_nm_rad(&self) -> f64 {
        self.static_ratio * self.coulomb_nm / self.deflection_rad
    }

    #[inline]
    fn slides(&self, rate_rad_s: f64, deflection_rad: f64) -> bool {
        (rate_rad_s > 0.0 && deflection_rad >= self.deflection_rad)
            || (rate_rad_s < 0.0 && deflection_rad <= -self.deflection_rad)
    }
}
