//! The program `counterpoise`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(counterpoise::run_command_line(std::env::args_os()))
}
