//! The window alone, without the command line: `cargo run --release -p counterpoise-studio --example window -- PROJECT [SCRIPT] [SIZE]
//! [FRAME-LOG]`. With NO_WINDOW in the environment the script is carried out and nothing is shown.

use counterpoise_studio::native_window::{DisplaySurface, Error, StartOptions, run};

fn main() -> Result<(), Error> {
    let mut arguments = std::env::args_os().skip(1).map(std::path::PathBuf::from);
    let project = arguments.next();
    let script = arguments.next().filter(|p| !p.as_os_str().is_empty());
    let size = arguments.next().and_then(|s| {
        let (width, height) = s.to_str()?.split_once('x')?;
        Some([width.parse().ok()?, height.parse().ok()?])
    });
    let frame_log = arguments.next();
    let unseen = std::env::var_os("NO_WINDOW").is_some();
    let surface = if unseen { DisplaySurface::Headless } else { DisplaySurface::Window };
    run(StartOptions { project, script, frame_log, size, surface, ..StartOptions::default() })
}
