//! Options that commands share, and those of the commands that have few.

use std::path::PathBuf;

use clap::Args;
use counterpoise_host::stages::Progress;
use counterpoise_pipeline::recordings::ReplayLength;
use counterpoise_pipeline::studies::assumptions::LoopSystems;

/// Arguments of `studio`, handed to the studio's own program as they are.
#[derive(Args, Default)]
#[command(disable_help_flag = true)]
pub struct StudioOptions {
    /// Project file or folder, and options (`counterpoise studio --help` lists them)
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "ARGUMENT")]
    pub arguments: Vec<std::ffi::OsString>,
}

/// Where a result goes.
#[derive(Args, Clone)]
pub struct Results {
    /// Print the result as JSON (to standard output, or to FILE)
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true, default_missing_value = "-")]
    pub json: Option<PathBuf>,
    /// Print no progress
    #[arg(long, short)]
    pub quiet: bool,
}

impl Results {
    /// Returns whether progress is printed.
    pub fn progress(&self) -> Progress {
        if self.quiet { Progress::Quiet } else { Progress::Shown }
    }

    /// Returns whether a result contains systems for other programs: if it is written as JSON.
    pub fn loop_systems(&self) -> LoopSystems {
        if self.json.is_some() { LoopSystems::Included } else { LoopSystems::LeftOut }
    }
}

/// Where a report and a result go.
#[derive(Args, Clone)]
pub struct Outputs {
    /// Write a report with pictures to this HTML file
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Where results go.
    #[command(flatten)]
    pub results: Results,
}

/// Arguments of `new`.
#[derive(Args)]
pub struct NewOptions {
    /// Folder to make, or an empty one; its name becomes the name of the machine
    pub folder: PathBuf,
    /// The machine that the file describes, in at most 25 lines; asked for on a terminal, with four of its values, if absent
    #[arg(long, value_name = "sight|gun|antenna|robot-joint|gimbal|linear-axis|pendulum")]
    pub like: Option<String>,
    /// A complete file of 263 lines instead, with weights, requirements and a campaign
    #[arg(long, conflicts_with = "like")]
    pub full: bool,
}

/// Arguments of `design`.
#[derive(Args)]
pub struct DesignOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// Folder for report and code
    #[arg(short, long, default_value = "out")]
    pub output: PathBuf,
    /// With --json: also the time histories of every experiment, from which the nonlinear figures can be recomputed (tens of megabytes)
    #[arg(long, requires = "json")]
    pub histories: bool,
    /// Where results go.
    #[command(flatten)]
    pub results: Results,
}

/// Arguments of `export`.
#[derive(Args)]
pub struct ExportOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// Folder for report and code
    #[arg(short, long, default_value = "out")]
    pub output: PathBuf,
    /// Write nothing; check whether these generated files are still what the project gives
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub check: Vec<PathBuf>,
    /// Where results go.
    #[command(flatten)]
    pub results: Results,
}

/// Arguments of a single stage.
#[derive(Args)]
pub struct StageOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// Where results go.
    #[command(flatten)]
    pub results: Results,
}

/// Arguments of `replay`.
#[derive(Args)]
pub struct ReplayOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// Recordings of one machine: CSV, Parquet, MATLAB, HDF5 or NumPy files, or folders of them
    #[arg(required = true)]
    pub recordings: Vec<PathBuf>,
    /// Drive the plant with the recorded control instead of the recording's controller
    #[arg(long)]
    pub open_loop: bool,
    /// Length of the windows over which the model follows the recording, under the recorded control and each from a fitted state:
    /// SECONDS; `none` follows it from start to end; `auto` uses half a second if the machine hunts, otherwise `none`
    #[arg(long, value_name = "auto|none|SECONDS", default_value = "auto", value_parser = windows)]
    pub windows: ReplayLength,
    /// Where report and results go.
    #[command(flatten)]
    pub outputs: Outputs,
}

/// `auto`, `none` or a length in seconds.
fn windows(text: &str) -> Result<ReplayLength, String> {
    match text {
        "auto" => Ok(ReplayLength::Automatic),
        "none" => Ok(ReplayLength::Whole),
        _ => match text.parse::<f64>() {
            Ok(window_s) if window_s > 0.0 && window_s.is_finite() => Ok(ReplayLength::Windows { window_s }),
            _ => Err("must be `auto`, `none` or a length in seconds, such as 0.5".to_owned()),
        },
    }
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
    /// Where report and results go.
    #[command(flatten)]
    pub outputs: Outputs,
}

/// Arguments of `experiment`.
#[derive(Args)]
pub struct ExperimentOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// JSON result of a diagnosis of this project; without it the plan is for the effects that machines most often lack
    pub findings: Option<PathBuf>,
    /// Largest angle from the start to either side, rad (m on a linear axis)
    #[arg(long, value_name = "ANGLE", value_parser = positive)]
    pub angle: f64,
    /// Largest rate in either direction, rad/s (m/s)
    #[arg(long, value_name = "RATE", value_parser = positive)]
    pub rate: f64,
    /// Largest current in either direction, A; no limit if absent
    #[arg(long, value_name = "CURRENT", value_parser = positive)]
    pub current: Option<f64>,
    /// Duration, s
    #[arg(long, value_name = "DURATION", default_value = "10", value_parser = seconds)]
    pub duration: f64,
    /// CSV file for the demand
    #[arg(short, long, value_name = "FILE", default_value = "demand.csv")]
    pub output: PathBuf,
    /// Where results go.
    #[command(flatten)]
    pub results: Results,
}

/// Returns a finite number above 0.
fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        _ => Err("must be a number above 0, such as 0.1".to_owned()),
    }
}

/// Longest experiment that is planned, s.
const LONGEST_S: f64 = 600.0;

/// Returns a duration that can be planned.
fn seconds(text: &str) -> Result<f64, String> {
    match positive(text)? {
        duration if duration <= LONGEST_S => Ok(duration),
        _ => Err(format!("must be at most {LONGEST_S} s: a longer experiment is this one, repeated")),
    }
}

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
    /// Where report and results go.
    #[command(flatten)]
    pub outputs: Outputs,
}
