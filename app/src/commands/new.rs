//! `counterpoise new`: a folder with a complete project file to start from.

use std::fs;
use std::path::Path;
use std::process::ExitCode;

use anyhow::{Context, Result, bail};
use counterpoise_project::{Document, STARTER, Setting};

use super::Done;
use crate::arguments::NewOptions;
use crate::files::{self, PROJECT_FILE};
use crate::output::say;

/// Writes the project file; never over another.
pub fn run(options: &NewOptions) -> Done {
    let folder = &options.folder;
    refuse_occupied(folder)?;
    fs::create_dir_all(folder).with_context(|| format!("cannot make the folder {}", folder.display()))?;
    let folder = &fs::canonicalize(folder)?;
    let path = folder.join(PROJECT_FILE);
    files::write(&path, named(folder)?.as_bytes())?;
    say!(
        "wrote {}: a complete machine. Change its numbers to your own, and after each change run",
        path.display()
    );
    say!("    counterpoise design {0} -o {0}/out", options.folder.display());
    Ok(ExitCode::SUCCESS)
}

fn refuse_occupied(folder: &Path) -> Result<()> {
    let path = folder.join(PROJECT_FILE);
    if path.exists() {
        bail!("{} is there already; give another folder, or remove it", path.display());
    }
    if folder.exists() && !folder.is_dir() {
        bail!("{} is a file, not a folder; give another name", folder.display());
    }
    Ok(())
}

/// The starter with the folder's name as the machine's.
fn named(folder: &Path) -> Result<String> {
    let Some(name) = folder.file_name().and_then(|name| name.to_str()) else {
        return Ok(STARTER.to_owned());
    };
    let document = Document::parse(STARTER, PROJECT_FILE);
    Ok(document.set("plant.name", &Setting::Text(name.to_owned()))?.text().to_owned())
}
