//! The dry level of a friction in the state of the moment, and Dahl's law in displacement.

use crate::parameters::{Friction, FrictionLaw};

/// What the dry level depends on.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Conditions {
    /// Relative rate, rad/s.
    pub rate_rad_s: f64,
    /// Relative angle, rad.
    pub angle_rad: f64,
    /// Load carried, N m.
    pub load_nm: f64,
    /// Time since the start, s.
    pub time_s: f64,
}

impl Friction {
    /// Whether the dry level is the Coulomb level whatever the conditions are.
    pub fn has_constant_level(&self) -> bool {
        self.static_ratio == 1.0
            && self.asymmetry == 0.0
            && self.position_ripple.amplitude == 0.0
            && self.load_coefficient == 0.0
            && self.warm_up == 0.0
    }

    /// The dry level
    ///
    /// ```text
    ///     g = F_c (1 + (r - 1) exp(-(w / v_s)^2)) (1 + a sgn w) (1 + ripple(x)) (1 + c (exp(-t / tau) - 1)) + k |load|
    /// ```
    ///
    /// in N m: Stribeck ratio r, asymmetry a, ripple over the angle x, warm-up c, load coefficient k.
    pub fn level_nm(&self, at: &Conditions) -> f64 {
        let mut level = self.coulomb_nm();
        if self.static_ratio != 1.0 {
            let relative = at.rate_rad_s / self.stribeck_rate_rad_s;
            level *= 1.0 + (self.static_ratio - 1.0) * (-relative * relative).exp();
        }
        if self.asymmetry != 0.0 && at.rate_rad_s != 0.0 {
            level *= 1.0 + self.asymmetry * at.rate_rad_s.signum();
        }
        level *= 1.0 + self.position_ripple.at(at.angle_rad);
        if self.warm_up != 0.0 {
            level *= 1.0 + self.warm_up * ((-at.time_s / self.warm_up_time_s).exp() - 1.0);
        }
        level + self.load_coefficient * at.load_nm.abs()
    }

    /// Torque that opposes the rate beside the dry one and the linear viscous one: quadratic drag, N m.
    pub fn drag_nm(&self, rate_rad_s: f64) -> f64 {
        self.quadratic_nm_s2_rad2 * rate_rad_s * rate_rad_s.abs()
    }

    /// Stiffness of the law at rest, N m/rad; infinite for a law that sticks truly, 0 without dry friction.
    pub fn rest_stiffness_nm_rad(&self) -> f64 {
        match self.law {
            FrictionLaw::None | FrictionLaw::Walrath { .. } => 0.0,
            FrictionLaw::Dahl { rest_stiffness_nm_rad, .. } => rest_stiffness_nm_rad,
            FrictionLaw::Lugre { bristle_stiffness_nm_rad, .. } => bristle_stiffness_nm_rad,
            FrictionLaw::ResetIntegrator { coulomb_nm, deflection_rad, .. } => {
                self.static_ratio * coulomb_nm / deflection_rad
            }
            FrictionLaw::Bristle { coulomb_nm, bond_rad, .. } => coulomb_nm / bond_rad,
            FrictionLaw::Coulomb { .. } | FrictionLaw::Stribeck { .. } | FrictionLaw::Karnopp { .. } => {
                f64::INFINITY
            }
        }
    }
}

/// Dahl's law over a displacement in one direction, at a constant level: exact for any size of the displacement.
///
/// ```text
///     dF/dx = sigma (1 - s F / g)^i,  s = sgn dx
///     i = 1:  F1 = s g + (F0 - s g) exp(-sigma |dx| / g)
///     else:   r1 = (r0^(1-i) + (i - 1) sigma |dx| / g)^(1 / (1-i)),  r = 1 - s F / g
/// ```
///
/// A level of zero leaves no torque.
pub fn dahl_advance(
    torque_nm: f64,
    level_nm: f64,
    stiffness_nm_rad: f64,
    exponent: f64,
    displacement_rad: f64,
) -> f64 {
    if displacement_rad == 0.0 || level_nm <= 0.0 {
        return if level_nm <= 0.0 { 0.0 } else { torque_nm };
    }
    let end = level_nm * displacement_rad.signum();
    let travel = stiffness_nm_rad * displacement_rad.abs() / level_nm;
    let rest = 1.0 - torque_nm / end;
    if exponent == 1.0 || rest <= 0.0 {
        return end + (torque_nm - end) * (-travel).exp();
    }
    let power = 1.0 - exponent;
    let base = rest.powf(power) - power * travel;
    let after = if base > 0.0 { base.powf(1.0 / power) } else { 0.0 };
    end * (1.0 - after)
}
