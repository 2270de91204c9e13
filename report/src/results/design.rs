//! A whole design as a result file has it.

use counterpoise_pipeline::CompletedDesign;
use counterpoise_pipeline::certificates::Certificate;
use counterpoise_pipeline::exchange::{SCHEMA, TargetsResult};
use counterpoise_pipeline::results::{AdviceResult, DesignResult, ModelResult, ReduceResult};
use serde::Serialize;

use super::comparison::ComparisonText;
use super::synthesis::{SynthText, describe_reduction};
use super::verification::{VerifiedAxes, VerifyText};
use crate::wording::certificates::describe_certified_quantity;
use crate::wording::weights::describe_weights;

/// A number that certifies a design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DesignCertificateText {
    /// The quantity that was computed.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// `true` if it is within its limit.
    pub holds: bool,
}

/// A verification with what to change.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AdvisedVerification {
    /// The verification.
    #[serde(flatten)]
    pub result: VerifyText,
    /// The changes that meet a requirement that fails.
    pub advice: Vec<AdviceResult>,
}

/// A whole design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DesignText {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// The plant.
    pub model: ModelResult,
    /// The reduction.
    pub reduce: ReduceResult<String>,
    /// The design.
    pub synth: SynthText,
    /// The verification.
    pub verify: AdvisedVerification,
    /// The demand of each weight, in words.
    pub weights_in_words: Vec<String>,
    /// Residuals, costs and poles that certify the design.
    pub certificates: Vec<DesignCertificateText>,
    /// The design beside its alternatives.
    pub beside: ComparisonText,
    /// The controller in every kind of numbers.
    pub targets: TargetsResult,
    /// Names of the files of code.
    pub files: Vec<String>,
    /// Code that the project asks for and cannot have, with the reason.
    pub left_out: Vec<String>,
}

impl DesignText {
    /// Returns the result of a design in words.
    pub fn new(designed: &CompletedDesign, result: DesignResult) -> Self {
        let made = &designed.stages;
        let axes = VerifiedAxes { own: made.verified.verification(), both: designed.two_axes.as_ref() };
        Self {
            schema: SCHEMA,
            model: result.model,
            reduce: describe_reduction(result.reduce),
            synth: result.synth.into(),
            verify: AdvisedVerification {
                result: VerifyText::new(axes, result.verify),
                advice: designed.advice.iter().map(Into::into).collect(),
            },
            weights_in_words: describe_weights(&designed.asked),
            certificates: designed.certificates.iter().map(describe_certificate).collect(),
            beside: (&designed.comparison).into(),
            targets: result.targets,
            files: made.files.iter().map(|file| file.name.clone()).collect(),
            left_out: made.all_left_out().map(ToString::to_string).collect(),
        }
    }
}

fn describe_certificate(found: &Certificate) -> DesignCertificateText {
    let name = describe_certified_quantity(found.quantity);
    DesignCertificateText { name, value: found.value, holds: found.holds }
}
