//! One law of the toolbox, chosen at run time without a pointer.

use super::bristle::Bristle;
use super::dahl::Dahl;
use super::lugre::Lugre;
use super::partials::Partials;
use super::reset::ResetIntegrator;
use super::sliding::Sliding;
use super::walrath::Walrath;

/// The dry part of friction. `level` scales the law's level (1 at nominal); `states` has [`Law::states`] entries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    /// No dry friction.
    None,
    /// Coulomb, stiction, the Tustin family and Karnopp.
    Sliding(Sliding),
    /// Dahl.
    Dahl(Dahl),
    /// LuGre.
    Lugre(Lugre),
    /// Reset integrator.
    ResetIntegrator(ResetIntegrator),
    /// Walrath.
    Walrath(Walrath),
    /// Bristles.
    Bristle(Bristle),
}

impl Law {
    /// Returns the number of states.
    #[inline]
    pub fn states(&self) -> usize {
        match self {
            Self::None | Self::Sliding(_) => 0,
            Self::Dahl(_) | Self::Lugre(_) | Self::ResetIntegrator(_) | Self::Walrath(_) => 1,
            Self::Bristle(law) => 2 * law.bristles,
        }
    }

    /// Writes the time derivative of the states.
    #[inline]
    pub fn derivative(&self, rate_rad_s: f64, level: f64, states: &[f64], slopes: &mut [f64]) {
        match self {
            Self::None | Self::Sliding(_) => {}
            Self::Dahl(law) => slopes[0] = law.derivative(rate_rad_s, level, states[0]),
            Self::Lugre(law) => slopes[0] = law.derivative(rate_rad_s, level, states[0]),
            Self::ResetIntegrator(law) => slopes[0] = law.derivative(rate_rad_s, states[0]),
            Self::Walrath(law) => slopes[0] = law.derivative(rate_rad_s, level, states[0]),
            Self::Bristle(law) => law.derivative(rate_rad_s, slopes),
        }
    }

    /// Returns the torque, N m.
    #[inline]
    pub fn torque(&self, rate_rad_s: f64, level: f64, states: &[f64]) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Sliding(law) => law.torque(rate_rad_s, level),
            Self::Dahl(_) | Self::Walrath(_) => states[0],
            Self::Lugre(law) => law.torque(rate_rad_s, level, states[0]),
            Self::ResetIntegrator(law) => law.torque(rate_rad_s, level, states[0]),
            Self::Bristle(law) => law.torque(rate_rad_s, level, states),
        }
    }

    /// Returns the states after a time at constant rate: exact for every law.
    #[inline]
    pub fn advance(&self, rate_rad_s: f64, time_s: f64, level: f64, states: &mut [f64]) {
        match self {
            Self::None | Self::Sliding(_) => {}
            Self::Dahl(law) => states[0] = law.advance(rate_rad_s, time_s, level, states[0]),
            Self::Lugre(law) => states[0] = law.advance(rate_rad_s, time_s, level, states[0]),
            Self::ResetIntegrator(law) => states[0] = law.advance(rate_rad_s, time_s, states[0]),
            Self::Walrath(law) => states[0] = law.advance(rate_rad_s, time_s, level, states[0]),
            Self::Bristle(law) => law.displace(rate_rad_s * time_s, states),
        }
    }

    /// Puts states that a step of an integrator left outside their limits back onto them.
    #[inline]
    pub fn project(&self, states: &mut [f64]) {
        match self {
            Self::ResetIntegrator(law) => states[0] = law.project(states[0]),
            Self::Bristle(law) => law.project(states),
            _ => {}
        }
    }

    /// Returns the torque after a long time at constant rate, N m; 0 at rest.
    pub fn steady_torque(&self, rate_rad_s: f64, level: f64) -> f64 {
        let sliding = |nm: f64| if rate_rad_s == 0.0 { 0.0 } else { level * nm * rate_rad_s.signum() };
        match self {
            Self::None => 0.0,
            Self::Sliding(law) => law.torque(rate_rad_s, level),
            Self::Dahl(law) => sliding(law.level.at(rate_rad_s)),
            Self::Lugre(law) => sliding(law.level.at(rate_rad_s)),
            Self::Bristle(law) => sliding(law.level.at(rate_rad_s)),
            Self::ResetIntegrator(law) => sliding(law.coulomb_nm),
            Self::Walrath(law) => law.steady_torque(rate_rad_s, level),
        }
    }

    /// Returns the derivative of the steady torque with the rate, N m s/rad, away from rest.
    pub fn steady_slope(&self, rate_rad_s: f64, level: f64) -> f64 {
        let sign = rate_rad_s.signum();
        match self {
            Self::None | Self::ResetIntegrator(_) => 0.0,
            Self::Sliding(law) => law.slope(rate_rad_s, level),
            Self::Dahl(law) => level * law.level.slope(rate_rad_s) * sign,
            Self::Lugre(law) => level * law.level.slope(rate_rad_s) * sign,
            Self::Bristle(law) => level * law.level.slope(rate_rad_s) * sign,
            Self::Walrath(law) => law.slope(rate_rad_s, level),
        }
    }

    /// Returns the partial derivatives of a law with exactly one state; `None` for the others.
    #[inline]
    pub fn partials(&self, rate_rad_s: f64, level: f64, states: &[f64]) -> Option<Partials> {
        match self {
            Self::Dahl(law) => Some(law.partials(rate_rad_s, level, states[0])),
            Self::Lugre(law) => Some(law.partials(rate_rad_s, level, states[0])),
            Self::ResetIntegrator(law) => Some(law.partials(rate_rad_s, level, states[0])),
            Self::Walrath(law) => Some(law.partials(rate_rad_s, level)),
            Self::None | Self::Sliding(_) | Self::Bristle(_) => None,
        }
    }

    /// Returns the stiffness at rest from zero torque, N m/rad: infinite for a law that truly sticks, 0 for one that creeps.
    pub fn rest_stiffness_nm_rad(&self) -> f64 {
        match self {
            Self::None | Self::Walrath(_) => 0.0,
            Self::Sliding(_) => f64::INFINITY,
            Self::Dahl(law) => law.rest_stiffness_nm_rad,
            Self::Lugre(law) => law.stiffness_nm_rad,
            Self::ResetIntegrator(law) => law.bond_stiffness_nm_rad(),
            Self::Bristle(law) => law.bristles as f64 * law.stiffness_nm_rad(0.0),
        }
    }

    /// Returns the damping at rest from zero torque, N m s/rad.
    pub fn rest_damping_nm_s_rad(&self) -> f64 {
        match self {
            Self::Lugre(law) => law.damping_nm_s_rad,
            Self::ResetIntegrator(law) => law.damping_nm_s_rad,
            _ => 0.0,
        }
    }
}
