//! What `counterpoise diagnose` prints of a structure without recordings: measured natural frequencies beside those of the model, and what was tried.

use counterpoise_diagnose::findings::answer::DiagnosisVerdict;
use counterpoise_pipeline::recordings::measured_modes::StructureAnswer;
use counterpoise_project::resolve::measured_modes::MeasuredModes;

use super::add_line;
use crate::wording::answer::describe_verdict;
use crate::wording::structure::{describe_fitted, describe_hypothesis, describe_structure, describe_support};

/// Returns the lines on the diagnosis of a structure.
pub fn structure_lines(measured: &MeasuredModes, answer: &StructureAnswer) -> Vec<String> {
    let mut lines = vec![format!(
        "{} natural frequencies, structure {}",
        measured.modes_hz.len(),
        describe_support(measured.support)
    )];
    let named = answer.verdict != DiagnosisVerdict::Consistent;
    let best = answer.tried.get(1).filter(|_| named);
    add_line!(lines, "{}: {}", describe_verdict(answer.verdict).name, describe_structure(answer));
    let head = best.map_or(String::new(), |t| format!("with {}", describe_hypothesis(t.hypothesis)));
    add_line!(lines, "  {:>4} {:>12} {:>12} {:>8}   {head}", "mode", "measured Hz", "model Hz", "error %");
    let off = &answer.model_errors_percent;
    for (k, measured) in answer.measured_hz.iter().enumerate() {
        let model = answer.model_hz[k];
        let improved =
            best.map_or(String::new(), |t| format!("{:12.3} {:+8.2}", t.modes_hz[k], t.errors_percent[k]));
        add_line!(lines, "  {:>4} {measured:12.3} {model:12.3} {:+8.2}   {improved}", k + 1, off[k]);
    }
    add_line!(lines);
    add_line!(lines, "  {:<64} {:>10} {:>14}", "tried", "RMS %", "held out %");
    for t in &answer.tried {
        let numbers: Vec<String> = t.parameters.iter().map(describe_fitted).collect();
        let what = describe_hypothesis(t.hypothesis);
        add_line!(
            lines,
            "  {what:<64} {:10.2} {:14.2}  {}",
            t.rms_percent,
            t.left_out_percent,
            numbers.join(", ")
        );
    }
    answer
        .alternatives
        .iter()
        .for_each(|other| add_line!(lines, "  cannot be distinguished from {}", describe_hypothesis(*other)));
    lines
}
