//! The diagnosis of a structure from its natural frequencies, in words: how it was supported, what was tried, and what the model lacks.

use counterpoise_diagnose::findings::answer::DiagnosisVerdict;
use counterpoise_models::structure::Support;
use counterpoise_pipeline::recordings::measured_modes::StructureAnswer;
use counterpoise_pipeline::recordings::structure_hypotheses::{
    Change, End, FittedParameter, FittedStructureValue, Hypothesis, Scale,
};

/// Describes how the structure was supported when its modes were measured.
pub fn describe_support(support: Support) -> &'static str {
    match support {
        Support::Free => "free",
        Support::Pinned => "pinned at its hub",
        Support::Clamped => "clamped at its hub",
    }
}

/// Returns the name of a fitted number, with its unit.
pub fn name_parameter(parameter: FittedParameter) -> &'static str {
    match parameter {
        FittedParameter::Mass => "mass [kg]",
        FittedParameter::StiffnessFactor => "factor on Young's modulus",
    }
}

/// Describes a fitted number.
pub fn describe_fitted(fitted: &FittedStructureValue) -> String {
    format!("{} {:.4}", name_parameter(fitted.parameter), fitted.value)
}

/// Describes a hypothesis.
pub fn describe_hypothesis(hypothesis: Hypothesis) -> String {
    let change = match hypothesis.change {
        Change::Nothing => "the model as it is",
        Change::Mesh => "more elements",
        Change::Shear => "shear and rotary inertia",
        Change::EndMass(End::Near) => "a mass at the near end",
        Change::EndMass(End::Tip) => "a mass at the tip",
    };
    match (hypothesis.change, hypothesis.scaled) {
        (_, Scale::AsItIs) => change.to_owned(),
        (Change::Nothing, Scale::Fitted) => "another stiffness of the whole beam".to_owned(),
        (_, Scale::Fitted) => format!("{change}, and another stiffness of the whole beam"),
    }
}

/// Describes what a structure's model lacks.
pub fn describe_structure(answer: &StructureAnswer) -> String {
    let before = answer.tried.first().map_or(f64::NAN, |as_it_is| as_it_is.left_out_percent);
    match (answer.verdict, &answer.chosen) {
        (DiagnosisVerdict::Consistent, _) => {
            format!("the model has the measured modes within {before:.2} % RMS")
        }
        (_, Some(found)) => format!(
            "the model lacks {}: with it, held-out modes are off by {:.2} % RMS, without it by {before:.2} %",
            describe_hypothesis(found.hypothesis),
            found.left_out_percent
        ),
        _ => format!("the modes are off by {before:.2} % RMS, and nothing that was tried explains that"),
    }
}
