//! The linear worst case and what to change where a requirement fails, as plain data.

use counterpoise_controller::{COMMON_READINGS, READING_NAMES};
use counterpoise_linalg::CMat;
use counterpoise_verify::structured::closing::LoopClosure;
use counterpoise_verify::structured::problem::StatedRange;
use counterpoise_verify::structured::{
    Bounds, DestabilisingMechanism, Joints, Perturbation, RobustStability, UpperBound,
};
use serde::Serialize;

use crate::exchange::{HistoryResult, PulledLoopResult, SystemResult};
use crate::studies::advice::{TriedDesign, WeightAdvice, WeightSensitivity};
use crate::studies::certificate::RegimeRobustness;

/// Bounds of how far all stated ranges may be widened together in a case and a regime of friction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RobustnessResult {
    /// The case: `design`, a configuration, or a factor of the schedule.
    pub case: String,
    /// `sliding` or `at rest`.
    pub joints: &'static str,
    /// Stable for all parameters in the stated ranges widened by less than this; `None` if the loop is not stable without any deviation.
    pub guaranteed: Option<f64>,
    /// Frequency at which the upper bound is largest, Hz.
    pub worst_hz: Option<f64>,
    /// Bounds of the structured singular value, by rising frequency.
    pub bounds: Vec<SingularValueResult>,
    /// The nearest mechanism at the limit of stability that was found.
    pub nearest: Option<NearestResult>,
    /// Keys of parameters that do not enter the linear loop.
    pub left_out: Vec<&'static str>,
    /// The sinusoidal hub rate at which dry friction is taken as viscous friction, rad/s.
    pub dry_friction_at_rad_s: Option<f64>,
    /// Relative errors at the plant's input and of the hub gyroscope's reading that are widened with the ranges.
    pub errors: [f64; 2],
    /// The loop of which the bounds are; absent without bounds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pulled: Option<PulledLoopResult>,
    /// The stated range of each parameter that enters the loop, in the order of the blocks.
    pub ranges: Vec<RangeResult>,
}

/// A stated range of a parameter: its factor is centre (1 + a d) / (1 + b d) for d from -1 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RangeResult {
    /// Key.
    pub key: &'static str,
    /// The factor at d = 0.
    pub centre: f64,
    /// Slope of the numerator.
    pub a: f64,
    /// Slope of the denominator.
    pub b: f64,
}

/// A block of a Hermitian scaling, as rows of numbers of real and imaginary part.
pub type ScalingBlock = Vec<Vec<[f64; 2]>>;

/// The structured singular value at one frequency.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)]
pub struct SingularValueResult {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Upper bound.
    pub upper: f64,
    /// Lower bound; 0 if no perturbation was found.
    pub lower: f64,
    /// The blocks of the scaling D that proves the upper bound: M^* D M + j (G M - M^* G) < upper^2 D.
    pub D: Vec<ScalingBlock>,
    /// The blocks of the scaling G.
    pub G: Vec<ScalingBlock>,
    /// A perturbation of size 1, a number for each block, with det(I - M perturbation / lower) = 0; empty if none was found.
    pub perturbation: Vec<[f64; 2]>,
}

/// A mechanism at the limit of stability.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NearestResult {
    /// By how much the stated ranges are widened to hold it.
    pub scale: f64,
    /// Frequency of its oscillation, Hz.
    pub frequency_hz: f64,
    /// Parameters that enter the loop, with their factors.
    pub factors: Vec<FactorResult>,
    /// Relative errors at the plant's input and of the hub gyroscope's reading, each as real and imaginary part.
    pub errors: [[f64; 2]; 2],
    /// The closed loop's pole there.
    pub pole: [f64; 2],
    /// The deviation of each parameter over its stated range, which `scale` widens.
    pub deltas: Vec<f64>,
    /// The phases of the two errors, of size 1 at most.
    pub phases: [[f64; 2]; 2],
    /// The perturbed plant as it is sampled (its control is the last input, its readings are the last outputs) and the controller with the
    /// errors before and behind it: the loop that has the pole.
    pub systems: Vec<SystemResult>,
}

/// A parameter with its factor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FactorResult {
    /// Key.
    pub key: &'static str,
    /// Factor.
    pub factor: f64,
}

/// Change that would meet a requirement that fails.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AdviceResult {
    /// Key of the figure.
    pub figure: String,
    /// The figure as it is.
    pub value: f64,
    /// Limit.
    pub limit: f64,
    /// Change of the figure for a weight that is e times as large.
    pub sensitivities: Vec<SensitivityResult>,
    /// The best change that was tried; `None` if no weight moves the figure.
    pub change: Option<ChangeResult>,
}

/// The sensitivity of a figure to a weight.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SensitivityResult {
    /// Key of the weight.
    pub weight: &'static str,
    /// Change of the figure for a weight that is e times as large.
    pub per_factor_e: f64,
    /// The design with that weight changed a little, from which it was found.
    pub tried: TriedResult,
}

/// A design with a weight changed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TriedResult {
    /// By what the weight is multiplied.
    pub factor: f64,
    /// The figure then.
    pub value: f64,
    /// The controllers and the loop.
    pub systems: Vec<SystemResult>,
    /// The time history from which the figure is measured; absent if it is measured from none, or histories were not asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub history: Option<HistoryResult>,
}

/// A change of a weight that was tried.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChangeResult {
    /// Key of the weight.
    pub weight: &'static str,
    /// By what it is multiplied.
    pub factor: f64,
    /// The figure then.
    pub value: f64,
    /// Change of the gain margin, dB.
    pub gain_margin_change_db: f64,
    /// `true` if the requirement holds then.
    pub holds: bool,
    /// The design with that change.
    pub tried: TriedResult,
}

