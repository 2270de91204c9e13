//! The command line's grammar.

use std::path::{Path, PathBuf};

use clap::{Args, Parser, Subcommand};
use counterpoise_host::files::RECORDING_ENDINGS;
use counterpoise_pipeline::recordings::ReplayLength;

use crate::commands::{
    adapt::AdaptOptions, claims::ClaimsOptions, fra::FraOptions, model::ModelOptions, sweep::SweepOptions,
    synth::SynthOptions, verify::VerifyOptions,
};

/// From a project file to a verified controller, and back from recordings to a better model.
#[derive(Parser)]
#[command(name = "counterpoise", version, about, max_term_width = 100)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// The commands.
#[derive(Subcommand)]
pub enum Command {
    /// Write a folder with a complete project file to start from
    New(NewOptions),
    /// Run the whole pipeline: model, reduce, synthesise, verify, export, report
    Design(DesignOptions),
    /// Print the plant: operating point, poles, modes, linear model
    Model(ModelOptions),
    /// Print the reduced plant and its error
    Reduce(StageOptions),
    /// Design the controller: weights, feedback, heave and pitch feedforward, certificates
    Synth(SynthOptions),
    /// Try the adaptation to a changing out-of-balance in eight runs of the nonlinear closed loop
    Adapt(AdaptOptions),
    /// Compare every required figure with its limit, on the linear and the nonlinear plant
    Verify(VerifyOptions),
    /// Write the verified controller as C, Rust, fixed point and FMI units, with self-test vectors
    Export(ExportOptions),
    /// Measure frequency responses as an analyser does: nonlinear, at several amplitudes, or on recordings
    Fra(FraOptions),
    /// Simulate what was recorded and compare it with the recording
    Replay(ReplayOptions),
    /// Find what the model lacks, and show that the fit improves on held-out data
    Diagnose(DiagnoseOptions),
    /// Identify out-of-balance, friction, inertia and the amplifier's gain curve from triangle waves in closed loop
    Identify(IdentifyOptions),
    /// Verify the controller on many mechanisms, in shards, and search for the worst case
    Sweep(SweepOptions),
    /// Measure the claims of the thesis, one by one
    Claims(ClaimsOptions),
    /// The desktop studio: weights in the hand, consequences at once (also with no arguments)
    Studio(StudioOptions),
}

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

/// Arguments of `new`.
#[derive(Args)]
pub struct NewOptions {
    /// Folder to make, or an empty one; its name becomes the name of the machine
    pub folder: PathBuf,
}

/// Arguments of `design`.
#[derive(Args)]
pub struct DesignOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// Folder for report and code
    #[arg(short, long, default_value = "out")]
    pub output: PathBuf,
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
    /// Recordings of one machine: CSV, Parquet, MATLAB or HDF5 files, or folders of them
    #[arg(required = true)]
    pub recordings: Vec<PathBuf>,
    /// Drive the plant with the recorded control instead of the recording's controller
    #[arg(long)]
    pub open_loop: bool,
    /// Length of the windows over which the model follows the recording, under the recorded control and each from a fitted state:
    /// SECONDS; `none` follows it from start to end; `auto` uses half a second if the machine hunts, otherwise `none`
    #[arg(long, value_name = "auto|none|SECONDS", default_value = "auto", value_parser = windows)]
    pub windows: ReplayLength,
    /// Write a report with pictures to this HTML file
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Where results go.
    #[command(flatten)]
    pub results: Results,
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
    /// Recordings of one machine: CSV, Parquet, MATLAB or HDF5 files, or folders of them; none if the project has natural
    /// frequencies in its section `measured`
    pub recordings: Vec<PathBuf>,
    /// Write the improved project file
    #[arg(long, value_name = "FILE")]
    pub save: Option<PathBuf>,
    /// Write a report with pictures to this HTML file
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Where results go.
    #[command(flatten)]
    pub results: Results,
}

/// Arguments of `identify`.
#[derive(Args)]
pub struct IdentifyOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// Recordings of one machine in one state of balance: CSV, Parquet, MATLAB or HDF5 files, or folders of them
    #[arg(required = true)]
    pub recordings: Vec<PathBuf>,
    /// Recordings of the same machine at another out-of-balance: they separate the amplifier's curve from friction
    #[arg(long, value_name = "RECORDING", num_args = 1..)]
    pub other: Vec<PathBuf>,
    /// Write the project file with the identified values
    #[arg(long, value_name = "FILE")]
    pub save: Option<PathBuf>,
    /// Write a report with pictures to this HTML file
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Where results go.
    #[command(flatten)]
    pub results: Results,
}

/// `--json FILE` written as `--json=FILE`, unless what follows is a project, a recording or another option: the file
/// is optional, and must not swallow the argument after it.
pub fn with_json_file_joined(arguments: impl Iterator<Item = String>) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for argument in arguments {
        match out.last_mut() {
            Some(last) if last == "--json" && names_a_result(&argument) => {
                *last = format!("--json={argument}")
            }
            _ => out.push(argument),
        }
    }
    out
}

fn names_a_result(argument: &str) -> bool {
    let path = Path::new(argument);
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let is_input = path.is_dir() || ending == "toml" || RECORDING_ENDINGS.contains(&ending.as_str());
    argument == "-" || (!argument.starts_with('-') && !is_input)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joined(line: &str) -> String {
        with_json_file_joined(line.split(' ').map(str::to_owned)).join(" ")
    }

    #[test]
    fn json_takes_a_file_but_no_input() {
        assert_eq!(joined("c replay p.toml r.csv --json"), "c replay p.toml r.csv --json");
        assert_eq!(joined("c replay p.toml r.csv --json a.json"), "c replay p.toml r.csv --json=a.json");
        assert_eq!(joined("c replay --json p.toml r.csv"), "c replay --json p.toml r.csv");
        assert_eq!(joined("c replay --json a.json p.toml r.csv"), "c replay --json=a.json p.toml r.csv");
        assert_eq!(joined("c design --json . -o x"), "c design --json . -o x");
        for recording in ["run.h5", "run.HDF5", "run.mat", "run.parquet"] {
            let line = format!("c replay p.toml --json {recording}");
            assert_eq!(joined(&line), line, "a recording is never written over");
        }
    }

    #[test]
    fn grammar_is_sound() {
        use clap::CommandFactory;
        Arguments::command().debug_assert();
    }
}
