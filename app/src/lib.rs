//! The command line of Counterpoise: a control-design studio for stabilised, out-of-balance servo mechanisms.
//!
//! [`run_command_line`] reads the arguments and hands them to one command. The program `counterpoise` and the package for Python both call
//! it, so that an installed package has the command, too.

mod arguments;
mod commands;
#[cfg(test)]
mod commands_page;
mod examples;
mod exit;
mod options;
mod output;

use std::ffi::OsString;
use std::path::PathBuf;

use arguments::{Arguments, Command};
use clap::Parser;
use commands::studio::StudioOptions;
use counterpoise_host::interrupt::{self, INTERRUPTED, Interruption};
use counterpoise_host::terminal::print_message;
use exit::{CommandResult, ExitStatus};

/// Runs the command that the arguments name, the name of the program first. Returns the exit code: 0 all verdicts hold, 1 some fail, 2 bad
/// input, 130 interrupted.
///
/// It is the process's: it handles Ctrl+C, and ends the process with 2 after a message if the arguments are wrong, or with 3 if a result
/// cannot be written to the standard output.
pub fn run_command_line(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    interrupt::install_handler();
    counterpoise_host::terminal::quiet_decoders();
    let given = arguments::with_json_file_joined(arguments.into_iter());
    let parsed = Arguments::try_parse_from(&given);
    let arguments = match parsed {
        Ok(arguments) => arguments,
        // help and version are results, too
        Err(asked) if !asked.use_stderr() => {
            output::write_out(&asked.render().to_string());
            return ExitStatus::SUCCESS.0;
        }
        Err(wrong) => wrong.exit(),
    };
    let window = Command::Studio(StudioOptions::default());
    let ExitStatus(code) =
        run_command(arguments.command.as_ref().unwrap_or(&window)).unwrap_or_else(|error| {
            print_message(&output::error_chain(&error));
            let paths: Vec<PathBuf> = given.iter().map(PathBuf::from).collect();
            let note = examples::describe_missing_example(&paths);
            let note = note.or_else(|| commands::new::describe_missing_project(&error));
            note.iter().for_each(|note| print_message(note));
            if error.is::<Interruption>() { ExitStatus(INTERRUPTED) } else { ExitStatus::BAD_INPUT }
        });
    // Work that was asked to stop has handed over what it had; it is not the result that was asked for.
    if interrupt::is_stop_requested() { INTERRUPTED } else { code }
}

fn run_command(command: &Command) -> CommandResult {
    match command {
        Command::New(options) => commands::new::run(options),
        Command::Check(options) => commands::check::run(options),
        Command::Design(options) => commands::design::run(options),
        Command::Model(options) => commands::model::run(options),
        Command::Reduce(options) => commands::stages::reduce(options),
        Command::Synth(options) => commands::synth::run(options),
        Command::Compare(options) => commands::compare::run(options),
        Command::Adapt(options) => commands::adapt::run(options),
        Command::Verify(options) => commands::verify::run(options),
        Command::Export(options) => commands::export::run(options),
        Command::Fra(options) => commands::fra::run(options),
        Command::Replay(options) => commands::replay::run(options),
        Command::Diagnose(options) => commands::diagnose::run(options),
        Command::Experiment(options) => commands::experiment::run(options),
        Command::Identify(options) => commands::identify::run(options),
        Command::Commission(options) => commands::commission::run(options),
        Command::Machine(options) => commands::machine::run(options),
        Command::Sweep(options) => commands::sweep::run(options),
        Command::Claims(options) => commands::claims::run(options),
        Command::Studio(options) => commands::studio::run(options),
    }
}
