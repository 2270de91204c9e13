//! `counterpoise model`: the plant, its poles, the modes of its structure, and pictures of both and of its friction.

use clap::Args;
use counterpoise_pipeline::studies::model::{ModelContents, SimulatorError, study_model};
use counterpoise_project::Purpose;
use counterpoise_report::model::model_report;
use counterpoise_report::terminal::model::model_lines;
use std::path::PathBuf;

use crate::exit::{CommandResult, ExitStatus};
use crate::options::ResultOutput;
use crate::output;
use counterpoise_host::interrupt;
use counterpoise_host::projects;
use counterpoise_host::workers::ProgressPool;

/// Arguments of `model`.
#[derive(Args)]
pub struct ModelOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// Write a report with mode shapes, friction characteristics and the simulator's own error to this HTML file
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// The destination of results.
    #[command(flatten)]
    pub results: ResultOutput,
}

/// Runs the command.
pub fn run(options: &ModelOptions) -> CommandResult {
    let loaded = projects::load_project(&options.project, Purpose::Model)?;
    output::print_warnings(&loaded, options.results.progress());
    let pool = ProgressPool::new(options.results.progress());
    let watch = interrupt::watch_interrupts();
    let simulator_error = match options.report {
        Some(_) => SimulatorError::Measured,
        None => SimulatorError::LeftOut,
    };
    let contents = ModelContents {
        assumptions: &loaded.assumptions,
        systems: options.results.loop_systems(),
        simulator_error,
    };
    let study = study_model(&loaded.project, contents, &pool);
    drop(watch);
    pool.finish();
    let study = study?;
    if let Some(path) = &options.report {
        let command = format!("counterpoise model {} --report {}", options.project.display(), path.display());
        output::write_report(path, &options.results, &model_report(&study, &command))?;
    }
    if !output::write_result(&options.results, &study.result)? {
        output::print_lines(&model_lines(&study));
    }
    Ok(ExitStatus::SUCCESS)
}
