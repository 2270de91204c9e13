//! `counterpoise export`: the verified controller as code; or whether generated files are still what the project gives.

use crate::output::say;
use std::path::{Path, PathBuf};

use clap::Args;
use counterpoise_export::{CheckOutcome, File, check_file};
use counterpoise_host::terminal::print_message;
use counterpoise_host::{code_files, files};
use counterpoise_pipeline::exchange::ControllerResult;
use counterpoise_pipeline::{self as pipeline, TraverseCode};
use counterpoise_project::Purpose;
use counterpoise_report::wording::code_header::HeaderText;
use serde::Serialize;

use crate::exit::{CommandResult, verdict_code};
use crate::options::ResultOutput;
use crate::output;
use counterpoise_host::projects::{self, ProjectWorld};

/// Arguments of `export`.
#[derive(Args)]
pub struct ExportOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// Folder for report and code
    #[arg(short, long, default_value = "out")]
    pub output: PathBuf,
    /// Write nothing; check whether these generated files are still what the project gives
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub check: Vec<PathBuf>,
    /// The destination of results.
    #[command(flatten)]
    pub results: ResultOutput,
}

/// Writes the code, or checks files.
pub fn run(options: &ExportOptions) -> CommandResult {
    let loaded = projects::load_project(&options.project, Purpose::Export)?;
    output::print_warnings(&loaded, options.results.progress());
    let world = ProjectWorld::of(&loaded, options.results.progress());
    let made = pipeline::run_stages(&loaded.project, &HeaderText, &world)?;
    if !options.check.is_empty() {
        let below = made.traverse.iter().flat_map(|axis| &axis.files);
        let inside =
            below.map(|file| File { name: format!("{TRAVERSE_FOLDER}/{}", file.name), ..file.clone() });
        let code: Vec<File> = made.files.iter().cloned().chain(inside).collect();
        return check_files(options, &code);
    }
    let identity = pipeline::ProjectIdentity::of(&loaded.project, &loaded.project_folder());
    let controller = ControllerResult::new(&identity, made.verified.controller());
    let mut written = code_files::write_with_controller(&options.output, &made.files, &controller, &[])?;
    if let Some(traverse) = &made.traverse {
        written.extend(write_traverse(&options.output, traverse)?);
    }
    let names: Vec<String> = written.iter().map(|path| path.display().to_string()).collect();
    if !output::write_list(&options.results, "files", &names)? {
        names.iter().for_each(|name| say!("{name}"));
    }
    made.all_left_out().for_each(|code| print_message(&format!("left out  {code}")));
    let traverse = made.traverse.as_ref().is_none_or(|axis| holds(axis));
    Ok(verdict_code([made.verified.verification().passes(), made.left_out.is_empty(), traverse]))
}

/// Folder of the traverse axis' code within that of the project.
pub(crate) const TRAVERSE_FOLDER: &str = "traverse";

/// Writes the code of the traverse axis into a folder of its own, with its controller; returns the files.
pub(crate) fn write_traverse(folder: &Path, axis: &TraverseCode) -> anyhow::Result<Vec<PathBuf>> {
    let controller = ControllerResult::new(&axis.design.identity, axis.design.verified.controller());
    code_files::write_with_controller(&folder.join(TRAVERSE_FOLDER), &axis.files, &controller, &[])
}

/// Returns whether the traverse axis meets its requirements and has all code that its project asks for.
pub(crate) fn holds(axis: &TraverseCode) -> bool {
    axis.design.verified.verification().passes() && axis.left_out.is_empty()
}

/// The outcome of a file that was checked.
#[derive(Serialize)]
struct CheckedCode {
    file: String,
    same: bool,
    unread: bool,
    says: String,
}

fn check_files(options: &ExportOptions, code: &[File]) -> CommandResult {
    let outcomes: Vec<CheckedCode> = options.check.iter().map(|path| outcome(path, code)).collect();
    if !output::write_list(&options.results, "files", &outcomes)? {
        outcomes.iter().for_each(|outcome| say!("{}: {}", outcome.file, outcome.says));
    }
    let unread = outcomes.iter().filter(|outcome| outcome.unread).count();
    anyhow::ensure!(unread == 0, "{unread} of {} files could not be read", outcomes.len());
    Ok(verdict_code(outcomes.iter().map(|outcome| outcome.same)))
}

/// Returns what became of one file; a file that cannot be read does not keep the others from being checked.
fn outcome(path: &Path, code: &[File]) -> CheckedCode {
    let file = path.display().to_string();
    let bytes = match files::read_file(path) {
        Ok(bytes) => bytes,
        Err(why) => {
            return CheckedCode { file, same: false, unread: true, says: format!("cannot be read: {why}") };
        }
    };
    let (same, says) = if path.extension().is_some_and(|ending| ending == "fmu") {
        unit_outcome(path, &bytes, code)
    } else {
        match String::from_utf8(bytes) {
            Ok(text) => text_outcome(&text, find_expected_file(path, code)),
            Err(_) => (false, "is no text, so no generated file".to_owned()),
        }
    };
    CheckedCode { file, same, unread: false, says }
}

/// Returns whether a packed unit contains the files of `code` unchanged, with a sentence that says so. The library that was
/// compiled from them is not compared.
fn unit_outcome(path: &Path, archive: &[u8], code: &[File]) -> (bool, String) {
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let inside = format!("{name}/");
    let own: Vec<&File> = code.iter().filter(|file| file.name.starts_with(&inside)).collect();
    if own.is_empty() {
        return (false, "the project generates no unit of this name".to_owned());
    }
    match own.iter().find(|file| !contains(archive, file.text.as_bytes())) {
        None => (true, "holds the sources that the project gives; its library is not compared".to_owned()),
        Some(file) => {
            let path = file.name.strip_prefix(&inside).unwrap_or(&file.name);
            (false, format!("{path} in it is not what the project gives"))
        }
    }
}

/// Returns whether bytes stand in an archive.
fn contains(archive: &[u8], part: &[u8]) -> bool {
    archive.windows(part.len().max(1)).any(|window| window == part)
}

/// Returns the file of the project whose path ends like the given one: the longest match of whole components.
fn find_expected_file<'a>(path: &Path, code: &'a [File]) -> Option<&'a File> {
    let matches = code
        .iter()
        .filter(|file| path.ends_with(&file.name) || Path::new(&file.name).file_name() == path.file_name());
    matches.max_by_key(|file| (path.ends_with(&file.name), file.name.len()))
}

fn text_outcome(text: &str, expected: Option<&File>) -> (bool, String) {
    let Some(expected) = expected else {
        return (false, "the project generates no file of this name".to_owned());
    };
    let line = |line: Option<String>| line.unwrap_or_else(|| "(end of file)".to_owned());
    match check_file(text, expected) {
        CheckOutcome::Same => (true, "is what the project gives".to_owned()),
        CheckOutcome::NotGenerated => (false, "is no generated file".to_owned()),
        CheckOutcome::OtherProject { found, expected } => {
            (false, format!("was generated from project {found}; the project is now {expected}"))
        }
        CheckOutcome::Differs { line: number, found, expected } => (
            false,
            format!("line {number} was changed\n  found:    {}\n  expected: {}", line(found), line(expected)),
        ),
    }
}
