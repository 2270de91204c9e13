//! The studio's program: `counterpoise studio` starts it.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use counterpoise_host::compilers::unit_library;
use counterpoise_studio::native_window::{self, DisplaySurface, StartOptions};

/// The desktop studio: weights are dragged on plots, and every consequence is shown at once
#[derive(Parser)]
#[command(name = "counterpoise studio", version, max_term_width = 100)]
struct Arguments {
    /// Project file, or a folder with a project.toml
    project: Option<PathBuf>,
    /// Replay a log of commands, one JSON value a line
    #[arg(long, value_name = "FILE")]
    script: Option<PathBuf>,
    /// Write the time that each redrawn design took, as CSV
    #[arg(long, value_name = "FILE")]
    frame_log: Option<PathBuf>,
    /// Size of the window in points, as 1280x800
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[f32; 2]>,
    /// Carry out the script without a window, and end with it
    #[arg(long, requires = "script")]
    no_window: bool,
}

fn main() -> ExitCode {
    counterpoise_host::terminal::quiet_decoders();
    let arguments = Arguments::parse();
    let options = StartOptions {
        project: arguments.project,
        script: arguments.script,
        frame_log: arguments.frame_log,
        size: arguments.size,
        state: None,
        surface: if arguments.no_window { DisplaySurface::Headless } else { DisplaySurface::Window },
        library: Some(unit_library::compile_library),
    };
    match native_window::run(options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

/// Reads a size such as `1280x800`.
fn size(written: &str) -> Result<[f32; 2], String> {
    let sides =
        written.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    sides
        .filter(|sides| sides.iter().all(|side: &f32| side.is_finite() && *side > 0.0))
        .ok_or_else(|| format!("{written} is not a size such as 1280x800"))
}
