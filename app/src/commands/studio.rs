//! `counterpoise studio`: starts the desktop window, which is a program of its own.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::Args;

use counterpoise_host::programs::run_program;

use crate::exit::{CommandResult, ExitStatus};

/// Arguments of `studio`, handed to the studio's own program as they are.
#[derive(Args, Default)]
#[command(disable_help_flag = true)]
pub struct StudioOptions {
    /// Project file or folder, and options (`counterpoise studio --help` lists them)
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "ARGUMENT")]
    pub arguments: Vec<std::ffi::OsString>,
}

/// Name of the studio's program, which is installed beside this one.
const PROGRAM: &str = "counterpoise-studio";

/// Runs the command: starts the studio with the same arguments and returns its exit code.
pub fn run(options: &StudioOptions) -> CommandResult {
    let program = beside_this_program()?;
    let code = run_program(&program, &options.arguments)
        .with_context(|| format!("cannot start {}", program.display()))?;
    Ok(ExitStatus(u8::try_from(code).unwrap_or(1)))
}

/// Returns the path of the studio's program.
fn beside_this_program() -> anyhow::Result<PathBuf> {
    let own = std::env::current_exe().context("cannot find the folder of this program")?;
    let folder = own.parent().unwrap_or(Path::new("."));
    let program = folder.join(format!("{PROGRAM}{}", std::env::consts::EXE_SUFFIX));
    if !program.is_file() {
        bail!(
            "the studio's window is a program of its own, {PROGRAM}, and it is not in {}; in the source folder, build it with \
             `cargo build --release -p {PROGRAM}` and try again",
            folder.display()
        );
    }
    Ok(program)
}
