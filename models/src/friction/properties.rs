//! The common properties of the laws: the Coulomb level, the presliding stiffness, and the state that carries a torque at rest.
//!
//! Other crates read and write these quantities here only, so that each is defined once and for every law.

use super::bristle::MEAN_DEFLECTION;
use crate::parameters::{Friction, FrictionLaw, Ripple, StribeckCurve};

/// The factors between two dynamically similar machines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Similarity {
    /// Factor on torques.
    pub torque: f64,
    /// Factor on angles and rates; times stay.
    pub angle: f64,
}

impl FrictionLaw {
    /// Returns the Coulomb level, N m: the sliding torque at speed. It is 0 if there is no dry friction.
    pub fn coulomb_nm(&self) -> f64 {
        match *self {
            Self::None => 0.0,
            Self::Dahl { coulomb_nm, .. }
            | Self::Lugre { coulomb_nm, .. }
            | Self::Coulomb { coulomb_nm }
            | Self::ResetIntegrator { coulomb_nm, .. }
            | Self::Stribeck { coulomb_nm, .. }
            | Self::Karnopp { coulomb_nm, .. }
            | Self::Walrath { coulomb_nm, .. }
            | Self::Bristle { coulomb_nm, .. } => coulomb_nm,
        }
    }

    /// Sets the Coulomb level, N m. The other parameters of the law stay, and so does the ratio of breakaway to sliding
    /// level: the rest stiffness of the Dahl and LuGre laws is unchanged, that of a reset integrator or of bristles changes
    /// with the level, because their deflection is unchanged. A law without dry friction stays without.
    pub fn set_coulomb_nm(&mut self, level_nm: f64) {
        if let Some(coulomb_nm) = self.coulomb_mut() {
            *coulomb_nm = level_nm;
        }
    }

    /// Sets the Coulomb level, N m, as [`FrictionLaw::set_coulomb_nm`] does; a law without dry friction becomes Coulomb's if
    /// the level is positive.
    pub fn set_or_add_coulomb_nm(&mut self, level_nm: f64) {
        if *self == Self::None && level_nm > 0.0 {
            *self = Self::Coulomb { coulomb_nm: level_nm };
        }
        self.set_coulomb_nm(level_nm);
    }

    /// Multiplies the Coulomb level by a factor, as [`FrictionLaw::set_coulomb_nm`] does; a factor of 0 removes dry friction.
    pub fn scale_coulomb(&mut self, factor: f64) {
        if factor == 0.0 {
            *self = Self::None;
        }
        if let Some(coulomb_nm) = self.coulomb_mut() {
            *coulomb_nm *= factor;
        }
    }

    /// Sets the Coulomb level, N m, so that the law breaks away at the same deflection as before: the stiffness and damping
    /// of its bonds change with the level. A level of 0 removes dry friction.
    pub fn set_coulomb_at_same_deflection_nm(&mut self, level_nm: f64) {
        if level_nm == 0.0 {
            *self = Self::None;
        }
        *self = self.scale_similarly(Similarity { torque: level_nm / self.coulomb_nm(), angle: 1.0 });
        self.set_coulomb_nm(level_nm);
    }

    fn coulomb_mut(&mut self) -> Option<&mut f64> {
        match self {
            Self::None => None,
            Self::Dahl { coulomb_nm, .. }
            | Self::Lugre { coulomb_nm, .. }
            | Self::Coulomb { coulomb_nm }
            | Self::ResetIntegrator { coulomb_nm, .. }
            | Self::Stribeck { coulomb_nm, .. }
            | Self::Karnopp { coulomb_nm, .. }
            | Self::Walrath { coulomb_nm, .. }
            | Self::Bristle { coulomb_nm, .. } => Some(coulomb_nm),
        }
    }

    /// Returns whether a joint with this law truly sticks: at rest it does not move at all until it breaks away.
    pub fn has_true_stick(&self) -> bool {
        matches!(self, Self::Coulomb { .. } | Self::Karnopp { .. } | Self::Stribeck { .. })
    }

