//! The diagnosis of a structure in words: what was tried, and what the model lacks. Its JSON result carries them.

use crate::recordings::structure_hypotheses::{Change, End, Hypothesis, Scale, TriedStructure};
use counterpoise_diagnose::findings::answer::DiagnosisVerdict;

/// Name of the fitted mass at an end of the beam.
pub(crate) const MASS: &str = "mass [kg]";
/// Name of the fitted factor on the stiffness of the whole beam.
pub(crate) const STIFFNESS_FACTOR: &str = "factor on Young's modulus";

/// Describes a hypothesis.
pub(crate) fn describe_hypothesis(hypothesis: Hypothesis) -> String {
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

/// Describes what a structure's model lacks; `chosen` is the hypothesis that explains the modes, if there is one.
pub(crate) fn describe_structure(
    verdict: DiagnosisVerdict,
    as_it_is: &TriedStructure,
    chosen: Option<&TriedStructure>,
) -> String {
    let before = as_it_is.left_out_percent;
    match (verdict, chosen) {
        (DiagnosisVerdict::Consistent, _) => {
            format!("the model has the measured modes within {before:.2} % RMS")
        }
        (_, Some(found)) => format!(
            "the model lacks {}: with it, held-out modes are off by {:.2} % RMS, without it by {before:.2} %",
            found.what, found.left_out_percent
        ),
        _ => format!("the modes are off by {before:.2} % RMS, and nothing that was tried explains that"),
    }
}
