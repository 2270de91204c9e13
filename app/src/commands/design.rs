//! `counterpoise design`: every stage from the project file to code, with the report.

use std::path::PathBuf;

use crate::output::say;
use clap::Args;
use counterpoise_export::File;
use counterpoise_host::code_files;
use counterpoise_host::compilers::{processor, proofs};
use counterpoise_host::stages::StagePrinter;
use counterpoise_host::terminal::print_message;
use counterpoise_pipeline::exchange::ControllerResult;
use counterpoise_pipeline::results::DesignResult;
use counterpoise_pipeline::studies::advice::KeptDesigns;
use counterpoise_pipeline::{
    CompletedDesign, DesignContents, FirstDesignResult, TwoAxisStudy, design_project,
};
use counterpoise_project::Purpose;
use counterpoise_report::adaptation::{describe_action, describe_refusal};
use counterpoise_report::certificate;
use counterpoise_report::design::DesignRun;
use counterpoise_report::results::{DesignText, FirstDesignText};
use counterpoise_report::terminal::verdicts::{describe_compiled_code, verdict_lines};
use counterpoise_report::wording::certificates::total_cost_lines;
use counterpoise_report::wording::code_header::HeaderText;
use counterpoise_report::wording::tuned_pi::describe_tuned_pi;
use counterpoise_report::{ReportOrigin, advice, html_page, of_design, two_axes};
use serde::Serialize;

use super::{export, first_design};
use crate::exit::{CommandResult, verdict_code};
use crate::options::{ResultOutput, WRITTEN};
use crate::output;
use counterpoise_host::projects::{self, ProjectOnDisk, ProjectWorld};

/// Arguments of `design`.
#[derive(Args)]
pub struct DesignOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// Folder for report and code
    #[arg(short, long, default_value = "out")]
    pub output: PathBuf,
    /// With --json or --data: also the time histories of every experiment, from which the nonlinear figures can be recomputed (tens of megabytes)
    #[arg(long, requires = WRITTEN)]
    pub histories: bool,
    /// The destination of results.
    #[command(flatten)]
    pub results: ResultOutput,
}

/// The results for another program, and why the weights are what they are if they were chosen.
#[derive(Serialize)]
struct DesignOutput {
    #[serde(flatten)]
    design: DesignText,
    #[serde(skip_serializing_if = "Option::is_none")]
    first_design: Option<FirstDesignText>,
}

/// Runs the command.
pub fn run(options: &DesignOptions) -> CommandResult {
    let choice = StagePrinter::new(options.results.progress());
    choice.begins("weights");
    let loaded = projects::load_project(&options.project, Purpose::Design)?;
    let mut times = Vec::new();
    if loaded.first_design.is_some() || loaded.tuned.is_some() {
        choice.ends();
        times = choice.times();
    }
    output::print_warnings(&loaded, options.results.progress());
    let world = ProjectWorld::of(&loaded, options.results.progress());
    let designed = design_project(&loaded.project, &asked_contents(options, &loaded), &HeaderText, &world)?;
    let mut result = DesignResult::complete(&designed);
    let code = &designed.targets.code;
    let (proofs, costs) =
        (proofs::prove_code(code, &designed.targets.compared), processor::measure_costs(code));
    result.targets = result.targets.with_answers(&proofs, &costs);
    let compiled = describe_compiled_code(&proofs, &costs);
    let first_design = loaded.first_design.as_ref().map(FirstDesignResult::from);
    times.extend(world.times());
    let run = DesignRun {
        origin: &ReportOrigin {
            project: loaded.path.display().to_string(),
            command: format!("counterpoise design {}", options.project.display()),
        },
        times: &times,
        proofs: &proofs,
        costs: &costs,
        first_design: first_design.as_ref(),
    };
    let page = of_design(&designed, &result, &run);
    output::write_figures(&options.results, &page)?;
    let controller = ControllerResult::new(&designed.identity, designed.stages.verified.controller());
    let report = File { name: "report.html".to_owned(), text: html_page(&page) };
    code_files::write_with_controller(&options.output, &designed.stages.files, &controller, &[report])?;
    if let Some(traverse) = &designed.stages.traverse {
        export::write_traverse(&options.output, traverse)?;
    }
    let first_design = first_design.map(FirstDesignText::from);
    let whole = DesignOutput { design: DesignText::new(&designed, result), first_design };
    if !output::write_result(&options.results, &whole)? {
        first_design::print_first_design(&loaded);
        print(options, &designed);
        print_two_axes(&designed);
    }
    compiled.said.iter().for_each(|line| print_message(line));
    print_adaptation(&designed);
    let refused = designed.adaptation.iter().flat_map(|tried| &tried.refused);
    refused.clone().for_each(|why| print_message(&describe_refusal(why)));
    let made = &designed.stages;
    let holds = made.verified.verification().passes() && made.left_out.is_empty() && refused.count() == 0;
    let together = designed.two_axes.as_ref().is_none_or(TwoAxisStudy::passes);
    let traverse = made.traverse.as_ref().is_none_or(|axis| export::holds(axis));
    Ok(verdict_code([holds, compiled.differing == 0, together, traverse]))
}

/// Returns what is computed and kept of the design beside its figures.
fn asked_contents<'a>(options: &DesignOptions, loaded: &'a ProjectOnDisk) -> DesignContents<'a> {
    DesignContents {
        assumptions: &loaded.assumptions,
        systems: options.results.loop_systems(),
        kept: if options.histories { KeptDesigns::Histories } else { KeptDesigns::Systems },
    }
}

fn print_two_axes(designed: &CompletedDesign) {
    let both = designed.two_axes.iter().flat_map(two_axes::two_axes_lines);
    both.for_each(|line| say!("two axes: {line}"));
}

fn print_adaptation(designed: &CompletedDesign) {
    let action = designed.adaptation.iter().filter_map(describe_action);
    action.for_each(|action| print_message(&format!("adaptation: {action}")));
}

fn print(options: &DesignOptions, designed: &CompletedDesign) {
    let made = &designed.stages;
    output::print_lines(&verdict_lines(made.verified.verification()));
    advice::advice_lines(&designed.advice).iter().for_each(|line| say!("advice: {line}"));
    output::print_lines(&total_cost_lines(designed.comparison.total_cost.as_ref()));
    let tuned_pi = designed.comparison.tuned_pi.as_ref().and_then(describe_tuned_pi);
    tuned_pi.iter().for_each(|text| say!("advice: {text}"));
    certificate::certificate_lines(&made.stability).iter().for_each(|line| say!("stability: {line}"));
    say!();
    say!("report  {}", options.output.join("report.html").display());
    for file in &made.files {
        say!("code    {}", options.output.join(&file.name).display());
    }
    if let Some(traverse) = &made.traverse {
        let folder = options.output.join(export::TRAVERSE_FOLDER);
        traverse.files.iter().for_each(|file| say!("code    {}", folder.join(&file.name).display()));
    }
    made.all_left_out().for_each(|code| say!("left out  {code}"));
}