impl RobustnessResult {
    /// Returns the bounds of the design's own case, unless nothing varies in it, then those of the other cases and regimes of friction.
    pub fn list(own: Option<&RobustStability>, joints: Joints, regimes: &[RegimeRobustness]) -> Vec<Self> {
        let own = own.map(|found| Self::new("design", joints, Some(found)));
        own.into_iter().chain(regimes.iter().map(Into::into)).collect()
    }

    /// Returns the bounds of a case in a regime of friction.
    pub fn new(case: &str, joints: Joints, found: Option<&RobustStability>) -> Self {
        Self {
            case: case.to_owned(),
            joints: match joints {
                Joints::Sliding => "sliding",
                Joints::AtRest => "at rest",
                Joints::Frictionless => "frictionless",
            },
            guaranteed: found.map(|it| it.guaranteed),
            worst_hz: found.map(|it| it.worst_hz),
            bounds: found.map_or_else(Vec::new, bounds),
            nearest: found.and_then(|it| it.found.as_ref()).map(NearestResult::from),
            left_out: found
                .map_or_else(Vec::new, |it| it.left_out.iter().map(|varied| varied.key()).collect()),
            dry_friction_at_rad_s: found.and_then(|it| it.dry_friction_at_rad_s),
            errors: found.map_or([0.0; 2], |it| it.errors),
            pulled: found.map(|it| (&it.proof.pulled).into()),
            ranges: found.map_or_else(Vec::new, |it| it.proof.ranges.iter().map(range).collect()),
        }
    }
}

fn range(StatedRange { varied, factor }: &StatedRange) -> RangeResult {
    RangeResult { key: varied.key(), centre: factor.centre, a: factor.a, b: factor.b }
}

/// Returns the bounds with what proves them.
fn bounds(found: &RobustStability) -> Vec<SingularValueResult> {
    let placed = found.proof.pulled.structure.place_blocks();
    let blocks = |scaling: &CMat| -> Vec<ScalingBlock> {
        let pair = |i: usize, j: usize| [scaling[(i, j)].re, scaling[(i, j)].im];
        let block = |rows: &std::ops::Range<usize>| {
            rows.clone().map(|i| rows.clone().map(|j| pair(i, j)).collect()).collect()
        };
        placed.iter().map(|(_, rows)| block(rows)).collect()
    };
    let proofs = found.proof.scalings.iter().zip(&found.proof.perturbations);
    let one =
        |(at, (proof, perturbation)): (&Bounds, (&UpperBound, &Option<Perturbation>))| SingularValueResult {
            frequency_hz: at.frequency_hz,
            upper: at.upper,
            lower: at.lower,
            D: blocks(&proof.D),
            G: blocks(&proof.G),
            perturbation: perturbation
                .as_ref()
                .map_or_else(Vec::new, |it| it.delta.iter().map(|q| [q.re, q.im]).collect()),
        };
    found.bounds.iter().zip(proofs).map(one).collect()
}

impl From<&RegimeRobustness> for RobustnessResult {
    fn from(at: &RegimeRobustness) -> Self {
        Self::new(&at.case, at.joints, at.found.as_ref())
    }
}

impl From<&DestabilisingMechanism> for NearestResult {
    fn from(found: &DestabilisingMechanism) -> Self {
        let factor = |(varied, factor): &(counterpoise_verify::robustness::VariedParameter, f64)| {
            FactorResult { key: varied.key(), factor: *factor }
        };
        Self {
            scale: found.scale,
            frequency_hz: found.frequency_hz,
            factors: found.factors.iter().map(factor).collect(),
            errors: found.errors.map(|error| [error.re, error.im]),
            pole: [found.pole.re, found.pole.im],
            deltas: found.deltas.clone(),
            phases: found.phases.map(|phase| [phase.re, phase.im]),
            systems: closed_loop_systems(&found.closed),
        }
    }
}

fn closed_loop_systems(found: &LoopClosure) -> Vec<SystemResult> {
    let readings = &READING_NAMES[..COMMON_READINGS];
    let mut outputs = vec!["hub_rate_rad_s", "tip_rate_rad_s", "motor_rate_rad_s", "current_a", "control_v"];
    outputs.extend(readings);
    let inputs = ["demand_rad_s", "heave_m_s2", "pitch_rate_rad_s", "control_v"];
    vec![
        SystemResult::new("sampled_plant", &found.plant, &inputs, &outputs),
        SystemResult::new("controller", &found.controller, readings, &["control_v"]),
    ]
    .into_iter()
    .map(|system| system.of_loop(found.controlled))
    .collect()
}

impl From<&TriedDesign> for TriedResult {
    fn from(tried: &TriedDesign) -> Self {
        let (systems, history) = (tried.systems.clone(), tried.history.clone());
        Self { factor: tried.factor, value: tried.value, systems, history }
    }
}

impl From<&WeightAdvice> for AdviceResult {
    fn from(advice: &WeightAdvice) -> Self {
        let change = advice.change.as_ref().map(|change| ChangeResult {
            weight: change.key,
            factor: change.factor,
            value: change.value,
            gain_margin_change_db: change.gain_margin_db,
            holds: change.holds,
            tried: (&change.tried).into(),
        });
        let sensitivity = |one: &WeightSensitivity| SensitivityResult {
            weight: one.key,
            per_factor_e: one.per_factor_e,
            tried: (&one.tried).into(),
        };
        Self {
            figure: advice.requirement.figure.key_in(advice.controlled),
            value: advice.value,
            limit: advice.requirement.limit.value(),
            sensitivities: advice.sensitivities.iter().map(sensitivity).collect(),
            change,
        }
    }
}
