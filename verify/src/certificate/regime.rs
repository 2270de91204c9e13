//! The linear loop in each regime of friction, gear teeth and estimator.

use counterpoise_lti::{StateSpace, candidate_margins};
use counterpoise_models::friction::FrictionModel;

use super::CertifiedCase;
use super::elements::{ElementLoop, Elements, Learning};
use super::floor::Subject;
use crate::Error;
use crate::tolerance::{GRID_LOWEST_HZ, GRID_POINTS, LARGEST_SENSITIVITY, OPEN};

/// A regime in which the loop is linear.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Regime {
    /// At rest: friction is the spring of its presliding stiffness, and so is each friction observer.
    Presliding,
    /// The hub turns at the rate of the step: friction has its sliding level.
    Sliding,
    /// As [`Regime::Presliding`], while the estimator learns.
    PreslidingLearning,
    /// As [`Regime::Sliding`], while the estimator learns.
    SlidingLearning,
    /// There is no dry friction, in the mechanism or in the controller: at rest and in motion the loop is the same.
    Frictionless,
    /// As [`Regime::Frictionless`], while the estimator learns.
    FrictionlessLearning,
    /// The gear teeth do not touch, and friction is at rest: no control reaches the hub.
    TeethOpen,
}

/// Rule for the parting of the gear teeth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Teeth {
    /// There is no gap.
    WithoutGap,
    /// There is a gap, and the weight presses the teeth together with more than friction can take over.
    Pressed,
    /// There is a gap, and friction can hold what presses the teeth together.
    CanOpen,
}

/// The loop in a regime.
#[derive(Debug, Clone, PartialEq)]
pub struct RegimeLoop {
    /// Regime.
    pub regime: Regime,
    /// Largest modulus of a pole of the closed loop; below 1 the loop is stable. Poles of constants that nothing changes are left
    /// out, such as the offset between the state of an observer and the friction itself.
    pub pole_radius: f64,
    /// Rate at which that motion grows, 1/s; below 0 it fades.
    pub growth_per_s: f64,
    /// Frequency of that pole, Hz; 0 if it does not oscillate.
    pub frequency_hz: f64,
    /// Factor on the loop's gain, in dB and nearest to 0 dB, at which the loop broken at the plant's input passes through -1; infinite if
    /// there is none, 0 in an unstable loop.
    pub gain_margin_db: f64,
    /// Largest magnitude of the sensitivity; infinite in an unstable loop.
    pub max_sensitivity: f64,
    /// The sampled loop broken at the plant's input: 1 + L is the return difference.
    pub broken: StateSpace,
}

impl RegimeLoop {
    /// Returns the time in which the motion grows by a factor of e, s.
    pub fn growth_time_s(&self) -> f64 {
        1.0 / self.growth_per_s
    }
}

impl Regime {
    /// Returns the key of the regime in results.
    pub fn key(self) -> &'static str {
        match self {
            Regime::Presliding => "presliding",
            Regime::Sliding => "sliding",
            Regime::PreslidingLearning => "presliding_learning",
            Regime::SlidingLearning => "sliding_learning",
            Regime::Frictionless => "frictionless",
            Regime::FrictionlessLearning => "frictionless_learning",
            Regime::TeethOpen => "teeth_open",
        }
    }

    /// Returns the regime while the estimator learns.
    fn learning(self) -> Self {
        match self {
            Regime::Presliding => Regime::PreslidingLearning,
            Regime::Sliding => Regime::SlidingLearning,
            Regime::Frictionless => Regime::FrictionlessLearning,
            other => other,
        }
    }

    /// Returns whether the loop must be stable in this regime: not with open teeth, where there is no loop.
    pub fn is_judged(self) -> bool {
        self != Regime::TeethOpen
    }
}

impl RegimeLoop {
    /// Returns whether friction is at rest in this regime: a limit cycle, not a growth without bound, follows if it is unstable.
    pub fn is_at_rest(&self) -> bool {
        matches!(self.regime, Regime::Presliding | Regime::PreslidingLearning | Regime::TeethOpen)
    }

