//! `counterpoise diagnose` without recordings: what the structure's model lacks, from measured natural frequencies.

use anyhow::bail;
use counterpoise_diagnose::findings::answer::DiagnosisVerdict;
use counterpoise_pipeline::recordings::measured_modes::{StructureAnswer, diagnose_structure};
use counterpoise_report::results::StructureText;
use counterpoise_report::structure::structure_report;
use counterpoise_report::wording::answer::describe_verdict;
use counterpoise_report::wording::structure::{
    describe_fitted, describe_hypothesis, describe_structure, describe_support,
};

use crate::exit::{CommandResult, ExitStatus};
use crate::options::DiagnoseOptions;
use crate::output::{self, say};
use counterpoise_host::projects::{self, ProjectOnDisk};

/// Runs the command on a project with measured modes.
pub fn run(loaded: &ProjectOnDisk, options: &DiagnoseOptions) -> CommandResult {
    let Some(measured) = &loaded.project.measured else {
        bail!(
            "no recording to diagnose, and {} has no [measured] section: name recordings, or give the natural frequencies of the \
             structure as measured.modes",
            loaded.path.display()
        );
    };
    let found = diagnose_structure(&loaded.project, measured)?;
    if let Some(path) = &options.save {
        let document = found.improved.update(&loaded.document, &loaded.project)?;
        projects::write_file(path, document.text().as_bytes())?;
    }
    if let Some(path) = &options.outputs.report {
        let command = format!("counterpoise diagnose {}", loaded.path.display());
        let page = structure_report(&loaded.project.plant.name, &command, &found.answer);
        output::write_report(path, &options.outputs.results, &page)?;
    }
    if !output::write_result(&options.outputs.results, &StructureText::from(&found.answer))? {
        say!(
            "{} natural frequencies, structure {}",
            measured.modes_hz.len(),
            describe_support(measured.support)
        );
        print(&found.answer);
    }
    Ok(ExitStatus::SUCCESS)
}

fn print(answer: &StructureAnswer) {
    let named = answer.verdict != DiagnosisVerdict::Consistent;
    let best = answer.tried.get(1).filter(|_| named);
    say!("{}: {}", describe_verdict(answer.verdict).name, describe_structure(answer));
    let head = best.map_or(String::new(), |t| format!("with {}", describe_hypothesis(t.hypothesis)));
    say!("  {:>4} {:>12} {:>12} {:>8}   {head}", "mode", "measured Hz", "model Hz", "error %");
    let off = &answer.model_errors_percent;
    for (k, measured) in answer.measured_hz.iter().enumerate() {
        let model = answer.model_hz[k];
        let improved =
            best.map_or(String::new(), |t| format!("{:12.3} {:+8.2}", t.modes_hz[k], t.errors_percent[k]));
        say!("  {:>4} {measured:12.3} {model:12.3} {:+8.2}   {improved}", k + 1, off[k]);
    }
    say!();
    say!("  {:<64} {:>10} {:>14}", "tried", "RMS %", "held out %");
    for t in &answer.tried {
        let numbers: Vec<String> = t.parameters.iter().map(describe_fitted).collect();
        let what = describe_hypothesis(t.hypothesis);
        say!("  {what:<64} {:10.2} {:14.2}  {}", t.rms_percent, t.left_out_percent, numbers.join(", "));
    }
    answer
        .alternatives
        .iter()
        .for_each(|other| say!("  cannot be distinguished from {}", describe_hypothesis(*other)));
}
