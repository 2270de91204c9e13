//! The stability certificate as plain data.

use counterpoise_models::{ControlledQuantity, QuantityKind};
use counterpoise_verify::certificate::multiplier::{MultiplierTerm, TermKind};
use counterpoise_verify::certificate::{
    CaseCertificate, Orbit, Prediction, RegimeLoop, SectorProof, Stability, StabilityCertificate,
};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::balance::CycleBalanceResult;
use crate::exchange::{PulledLoopResult, SystemResult};

/// The certificate: the worst case, and every case.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CertificateResult {
    /// `stable`, `limit cycle`, `unstable` or `not predicted`: that of the worst case.
    pub stability: &'static str,
    /// `true` if stability is proved in every case.
    pub proved: bool,
    /// Name of the worst case.
    pub worst_case: String,
    /// Key of its worst regime.
    pub worst_regime: &'static str,
    /// Every case.
    pub cases: Vec<CaseResult>,
}

/// One case.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CaseResult {
    /// Name.
    pub name: String,
    /// Out-of-balance that the controller is told, kg m.
    pub out_of_balance_kg_m: f64,
    /// Stability, as [`CertificateResult::stability`].
    pub stability: &'static str,
    /// `true` if it is proved by a sector argument.
    pub proved: bool,
    /// The sector argument; `None` if none applies.
    pub sector: Option<SectorResult>,
    /// The limit cycle that stays: half the range of the hub rate, rad/s, or of what else the loop controls, and its frequency, Hz.
    pub limit_cycle: Option<CycleResult>,
    /// The linear loop in each regime.
    pub regimes: Vec<RegimeResult>,
    /// Limit cycles predicted by harmonic balance.
    pub predicted: Vec<PredictedResult>,
    /// Simulated motions from near each prediction, and from two other disturbances.
    pub orbits: Vec<OrbitResult>,
    /// Quantity that moves in the runs.
    #[serde(flatten)]
    pub motion: MotionResult,
}

/// The runs of a case at rest and in motion, with the noise floor: in rad/s of the hub rate, or of what else the loop controls in its unit,
/// which then stands at the end of the keys.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionResult {
    /// Quantity that the loop controls.
    pub controlled: ControlledQuantity,
    /// RMS in a run of 20 s at rest, with noise.
    pub rest_rms_rad_s: f64,
    /// RMS over the second half of a run in motion, over that of the first half.
    pub motion_growth: f64,
    /// Noise floor: RMS of noise and quantisation of a reading, and of what rounding keeps up.
    pub noise_floor_rad_s: f64,
    /// RMS of the white noise of a reading.
    pub reading_noise_rad_s: f64,
    /// Step of a reading.
    pub reading_step_rad_s: f64,
    /// RMS of what the rounding of the control and the arithmetic of a run keep up; not part of a loop of rate.
    pub rounding: f64,
    /// The motion about its mean in the run at rest, at the sample time of the loop; absent unless time histories were asked for.
    pub rest_rates_rad_s: Vec<f64>,
    /// The same in the run in motion.
    pub motion_rates_rad_s: Vec<f64>,
}

impl Serialize for MotionResult {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let controlled = self.controlled;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry(&controlled.key_of("rest_rms"), &self.rest_rms_rad_s)?;
        map.serialize_entry("motion_growth", &self.motion_growth)?;
        map.serialize_entry(&controlled.key_of("noise_floor"), &self.noise_floor_rad_s)?;
        map.serialize_entry(&controlled.key_of("reading_noise"), &self.reading_noise_rad_s)?;
        map.serialize_entry(&controlled.key_of("reading_step"), &self.reading_step_rad_s)?;
        if controlled.kind != QuantityKind::Rate {
            map.serialize_entry(&controlled.key_of("rounding"), &self.rounding)?;
        }
        let histories = [("rest", &self.rest_rates_rad_s), ("motion", &self.motion_rates_rad_s)];
        for (run, motion) in histories.into_iter().filter(|(_, motion)| !motion.is_empty()) {
            map.serialize_entry(&controlled.key_of(&format!("{run}_{}", plural_of(controlled))), motion)?;
        }
        map.end()
    }
}

/// Returns what the samples of a motion are called in a key: `rates` in a loop of rate.
fn plural_of(controlled: ControlledQuantity) -> &'static str {
    if controlled.kind == QuantityKind::Rate { "rates" } else { "samples" }
}

/// A sector argument.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SectorResult {
    /// `true` if it is a proof.
    pub holds: bool,
    /// `passivity`, `circle`, `popov` or `zames-falb`: the strongest criterion that it needs, or that was tried.
    pub criterion: &'static str,
    /// Least eigenvalue of the condition over its largest; `None` if the condition fails.
    pub least: Option<f64>,
    /// Frequency at which it is least, or at which it fails, Hz.
    pub frequency_hz: f64,
    /// Range of frequencies over which it was checked, with bounds between the points, Hz.
    pub range_hz: [f64; 2],
    /// Intervals of that check.
    pub intervals: usize,
    /// Bound of what passes through aliases, which must be below 1; `None` if the condition fails.
    pub aliases: Option<f64>,
    /// The multiplier that proves it; absent if none was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub multiplier: Option<MultiplierResult>,
}