    /// Returns a number that orders regimes from far inside stability to far beyond: the largest sensitivity while stable, and more
    /// than any sensitivity beyond.
    pub fn severity(&self) -> f64 {
        if self.pole_radius < 1.0 {
            self.max_sensitivity.min(LARGEST_SENSITIVITY)
        } else {
            LARGEST_SENSITIVITY * (2.0 + self.growth_per_s)
        }
    }
}

/// Returns whether the gear teeth of a case can part at rest.
///
/// # Errors
/// Friction parameters out of range.
pub fn teeth_can_part(
    case: &CertifiedCase,
    subject_point: &counterpoise_models::OperatingPoint,
) -> Result<Teeth, Error> {
    let parameters = case.plant.parameters();
    if parameters.gearbox.backlash_rad == 0.0 {
        return Ok(Teeth::WithoutGap);
    }
    let pressed = case.plant.equilibrium(subject_point).mesh_torque_nm.abs();
    let held = parameters.pivot_friction.breakaway_nm();
    let sticks = FrictionModel::new(&parameters.pivot_friction)?.rest_stiffness_nm_rad() > 0.0;
    Ok(if pressed <= held && (sticks || pressed == 0.0) { Teeth::CanOpen } else { Teeth::Pressed })
}

/// Returns the loops of a case in every regime that it can be in.
pub(super) fn loops(subject: &Subject<'_>) -> Result<Vec<RegimeLoop>, Error> {
    let rest = Elements::at_rest(subject)?;
    let sliding = Elements::sliding(subject, subject.procedure.step.rate_rad_s.abs())?;
    let mut regimes = if has_friction(subject) {
        vec![(Regime::Presliding, &rest), (Regime::Sliding, &sliding)]
    } else {
        vec![(Regime::Frictionless, &sliding)]
    };
    if subject.controller.parts().estimator.is_some() {
        regimes.extend(regimes.clone().into_iter().map(|(regime, elements)| (regime.learning(), elements)));
    }
    let one = |(regime, elements)| loop_in(subject, regime, elements);
    let mut all = regimes.into_iter().map(one).collect::<Result<Vec<_>, Error>>()?;
    if teeth_can_part(subject.case, &subject.procedure.operating_point)? == Teeth::CanOpen {
        let open = Elements { mesh_share: OPEN, ..rest };
        all.push(loop_in(subject, Regime::TeethOpen, &open)?);
    }
    Ok(all)
}

/// Returns whether dry friction acts in the mechanism, or a friction observer in the controller.
fn has_friction(subject: &Subject<'_>) -> bool {
    subject.case.plant.parameters().has_dry_friction() || !subject.controller.parts().observers.is_empty()
}

fn loop_in(subject: &Subject<'_>, regime: Regime, elements: &Elements) -> Result<RegimeLoop, Error> {
    let learning = match regime {
        Regime::PreslidingLearning | Regime::SlidingLearning | Regime::FrictionlessLearning => {
            Learning::Active
        }
        _ => Learning::Still,
    };
    let linear = ElementLoop::close(subject, elements, learning)?;
    let (pole, period_s) = (linear.largest_pole(), linear.plant.sample_period_s);
    let pole_radius = pole.norm();
    let stable = pole_radius < 1.0;
    let (gain_margin_db, max_sensitivity) = match stable {
        true => {
            let found = candidate_margins(&linear.broken)?;
            (found.gain_margin_db(), found.ms.value)
        }
        false => (0.0, f64::INFINITY),
    };
    Ok(RegimeLoop {
        regime,
        pole_radius,
        growth_per_s: pole_radius.ln() / period_s,
        frequency_hz: pole.arg().abs() / (std::f64::consts::TAU * period_s),
        gain_margin_db,
        max_sensitivity,
        broken: linear.broken,
    })
}

/// Frequencies from the lowest to just below half the sample rate, rad/s.
pub(super) fn grid_rad_s(period_s: f64) -> Vec<f64> {
    let ratio = (0.499 / period_s / GRID_LOWEST_HZ).ln() / (GRID_POINTS - 1) as f64;
    (0..GRID_POINTS).map(|k| std::f64::consts::TAU * GRID_LOWEST_HZ * (ratio * k as f64).exp()).collect()
}
