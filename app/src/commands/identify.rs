//! `counterpoise identify`: the triangle-wave method.

use std::path::PathBuf;

use clap::Args;
use counterpoise_pipeline::recordings::identify;
use counterpoise_project::Purpose;
use counterpoise_report::identify::identification_report;
use counterpoise_report::terminal::identification::identification_lines;
use counterpoise_report::wording::identification::describe_identified_recordings;
use counterpoise_report::wording::recordings::describe_recordings_error;

use crate::exit::{CommandResult, ExitStatus};
use crate::options::CommandOutputs;
use crate::output;
use counterpoise_host::projects;

/// Arguments of `identify`.
#[derive(Args)]
pub struct IdentifyOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// Recordings of one machine in one state of balance: CSV, Parquet, MATLAB, HDF5 or NumPy files, or folders of them
    #[arg(required = true)]
    pub recordings: Vec<PathBuf>,
    /// Recordings of the same machine at another out-of-balance: they separate the amplifier's curve from friction
    #[arg(long, value_name = "RECORDING", num_args = 1..)]
    pub other: Vec<PathBuf>,
    /// Write the project file with the identified values
    #[arg(long, value_name = "FILE")]
    pub save: Option<PathBuf>,
    /// The destinations of report and results.
    #[command(flatten)]
    pub outputs: CommandOutputs,
}

/// Runs the command.
pub fn run(options: &IdentifyOptions) -> CommandResult {
    let loaded = projects::load_project(&options.project, Purpose::Model)?;
    output::print_warnings(&loaded, options.outputs.results.progress());
    let (first, second) =
        (projects::read_recordings(&options.recordings)?, projects::read_recordings(&options.other)?);
    let identified = identify(&loaded.project, &[&first, &second])
        .map_err(|error| anyhow::Error::msg(describe_recordings_error(&error)))?;
    let found = describe_identified_recordings(&identified);
    if let Some(path) = &options.save {
        projects::save_improved(&loaded, &identified.improved, path)?;
    }
    if let Some(path) = &options.outputs.report {
        let command = format!("counterpoise identify {}", loaded.path.display());
        let name = &loaded.project.plant.name;
        let page = identification_report(name, &command, &found, &identified.units);
        output::write_report(path, &options.outputs.results, &page)?;
    }
    if !output::write_result(&options.outputs.results, &found)? {
        output::print_lines(&identification_lines(&found, &identified.units));
    }
    Ok(ExitStatus::SUCCESS)
}
