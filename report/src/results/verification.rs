//! A verification as a result file has it: figures and verdicts with how each is judged.

use counterpoise_pipeline::TwoAxisStudy;
use counterpoise_pipeline::exchange::SCHEMA;
use counterpoise_pipeline::results::{
    JointResult, TwoAxesResult, VerificationData, VerificationStudies, VerifyResult,
};
use counterpoise_verify::{MeasuredFigure, Requirement, Value, Verdict, Verification};
use serde::Serialize;

use crate::wording::acceptance::AcceptanceSource;
use crate::wording::figures::describe_unmeasured;

/// A figure with its value.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FigureText {
    /// Key, as in a project file.
    pub figure: String,
    /// Value; `None` if it could not be measured.
    pub value: Option<f64>,
    /// Unit.
    pub unit: &'static str,
    /// The basis: linear, or nonlinear with its amplitude.
    pub basis: String,
}

/// A requirement with its verdict.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RequirementVerdictText {
    /// Key of the figure.
    pub figure: String,
    /// The basis of the figure: linear, or nonlinear with its amplitude.
    pub basis: String,
    /// `holds`, `fails` or `not applicable`.
    pub verdict: &'static str,
    /// Value.
    pub value: Option<f64>,
    /// Limit.
    pub limit: Option<f64>,
    /// `at least` or `at most`.
    pub limit_side: &'static str,
    /// Why it is not applicable.
    pub why: Option<String>,
    /// The origin of the requirement, as the project file states it; empty if it does not.
    pub source: String,
    /// The run that judged it.
    pub judged_by: String,
    /// The test on the machine that would.
    pub acceptance_test: String,
}

/// The verification.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VerifyText {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// `true` if no requirement fails and the loop is stable.
    pub passes: bool,
    /// Verdicts, in the order of the project file.
    pub verdicts: Vec<RequirementVerdictText>,
    /// Every figure.
    pub figures: Vec<FigureText>,
    /// The studies beside the figures.
    #[serde(flatten)]
    pub studies: VerificationStudies,
    /// The traverse axis alone, and both axes together; absent if the project has no traverse axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub two_axes: Option<TwoAxesText>,
    /// The data of the figures.
    #[serde(flatten)]
    pub data: VerificationData,
}

/// The traverse axis alone, and both axes together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TwoAxesText {
    /// Name of the traverse axis' machine.
    pub name: String,
    /// `true` if no requirement of the traverse axis or of both axes fails.
    pub passes: bool,
    /// The verification of the traverse axis alone.
    pub traverse: Box<VerifyText>,
    /// Both axes together.
    #[serde(flatten)]
    pub joint: JointResult,
}

/// The verifications that a result is about.
#[derive(Debug, Clone, Copy)]
pub struct VerifiedAxes<'a> {
    /// That of the project's own axis.
    pub own: &'a Verification,
    /// That of the traverse axis, and of both together; `None` if there is none.
    pub both: Option<&'a TwoAxisStudy>,
}

impl VerifyText {
    /// Returns the result of verifications in words.
    pub fn new(found: VerifiedAxes<'_>, result: VerifyResult) -> Self {
        let two_axes = result.two_axes.zip(found.both).map(|(both, study)| TwoAxesText::new(study, both));
        Self {
            schema: SCHEMA,
            passes: result.passes,
            verdicts: found
                .own
                .verdicts
                .iter()
                .map(|(requirement, verdict)| describe_verdict(found.own, requirement, verdict))
                .collect(),
            figures: found.own.figures.iter().map(|figure| describe_measured(found.own, figure)).collect(),
            studies: result.studies,
            two_axes,
            data: result.data,
        }
    }
}

impl TwoAxesText {
    fn new(study: &TwoAxisStudy, result: TwoAxesResult) -> Self {
        let axis = VerifiedAxes { own: study.traverse.verified.verification(), both: None };
        Self {
            name: result.name,
            passes: result.passes,
            traverse: Box::new(VerifyText::new(axis, *result.traverse)),
            joint: result.joint,
        }
    }
}

fn describe_measured(found: &Verification, measured: &MeasuredFigure) -> FigureText {
    let controlled = found.controlled_quantity();
    FigureText {
        figure: measured.figure.key_in(controlled),
        value: match measured.value {
            Value::Is(value) => Some(value),
            Value::Absent { .. } => None,
        },
        unit: measured.figure.unit(controlled),
        basis: found.acceptance(&measured.figure).basis,
    }
}

fn describe_verdict(
    found: &Verification,
    requirement: &Requirement,
    verdict: &Verdict,
) -> RequirementVerdictText {
    let acceptance = found.acceptance(&requirement.figure);
    let (verdict, value, limit, why) = match verdict {
        Verdict::Holds { value, limit, .. } => ("holds", Some(*value), Some(limit.value()), None),
        Verdict::Fails { value, limit, .. } => ("fails", Some(*value), Some(limit.value()), None),
        Verdict::NotApplicable { why } => ("not applicable", None, None, Some(describe_unmeasured(why))),
    };
    RequirementVerdictText {
        figure: requirement.figure.key_in(found.controlled_quantity()),
        basis: acceptance.basis,
        verdict,
        value,
        limit,
        limit_side: requirement.limit.side(),
        why,
        source: requirement.source.clone(),
        judged_by: acceptance.judged_by,
        acceptance_test: acceptance.test,
    }
}
