//! The stability certificate of the controller as it is exported, with all of its blocks, in every regime that matters.
//!
//! A mechanism with dry friction and backlash has no single linear loop. The certificate therefore
//!
//! 1. linearises the loop in each regime ([`regime`]): at rest with the presliding stiffness of friction and of the controller's
//!    friction observers, sliding, with open gear teeth, and with the estimator learning, at each setting of the schedule;
//! 2. predicts limit cycles by harmonic balance with the describing functions of friction, observers and backlash ([`prediction`]);
//! 3. starts the simulator near each predicted limit cycle and follows the motion until it settles or fades ([`orbit`]);
//! 4. proves stability where a sector argument applies: passivity, circle criterion, Popov, Zames-Falb ([`sector`]);
//! 5. looks at runs of its own at rest and in motion, with noise and quantisation ([`runs`]).
//!
//! Its verdict is a [`Stability`]; what is proved, what is predicted and what is only simulated stay apart.
//!
//! Modules in reading order: [`regime`], [`elements`], [`floor`], [`gap`], [`balance`], [`cycle`], [`gear_rattle`], `rounding`, [`prediction`], [`orbit`], [`multiplier`], [`sector`],
//! [`runs`].

pub mod balance;
pub mod cycle;
pub mod elements;
pub mod floor;
pub mod gap;
pub mod gear_rattle;
pub mod multiplier;
pub mod orbit;
pub mod prediction;
pub mod regime;
mod rounding;
pub mod runs;
pub mod sector;

use counterpoise_controller::Controller;
use counterpoise_models::plant::Plant;
use counterpoise_models::{ControlledQuantity, QuantityKind};

use floor::Subject;

pub use balance::CycleBalance;
pub use cycle::Cycle;
pub use floor::ReadingNoise;
pub use multiplier::StabilityCriterion;
pub use orbit::Orbit;
pub use prediction::Prediction;
pub use regime::{Regime, RegimeLoop, Teeth};
pub use runs::Run;
pub use sector::SectorProof;

use crate::measure::{MeasuredFigure, Value};
use crate::structured::Joints;
use crate::tolerance::{LEAST_CYCLES, MOVES_FLOORS, MOVES_UNSTABLE_FLOORS, RUN_S, STEADY_GROWTH};
use crate::{CertificateFigure, Error, MissingReason, PerformanceFigure, Procedure};

/// A mechanism with the out-of-balance that is set in the controller: the design's own, or another one of the schedule.
#[derive(Debug, Clone, PartialEq)]
pub struct CertifiedCase {
    /// Name, for reports: that of the configuration.
    pub name: String,
    /// The mechanism.
    pub plant: Plant,
    /// The out-of-balance that the controller is told, kg m.
    pub out_of_balance_kg_m: f64,
}

/// Verdict of the certificate on a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stability {
    /// The loop is stable in every regime, and no motion stays that exceeds two noise floors.
    Stable,
    /// A limit cycle stays.
    LimitCycle {
        /// Amplitude: half the range of the hub's rate, rad/s, or of what the loop controls, in its unit.
        amplitude_rad_s: f64,
        /// Frequency, Hz.
        frequency_hz: f64,
    },
    /// The motion grows without bound, or until the drive saturates.
    Unstable,
    /// Neither can be said: a run of its own moves more than the prediction explains.
    NotPredicted,
}

/// All that was found about one case.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseCertificate {
    /// The case's name.
    pub name: String,
    /// The rate of its axis, in which limit cycles are predicted and disturbances start.
    pub rate: ControlledQuantity,
    /// Quantity that the loop controls: the motion of the runs and the noise floor are of it, in its unit.
    pub controlled: ControlledQuantity,
    /// The out-of-balance that the controller is told, kg m.
    pub out_of_balance_kg_m: f64,
    /// The verdict.
    pub stability: Stability,
    /// The linear loop in each regime.
    pub regimes: Vec<RegimeLoop>,
    /// Limit cycles that the harmonic balance predicts.
    pub prediction: Prediction,
    /// Simulated motions from near each predicted limit cycle, and from two other disturbances.
    pub orbits: Vec<Orbit>,
    /// The proof by a sector argument; `None` if none applies.
    pub sector: Option<SectorProof>,
    /// The run at rest, with noise and quantisation.
    pub rest: Run,
    /// The run in motion.
    pub motion: Run,
    /// Noise floor of the hub's rate, rad/s: RMS of the hub gyroscope's noise and quantisation. That of another controlled quantity is in its
    /// unit, with what rounding keeps up.
    pub noise_floor_rad_s: f64,
    /// Parts of the noise floor.
    pub noise: ReadingNoise,
}

