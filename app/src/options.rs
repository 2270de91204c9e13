//! Options that commands share.

use std::path::PathBuf;

use clap::{ArgGroup, Args};
use counterpoise_host::result_files::MatlabVersion;
use counterpoise_host::stages::ProgressDisplay;
use counterpoise_pipeline::studies::assumptions::LoopSystems;

/// The options that write a result to files, by a name that other options can require.
pub const WRITTEN: &str = "written";

/// The destination of a result.
#[derive(Args, Clone)]
#[command(group = ArgGroup::new(WRITTEN).multiple(true).args(["json", "data"]))]
pub struct ResultOutput {
    /// Print the result as JSON (to standard output, or to FILE)
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true, default_missing_value = "-")]
    pub json: Option<PathBuf>,
    /// Write every curve and table of the result as CSV, and the whole result as a MATLAB file (result.mat), to this folder
    #[arg(long, value_name = "FOLDER")]
    pub data: Option<PathBuf>,
    /// With --data: version of the MATLAB file; one of 7.3 has no limit of 2 GB for a variable
    #[arg(long, value_name = "VERSION", requires = "data", default_value = "5", value_parser = matlab_version)]
    pub matlab: MatlabVersion,
    /// Print no progress
    #[arg(long, short)]
    pub quiet: bool,
}

/// Reads the version of a MATLAB file.
fn matlab_version(text: &str) -> Result<MatlabVersion, String> {
    match text {
        "5" => Ok(MatlabVersion::Five),
        "7.3" => Ok(MatlabVersion::SevenThree),
        _ => Err("must be 5 or 7.3".to_owned()),
    }
}

impl ResultOutput {
    /// Returns whether progress is printed.
    pub fn progress(&self) -> ProgressDisplay {
        if self.quiet { ProgressDisplay::Quiet } else { ProgressDisplay::Shown }
    }

    /// Returns whether a result contains systems for other programs: if it is written to files.
    pub fn loop_systems(&self) -> LoopSystems {
        if self.json.is_some() || self.data.is_some() { LoopSystems::Included } else { LoopSystems::LeftOut }
    }
}

/// The destinations of a report and a result.
#[derive(Args, Clone)]
pub struct CommandOutputs {
    /// Write a report with pictures to this HTML file
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// The destination of results.
    #[command(flatten)]
    pub results: ResultOutput,
}

/// Arguments of `diagnose`.
#[derive(Args)]
pub struct DiagnoseOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// Recordings of one machine: CSV, Parquet, MATLAB, HDF5 or NumPy files, or folders of them; none if the project has natural
    /// frequencies in its section `measured`
    pub recordings: Vec<PathBuf>,
    /// Write the improved project file
    #[arg(long, value_name = "FILE")]
    pub save: Option<PathBuf>,
    /// Recordings that the diagnosis is not given: replayed by the model as it was and by the improved one, to show that the fit
    /// improves
    #[arg(long, value_name = "RECORDING", num_args = 1..)]
    pub held_out: Vec<PathBuf>,
    /// With --json or --data: also what was recorded beside what the models give, before and after
    #[arg(long, requires = WRITTEN)]
    pub histories: bool,
    /// The destinations of report and results.
    #[command(flatten)]
    pub outputs: CommandOutputs,
}
