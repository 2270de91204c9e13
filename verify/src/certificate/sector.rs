//! The sector argument: a proof that the loop is stable whatever the friction at the joints, within what is known of its law.
//!
//! The mechanism with its controller, without dry friction, is linear: H, from torques at motor and pivot to the rates there. What is
//! known of a friction law gives the terms of a multiplier ([`super::multiplier`]):
//!
//! - Dahl's law is passive (P.-A. Bliman 1992), and its torque changes by at most (1 + F / F_c)^exponent times the rest stiffness times the
//!   displacement, never against it (P. Dahl 1968): the joint is a spring that yields.
//! - Coulomb friction, with any level, is a rising odd function of the rate; with Stribeck's effect still a function of the rate.
//! - LuGre friction without Stribeck effect is passive (N. Barahanov and R. Ortega, IFAC ALCOSP 2000). With it, passivity depends on the
//!   damping of the bristles, and Walrath's law gives energy after a reversal; nothing is claimed for these two.
//!
//! The controller is sampled. A torque of one frequency also moves the joints at the aliases of that frequency. What goes through them is
//! bounded: if the sum of [`SectorProof::aliases`] is below 1, the proof holds for the sampled loop as it is.
//!
//! The argument does not apply to friction observers in the loop, which give energy, nor to teeth that friction can hold apart.

use counterpoise_linalg::{C64, CMat, csolve};
use counterpoise_models::friction::FrictionModel;
use counterpoise_models::{Friction, FrictionLaw};

use super::elements::{ObserverGain, quasi_linear};
use super::floor::Subject;
use super::multiplier::{
    BestMultiplier, FrictionKnowledge, Multiplier, ProofOutcome, StabilityCriterion, adds_terms,
    search_multiplier,
};
use super::regime::{Teeth, grid_rad_s, teeth_can_part};
use crate::Error;
use crate::structured::closing::{GainErrors, outermost_pole};
use crate::structured::factor::Factor;
use crate::structured::loops::{Pieces, PulledLoop, UncertainLoop, UncertainParameter};
use crate::structured::places::{LinearisedDryFriction, Place, without_dry};
use crate::structured::taylor::{RateInterval, Taylor};
use crate::tolerance::{ALIASES, MULTIPLIER_RANGE, MULTIPLIER_ROUNDS};

/// Result of the sector argument for a loop.
#[derive(Debug, Clone, PartialEq)]
pub struct SectorProof {
    /// The strongest criterion that was needed, or tried in vain.
    pub criterion: StabilityCriterion,
    /// Least eigenvalue of the condition over its largest, over all frequencies; above 0 the condition holds at every one of them.
    pub least: f64,
    /// Frequency at which it is least, or fails, Hz.
    pub frequency_hz: f64,
    /// Intervals of the frequency over which it was shown, and the range from the first to the last of them, Hz.
    pub intervals: usize,
    /// See [`SectorProof::intervals`].
    pub range_hz: [f64; 2],
    /// Bound of what passes through the aliases of a frequency; below 1 they change nothing.
    pub aliases: f64,
    /// The assumption that the gear teeth stay together: there is a gap, and the weight presses them together.
    pub teeth: Teeth,
    /// The multiplier that proves it; `None` if none was found.
    pub multiplier: Option<Multiplier>,
    /// Units of the torques at motor and pivot in which the multiplier is stated: a torque is its number times the unit, a rate its number over
    /// the unit.
    pub units: [f64; 2],
    /// The loop from the torques of dry friction at motor and pivot to the rates there.
    pub pulled: PulledLoop,
}

impl SectorProof {
    /// Returns whether the proof holds.
    pub fn holds(&self) -> bool {
        self.least > 0.0 && self.aliases < 1.0
    }
}