    /// Returns the deflection over which the torque builds up after a reversal, rad: Coulomb level over stiffness for the
    /// Dahl and LuGre laws, the limit of the bond for the reset integrator and for bristles, 0 for laws without presliding.
    pub fn presliding_deflection_rad(&self) -> f64 {
        match *self {
            Self::Dahl { coulomb_nm, rest_stiffness_nm_rad: stiffness, .. }
            | Self::Lugre { coulomb_nm, bristle_stiffness_nm_rad: stiffness, .. } => coulomb_nm / stiffness,
            Self::ResetIntegrator { deflection_rad: limit, .. } | Self::Bristle { bond_rad: limit, .. } => {
                limit
            }
            Self::None
            | Self::Coulomb { .. }
            | Self::Stribeck { .. }
            | Self::Karnopp { .. }
            | Self::Walrath { .. } => 0.0,
        }
    }

    /// Returns the law of a dynamically similar machine, whose torques, and angles and rates, are multiplied by the factors.
    pub fn scale_similarly(&self, by: Similarity) -> Self {
        let (torque, angle) = (by.torque, by.angle);
        let mut law = self.clone();
        match &mut law {
            Self::None => {}
            Self::Dahl { coulomb_nm, rest_stiffness_nm_rad, .. } => {
                *coulomb_nm *= torque;
                *rest_stiffness_nm_rad *= torque / angle;
            }
            Self::Lugre { coulomb_nm, bristle_stiffness_nm_rad, bristle_damping_nm_s_rad } => {
                *coulomb_nm *= torque;
                *bristle_stiffness_nm_rad *= torque / angle;
                *bristle_damping_nm_s_rad *= torque / angle;
            }
            Self::Coulomb { coulomb_nm } | Self::Stribeck { coulomb_nm, .. } => *coulomb_nm *= torque,
            Self::ResetIntegrator { coulomb_nm, deflection_rad, damping_nm_s_rad } => {
                *coulomb_nm *= torque;
                *deflection_rad *= angle;
                *damping_nm_s_rad *= torque / angle;
            }
            Self::Karnopp { coulomb_nm, stick_rate_rad_s: size }
            | Self::Walrath { coulomb_nm, smoothing_rate_rad_s: size, .. }
            | Self::Bristle { coulomb_nm, bond_rad: size, .. } => {
                *coulomb_nm *= torque;
                *size *= angle;
            }
        }
        law
    }
}

impl Friction {
    /// Returns the Coulomb level of the law, N m: see [`FrictionLaw::coulomb_nm`].
    pub fn coulomb_nm(&self) -> f64 {
        self.law.coulomb_nm()
    }

    /// Sets the ratio of the level at rest to the Coulomb level. A law of Coulomb or Karnopp, whose level does not depend on the rate, becomes
    /// one whose level falls with the rate by exp(-(w / `stribeck_rate_rad_s`)^2); with a ratio of 1 it moves as before.
    pub fn set_static_ratio(&mut self, ratio: f64) {
        self.static_ratio = ratio;
        if let FrictionLaw::Coulomb { coulomb_nm } | FrictionLaw::Karnopp { coulomb_nm, .. } = self.law {
            self.law = FrictionLaw::Stribeck { coulomb_nm, curve: StribeckCurve::Gaussian };
        }
    }

    /// Returns the largest dry torque at rest, N m, without ripple, load or warm-up.
    pub fn breakaway_nm(&self) -> f64 {
        self.coulomb_nm() * self.static_ratio.max(1.0)
    }

    /// Returns the presliding stiffness from zero torque, N m/rad; `None` if the law has none, because it truly sticks, creeps
    /// or is absent. [`super::FrictionModel::rest_stiffness_nm_rad`] gives the limits of those laws.
    pub fn presliding_stiffness_nm_rad(&self) -> Option<f64> {
        match self.law {
            FrictionLaw::Dahl { rest_stiffness_nm_rad, .. } => Some(rest_stiffness_nm_rad),
            FrictionLaw::Lugre { bristle_stiffness_nm_rad, .. } => Some(bristle_stiffness_nm_rad),
            FrictionLaw::ResetIntegrator { coulomb_nm, deflection_rad, .. } => {
                Some(self.static_ratio * coulomb_nm / deflection_rad)
            }
            FrictionLaw::Bristle { coulomb_nm, bond_rad, .. } => {
                Some(self.static_ratio * coulomb_nm / (MEAN_DEFLECTION * bond_rad))
            }
            _ => None,
        }
    }

