//! `counterpoise adapt`: the adaptation put to the test in the nonlinear closed loop.

use counterpoise_pipeline::studies::adapt::{AdaptationInterval, AdaptedIntervals};
use counterpoise_pipeline::studies::adaptation::study_adaptation;
use counterpoise_project::Purpose;
use counterpoise_project::resolve::synthesis_options::AdaptationUse;

use std::path::PathBuf;

use clap::Args;
use counterpoise_report::adaptation::{self, adaptation_report};
use counterpoise_report::results::AdaptText;
use counterpoise_report::terminal::adaptation::adaptation_lines;

use crate::exit::{CommandResult, verdict_code};
use crate::options::{CommandOutputs, WRITTEN};
use crate::output::{self, say};
use counterpoise_host::projects::{self, ProjectWorld};

/// Arguments of `adapt`.
#[derive(Args)]
pub struct AdaptOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// With --json or --data: also the hub rate in every run, from which the figures can be recomputed (tens of megabytes)
    #[arg(long, requires = WRITTEN)]
    pub histories: bool,
    /// The destinations of report and results.
    #[command(flatten)]
    pub outputs: CommandOutputs,
}

/// Runs the command.
pub fn run(options: &AdaptOptions) -> CommandResult {
    let loaded = projects::load_project(&options.project, Purpose::Verify)?;
    output::print_warnings(&loaded, options.outputs.results.progress());
    let world = ProjectWorld::of(&loaded, options.outputs.results.progress());
    let mut result = study_adaptation(&loaded.project, &world)?;
    if !options.histories {
        result.leave_histories_out();
    }
    let (runs, tried) = (&result.runs, &result.trials);
    let adapted = AdaptedIntervals::of(runs);
    if let Some(path) = &options.outputs.report {
        let command = format!("counterpoise adapt {}", options.project.display());
        let name = &loaded.project.plant.name;
        let page = adaptation_report(name, &command, runs, adapted);
        output::write_report(path, &options.outputs.results, &page)?;
    }
    if !output::write_result(&options.outputs.results, &AdaptText::from(&result))? {
        output::print_lines(&adaptation_lines(runs, adapted));
        adaptation::trial_lines(tried).iter().for_each(|line| say!("{line}"));
        options.outputs.report.iter().for_each(|path| say!("report  {}", path.display()));
    }
    let own = loaded.project.synth.as_ref().and_then(|synth| synth.options.adaptation.as_ref());
    let refused =
        own.is_some_and(|own| own.use_in_code == AdaptationUse::Exported && tried.refuses(own.method));
    Ok(verdict_code(
        runs.iter().flat_map(|run| &run.intervals).map(AdaptationInterval::has_returned).chain([!refused]),
    ))
}
