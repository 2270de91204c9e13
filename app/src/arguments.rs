//! The command line's grammar.

use std::ffi::{OsStr, OsString};
use std::path::Path;

use clap::{Parser, Subcommand};
use counterpoise_host::files::RECORDING_ENDINGS;

use crate::commands::{
    adapt::AdaptOptions, check::CheckOptions, claims::ClaimsOptions, commission::CommissionOptions,
    compare::CompareOptions, design::DesignOptions, experiment::ExperimentOptions, export::ExportOptions,
    fra::FraOptions, identify::IdentifyOptions, machine::MachineOptions, model::ModelOptions,
    new::NewOptions, replay::ReplayOptions, stages::StageOptions, studio::StudioOptions, sweep::SweepOptions,
    synth::SynthOptions, verify::VerifyOptions,
};
use crate::options::DiagnoseOptions;

/// The text that `--version` prints; `-V` prints the version alone.
const LONG_VERSION: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    "\ncommit:   ",
    env!("COUNTERPOISE_COMMIT"),
    "\nresults:  counterpoise.results/2\nrecordings: CSV, Parquet, MATLAB, HDF5, NumPy"
);

/// From a project file to a verified controller, and back from recordings to a better model.
#[derive(Parser)]
#[command(name = "counterpoise", version, long_version = LONG_VERSION, about, max_term_width = 100)]
pub struct Arguments {
    /// The command.
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// The commands.
#[derive(Subcommand)]
pub enum Command {
    /// Write a folder with a project file to start from
    New(NewOptions),
    /// Print how a project file is read and which values are assumed; migrate older files
    Check(CheckOptions),
    /// Run the whole pipeline: model, reduce, synthesise, verify, export, report
    Design(DesignOptions),
    /// Print the plant: operating point, poles, modes, linear model
    Model(ModelOptions),
    /// Print the reduced plant and its error
    Reduce(StageOptions),
    /// Design the controller: weights, feedback, heave and pitch feedforward, certificates
    Synth(SynthOptions),
    /// Compare designs in one table: the project's own, the joint optimum, tuned fixed structures
    Compare(CompareOptions),
    /// Try the adaptation to a changing out-of-balance in eight runs of the nonlinear closed loop
    Adapt(AdaptOptions),
    /// Compare every required figure with its limit, on the linear and the nonlinear plant
    Verify(VerifyOptions),
    /// Write the verified controller as C, Rust, fixed point and FMI units, with self-test vectors
    Export(ExportOptions),
    /// Measure frequency responses as an analyser does: nonlinear, at several amplitudes, or on recordings
    Fra(FraOptions),
    /// Simulate the experiment of each recording and compare the result with the recording
    Replay(ReplayOptions),
    /// Find from recordings what the model lacks, and show that the fit improves on held-out data
    Diagnose(DiagnoseOptions),
    /// Plan the experiment that best separates the models that a diagnosis leaves possible
    Experiment(ExperimentOptions),
    /// Identify out-of-balance, friction, inertia and the amplifier's gain curve from triangle waves in closed loop
    Identify(IdentifyOptions),
    /// Design, run on a machine, diagnose and redesign, round by round, until the machine meets its requirements
    Commission(CommissionOptions),
    /// Run one experiment of a commissioning on a project that stands for the true machine, with the exported C in the loop
    Machine(MachineOptions),
    /// Verify the controller on many mechanisms, in shards, and search for the worst case
    Sweep(SweepOptions),
    /// Measure the claims of the thesis, one by one
    Claims(ClaimsOptions),
    /// Open the desktop studio, which shows every consequence of a change at once (also without a command)
    Studio(StudioOptions),
}

/// Returns the arguments with `--json FILE` written as `--json=FILE`, unless what follows is a project, a recording or another
/// option: the file is optional, and must not swallow the argument after it.
pub fn with_json_file_joined(arguments: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut out: Vec<OsString> = Vec::new();
    for argument in arguments {
        match out.last_mut() {
            Some(last) if last == "--json" && names_a_result(&argument) => {
                last.push("=");
                last.push(argument);
            }
            _ => out.push(argument),
        }
    }
    out
}

fn names_a_result(argument: &OsStr) -> bool {
    let path = Path::new(argument);
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let is_input = path.is_dir() || ending == "toml" || RECORDING_ENDINGS.contains(&ending.as_str());
    argument == "-" || (!argument.as_encoded_bytes().starts_with(b"-") && !is_input)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn join_json_file(line: &str) -> String {
        let joined = with_json_file_joined(line.split(' ').map(OsString::from));
        joined.iter().map(|each| each.to_string_lossy()).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn json_takes_a_file_but_no_input() {
        assert_eq!(join_json_file("c replay p.toml r.csv --json"), "c replay p.toml r.csv --json");
        assert_eq!(
            join_json_file("c replay p.toml r.csv --json a.json"),
            "c replay p.toml r.csv --json=a.json"
        );
        assert_eq!(join_json_file("c replay --json p.toml r.csv"), "c replay --json p.toml r.csv");
        assert_eq!(
            join_json_file("c replay --json a.json p.toml r.csv"),
            "c replay --json=a.json p.toml r.csv"
        );
        assert_eq!(join_json_file("c design --json . -o x"), "c design --json . -o x");
        for recording in ["run.h5", "run.HDF5", "run.mat", "run.parquet"] {
            let line = format!("c replay p.toml --json {recording}");
            assert_eq!(join_json_file(&line), line, "a recording is never written over");
        }
    }

    #[test]
    fn grammar_is_sound() {
        use clap::CommandFactory;
        Arguments::command().debug_assert();
    }
}
