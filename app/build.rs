//! The contents that the program carries: the commit it was built from, and the examples of the manual.

use std::env::var;
use std::fmt::Write as _;
use std::fs::{read_dir, write};
use std::path::{Path, PathBuf};
use std::process::Command;

fn main() -> std::io::Result<()> {
    let source = PathBuf::from(var("CARGO_MANIFEST_DIR").unwrap_or_default());
    println!("cargo:rustc-env=COUNTERPOISE_COMMIT={}", commit(&source));
    let examples = source.join("../examples");
    println!("cargo:rerun-if-changed={}", examples.display());
    let mut files = Vec::new();
    if examples.is_dir() {
        collect_files(&examples, &mut files)?;
    }
    files.sort();
    let target = PathBuf::from(var("OUT_DIR").unwrap_or_default()).join("examples.rs");
    write(target, table(&examples, &files))
}

/// Returns the commit that is checked out; "unknown" outside a repository.
fn commit(source: &Path) -> String {
    let git = |arguments: &[&str]| {
        let done = Command::new("git").args(arguments).current_dir(source).output().ok()?;
        let text = String::from_utf8(done.stdout).ok()?;
        done.status.success().then(|| text.trim().to_owned()).filter(|text| !text.is_empty())
    };
    // The head's log grows with every commit and every checkout.
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]).map(|path| source.join(path))
        && log.is_file()
    {
        println!("cargo:rerun-if-changed={}", log.display());
    }
    git(&["rev-parse", "--short=12", "HEAD"]).unwrap_or_else(|| "unknown".to_owned())
}

fn collect_files(folder: &Path, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect_files(&path, files)?;
        } else {
            files.push(path);
        }
    }
    Ok(())
}

/// Returns the source of a table of names and contents.
fn table(examples: &Path, files: &[PathBuf]) -> String {
    let mut text = "/// Files of the examples: name below the folder of examples, and content.\npub static FILES: &[(&str, &[u8])] = &[\n".to_owned();
    for path in files {
        let Ok(name) = path.strip_prefix(examples) else { continue };
        let name = name.to_string_lossy().replace('\\', "/");
        let _ = writeln!(text, "    ({name:?}, include_bytes!({:?})),", path.display().to_string());
    }
    text + "];\n"
}
