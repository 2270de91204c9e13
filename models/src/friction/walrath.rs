//! Walrath's law: the sign of the rate through a first-order lag.

use super::partials::Partials;
use super::real::Real;

/// T + tau dT/dt = T_c sgn w; the state is the torque T, N m.
///
/// The sign is smoothed, tanh(w / w_0). The lag is one of time, not of displacement: at rest the torque decays, so
/// that a constant load creeps at the rate w_0 atanh(load / T_c). C. Walrath, "Adaptive bearing friction compensation
/// based on recent knowledge of dynamic friction", Automatica 20, 1984; (5-40). Its tuning 1/tau = 1 + 0.37 x RMS
/// acceleration (5-41) holds for that paper's mechanism only, so tau is given here.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Walrath<R = f64> {
    /// Coulomb level T_c, N m.
    pub coulomb_nm: R,
    /// Time constant tau, s.
    pub time_constant_s: R,
    /// Rate w_0 of the smoothed sign, rad/s.
    pub smoothing_rate_rad_s: R,
}

impl<R: Copy> Walrath<R> {
    /// Returns the law in other numbers: each of its numbers as `convert` has it.
    #[inline(always)]
    pub fn map_numbers<T>(&self, convert: impl Fn(R) -> T) -> Walrath<T> {
        Walrath {
            coulomb_nm: convert(self.coulomb_nm),
            time_constant_s: convert(self.time_constant_s),
            smoothing_rate_rad_s: convert(self.smoothing_rate_rad_s),
        }
    }
}

impl<R: Real> Walrath<R> {
    /// Returns T_c tanh(w / w_0), N m: where the torque settles.
    #[inline(always)]
    pub fn steady_torque(&self, rate_rad_s: R, level: R) -> R {
        level * self.coulomb_nm * (rate_rad_s / self.smoothing_rate_rad_s).tanh()
    }

    /// Returns the torque after a time at constant rate: exact.
    #[inline(always)]
    pub fn advance(&self, rate_rad_s: R, time_s: R, level: R, torque_nm: R) -> R {
        let steady = self.steady_torque(rate_rad_s, level);
        steady + (torque_nm - steady) * (-time_s / self.time_constant_s).exp()
    }
}

impl Walrath {
    /// Returns dT/dt, N m/s.
    #[inline]
    pub fn derivative(&self, rate_rad_s: f64, level: f64, torque_nm: f64) -> f64 {
        (self.steady_torque(rate_rad_s, level) - torque_nm) / self.time_constant_s
    }

    /// Returns d steady / d rate, N m s/rad.
    #[inline]
    pub fn slope(&self, rate_rad_s: f64, level: f64) -> f64 {
        let bent = (rate_rad_s / self.smoothing_rate_rad_s).tanh();
        level * self.coulomb_nm * (1.0 - bent * bent) / self.smoothing_rate_rad_s
    }

    /// Returns the partial derivatives of dT/dt and of the torque (the state itself).
    #[inline]
    pub fn partials(&self, rate_rad_s: f64, level: f64) -> Partials {
        Partials {
            state_by_rate: self.slope(rate_rad_s, level) / self.time_constant_s,
            state_by_state: -self.time_constant_s.recip(),
            torque_by_rate: 0.0,
            torque_by_state: 1.0,
        }
    }
}
