//! Other programs that this one starts on its terminal.

use std::ffi::OsString;
use std::io;
use std::path::Path;
use std::process::Command;

/// Runs another program until it ends; returns its exit code, 1 if a signal ended it.
///
/// # Errors
/// The program cannot be started.
pub fn run_program(program: &Path, arguments: &[OsString]) -> io::Result<i32> {
    Ok(Command::new(program).args(arguments).status()?.code().unwrap_or(1))
}
