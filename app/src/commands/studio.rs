//! `counterpoise studio`: the desktop window.

use std::process::ExitCode;

use counterpoise_studio::window::{self, Options, Surface};

use super::Done;
use crate::arguments::StudioOptions;

/// Runs the command.
pub fn run(options: &StudioOptions) -> Done {
    window::run(Options {
        project: options.project.clone(),
        script: options.script.clone(),
        frame_log: options.frame_log.clone(),
        size: options.size.as_deref().and_then(size),
        state: None,
        surface: if options.no_window { Surface::Nothing } else { Surface::Window },
        library: Some(super::export::library),
    })?;
    Ok(ExitCode::SUCCESS)
}

/// A size as `1280x800`.
fn size(written: &str) -> Option<[f32; 2]> {
    let (width, height) = written.split_once('x')?;
    Some([width.parse().ok()?, height.parse().ok()?])
}
