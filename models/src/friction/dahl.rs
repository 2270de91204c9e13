//! Dahl's law: a hysteretic spring that yields at the Coulomb level.

use super::partials::Partials;
use super::real::Real;
use super::stribeck::StribeckLevel;
use crate::tolerance::YIELDED;

/// dF/dt = sigma w |r|^i sgn r, r = 1 - (F / g(w)) sgn w; the state is the torque F, N m.
///
/// sgn r is the stabilising factor S_d of (5-39): a torque above the level falls back to it instead of growing.
/// With a constant g the loop depends on the displacement alone. P. Dahl, "Solid friction damping of mechanical
/// vibrations", AIAA Journal 14, 1976; the Stribeck level g(w) in place of F_c is an extension in use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dahl<R = f64> {
    /// Level by the rate; constant in Dahl's papers.
    pub level: StribeckLevel<R>,
    /// Rest stiffness sigma, N m/rad.
    pub rest_stiffness_nm_rad: R,
    /// Exponent i; 1 is usual, 2 is (5-38).
    pub exponent: f64,
}

impl Dahl {
    /// Returns dF/dt, N m/s.
    #[inline]
    pub fn derivative(&self, rate_rad_s: f64, level: f64, torque_nm: f64) -> f64 {
        let r = self.distance(rate_rad_s, level, torque_nm);
        self.rest_stiffness_nm_rad * rate_rad_s * self.power(r)
    }

    /// Returns the torque after a displacement with the level of rest: the rate-independent form of [`Dahl::advance`].
    pub fn torque_after(&self, displacement_rad: f64, level: f64, torque_nm: f64) -> f64 {
        let constant = Self { level: self.level.level_at_rest(), ..*self };
        constant.advance(displacement_rad, 1.0, level, torque_nm)
    }

    /// Returns the partial derivatives of dF/dt and of the torque (the state itself).
    #[inline]
    pub fn partials(&self, rate_rad_s: f64, level: f64, torque_nm: f64) -> Partials {
        let r = self.distance(rate_rad_s, level, torque_nm);
        let sign = rate_rad_s.signum();
        let g = level * self.level.at(rate_rad_s);
        let steep = self.rest_stiffness_nm_rad * rate_rad_s * self.power_slope(r);
        let r_by_rate = torque_nm * sign * level * self.level.slope(rate_rad_s) / (g * g);
        Partials {
            state_by_rate: self.rest_stiffness_nm_rad * self.power(r) + steep * r_by_rate,
            state_by_state: -steep * sign / g,
            torque_by_rate: 0.0,
            torque_by_state: 1.0,
        }
    }

    #[inline]
    fn distance(&self, rate_rad_s: f64, level: f64, torque_nm: f64) -> f64 {
        1.0 - torque_nm * rate_rad_s.signum() / (level * self.level.at(rate_rad_s))
    }

    #[inline]
    fn power(&self, r: f64) -> f64 {
        if self.exponent == 1.0 { r } else { r.abs().powf(self.exponent) * r.signum() }
    }

    #[inline]
    fn power_slope(&self, r: f64) -> f64 {
        if self.exponent == 1.0 {
            1.0
        } else {
            self.exponent * r.abs().max(YIELDED).powf(self.exponent - 1.0)
        }
    }
}

impl<R: Copy> Dahl<R> {
    /// Returns the law in other numbers: each of its numbers as `convert` has it.
    #[inline(always)]
    pub fn map_numbers<T>(&self, convert: impl Fn(R) -> T) -> Dahl<T> {
        Dahl {
            level: self.level.map_numbers(&convert),
            rest_stiffness_nm_rad: convert(self.rest_stiffness_nm_rad),
            exponent: self.exponent,
        }
    }
}

impl<R: Real> Dahl<R> {
    /// Returns the torque after a time at constant rate: exact.
    ///
    /// With s = sigma |w| h / g: r exp(-s) for i = 1, and |r|^(1-i) falls by (1 - i) s otherwise (not below 0).
    #[inline(always)]
    pub fn advance(&self, rate_rad_s: R, time_s: R, level: R, torque_nm: R) -> R {
        let one = torque_nm.constant(1.0);
        let g = level * self.level.at(rate_rad_s);
        let sign = rate_rad_s.signum();
        let r = one - torque_nm / g * sign;
        let s = self.rest_stiffness_nm_rad * rate_rad_s.abs() * time_s / g;
        let moved = g * sign * (one - yielding_solution(r, s, self.exponent));
        R::choose(rate_rad_s.is_zero(), torque_nm, moved)
    }
}

/// Returns the solution of dr/ds = -|r|^i sgn r.
#[inline(always)]
fn yielding_solution<R: Real>(r: R, s: R, exponent: f64) -> R {
    if exponent == 1.0 {
        return r * (-s).exp();
    }
    let left = (r.abs().powf(1.0 - exponent) - r.constant(1.0 - exponent) * s).max(r.constant(0.0));
    left.powf((1.0 - exponent).recip()) * r.signum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::StribeckCurve;

    fn dahl(exponent: f64) -> Dahl {
        let level = StribeckLevel::new(2.0, 1.0, 1.0, StribeckCurve::Gaussian);
        Dahl { level, rest_stiffness_nm_rad: 1e3, exponent }
    }

    #[test]
    fn first_loading_follows_the_exponential() {
        let law = dahl(1.0);
        let from = -0.7;
        let expected = 2.0 - (2.0 - from) * (-1e3 * 1.5e-3 / 2.0_f64).exp();
        assert!((law.torque_after(1.5e-3, 1.0, from) - expected).abs() < 1e-14);
    }

    #[test]
    fn the_advance_solves_the_derivative() {
        for exponent in [0.5, 1.0, 1.5, 2.0] {
            let law = dahl(exponent);
            let (rate, start, steps, end) = (-0.3, 1.2, 200_000, 6e-3);
            let mut torque = start;
            let h = end / steps as f64;
            for _ in 0..steps {
                let middle = torque + 0.5 * h * law.derivative(rate, 1.0, torque);
                torque += h * law.derivative(rate, 1.0, middle);
            }
            assert!((law.advance(rate, end, 1.0, start) - torque).abs() < 1e-8, "{exponent}");
        }
    }

    #[test]
    fn a_torque_above_the_level_falls_back_to_it() {
        for exponent in [0.5, 1.0, 1.5, 2.0] {
            let law = dahl(exponent);
            let fallen = law.advance(1.0, 1.0, 1.0, 3.0);
            assert!((2.0..2.1).contains(&fallen), "{exponent}: {fallen}");
        }
    }
}