    /// Sets the presliding stiffness, N m/rad. A reset integrator and bristles take the deflection that gives it at their
    /// present level. A law that has no presliding stiffness stays as it is.
    pub fn set_presliding_stiffness_nm_rad(&mut self, stiffness_nm_rad: f64) {
        let static_ratio = self.static_ratio;
        match &mut self.law {
            FrictionLaw::Dahl { rest_stiffness_nm_rad, .. } => *rest_stiffness_nm_rad = stiffness_nm_rad,
            FrictionLaw::Lugre { bristle_stiffness_nm_rad, .. } => {
                *bristle_stiffness_nm_rad = stiffness_nm_rad;
            }
            FrictionLaw::ResetIntegrator { coulomb_nm, deflection_rad, .. } => {
                *deflection_rad = static_ratio * *coulomb_nm / stiffness_nm_rad;
            }
            FrictionLaw::Bristle { coulomb_nm, bond_rad, .. } => {
                *bond_rad = static_ratio * *coulomb_nm / (MEAN_DEFLECTION * stiffness_nm_rad);
            }
            _ => {}
        }
    }

    /// Multiplies the presliding stiffness by a factor, as [`Friction::set_presliding_stiffness_nm_rad`] does.
    pub fn scale_presliding_stiffness(&mut self, factor: f64) {
        if let Some(stiffness) = self.presliding_stiffness_nm_rad() {
            self.set_presliding_stiffness_nm_rad(factor * stiffness);
        }
    }

    /// Returns the state of a law with one state that carries a torque (N m) at rest: a torque for the Dahl and Walrath laws,
    /// a deflection in rad for LuGre and the reset integrator. It is 0 for the others: what truly sticks carries whatever it
    /// must without a state, and bristles start unbent.
    pub fn state_at_torque(&self, torque_nm: f64) -> f64 {
        match self.law {
            FrictionLaw::Lugre { bristle_stiffness_nm_rad, .. } => torque_nm / bristle_stiffness_nm_rad,
            FrictionLaw::ResetIntegrator { coulomb_nm, deflection_rad, .. } if coulomb_nm > 0.0 => {
                torque_nm * deflection_rad / (self.static_ratio * coulomb_nm)
            }
            FrictionLaw::Dahl { .. } | FrictionLaw::Walrath { .. } => torque_nm,
            _ => 0.0,
        }
    }

    /// Returns the torque at rest, N m, that a state of the law carries: the inverse of [`Friction::state_at_torque`].
    pub fn torque_at_state_nm(&self, state: f64) -> f64 {
        match self.law {
            FrictionLaw::Lugre { bristle_stiffness_nm_rad, .. } => state * bristle_stiffness_nm_rad,
            FrictionLaw::ResetIntegrator { coulomb_nm, deflection_rad, .. } if deflection_rad > 0.0 => {
                state * self.static_ratio * coulomb_nm / deflection_rad
            }
            FrictionLaw::Dahl { .. } | FrictionLaw::Walrath { .. } => state,
            _ => 0.0,
        }
    }

    /// Returns the friction of a dynamically similar machine, whose torques, and angles and rates, are multiplied by the
    /// factors.
    pub fn scale_similarly(&self, by: Similarity) -> Self {
        let (torque, angle) = (by.torque, by.angle);
        let ripple = &self.position_ripple;
        Self {
            law: self.law.scale_similarly(by),
            viscous_nm_s_rad: self.viscous_nm_s_rad * torque / angle,
            stribeck_rate_rad_s: self.stribeck_rate_rad_s * angle,
            quadratic_nm_s2_rad2: self.quadratic_nm_s2_rad2 * torque / (angle * angle),
            position_ripple: Ripple { order: ripple.order / angle, ..*ripple },
            ..self.clone()
        }
    }
}
