//! The controller on its targets: in double, single and fixed point side by side, and what a step costs.

use counterpoise_controller::sensitivity::RealisationForm;
use counterpoise_export::{FormFigures, Numbers, TargetFigures, Targets};
use counterpoise_models::ControlledQuantity;
use counterpoise_pipeline::design::TargetStudy;
use counterpoise_pipeline::export::PathForms;
use counterpoise_pipeline::export::target_proofs::{
    CodeAgreement, CompiledCodeTest, CoreCost, OperationCounts, StepCosts,
};
use counterpoise_verify::{Experiment, Source};

use crate::tolerance::COST_SHOWN_AS_ZERO_DB;
use crate::wording::capitalise_first;
use crate::{ReportCell, ReportColumn, ReportSection, ReportTable};

/// Evidence on the targets that the section shows.
#[derive(Debug, Clone, Copy)]
pub struct TargetEvidence<'a> {
    /// The controller in every kind of numbers.
    pub study: &'a TargetStudy,
    /// The compiled code, compared with its model.
    pub proofs: &'a [CompiledCodeTest],
    /// Instructions and memory.
    pub costs: &'a StepCosts,
    /// Quantity that the loop controls.
    pub controlled: ControlledQuantity,
}

/// Returns the section of a report that sets the targets side by side.
pub fn targets_section(evidence: &TargetEvidence<'_>) -> ReportSection {
    let about = "Every code below was generated, compiled and given all readings of its own closed loops on the nonlinear plant. \
                 Where it answers as its model to the last bit, it moves the plant as its model does, sample by sample. What \
                 small numbers cost is against double; for heave, pitch and road it is what the rejection ratio loses.";
    let section = ReportSection::new("On the target").with_text(about).with_table(loops(evidence));
    let section = match &evidence.study.compared.fixed {
        Ok(_) => section,
        Err(why) => section.with_text(format!("There is no fixed-point form: {why}.")),
    };
    let section =
        section.with_table(proof_table(evidence.proofs)).with_table(deviations(&evidence.study.compared));
    let section = section
        .with_text(ROUNDING)
        .with_table(form_table(&evidence.study.forms))
        .with_table(by_form(&evidence.study.by_form))
        .with_text(work(evidence.study.operations));
    let costs = evidence.costs;
    let section = if costs.counted.is_empty() { section } else { section.with_table(cost_table(costs)) };
    match &costs.remark {
        Some(remark) => section.with_text(format!("Instructions, flash and stack: {remark}.")),
        None => section,
    }
}

/// The meaning of the predictions of rounding.
const ROUNDING: &str = "Predicted: what every operation rounds is carried on by the derivatives of each step as it ran, estimators, \
                        observers and limits included; a sample exceeds it with a probability of 3e-8. Worst case: every rounding \
                        of a run goes the same way, with every number at the end of its range and the limiter inactive; a bound \
                        where the step is linear, a measure where an estimator or a friction observer bends it.";

fn work(operations: OperationCounts) -> String {
    let OperationCounts { multiplications, additions, states } = operations;
    let needed = operations.instructions_by_hand();
    format!(
        "One step takes {multiplications} multiplications and {additions} additions on {states} states, without a loop; only \
         limits branch, so the largest count is the worst case within a few instructions. By hand a step in single precision \
         needs about {needed} instructions: a product and the load of its coefficient, a sum, a load and a store of each state."
    )
}

/// Returns the closed loop in each experiment, a column for each code.
fn loops(evidence: &TargetEvidence<'_>) -> ReportTable {
    let mut columns = vec![ReportColumn::Text("experiment")];
    for (figures, proof) in codes(evidence) {
        columns.push(ReportColumn::Number(code_unit(proof, evidence.controlled)));
        if !proof.rust && figures.numbers != Numbers::Double {
            columns.push(ReportColumn::Number(if figures.numbers == Numbers::Single {
                "single costs [dB]"
            } else {
                "fixed costs [dB]"
            }));
        }
    }
    let mut table = ReportTable::new(&caption(evidence.controlled), &columns);
    let experiments = evidence.study.compared.figures.first().map_or(0, |figures| figures.experiments.len());
    table.rows = (0..experiments).map(|i| loop_row(evidence, i)).collect();
    table
}

