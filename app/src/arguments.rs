//! The command line's grammar.

use std::path::{Path, PathBuf};

use clap::{Args, Parser, Subcommand};
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
    /// A folder with a complete project file to start from
    New(NewOptions),
    /// The main job: model, reduce, synthesise, verify, export, report
    Design(DesignOptions),
    /// The plant: operating point, poles, modes, linear model
    Model(ModelOptions),
    /// The reduced plant and its error
    Reduce(StageOptions),
    /// The controller: weights, feedback, heave and pitch feedforward, certificates
    Synth(SynthOptions),
    /// The adaptation to a changing out-of-balance, in eight runs of the nonlinear closed loop
    Adapt(AdaptOptions),
    /// The verdicts: every figure against its limit, linear and nonlinear
    Verify(VerifyOptions),
    /// The verified controller as C, Rust, fixed point and FMI units, with self-test vectors
    Export(ExportOptions),
    /// Frequency responses as an analyser measures them: nonlinear, amplitude by amplitude, or on recordings
    Fra(FraOptions),
    /// Simulate what was recorded, and say how well it fits
    Replay(ReplayOptions),
    /// Locate, name and model what the simulation lacks, and show that the fit improves
    Diagnose(DiagnoseOptions),
    /// Out-of-balance, friction, inertia and the amplifier's gain curve, from triangle waves in closed loop
    Identify(IdentifyOptions),
    /// Robustness: many mechanisms at once, in shards, and each configuration
    Sweep(SweepOptions),
    /// The thesis' claims, measured claim by claim
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
    /// Say nothing about progress
    #[arg(long, short)]
    pub quiet: bool,
}

/// Arguments of `new`.
#[derive(Args)]
pub struct NewOptions {
    /// Folder to make, or an empty one; its name becomes the machine's
    pub folder: PathBuf,
}

/// Arguments of `design`.
#[derive(Args)]
pub struct DesignOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// Folder for what is written
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
    /// Folder for what is written
    #[arg(short, long, default_value = "out")]
    pub output: PathBuf,
    /// Write nothing; say whether these generated files are still what the project gives
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
    /// Recordings of one machine: CSV, Parquet or MATLAB files, or folders of them
    #[arg(required = true)]
    pub recordings: Vec<PathBuf>,
    /// Drive the plant with the recorded control instead of the recording's controller
    #[arg(long)]
    pub open_loop: bool,
    /// Whether the model starts anew every so many seconds, under the recorded control, from a state fitted to the first half of what
    /// follows: SECONDS; `none`, from start to end; `auto`, over half a second where the machine hunts, so that two runs of the model
    /// itself part by more than noise, and from start to end elsewhere
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
    /// Recordings of one machine: CSV, Parquet or MATLAB files, or folders of them; none where the project's section
    /// `measured` holds the natural frequencies of the structure
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
    /// Recordings of one machine in one state of balance: CSV, Parquet or MATLAB files, or folders of them
    #[arg(required = true)]
    pub recordings: Vec<PathBuf>,
    /// Recordings of the same machine at another out-of-balance: they tell the amplifier's curve from friction
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
    let is_input = path.is_dir() || ["toml", "csv", "parquet", "mat"].contains(&ending.as_str());
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
    }

    #[test]
    fn grammar_is_sound() {
        use clap::CommandFactory;
        Arguments::command().debug_assert();
    }
}
