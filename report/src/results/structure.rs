//! The diagnosis of a structure as a result file has it.

use counterpoise_diagnose::findings::answer::DiagnosisVerdict;
use counterpoise_pipeline::recordings::measured_modes::StructureAnswer;
use counterpoise_pipeline::recordings::structure_hypotheses::TriedStructure;
use serde::Serialize;

use crate::wording::structure::{describe_hypothesis, describe_structure, name_parameter};

/// The answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StructureText {
    /// Verdict.
    pub verdict: DiagnosisVerdict,
    /// What was left out, how large it is.
    pub explanation: String,
    /// Measured frequencies, Hz.
    pub measured_hz: Vec<f64>,
    /// Frequencies of the model as it is, Hz.
    pub model_hz: Vec<f64>,
    /// Trials; the first one is the model as it is, the others best first.
    pub tried: Vec<TriedStructureText>,
    /// Others that explain the modes as well as the one that is named.
    pub alternatives: Vec<String>,
}

/// A hypothesis that was tried.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TriedStructureText {
    /// Description of the trial.
    pub what: String,
    /// Fitted numbers with their names.
    pub parameters: Vec<(&'static str, f64)>,
    /// RMS relative error of all modes, %.
    pub rms_percent: f64,
    /// RMS relative error of modes that were left out of the fit, one after the other, %.
    pub left_out_percent: f64,
    /// Frequencies of the fitted model, Hz.
    pub modes_hz: Vec<f64>,
}

impl From<&StructureAnswer> for StructureText {
    fn from(answer: &StructureAnswer) -> Self {
        Self {
            verdict: answer.verdict,
            explanation: describe_structure(answer),
            measured_hz: answer.measured_hz.clone(),
            model_hz: answer.model_hz.clone(),
            tried: answer.tried.iter().map(TriedStructureText::from).collect(),
            alternatives: answer.alternatives.iter().map(|other| describe_hypothesis(*other)).collect(),
        }
    }
}

impl From<&TriedStructure> for TriedStructureText {
    fn from(tried: &TriedStructure) -> Self {
        let named = tried.parameters.iter().map(|one| (name_parameter(one.parameter), one.value));
        Self {
            what: describe_hypothesis(tried.hypothesis),
            parameters: named.collect(),
            rms_percent: tried.rms_percent,
            left_out_percent: tried.left_out_percent,
            modes_hz: tried.modes_hz.clone(),
        }
    }
}