/// Returns each code with the figures of its numbers.
fn codes<'a>(evidence: &TargetEvidence<'a>) -> Vec<(&'a TargetFigures, &'a CompiledCodeTest)> {
    let figures = |proof: &CompiledCodeTest| {
        evidence.study.compared.figures.iter().find(|f| f.numbers == proof.numbers)
    };
    evidence.proofs.iter().filter_map(|proof| Some((figures(proof)?, proof))).collect()
}

fn code_name(proof: &CompiledCodeTest) -> &'static str {
    match (proof.rust, proof.numbers) {
        (false, Numbers::Double) => "C, double",
        (false, Numbers::Single) => "C, single",
        (false, Numbers::Fixed) => "C, 32-bit fixed point",
        (true, Numbers::Single) => "Rust, single",
        (true, _) => "Rust, double",
    }
}

/// Returns the caption of the table of errors; it has the unit where the columns' heads do not.
fn caption(controlled: ControlledQuantity) -> String {
    let unit = match controlled == ControlledQuantity::RATE {
        true => String::new(),
        false => format!(" [{}]", controlled.unit()),
    };
    let name = capitalise_first(controlled.name());
    format!("{name} error RMS{unit} of the closed loop with the exported code, nonlinear plant")
}

fn code_unit(proof: &CompiledCodeTest, controlled: ControlledQuantity) -> &'static str {
    if controlled != ControlledQuantity::RATE {
        return code_name(proof);
    }
    match (proof.rust, proof.numbers) {
        (false, Numbers::Double) => "C double [rad/s]",
        (false, Numbers::Single) => "C single [rad/s]",
        (false, Numbers::Fixed) => "C fixed [rad/s]",
        (true, Numbers::Single) => "Rust single [rad/s]",
        (true, _) => "Rust double [rad/s]",
    }
}

fn loop_row(evidence: &TargetEvidence<'_>, i: usize) -> Vec<ReportCell> {
    let mut cells = Vec::new();
    for (figures, proof) in codes(evidence) {
        let Some(each) = figures.experiments.get(i) else { continue };
        if cells.is_empty() {
            cells.push(ReportCell::text(experiment(each.experiment)));
        }
        cells.push(match proof.answered {
            CodeAgreement::Alike { .. } => ReportCell::text(format!("{:.4e}", each.error_rms_rad_s)),
            CodeAgreement::Otherwise { .. } => ReportCell::text("differs"),
            CodeAgreement::NotRun(_) => ReportCell::text("not run"),
        });
        if !proof.rust && figures.numbers != Numbers::Double {
            let cost = match each.cost_db {
                None => "\u{2013}".to_owned(),
                Some(cost) if cost.abs() < COST_SHOWN_AS_ZERO_DB => "0.000".to_owned(),
                Some(cost) => format!("{cost:+.3}"),
            };
            cells.push(ReportCell::text(cost));
        }
    }
    cells
}

fn proof_table(proofs: &[CompiledCodeTest]) -> ReportTable {
    let columns = [
        ReportColumn::Text("code"),
        ReportColumn::Text("compiled and run on this machine, compared with its model"),
    ];
    let mut table = ReportTable::new(
        "Compiled code compared with its model, for all readings of its closed loops",
        &columns,
    );
    let said = |answered: &CodeAgreement| match answered {
        CodeAgreement::Alike { samples } => format!("{samples} samples equal to the last bit"),
        CodeAgreement::Otherwise { samples, wrong } => format!("{wrong} of {samples} samples DIFFER"),
        CodeAgreement::NotRun(why) => format!("not run: {why}"),
    };
    let row = |proof: &CompiledCodeTest| {
        vec![ReportCell::text(code_name(proof)), ReportCell::text(said(&proof.answered))]
    };
    table.rows = proofs.iter().map(row).collect();
    table
}

fn form_table(forms: &[PathForms]) -> ReportTable {
    let columns = [
        ReportColumn::Text("path"),
        ReportColumn::Text("form"),
        ReportColumn::Number("coefficients"),
        ReportColumn::Number("error predicted [1]"),
        ReportColumn::Number("error measured [1]"),
        ReportColumn::Text(""),
    ];
    let title = "Realisation: error of each path's frequency response with coefficients in single precision";
    let mut table = ReportTable::new(title, &columns);
    for each in forms {
        for candidate in &each.candidates {
            let name =
                if candidate.form == RealisationForm::Balanced { "balanced" } else { "modal sections" };
            table.rows.push(vec![
                ReportCell::text(each.path.as_str()),
                ReportCell::text(name),
                ReportCell::text(candidate.coefficients.to_string()),
                ReportCell::text(format!("{:.1e}", candidate.predicted)),
                ReportCell::text(format!("{:.1e}", candidate.measured)),
                ReportCell::text(if candidate.form == each.chosen { "in use" } else { "" }),
            ]);
        }
    }
    table
}