/// A multiplier N(jw) of the torques of dry friction at motor and pivot, with a residue R: N H + (N H)^* + R is positive, where H is the
/// response from these torques to the rates there.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MultiplierResult {
    /// The loop H, whose two added signals are the torques.
    pub pulled: PulledLoopResult,
    /// Units of the torques at motor and pivot: H is multiplied by them from both sides.
    pub units: [f64; 2],
    /// Rate by which derivatives are divided, rad/s.
    pub reference_rad_s: f64,
    /// The terms of N and R.
    pub terms: Vec<TermResult>,
}

/// A term of a multiplier.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TermResult {
    /// 0 for the motor, 1 for the pivot.
    pub joint: usize,
    /// `constant` (1), `derivative` (value x jw / reference), `kernel` (-sign / (1 + jw / value)) or `stiffness` (-jw / reference in N,
    /// 2 w^2 / (reference value) in R).
    pub kind: &'static str,
    /// Value of the kind: a sign, a corner in rad/s, or a stiffness in the units of the torques.
    pub value: f64,
    /// Sign of a kernel; 1 for other kinds.
    pub sign: f64,
    /// Weight by which the term is multiplied.
    pub weight: f64,
}

impl From<&MultiplierTerm> for TermResult {
    fn from(term: &MultiplierTerm) -> Self {
        let (kind, value, sign) = match term.kind {
            TermKind::Constant => ("constant", 1.0, 1.0),
            TermKind::Derivative(sign) => ("derivative", sign, 1.0),
            TermKind::Kernel { corner_rad_s, sign } => ("kernel", corner_rad_s, sign),
            TermKind::Stiffness(stiffness) => ("stiffness", stiffness, 1.0),
        };
        Self { joint: term.joint, kind, value, sign, weight: term.weight }
    }
}

impl From<&SectorProof> for SectorResult {
    fn from(found: &SectorProof) -> Self {
        Self {
            holds: found.holds(),
            criterion: found.criterion.key(),
            least: (found.least > 0.0).then_some(found.least),
            frequency_hz: found.frequency_hz,
            range_hz: found.range_hz,
            intervals: found.intervals,
            aliases: finite_value(found.aliases),
            multiplier: found.multiplier.as_ref().map(|multiplier| MultiplierResult {
                pulled: (&found.pulled).into(),
                units: found.units,
                reference_rad_s: multiplier.reference_rad_s,
                terms: multiplier.terms.iter().map(TermResult::from).collect(),
            }),
        }
    }
}

/// A limit cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CycleResult {
    /// Quantity that the loop controls.
    pub controlled: ControlledQuantity,
    /// Amplitude of the hub rate, rad/s, or of what else the loop controls, in its unit.
    pub amplitude_rad_s: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
}

impl Serialize for CycleResult {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry(&self.controlled.key_of("amplitude"), &self.amplitude_rad_s)?;
        map.serialize_entry("frequency_hz", &self.frequency_hz)?;
        map.end()
    }
}

/// The loop in a regime.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RegimeResult {
    /// Key of the regime.
    pub regime: &'static str,
    /// Largest modulus of a pole.
    pub pole_radius: f64,
    /// Growth of that motion, 1/s.
    pub growth_per_s: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Gain margin, dB; `None` if no gain destabilises.
    pub gain_margin_db: Option<f64>,
    /// Largest sensitivity; `None` in an unstable loop.
    pub max_sensitivity: Option<f64>,
    /// The sampled loop broken at the plant's input: 1 + L is the return difference.
    pub sampled_loop: SystemResult,
}

/// A predicted limit cycle.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PredictedResult {
    /// Amplitude of the hub rate, rad/s.
    pub amplitude_rad_s: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Share of the first harmonic with which the third one returns round the loop.
    pub third_harmonic: f64,
    /// Relative difference between the frequency of the pole and the one for which the describing functions hold, the larger of both sides;
    /// `None` if growth does not turn into fading between them.
    pub frequency_error: Option<f64>,
    /// `true` if the loop is enough of a low-pass for the prediction to hold, and its describing functions hold for its frequency.
    pub reliable: bool,
    /// The loop with its describing functions at the last amplitude that grows, and at the first that fades.
    pub balances: Vec<CycleBalanceResult>,
}

/// A motion on the simulator.
#[derive(Debug, Clone, PartialEq)]
pub struct OrbitResult {
    /// Quantity that the loop controls.
    pub controlled: ControlledQuantity,
    /// Amplitude at its start, rad/s of the hub rate or the unit of what else the loop controls.
    pub start_rad_s: f64,
    /// Amplitude that stays, rad/s or the unit of what else the loop controls; 0 if the motion faded, `None` if it diverged.
    pub amplitude_rad_s: Option<f64>,
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// The motion about its mean over the last stretch that was followed, at the sample time of the loop; absent unless time histories were
    /// asked for.
    pub rates_rad_s: Vec<f64>,
}