/// The certificate over all cases.
#[derive(Debug, Clone, PartialEq)]
pub struct StabilityCertificate {
    /// The cases, the design's own first.
    pub cases: Vec<CaseCertificate>,
}

impl StabilityCertificate {
    /// Returns the worst case: unstable before a limit cycle before what is not predicted before stable, then the case whose worst
    /// regime is nearest to instability. `None` without cases.
    pub fn worst_case(&self) -> Option<&CaseCertificate> {
        let rank = |case: &CaseCertificate| match case.stability {
            Stability::Unstable => 3,
            Stability::LimitCycle { .. } => 2,
            Stability::NotPredicted => 1,
            Stability::Stable => 0,
        };
        let near = |case: &CaseCertificate| case.worst_regime().map_or(0.0, RegimeLoop::severity);
        self.cases.iter().max_by(|a, b| rank(a).cmp(&rank(b)).then(near(a).total_cmp(&near(b))))
    }
}

impl StabilityCertificate {
    /// Returns the regime of all cases that is nearest to instability, or furthest beyond it, with its case; `None` without regimes.
    pub fn nearest_to_instability(&self) -> Option<(&CaseCertificate, &RegimeLoop)> {
        let worst = self.cases.iter().filter_map(|case| Some((case, case.worst_regime()?)));
        worst.max_by(|(_, a), (_, b)| a.severity().total_cmp(&b.severity()))
    }

    /// Returns the figures on which a requirement can be stated.
    pub(crate) fn figures(&self) -> Vec<MeasuredFigure> {
        let measured =
            |figure, value| MeasuredFigure { figure: PerformanceFigure::Certificate(figure), value };
        let mut all = vec![measured(CertificateFigure::LimitCyclePeak, self.limit_cycle_peak())];
        if let Some((_, at)) = self.nearest_to_instability() {
            all.push(measured(CertificateFigure::GainMargin, Value::Is(at.gain_margin_db)));
            all.push(measured(CertificateFigure::MaxSensitivity, Value::Is(at.max_sensitivity)));
        }
        all
    }

    /// Returns the largest limit cycle that stays in any case.
    fn limit_cycle_peak(&self) -> Value {
        let peak = |case: &CaseCertificate| match case.stability {
            Stability::Stable => Some(0.0),
            Stability::LimitCycle { amplitude_rad_s, .. } => Some(amplitude_rad_s),
            Stability::Unstable => Some(f64::INFINITY),
            Stability::NotPredicted => None,
        };
        let known: Option<Vec<f64>> = self.cases.iter().map(peak).collect();
        let absent = Value::Absent { why: MissingReason::NotPredicted };
        known.map_or(absent, |all| Value::Is(all.into_iter().fold(0.0, f64::max)))
    }
}

impl CaseCertificate {
    /// Returns the regime of dry friction in which the linear worst case of the case is computed first.
    pub fn first_joints(&self) -> Joints {
        let frictionless = self.regimes.iter().any(|at| at.regime == Regime::Frictionless);
        if frictionless { Joints::Frictionless } else { Joints::Sliding }
    }

    /// Returns the regime that is nearest to instability, or furthest beyond it; open teeth do not count, because no control reaches
    /// the hub while they are open. `None` without regimes.
    pub fn worst_regime(&self) -> Option<&RegimeLoop> {
        let judged = self.regimes.iter().filter(|found| found.regime.is_judged());
        judged.max_by(|a, b| a.severity().total_cmp(&b.severity()))
    }

    /// Returns whether stability is proved in this case: by a sector argument, and in a stable loop.
    pub fn is_proved(&self) -> bool {
        self.stability == Stability::Stable && self.sector.as_ref().is_some_and(SectorProof::holds)
    }
}

