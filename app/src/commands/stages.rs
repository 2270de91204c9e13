//! Single stages of the pipeline, from the same file.

use std::path::PathBuf;

use clap::Args;
use counterpoise_pipeline::results::ReduceResult;
use counterpoise_pipeline::{self as pipeline, PlantModel, ReducedPlant};
use counterpoise_project::Purpose;
use counterpoise_report::results::describe_reduction;
use counterpoise_report::terminal::reduction::reduction_lines;

use crate::exit::{CommandResult, ExitStatus};
use crate::options::ResultOutput;
use crate::output;
use counterpoise_host::projects::{self, ProjectOnDisk};

/// Arguments of a single stage.
#[derive(Args)]
pub struct StageOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// The destination of results.
    #[command(flatten)]
    pub results: ResultOutput,
}

/// Runs `counterpoise reduce`.
pub fn reduce(options: &StageOptions) -> CommandResult {
    let loaded = load_with_warnings(options, Purpose::Reduce)?;
    let (_, reduced) = to_reduced(&loaded)?;
    let result = describe_reduction(ReduceResult::from(&reduced));
    if !output::write_result(&options.results, &result)? {
        output::print_lines(&reduction_lines(&result));
    }
    verdict_ok()
}

fn verdict_ok() -> CommandResult {
    Ok(ExitStatus::SUCCESS)
}

fn load_with_warnings(options: &StageOptions, purpose: Purpose) -> anyhow::Result<ProjectOnDisk> {
    let loaded = projects::load_project(&options.project, purpose)?;
    output::print_warnings(&loaded, options.results.progress());
    Ok(loaded)
}

fn to_reduced(loaded: &ProjectOnDisk) -> anyhow::Result<(PlantModel, ReducedPlant)> {
    let modelled = pipeline::build_plant_model(&loaded.project)?;
    let reduced = pipeline::reduce_plant(&loaded.project, &modelled)?;
    Ok((modelled, reduced))
}