impl Serialize for OrbitResult {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let controlled = self.controlled;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry(&controlled.key_of("start"), &self.start_rad_s)?;
        map.serialize_entry(&controlled.key_of("amplitude"), &self.amplitude_rad_s)?;
        map.serialize_entry("frequency_hz", &self.frequency_hz)?;
        if !self.rates_rad_s.is_empty() {
            map.serialize_entry(&controlled.key_of(plural_of(controlled)), &self.rates_rad_s)?;
        }
        map.end()
    }
}

impl CertificateResult {
    /// Leaves out the rates of motions on the simulator.
    pub fn leave_histories_out(&mut self) {
        for case in &mut self.cases {
            (case.motion.rest_rates_rad_s, case.motion.motion_rates_rad_s) = (Vec::new(), Vec::new());
            case.orbits.iter_mut().for_each(|orbit| orbit.rates_rad_s.clear());
            let balances = case.predicted.iter_mut().flat_map(|cycle| &mut cycle.balances);
            balances.for_each(CycleBalanceResult::leave_torques_out);
        }
    }
}

fn word(stability: Stability) -> &'static str {
    match stability {
        Stability::Stable => "stable",
        Stability::LimitCycle { .. } => "limit cycle",
        Stability::Unstable => "unstable",
        Stability::NotPredicted => "not predicted",
    }
}

fn finite_value(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

impl From<&StabilityCertificate> for CertificateResult {
    fn from(found: &StabilityCertificate) -> Self {
        let worst = found.worst_case();
        Self {
            stability: worst.map_or("not predicted", |case| word(case.stability)),
            proved: found.cases.iter().all(CaseCertificate::is_proved),
            worst_case: worst.map_or(String::new(), |case| case.name.clone()),
            worst_regime: worst.and_then(CaseCertificate::worst_regime).map_or("", |at| at.regime.key()),
            cases: found.cases.iter().map(CaseResult::from).collect(),
        }
    }
}

impl From<&CaseCertificate> for CaseResult {
    fn from(case: &CaseCertificate) -> Self {
        let limit_cycle = match case.stability {
            Stability::LimitCycle { amplitude_rad_s, frequency_hz } => {
                Some(CycleResult { controlled: case.controlled, amplitude_rad_s, frequency_hz })
            }
            _ => None,
        };
        Self {
            name: case.name.clone(),
            out_of_balance_kg_m: case.out_of_balance_kg_m,
            stability: word(case.stability),
            proved: case.is_proved(),
            sector: case.sector.as_ref().map(SectorResult::from),
            limit_cycle,
            regimes: case.regimes.iter().map(RegimeResult::from).collect(),
            predicted: predicted_cycles(&case.prediction),
            orbits: case.orbits.iter().map(|orbit| OrbitResult::new(orbit, case.controlled)).collect(),
            motion: MotionResult {
                controlled: case.controlled,
                rest_rms_rad_s: case.rest.rms_rad_s,
                motion_growth: case.motion.second_half_rad_s / case.motion.first_half_rad_s,
                noise_floor_rad_s: case.noise_floor_rad_s,
                reading_noise_rad_s: case.noise.white_rad_s,
                reading_step_rad_s: case.noise.step_rad_s,
                rounding: case.noise.rounding,
                rest_rates_rad_s: case.rest.rates_rad_s.clone(),
                motion_rates_rad_s: case.motion.rates_rad_s.clone(),
            },
        }
    }
}

impl From<&RegimeLoop> for RegimeResult {
    fn from(at: &RegimeLoop) -> Self {
        Self {
            regime: at.regime.key(),
            pole_radius: at.pole_radius,
            growth_per_s: at.growth_per_s,
            frequency_hz: at.frequency_hz,
            gain_margin_db: finite_value(at.gain_margin_db),
            max_sensitivity: finite_value(at.max_sensitivity),
            sampled_loop: SystemResult::new("loop", &at.broken, &["control_v"], &["returned_control_v"]),
        }
    }
}

/// Returns the predicted limit cycles with the loops on both sides of each.
fn predicted_cycles(found: &Prediction) -> Vec<PredictedResult> {
    let each = found.cycles.iter().zip(&found.balances).map(|(cycle, sides)| PredictedResult {
        amplitude_rad_s: cycle.rate_rad_s,
        frequency_hz: cycle.frequency_hz,
        third_harmonic: cycle.third_harmonic,
        frequency_error: finite_value(cycle.frequency_error),
        reliable: cycle.is_reliable(),
        balances: sides.iter().map(CycleBalanceResult::from).collect(),
    });
    each.collect()
}

impl OrbitResult {
    fn new(orbit: &Orbit, controlled: ControlledQuantity) -> Self {
        let diverged = orbit.rms_rad_s.is_infinite();
        Self {
            controlled,
            start_rad_s: orbit.start_rad_s,
            amplitude_rad_s: (!diverged).then_some(orbit.amplitude_rad_s),
            frequency_hz: orbit.frequency_hz,
            rates_rad_s: orbit.rates_rad_s.clone(),
        }
    }
}