/// Certifies `controller` on each case, moved by `procedure` in the run in motion.
///
/// # Errors
/// Those of the models, the linear loop and the simulator; a motion that diverges is a result.
pub fn certify(
    controller: &Controller,
    procedure: &Procedure,
    cases: &[CertifiedCase],
) -> Result<StabilityCertificate, Error> {
    let certified = |case: &CertifiedCase| {
        let noise = ReadingNoise::default();
        let mut subject = Subject { case, controller, procedure, noise };
        subject.noise = rounding::reading_noise(&subject)?;
        certify_case(&subject)
    };
    Ok(StabilityCertificate { cases: cases.iter().map(certified).collect::<Result<_, Error>>()? })
}

fn certify_case(subject: &Subject<'_>) -> Result<CaseCertificate, Error> {
    let noise_floor_rad_s = subject.noise_floor_rad_s();
    let regimes = regime::loops(subject)?;
    let prediction = prediction::predict(subject)?;
    let orbits = orbit::follow_orbits(subject, &prediction)?;
    let sector = sector::prove(subject)?;
    let is_proved = sector.as_ref().is_some_and(SectorProof::holds);
    let proof = if is_proved { runs::Proof::Given } else { runs::Proof::Missing };
    let rest = runs::at_rest(subject, proof)?;
    let motion = runs::run_in_motion(subject)?;
    let mut found = CaseCertificate {
        name: subject.case.name.clone(),
        rate: subject.controlled_quantity().rate(),
        controlled: subject.controlled_quantity(),
        out_of_balance_kg_m: subject.case.out_of_balance_kg_m,
        stability: Stability::Stable,
        regimes,
        prediction,
        orbits,
        sector,
        rest,
        motion,
        noise_floor_rad_s,
        noise: subject.noise,
    };
    found.stability = judge(&found);
    Ok(found)
}

/// The verdict: what the simulator shows decides where it was asked, the linear loop where it was not.
fn judge(found: &CaseCertificate) -> Stability {
    let sliding = |one: &&RegimeLoop| one.regime.is_judged() && !one.is_at_rest();
    let grows = found.regimes.iter().filter(sliding).any(|one| one.growth_per_s > STEADY_GROWTH);
    let diverges = found.orbits.iter().any(|orbit| orbit.rms_rad_s.is_infinite());
    if grows || diverges || found.rest.diverges() || found.motion.diverges() {
        return Stability::Unstable;
    }
    let floor = MOVES_FLOORS * found.noise_floor_rad_s;
    let cycles = found.rest.frequency_hz * RUN_S >= LEAST_CYCLES && found.rest.is_periodic();
    if found.rest.rms_rad_s > floor && cycles && found.rest.recurs {
        let Run { amplitude_rad_s, frequency_hz, .. } = found.rest;
        return Stability::LimitCycle { amplitude_rad_s, frequency_hz };
    }
    let (cycling, wandering): (Vec<&Orbit>, Vec<&Orbit>) =
        found.orbits.iter().filter(|orbit| orbit.rms_rad_s > floor).partition(|orbit| orbit.recurs);
    if let Some(largest) = cycling.into_iter().max_by(|a, b| a.rms_rad_s.total_cmp(&b.rms_rad_s)) {
        let (amplitude_rad_s, frequency_hz) = (largest.amplitude_rad_s, largest.frequency_hz);
        return Stability::LimitCycle { amplitude_rad_s, frequency_hz };
    }
    let is_rate = found.controlled.kind == QuantityKind::Rate;
    if found.motion.grows() && (is_rate || found.motion.second_half_rad_s > floor) {
        return Stability::Unstable;
    }
    let grows = |one: &RegimeLoop| one.regime.is_judged() && one.growth_per_s > STEADY_GROWTH;
    // a prediction near which every motion faded is refuted
    let stays = found.orbits.iter().any(|orbit| orbit.rms_rad_s > 0.0);
    let doubtful = found.regimes.iter().any(grows) || (!found.prediction.cycles.is_empty() && stays);
    let bound = if doubtful { MOVES_UNSTABLE_FLOORS * found.noise_floor_rad_s } else { floor };
    let most = found.rest.rms_rad_s + found.rest.spread_rad_s;
    if most > bound || !wandering.is_empty() { Stability::NotPredicted } else { Stability::Stable }
}
