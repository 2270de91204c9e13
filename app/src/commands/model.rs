//! `counterpoise model`: the plant, its poles, the modes of its structure, and pictures of both and of its friction.

use anyhow::Result;
use clap::Args;
use counterpoise_pipeline::check::rank_assumptions;
use counterpoise_pipeline::exchange::StructureResult;
use counterpoise_pipeline::plant_views::view_plant;
use counterpoise_pipeline::results::ModelResult;
use counterpoise_pipeline::studies::accuracy::{Accuracy, simulation_accuracy};
use counterpoise_pipeline::{self as pipeline, PlantModel};
use counterpoise_project::Purpose;
use counterpoise_report::model::model_report;
use counterpoise_report::terminal::model::{ModelRemarks, model_lines};
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
    let watched = ProgressPool::new(options.results.progress());
    let watch = interrupt::watch_interrupts();
    let modelled = pipeline::model_watched(&loaded.project, &watched);
    drop(watch);
    watched.finish();
    let modelled = modelled?;
    let mut result = ModelResult::from(&modelled);
    let ranked =
        rank_assumptions(&loaded.project, &modelled, &loaded.assumptions, options.results.loop_systems());
    let mut unranked = None;
    match ranked {
        Ok(ranked) => {
            (result.assumptions, result.assumption_effects) = (ranked.assumptions, ranked.effects);
            result.assumed_loop = ranked.assumed_loop;
        }
        Err(why) => {
            result.assumptions.clone_from(&loaded.assumptions);
            unranked = Some(why);
        }
    }
    let views = view_plant(&loaded.project, &modelled)?;
    result.structure = StructureResult::of(&views, loaded.project.plant.beam.as_ref());
    result.frictions.clone_from(&views.frictions);
    result.accuracy = measure_accuracy(options, &modelled)?;
    if let Some(path) = &options.report {
        let command = format!("counterpoise model {} --report {}", options.project.display(), path.display());
        let page = model_report(&result, &views, &result.accuracy, &command);
        output::write_report(path, &options.results, &page)?;
    }
    if !output::write_result(&options.results, &result)? {
        let unheld = pipeline::cannot_hold(&modelled);
        let remarks = ModelRemarks {
            unheld: unheld.as_ref(),
            unranked: unranked.as_ref(),
            truncation: modelled.elements.as_ref().and_then(|elements| elements.truncation),
        };
        output::print_lines(&model_lines(&result, &views, remarks));
    }
    Ok(ExitStatus::SUCCESS)
}

/// Returns the errors of the simulation of the plant; none if no report is asked for.
fn measure_accuracy(options: &ModelOptions, modelled: &PlantModel) -> Result<Vec<Accuracy>> {
    if options.report.is_none() {
        return Ok(Vec::new());
    }
    let workers = ProgressPool::new(options.results.progress());
    let accuracy = simulation_accuracy(modelled, &workers);
    workers.finish();
    Ok(accuracy?)
}
