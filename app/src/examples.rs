//! The examples of the manual, carried by the program, so that an installed one needs no source folder.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail, ensure};
use counterpoise_host::files::is_empty_place;
use counterpoise_host::projects;

include!(concat!(env!("OUT_DIR"), "/examples.rs"));

/// Folder in which the manual has its examples.
const FOLDER: &str = "examples";

/// Returns the names of the examples, in alphabetical order.
pub fn example_names() -> Vec<&'static str> {
    let mut names: Vec<&str> = FILES.iter().filter_map(|(file, _)| Some(file.split_once('/')?.0)).collect();
    names.dedup();
    names
}

/// Writes the files of an example into a folder that does not exist or is empty. Returns their paths.
///
/// # Errors
/// There is no such example, the folder is not empty, or a file cannot be written.
pub fn write_example(name: &str, folder: &Path) -> Result<Vec<PathBuf>> {
    let inside = |file: &'static str| file.strip_prefix(name)?.strip_prefix('/');
    let files = FILES.iter().filter_map(|(file, bytes)| Some((folder.join(inside(file)?), *bytes)));
    let files: Vec<(PathBuf, &[u8])> = files.collect();
    if files.is_empty() {
        bail!("there is no example \"{name}\"; known are {}", example_names().join(", "));
    }
    ensure!(is_empty_place(folder), "{} is not an empty folder; nothing was written", folder.display());
    files
        .into_iter()
        .map(|(path, bytes)| {
            projects::write_file(&path, bytes)?;
            Ok(path)
        })
        .collect()
}

/// Returns how to get an example that the arguments name, if it is not there; `None` if all are.
pub fn describe_missing_example(arguments: &[PathBuf]) -> Option<String> {
    let missing = |path: &PathBuf| {
        let name = path.strip_prefix(FOLDER).ok()?.components().next()?.as_os_str().to_str()?.to_owned();
        let folder = Path::new(FOLDER).join(&name);
        (!folder.exists() && example_names().contains(&name.as_str())).then_some(name)
    };
    let name = arguments.iter().find_map(missing)?;
    Some(format!(
        "note: this example comes with the program: counterpoise new {FOLDER}/{name} --example {name}"
    ))
}