/// Returns what is known of a friction; `None` if it may give energy.
fn knowledge(friction: &Friction) -> Result<Option<FrictionKnowledge>, Error> {
    let plain = friction.static_ratio <= 1.0;
    if FrictionModel::new(friction)?.is_modulated() {
        return Ok(memoryless(&friction.law).then_some(FrictionKnowledge::Dissipates));
    }
    Ok(match friction.law {
        FrictionLaw::None => Some(FrictionKnowledge::Rises),
        FrictionLaw::Dahl { rest_stiffness_nm_rad, exponent, .. } => plain.then(|| {
            // 1 - F / F_c sgn w with the levels of the two directions: at most 2 / (1 - asymmetry)
            let most = 2.0 / (1.0 - friction.asymmetry.abs());
            FrictionKnowledge::Stiffness(rest_stiffness_nm_rad * most.powf(exponent))
        }),
        FrictionLaw::Coulomb { .. } if plain && friction.asymmetry == 0.0 => Some(FrictionKnowledge::Rises),
        FrictionLaw::Coulomb { .. } | FrictionLaw::Stribeck { .. } => Some(FrictionKnowledge::FunctionOfRate),
        FrictionLaw::Lugre { .. } => plain.then_some(FrictionKnowledge::Dissipates),
        FrictionLaw::Walrath { .. } => None,
        FrictionLaw::ResetIntegrator { .. } | FrictionLaw::Karnopp { .. } | FrictionLaw::Bristle { .. } => {
            Some(FrictionKnowledge::Dissipates)
        }
    })
}

fn memoryless(law: &FrictionLaw) -> bool {
    matches!(law, FrictionLaw::None | FrictionLaw::Coulomb { .. } | FrictionLaw::Stribeck { .. })
}

/// Tries the proof; `None` if it does not apply: with a friction observer that follows a measured rate, with an estimator, with a curve of the
/// drive or its inverse, with a gap that friction can hold open, with a structure that is not lumped, with a law that may give energy, or
/// if the loop without dry friction is not stable.
pub(super) fn prove(subject: &Subject<'_>) -> Result<Option<SectorProof>, Error> {
    let parts = subject.controller.parts();
    let fed_back =
        parts.observers.iter().any(|observer| observer.rate != counterpoise_controller::PathSignal::Demand);
    let parameters = subject.case.plant.parameters();
    let point = &subject.procedure.operating_point;
    let teeth = teeth_can_part(subject.case, point)?;
    let curved = !parts.drive_curve.is_empty()
        || !parameters.amplifier.map.is_empty()
        || parameters.amplifier.dead_zone_v != 0.0;
    if fed_back
        || parts.estimator.is_some()
        || curved
        || parameters.lumped.is_none()
        || teeth == Teeth::CanOpen
    {
        return Ok(None);
    }
    let laws = [&parameters.motor_friction, &parameters.pivot_friction];
    let [Some(motor), Some(pivot)] = [knowledge(laws[0])?, knowledge(laws[1])?] else { return Ok(None) };
    let gains = vec![ObserverGain::default(); parts.observers.len()];
    let controller = quasi_linear(subject.controller, &gains)?;
    let rates = LinearisedDryFriction { viscous: [-1.0; 2], springs: [0.0; 2] };
    let nominal = without_dry(parameters, [0.0; 2]);
    let still = LinearisedDryFriction { viscous: [0.0; 2], springs: [0.0; 2] };
    let exact = GainErrors { at: [C64::new(0.0, 0.0); 2], rate_rad_s: 1.0 };
    if outermost_pole(&nominal, &still, &controller, point, &exact)?.norm() >= 1.0 {
        return Ok(None);
    }
    let whole = Factor { centre: 1.0, a: 1.0, b: 0.0 };
    let joint = |place| UncertainParameter { factor: whole, places: vec![place] };
    let joints = [joint(Place::MotorDry), joint(Place::PivotDry)];
    let pulled = UncertainLoop::new(&nominal, rates, &controller, point, &joints, [0.0; 2])?;
    let scaled = ScaledLoop::new(&pulled, [motor, pivot])?;
    Ok(Some(scaled.prove(teeth)?))
}

/// A grid is searched at every point of this number first.
const COARSER: usize = 4;