/// Returns the controller with every path in each form.
fn by_form(figures: &[FormFigures]) -> ReportTable {
    let columns = [
        ReportColumn::Text("every path"),
        ReportColumn::Number("multiplications"),
        ReportColumn::Number("in double, largest [V]"),
        ReportColumn::Number("in single, largest [V]"),
        ReportColumn::Number("in single, RMS [V]"),
    ];
    let title = "Control of the C against the reference with the paths in each form, for the same readings";
    let mut table = ReportTable::new(title, &columns);
    let volts = |value: f64| match value {
        0.0 => "0".to_owned(),
        value if value.is_finite() => format!("{value:.1e}"),
        _ => "leaves all range".to_owned(),
    };
    let row = |each: &FormFigures| {
        let values = [each.double.largest_v, each.single.largest_v, each.single.rms_v];
        let first = [each.form.name().to_owned(), each.multiplications.to_string()];
        first.into_iter().chain(values.map(volts)).map(ReportCell::text).collect()
    };
    table.rows = figures.iter().map(row).collect();
    table
}

/// Returns how far the control is from the reference for the same readings.
fn deviations(targets: &Targets) -> ReportTable {
    let columns = [
        ReportColumn::Text("numbers"),
        ReportColumn::Number("largest, measured [V]"),
        ReportColumn::Number("largest, predicted [V]"),
        ReportColumn::Number("worst case [V]"),
        ReportColumn::Number("RMS, measured [V]"),
        ReportColumn::Number("RMS, predicted [V]"),
    ];
    let title = "Control against the reference for the same readings, at every setting of the out-of-balance where a gain bends";
    let mut table = ReportTable::new(title, &columns);
    table.rows = targets.figures.iter().map(deviation_row).collect();
    table
}

fn deviation_row(figures: &TargetFigures) -> Vec<ReportCell> {
    let predicted = &figures.predicted;
    let volts =
        |value: f64| ReportCell::text(if value == 0.0 { "0".to_owned() } else { format!("{value:.1e}") });
    vec![
        ReportCell::text(numbers(figures.numbers)),
        volts(figures.measured_v),
        volts(predicted.likely_v),
        volts(predicted.worst_v),
        volts(figures.measured_rms_v),
        volts(predicted.rms_v),
    ]
}

fn cost_table(costs: &StepCosts) -> ReportTable {
    let columns = [
        ReportColumn::Text("core"),
        ReportColumn::Text("numbers"),
        ReportColumn::Number("step, at most [instructions]"),
        ReportColumn::Number("set out-of-balance [instructions]"),
        ReportColumn::Number("flash [bytes]"),
        ReportColumn::Number("state in RAM [bytes]"),
        ReportColumn::Number("stack [bytes]"),
    ];
    let title =
        "Cost on a Cortex-M, counted in QEMU; code compiled with gcc -O2; without the compiler's own library";
    let mut table = ReportTable::new(title, &columns);
    table.rows = costs.counted.iter().map(cost_row).collect();
    table
}

fn cost_row(each: &CoreCost) -> Vec<ReportCell> {
    let c = &each.cost;
    let counts = [c.step_instructions, c.set_instructions, c.flash_bytes, c.state_bytes, c.stack_bytes];
    let names = [each.core, numbers(each.numbers)].map(ReportCell::text);
    names.into_iter().chain(counts.map(|count| ReportCell::text(count.to_string()))).collect()
}

fn numbers(numbers: Numbers) -> &'static str {
    match numbers {
        Numbers::Double => "double",
        Numbers::Single => "single",
        Numbers::Fixed => "32-bit fixed point",
    }
}

fn experiment(experiment: Experiment) -> &'static str {
    match experiment {
        Experiment::Step => "step of the demand",
        Experiment::Triangle => "triangle of the demand",
        Experiment::Rest => "rest",
        Experiment::Disturbance(Source::Heave, _) => "heave",
        Experiment::Disturbance(Source::Pitch, _) => "pitch",
        Experiment::Disturbance(Source::Both, _) => "heave and pitch",
        Experiment::Disturbance(Source::Road, _) => "road",
    }
}
