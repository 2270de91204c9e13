//! The dry part of friction in the laws that have at most one state and never truly stick, in any numbers.

use super::dahl::Dahl;
use super::law::Law;
use super::lugre::Lugre;
use super::model::FrictionModel;
use super::real::Real;
use super::reset::ResetIntegrator;
use super::walrath::Walrath;

/// A law that is continuous in its rate and its state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SmoothLaw<R = f64> {
    /// No dry friction.
    None,
    /// Dahl.
    Dahl(Dahl<R>),
    /// LuGre.
    Lugre(Lugre<R>),
    /// Reset integrator.
    ResetIntegrator(ResetIntegrator<R>),
    /// Walrath.
    Walrath(Walrath<R>),
}

/// The dry part of friction at its nominal level: a smooth law, and its asymmetry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DryFriction<R = f64> {
    law: SmoothLaw<R>,
    asymmetry: R,
}

impl<const N: usize> DryFriction<[f64; N]> {
    /// Returns the friction of several mechanisms side by side; `None` if their laws are of different kinds or not smooth, or if their
    /// level depends on more than the rate.
    pub fn join(models: [&FrictionModel; N]) -> Option<Self> {
        if models.iter().any(|model| model.is_modulated()) {
            return None;
        }
        let laws = models.map(FrictionModel::law);
        let law = match laws.first()? {
            Law::None => laws.iter().all(|law| **law == Law::None).then_some(SmoothLaw::None),
            Law::Dahl(_) => {
                find_in_each(laws, |law| if let Law::Dahl(law) = law { Some(*law) } else { None })
                    .and_then(joined_dahl)
                    .map(SmoothLaw::Dahl)
            }
            Law::Lugre(_) => {
                find_in_each(laws, |law| if let Law::Lugre(law) = law { Some(*law) } else { None })
                    .and_then(joined_lugre)
                    .map(SmoothLaw::Lugre)
            }
            Law::ResetIntegrator(_) => {
                find_in_each(laws, |law| if let Law::ResetIntegrator(law) = law { Some(*law) } else { None })
                    .map(joined_reset)
                    .map(SmoothLaw::ResetIntegrator)
            }
            Law::Walrath(_) => {
                find_in_each(laws, |law| if let Law::Walrath(law) = law { Some(*law) } else { None })
                    .map(joined_walrath)
                    .map(SmoothLaw::Walrath)
            }
            Law::Sliding(_) | Law::Bristle(_) => None,
        }?;
        Some(Self { law, asymmetry: models.map(FrictionModel::asymmetry) })
    }
}

/// Returns what a function finds in each of several laws; `None` if it finds nothing in one of them.
fn find_in_each<T: Copy, const N: usize>(
    laws: [&Law; N],
    find: impl Fn(&Law) -> Option<T>,
) -> Option<[T; N]> {
    let first = find(laws.first()?)?;
    let mut all = [first; N];
    for (place, law) in all.iter_mut().zip(laws) {
        *place = find(law)?;
    }
    Some(all)
}

fn joined_dahl<const N: usize>(laws: [Dahl; N]) -> Option<Dahl<[f64; N]>> {
    let exponent = laws.first()?.exponent;
    if laws.iter().any(|law| law.exponent != exponent) {
        return None;
    }
    let level = super::stribeck::join_levels(laws.map(|law| law.level))?;
    Some(Dahl { level, rest_stiffness_nm_rad: laws.map(|law| law.rest_stiffness_nm_rad), exponent })
}

fn joined_lugre<const N: usize>(laws: [Lugre; N]) -> Option<Lugre<[f64; N]>> {
    Some(Lugre {
        level: super::stribeck::join_levels(laws.map(|law| law.level))?,
        stiffness_nm_rad: laws.map(|law| law.stiffness_nm_rad),
        damping_nm_s_rad: laws.map(|law| law.damping_nm_s_rad),
    })
}

fn joined_reset<const N: usize>(laws: [ResetIntegrator; N]) -> ResetIntegrator<[f64; N]> {
    ResetIntegrator {
        coulomb_nm: laws.map(|law| law.coulomb_nm),
        static_ratio: laws.map(|law| law.static_ratio),
        deflection_rad: laws.map(|law| law.deflection_rad),
        damping_nm_s_rad: laws.map(|law| law.damping_nm_s_rad),
    }
}

fn joined_walrath<const N: usize>(laws: [Walrath; N]) -> Walrath<[f64; N]> {
    Walrath {
        coulomb_nm: laws.map(|law| law.coulomb_nm),
        time_constant_s: laws.map(|law| law.time_constant_s),
        smoothing_rate_rad_s: laws.map(|law| law.smoothing_rate_rad_s),
    }
}

impl<R: Copy> DryFriction<R> {
    /// Returns whether there is no dry friction.
    pub fn is_none(&self) -> bool {
        matches!(self.law, SmoothLaw::None)
    }

    /// Returns the friction in other numbers: each of its numbers as `convert` has it.
    #[inline(always)]
    pub fn map_numbers<T>(&self, convert: impl Fn(R) -> T + Copy) -> DryFriction<T> {
        let law = match &self.law {
            SmoothLaw::None => SmoothLaw::None,
            SmoothLaw::Dahl(law) => SmoothLaw::Dahl(law.map_numbers(convert)),
            SmoothLaw::Lugre(law) => SmoothLaw::Lugre(law.map_numbers(convert)),
            SmoothLaw::ResetIntegrator(law) => SmoothLaw::ResetIntegrator(law.map_numbers(convert)),
            SmoothLaw::Walrath(law) => SmoothLaw::Walrath(law.map_numbers(convert)),
        };
        DryFriction { law, asymmetry: convert(self.asymmetry) }
    }
}

impl<R: Real> DryFriction<R> {
    /// Returns the torque, N m, as [`FrictionModel::dry_torque`] does.
    #[inline(always)]
    pub fn torque(&self, rate_rad_s: R, state: R) -> R {
        let level = self.direction_factor(rate_rad_s);
        match &self.law {
            SmoothLaw::None => state.constant(0.0),
            SmoothLaw::Dahl(_) | SmoothLaw::Walrath(_) => state,
            SmoothLaw::Lugre(law) => law.torque(rate_rad_s, level, state),
            SmoothLaw::ResetIntegrator(law) => law.torque(rate_rad_s, level, state),
        }
    }

    /// Returns the state after a time at constant rate, as [`FrictionModel::advance`] does.
    #[inline(always)]
    pub fn advance(&self, rate_rad_s: R, time_s: R, state: R) -> R {
        let level = self.direction_factor(rate_rad_s);
        match &self.law {
            SmoothLaw::None => state,
            SmoothLaw::Dahl(law) => law.advance(rate_rad_s, time_s, level, state),
            SmoothLaw::Lugre(law) => law.advance(rate_rad_s, time_s, level, state),
            SmoothLaw::ResetIntegrator(law) => law.advance(rate_rad_s, time_s, state),
            SmoothLaw::Walrath(law) => law.advance(rate_rad_s, time_s, level, state),
        }
    }

    #[inline(always)]
    fn direction_factor(&self, rate_rad_s: R) -> R {
        rate_rad_s.constant(1.0) + self.asymmetry * rate_rad_s.signum()
    }
}
