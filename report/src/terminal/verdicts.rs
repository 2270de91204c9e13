//! What commands print of a verification: its verdicts, and what compilers made of the code.

use counterpoise_pipeline::export::target_proofs::{CodeAgreement, CompiledCodeTest, StepCosts};
use counterpoise_verify::{Verdict, Verification};

use super::add_line;
use crate::summary;
use crate::wording::acceptance::AcceptanceSource;
use crate::wording::figures::{describe_figure, describe_unmeasured, format_figure};

/// Returns the verdicts, one a line, and their sum.
pub fn verdict_lines(found: &Verification) -> Vec<String> {
    let mut lines = Vec::new();
    add_verdicts(&mut lines, found);
    lines
}

fn add_verdicts(lines: &mut Vec<String>, found: &Verification) {
    for (requirement, verdict) in &found.verdicts {
        let name = describe_figure(requirement.figure, found.controlled_quantity());
        let unit = requirement.figure.unit(found.controlled_quantity());
        let basis = found.acceptance(&requirement.figure).basis;
        match verdict {
            Verdict::Holds { value, limit, .. } => {
                let (value, sign, limit) = (with_unit(*value, unit), limit.side(), limit.value());
                add_line!(lines, "  holds  {name}: {value} ({sign} {limit}; {basis})");
            }
            Verdict::Fails { value, limit, by } => {
                let by = format_figure(*by);
                add_line!(
                    lines,
                    "  FAILS  {name}: {} ({} {}; {basis}), by {by}",
                    with_unit(*value, unit),
                    limit.side(),
                    limit.value()
                );
            }
            Verdict::NotApplicable { why } => {
                add_line!(lines, "  -      {name}: not applicable, {}", describe_unmeasured(why))
            }
        }
    }
    let (holds, fails, open) = found.counts();
    if found.verdicts.is_empty() {
        add_line!(
            lines,
            "nothing was required: [[verify.requirement]] with `figure` and `at_least` or `at_most` states what the design must reach"
        );
    } else {
        add_line!(lines, "{holds} requirements hold, {fails} fail, {open} not applicable");
    }
    summary::not_quiet(found).iter().for_each(|line| add_line!(lines, "NOT quiet: {line}"));
}

fn with_unit(value: f64, unit: &str) -> String {
    let number = format_figure(value);
    if unit.is_empty() { number } else { format!("{number} {unit}") }
}

/// The answers of compilers and of the compiled code.
pub struct CompiledCode {
    /// Number of compiled codes that answer otherwise than their model.
    pub differing: usize,
    /// The notes for the user.
    pub said: Vec<String>,
}

/// Describes code that was compiled and run, or could not be.
pub fn describe_compiled_code(proofs: &[CompiledCodeTest], costs: &StepCosts) -> CompiledCode {
    let mut code = CompiledCode { differing: 0, said: Vec::new() };
    for proof in proofs {
        let language = if proof.rust { "Rust" } else { "C" };
        let numbers = proof.numbers.name();
        match &proof.answered {
            CodeAgreement::Alike { .. } => {}
            CodeAgreement::Otherwise { samples, wrong } => {
                code.differing += 1;
                code.said.push(format!(
                    "  FAILS  compiled {language} in {numbers} numbers: {wrong} of {samples} samples differ from its model; \
                     use another compiler, or report this with the compiler's version"
                ));
            }
            CodeAgreement::NotRun(why) => code.said.push(format!(
                "note: the {language} in {numbers} numbers was not compared with its model: {why}"
            )),
        }
    }
    code.said.extend(costs.remark.iter().map(|remark| format!("note: the cost on a Cortex-M: {remark}")));
    code
}