/// The loop with the torques and rates of the joints in units in which its diagonal reaches 1.
struct ScaledLoop<'a> {
    pulled: &'a UncertainLoop,
    units: [f64; 2],
    known: [FrictionKnowledge; 2],
}

impl<'a> ScaledLoop<'a> {
    fn new(pulled: &'a UncertainLoop, known: [FrictionKnowledge; 2]) -> Result<Self, Error> {
        let all = pulled.at(&grid_rad_s(pulled.sample_period_s()))?;
        let units = [0, 1].map(|k| {
            let most = all.iter().map(|H| H[(k, k)].norm()).fold(f64::MIN_POSITIVE, f64::max);
            most.sqrt().recip()
        });
        let in_units = |k: usize| match known[k] {
            FrictionKnowledge::Stiffness(most) => FrictionKnowledge::Stiffness(most / units[k].powi(2)),
            other => other,
        };
        Ok(Self { pulled, units, known: [in_units(0), in_units(1)] })
    }

    fn pieces(&self, over: RateInterval) -> Option<Pieces> {
        let mut found = self.pulled.pieces_over(over)?;
        for k in 0..2 {
            found.control[k] = found.control[k] * self.units[k];
            found.reading[k] = found.reading[k] * self.units[k];
            (0..2).for_each(|j| found.direct[k][j] = found.direct[k][j] * (self.units[k] * self.units[j]));
        }
        Some(found)
    }

    fn at(&self, over: RateInterval) -> Option<Vec<Vec<Taylor>>> {
        Some(whole_response(&self.pieces(over)?))
    }

    /// The weakest criterion that holds, or the strongest one and where it fails.
    fn prove(&self, teeth: Teeth) -> Result<SectorProof, Error> {
        let period_s = self.pulled.sample_period_s();
        let nyquist = std::f64::consts::PI / period_s;
        let range = [MULTIPLIER_RANGE[0] * std::f64::consts::TAU, MULTIPLIER_RANGE[1] * nyquist];
        let hertz = |rate: f64| rate / std::f64::consts::TAU;
        let mut found = SectorProof {
            criterion: StabilityCriterion::Passivity,
            least: f64::NEG_INFINITY,
            frequency_hz: 0.0,
            intervals: 0,
            range_hz: range.map(hertz),
            aliases: f64::INFINITY,
            teeth,
            multiplier: None,
            units: self.units,
            pulled: self.pulled.pulled_loop(),
        };
        for most in [
            StabilityCriterion::Passivity,
            StabilityCriterion::Circle,
            StabilityCriterion::Popov,
            StabilityCriterion::ZamesFalb,
        ] {
            found.criterion = most;
            if !adds_terms(&self.known, most) {
                continue;
            }
            let (tried, failed) = self.search_grids(most, range);
            if let Some((multiplier, ProofOutcome::Holds { least, rate_rad_s, intervals })) = tried {
                found.criterion = multiplier.criterion();
                (found.least, found.frequency_hz, found.intervals) = (least, hertz(rate_rad_s), intervals);
                found.aliases = self.aliases(&multiplier, nyquist);
                found.multiplier = Some(multiplier);
                return Ok(found);
            }
            found.frequency_hz = hertz(failed);
            found.least = -1.0;
        }
        Ok(found)
    }

    /// Searches a multiplier on a grid, to which the rate at which it failed is added, until it holds or none can; and that rate. What none can
    /// hold at every fourth point of the grid, none can at all of them.
    fn search_grids(
        &self,
        most: StabilityCriterion,
        range: [f64; 2],
    ) -> (Option<(Multiplier, ProofOutcome)>, f64) {
        let mut rates = grid_between(range);
        let few: Vec<f64> = rates.iter().copied().step_by(COARSER).collect();
        let mut failed = range[0];
        match self.best_multiplier(most, &few) {
            Some(found) if found.is_ruled_out() => return (None, found.costliest_rad_s),
            Some(_) => {}
            None => return (None, failed),
        }
        for _ in 0..MULTIPLIER_ROUNDS {
            let Some(best) = self.best_multiplier(most, &rates) else { break };
            match best.multiplier.proves(&|over| self.at(over), range) {
                ProofOutcome::FailsAt(_) if best.is_hopeless() => return (None, best.costliest_rad_s),
                ProofOutcome::FailsAt(rate) => {
                    failed = rate;
                    rates.push(rate);
                }
                // Another multiplier for one more rate holds as narrowly.
                ProofOutcome::Narrow(rate) => return (None, rate),
                holds => return (Some((best.multiplier, holds)), failed),
            }
        }
        (None, failed)
    }

