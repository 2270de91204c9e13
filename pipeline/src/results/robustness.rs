//! The linear worst case and what to change where a requirement fails, as plain data.

use counterpoise_verify::structured::{Destabilising, Joints, RobustStability};
use serde::Serialize;

use crate::studies::advice::Advice;
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
    /// Where the upper bound is largest, Hz.
    pub worst_hz: Option<f64>,
    /// Bounds of the structured singular value, by rising frequency.
    pub bounds: Vec<BoundResult>,
    /// The nearest mechanism at the limit of stability that was found.
    pub nearest: Option<NearestResult>,
    /// Keys of parameters that do not enter the linear loop.
    pub left_out: Vec<&'static str>,
    /// The sinusoidal hub rate at which dry friction is taken as viscous friction, rad/s.
    pub dry_friction_at_rad_s: Option<f64>,
    /// Relative errors at the plant's input and of the hub gyroscope's reading that are widened with the ranges.
    pub errors: [f64; 2],
}

/// The structured singular value at one frequency.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BoundResult {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Upper bound.
    pub upper: f64,
    /// Lower bound; 0 where no perturbation was found.
    pub lower: f64,
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
}

/// A parameter with its factor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FactorResult {
    /// Key.
    pub key: &'static str,
    /// Factor.
    pub factor: f64,
}

/// What to change where a requirement fails.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AdviceResult {
    /// Key of the figure.
    pub figure: String,
    /// The figure as it is.
    pub value: f64,
    /// Its limit.
    pub limit: f64,
    /// Change of the figure for a weight that is e times as large.
    pub sensitivities: Vec<SensitivityResult>,
    /// The best change that was tried; `None` if no weight moves the figure.
    pub change: Option<ChangeResult>,
}

/// The sensitivity of a figure to a weight.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SensitivityResult {
    /// Key of the weight.
    pub weight: &'static str,
    /// Change of the figure for a weight that is e times as large.
    pub per_factor_e: f64,
}

/// A change of a weight that was tried.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ChangeResult {
    /// Key of the weight.
    pub weight: &'static str,
    /// By what it is multiplied.
    pub factor: f64,
    /// The figure then.
    pub value: f64,
    /// Change of the gain margin, dB.
    pub gain_margin_change_db: f64,
    /// Whether the requirement holds then.
    pub holds: bool,
}

impl RobustnessResult {
    /// Returns the bounds of a case in a regime of friction.
    pub fn new(case: &str, joints: Joints, found: Option<&RobustStability>) -> Self {
        let bound = |at: &counterpoise_verify::structured::Bounds| BoundResult {
            frequency_hz: at.frequency_hz,
            upper: at.upper,
            lower: at.lower,
        };
        Self {
            case: case.to_owned(),
            joints: match joints {
                Joints::Sliding => "sliding",
                Joints::AtRest => "at rest",
            },
            guaranteed: found.map(|it| it.guaranteed),
            worst_hz: found.map(|it| it.worst_hz),
            bounds: found.map_or_else(Vec::new, |it| it.bounds.iter().map(bound).collect()),
            nearest: found.and_then(|it| it.found.as_ref()).map(NearestResult::from),
            left_out: found
                .map_or_else(Vec::new, |it| it.left_out.iter().map(|varied| varied.key()).collect()),
            dry_friction_at_rad_s: found.and_then(|it| it.dry_friction_at_rad_s),
            errors: found.map_or([0.0; 2], |it| it.errors),
        }
    }
}

impl From<&RegimeRobustness> for RobustnessResult {
    fn from(at: &RegimeRobustness) -> Self {
        Self::new(&at.case, at.joints, at.found.as_ref())
    }
}

impl From<&Destabilising> for NearestResult {
    fn from(found: &Destabilising) -> Self {
        let factor = |(varied, factor): &(counterpoise_verify::robust::Varied, f64)| FactorResult {
            key: varied.key(),
            factor: *factor,
        };
        Self {
            scale: found.scale,
            frequency_hz: found.frequency_hz,
            factors: found.factors.iter().map(factor).collect(),
            errors: found.errors.map(|error| [error.re, error.im]),
            pole: [found.pole.re, found.pole.im],
        }
    }
}

impl From<&Advice> for AdviceResult {
    fn from(advice: &Advice) -> Self {
        let change = advice.change.as_ref().map(|change| ChangeResult {
            weight: change.key,
            factor: change.factor,
            value: change.value,
            gain_margin_change_db: change.gain_margin_db,
            holds: change.holds,
        });
        let sensitivity =
            |&(weight, per_factor_e): &(&'static str, f64)| SensitivityResult { weight, per_factor_e };
        Self {
            figure: advice.requirement.figure.key(),
            value: advice.value,
            limit: advice.requirement.limit.value(),
            sensitivities: advice.sensitivities.iter().map(sensitivity).collect(),
            change,
        }
    }
}
