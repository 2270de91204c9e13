//! Laws without a state: the sliding level by the rate, and true stick at rest.

use super::stribeck::StribeckLevel;

/// T = g(w) sgn w while sliding; at rest any torque up to the breakaway level.
///
/// With a constant g this is Coulomb's law (5-32), with g(0) above g(w) stiction is added (5-34), with one of the
/// curves of [`StribeckLevel`] it is the Tustin, exponential, Gaussian, Lorentzian or polynomial law (5-35, 5-36 with
/// the modulus that the print lacks). With a band of rates that counts as rest it is Karnopp's (D. Karnopp,
/// "Computer simulation of stick-slip friction in mechanical dynamic systems", ASME JDSMC 107, 1985).
///
/// The torque at rest is a matter of the whole mechanism: the simulator asks for the [`Stick`] and applies
/// [`Stick::holding_torque_nm`] to the torque that would otherwise move the joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sliding {
    /// Sliding level by the rate; breakaway is its value at rest.
    pub level: StribeckLevel,
    /// Breakaway over the sliding level's value at rest (above 1 if stiction is not part of the curve).
    pub breakaway_ratio: f64,
    /// Half width of the band of rates that counts as rest, rad/s; 0 if only rest itself does.
    pub rest_rate_rad_s: f64,
}

impl Sliding {
    /// Returns g(w) sgn w, N m; 0 at rest, where [`super::FrictionModel::stick`] holds.
    #[inline]
    pub fn torque(&self, rate_rad_s: f64, level: f64) -> f64 {
        if rate_rad_s == 0.0 { 0.0 } else { level * self.level.at(rate_rad_s) * rate_rad_s.signum() }
    }

    /// Returns the derivative of the sliding torque with the rate, N m s/rad.
    #[inline]
    pub fn slope(&self, rate_rad_s: f64, level: f64) -> f64 {
        level * self.level.slope(rate_rad_s) * rate_rad_s.signum()
    }

    /// Returns the torque that breaks away, N m.
    pub fn breakaway_nm(&self) -> f64 {
        self.breakaway_ratio * self.level.static_nm()
    }
}

/// Torques that a law with true sticking can hold at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stick {
    /// Torque up to which a motion in the positive direction is held, N m (positive).
    pub positive_nm: f64,
    /// Torque up to which a motion in the negative direction is held, N m (positive).
    pub negative_nm: f64,
    /// Half width of the band of rates that counts as rest, rad/s.
    pub rest_rate_rad_s: f64,
}

impl Stick {
    /// Returns the friction torque at rest against the torque that would accelerate the joint: all of it, up to breakaway.
    #[inline]
    pub fn holding_torque_nm(&self, applied_nm: f64) -> f64 {
        applied_nm.clamp(-self.negative_nm, self.positive_nm)
    }

    /// Returns whether the joint stays at rest against a torque.
    #[inline]
    pub fn holds(&self, applied_nm: f64) -> bool {
        -self.negative_nm <= applied_nm && applied_nm <= self.positive_nm
    }
}