    /// The best multiplier at some rates; `None` at a pole or if the solver gives up.
    fn best_multiplier(&self, most: StabilityCriterion, rates: &[f64]) -> Option<BestMultiplier> {
        let point = |rate: &f64| self.at(RateInterval { middle_rad_s: *rate, half_rad_s: 0.0 });
        let all = rates.iter().map(point).collect::<Option<Vec<_>>>()?;
        search_multiplier(&self.known, most, &all, rates)
    }

    /// The bound of what passes through aliases: 4 sum over j != k of b_k^2 r_j^2 at its largest over the frequencies below half the
    /// sample rate, where b = |Q^-1/2 N control| and r = |Q^-1/2 reading| at each alias, Q the matrix of the condition there.
    fn aliases(&self, multiplier: &Multiplier, nyquist: f64) -> f64 {
        let below = grid_between([MULTIPLIER_RANGE[0] * std::f64::consts::TAU, nyquist]);
        below.iter().map(|rate| self.aliases_of(multiplier, *rate, nyquist)).fold(0.0, f64::max)
    }

    fn aliases_of(&self, multiplier: &Multiplier, rate: f64, nyquist: f64) -> f64 {
        let mut all = Vec::new();
        for k in -ALIASES..=ALIASES {
            let alias = (rate + 2.0 * nyquist * f64::from(k)).abs();
            let Some([b, r]) = self.sizes(multiplier, alias) else { return f64::INFINITY };
            // the last alias stands for all beyond it, which fall faster than the square of their number
            let weight = if k.abs() == ALIASES { f64::from(ALIASES) } else { 1.0 };
            all.push([weight * b, weight * r]);
        }
        let others =
            |k: usize| -> f64 { all.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, x)| x[1]).sum() };
        4.0 * (0..all.len()).map(|k| all[k][0] * others(k)).sum::<f64>()
    }

    /// |Q^-1/2 N control|^2 and |Q^-1/2 reading|^2 at a rate; `None` at a pole.
    fn sizes(&self, multiplier: &Multiplier, rate: f64) -> Option<[f64; 2]> {
        let over = RateInterval { middle_rad_s: rate, half_rad_s: 0.0 };
        let pieces = self.pieces(over)?;
        let Q = multiplier.matrix(&whole_response(&pieces), over);
        let weighed = |column: [C64; 2]| -> Option<f64> {
            let x = csolve(&Q, &CMat::col(&column)).ok()?;
            Some((0..2).map(|k| (column[k].conj() * x[(k, 0)]).re).sum())
        };
        let control = [0, 1].map(|k| (multiplier.at(k, over) * pieces.control[k]).value);
        let reading = [0, 1].map(|k| pieces.reading[k].value.conj());
        Some([weighed(control)?, weighed(reading)?])
    }
}

/// H = direct + control x reading.
fn whole_response(pieces: &Pieces) -> Vec<Vec<Taylor>> {
    let entry = |i: usize, j: usize| pieces.direct[i][j] + pieces.control[i] * pieces.reading[j];
    (0..pieces.control.len()).map(|i| (0..pieces.reading.len()).map(|j| entry(i, j)).collect()).collect()
}

/// A logarithmic grid of a range.
fn grid_between([low, high]: [f64; 2]) -> Vec<f64> {
    const POINTS: usize = 160;
    let ratio = (high / low).ln() / (POINTS - 1) as f64;
    (0..POINTS).map(|k| low * (ratio * k as f64).exp()).collect()
}
