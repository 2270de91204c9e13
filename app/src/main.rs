//! Counterpoise: a control-design studio for stabilised, out-of-balance servo mechanisms.
//!
//! `main` reads the arguments and hands them to one command; what a command may cost is its exit code:
//! 0 all verdicts hold, 1 some fail, 2 bad input, 3 a result could not be written to the standard output, 130 interrupted.

mod arguments;
mod commands;
#[cfg(test)]
mod commands_page;
mod exit;
mod options;
mod output;

use std::process::ExitCode;

use arguments::{Arguments, Command};
use clap::Parser;
use counterpoise_host::interrupt::{self, INTERRUPTED, Interrupted};
use counterpoise_host::terminal::print_message;
use options::StudioOptions;

fn main() -> ExitCode {
    interrupt::install_handler();
    counterpoise_host::terminal::quiet_decoders();
    let parsed = Arguments::try_parse_from(arguments::with_json_file_joined(std::env::args_os()));
    let arguments = match parsed {
        Ok(arguments) => arguments,
        // help and version are results, too
        Err(asked) if !asked.use_stderr() => {
            output::write_out(&asked.render().to_string());
            return ExitCode::SUCCESS;
        }
        Err(wrong) => wrong.exit(),
    };
    let window = Command::Studio(StudioOptions::default());
    let done = match arguments.command.as_ref().unwrap_or(&window) {
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
        Command::Sweep(options) => commands::sweep::run(options),
        Command::Claims(options) => commands::claims::run(options),
        Command::Studio(options) => commands::studio::run(options),
    };
    let code = done.unwrap_or_else(|error| {
        print_message(&output::error_chain(&error));
        ExitCode::from(if error.is::<Interrupted>() { INTERRUPTED } else { 2 })
    });
    // Work that was asked to stop has handed over what it had; it is not the result that was asked for.
    if interrupt::is_stop_requested() { ExitCode::from(INTERRUPTED) } else { code }
}
