//! The reset integrator: a bond that stretches to its limit and then slides.

use super::partials::Partials;
use super::real::Real;

/// dz/dt = 0 while w pushes z beyond +/- z_0, w otherwise;
/// T = (1 + a) k z + d dz/dt while |z| < z_0, k z_0 sgn z while sliding; the state is the deflection z, rad.
///
/// k z_0 is the sliding level F_c, (1 + a) k z_0 the breakaway level F_s. D. Haessig and B. Friedland, "On the
/// modeling and simulation of friction", ASME JDSMC 113, 1991; (5-42), (5-43).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResetIntegrator<R = f64> {
    /// Sliding level F_c, N m.
    pub coulomb_nm: R,
    /// F_s / F_c = 1 + a.
    pub static_ratio: R,
    /// Deflection z_0 at which the bond breaks, rad.
    pub deflection_rad: R,
    /// Damping d of the bond, N m s/rad.
    pub damping_nm_s_rad: R,
}

impl<R: Copy> ResetIntegrator<R> {
    /// Returns the law in other numbers: each of its numbers as `convert` has it.
    #[inline(always)]
    pub fn map_numbers<T>(&self, convert: impl Fn(R) -> T) -> ResetIntegrator<T> {
        ResetIntegrator {
            coulomb_nm: convert(self.coulomb_nm),
            static_ratio: convert(self.static_ratio),
            deflection_rad: convert(self.deflection_rad),
            damping_nm_s_rad: convert(self.damping_nm_s_rad),
        }
    }
}

impl<R: Real> ResetIntegrator<R> {
    /// Returns dz/dt, rad/s.
    #[inline(always)]
    pub fn derivative(&self, rate_rad_s: R, deflection_rad: R) -> R {
        let zero = rate_rad_s.constant(0.0);
        // pushed outwards at either limit
        let at_upper = R::choose(rate_rad_s.is_above(zero), deflection_rad, -deflection_rad);
        let slides = at_upper.is_at_least(self.deflection_rad);
        let moving = R::choose(slides, zero, rate_rad_s);
        R::choose(rate_rad_s.is_zero(), rate_rad_s, moving)
    }

    /// Returns the torque, N m.
    #[inline(always)]
    pub fn torque(&self, rate_rad_s: R, level: R, deflection_rad: R) -> R {
        let damped = self.damping_nm_s_rad * self.derivative(rate_rad_s, deflection_rad);
        let sliding = level * self.coulomb_nm.copysign(deflection_rad) + damped;
        let is_broken = deflection_rad.abs().is_at_least(self.deflection_rad);
        let held = level * self.bond_stiffness_nm_rad() * deflection_rad + self.damping_nm_s_rad * rate_rad_s;
        R::choose(is_broken, sliding, held)
    }

    /// Returns the deflection after a time at constant rate: exact.
    #[inline(always)]
    pub fn advance(&self, rate_rad_s: R, time_s: R, deflection_rad: R) -> R {
        self.project(deflection_rad + rate_rad_s * time_s)
    }

    /// Returns the deflection within its limits; an integrator calls it after each step.
    #[inline(always)]
    pub fn project(&self, deflection_rad: R) -> R {
        let limit = self.deflection_rad;
        let below = R::choose(deflection_rad.is_above(limit), limit, deflection_rad);
        R::choose((-limit).is_above(below), -limit, below)
    }

    /// Returns the stiffness (1 + a) k of the unbroken bond, N m/rad.
    #[inline(always)]
    pub fn bond_stiffness_nm_rad(&self) -> R {
        self.static_ratio * self.coulomb_nm / self.deflection_rad
    }
}

impl ResetIntegrator {
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

    #[inline]
    fn slides(&self, rate_rad_s: f64, deflection_rad: f64) -> bool {
        (rate_rad_s > 0.0 && deflection_rad >= self.deflection_rad)
            || (rate_rad_s < 0.0 && deflection_rad <= -self.deflection_rad)
    }
}
