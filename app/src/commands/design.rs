//! `counterpoise design`: the whole road, with its report and its code.

use crate::output::say;
use counterpoise_host::compilers::{processor, proofs};
use counterpoise_pipeline::export::target_proofs::Operations;
use counterpoise_pipeline::results::DesignResult;
use counterpoise_pipeline::{self as pipeline, Designed};
use counterpoise_project::Purpose;
use counterpoise_report::Section;
use counterpoise_report::targets::{self, Told};
use counterpoise_verify::{Limit, Verdict, Verification};

use super::pages::Run;
use super::{Done, export, pages, verdict_code};
use crate::arguments::DesignOptions;
use crate::output;
use counterpoise_host::projects::{self, Loaded, Surroundings};

/// Runs the command.
pub fn run(options: &DesignOptions) -> Done {
    let loaded = projects::load(&options.project, Purpose::Design)?;
    output::warnings(&loaded, options.results.quiet);
    let world = Surroundings::of(&loaded, options.results.quiet);
    let made = pipeline::design(&loaded.project, &world)?;
    let times = world.times();
    let command = format!("counterpoise design {}", options.project.display());
    let targets = on_target(&loaded, &made, &world)?;
    let page = pages::design(&loaded, &made, &Run { command, times, targets })?;
    export::write(&options.output, &made.files)?;
    projects::write(&options.output.join("report.html"), page.as_bytes())?;
    if !output::json(&options.results, &DesignResult::from(&made))? {
        print(options, &made);
    }
    Ok(verdict_code(made.verified.verification().passes() && made.left_out.is_empty()))
}

/// The controller in every kind of numbers, in the simulated loop and on a processor.
fn on_target(loaded: &Loaded, made: &Designed, world: &Surroundings) -> anyhow::Result<Section> {
    let compared = pipeline::export::compare(&loaded.project, &made.modelled, &made.verified, world)?;
    let code = pipeline::export::every_target(&loaded.project, &made.verified, &compared)?;
    let programs = made.verified.controller().programs();
    let operations = Operations {
        multiplications: programs.step.multiplications(),
        additions: programs.step.additions(),
        states: programs.state_count(),
    };
    Ok(targets::section(&Told {
        targets: &compared,
        proofs: &proofs::proofs(&code, &compared),
        operations,
        costs: &processor::costs(&code),
        forms: &pipeline::export::forms(&made.verified)?,
        by_form: &pipeline::export::by_form(&made.verified, &compared),
    }))
}

fn print(options: &DesignOptions, made: &Designed) {
    print_verdicts(made.verified.verification());
    say!();
    say!("report  {}", options.output.join("report.html").display());
    for file in &made.files {
        say!("code    {}", options.output.join(&file.name).display());
    }
    made.left_out.iter().for_each(|code| say!("left out  {code}"));
}

/// The verdicts, one a line, and their sum.
pub fn print_verdicts(found: &Verification) {
    for (requirement, verdict) in &found.verdicts {
        let name = requirement.figure.name();
        let unit = requirement.figure.unit();
        match verdict {
            Verdict::Holds { value, limit, .. } => {
                say!("  holds  {name}: {} ({} {})", with_unit(*value, unit), sign(*limit), limit.value());
            }
            Verdict::Fails { value, limit, by } => {
                let by = output::figure(*by);
                say!(
                    "  FAILS  {name}: {} ({} {}), by {by}",
                    with_unit(*value, unit),
                    sign(*limit),
                    limit.value()
                );
            }
            Verdict::NotApplicable { why } => say!("  -      {name}: not applicable, {why}"),
        }
    }
    let (holds, fails, open) = found.counts();
    say!("{holds} requirements hold, {fails} fail, {open} not applicable");
}

fn with_unit(value: f64, unit: &str) -> String {
    let number = output::figure(value);
    if unit.is_empty() { number } else { format!("{number} {unit}") }
}

fn sign(limit: Limit) -> &'static str {
    match limit {
        Limit::AtLeast(_) => "at least",
        Limit::AtMost(_) => "at most",
    }
}
