//! `counterpoise check`: how a project file is read, which values are assumed, and its migration to the present format.

use anyhow::{Context, bail};
use clap::Args;
use counterpoise_host::files::project_file;
use counterpoise_host::projects::{self, BadProject};
use counterpoise_pipeline::check::check_project;
use counterpoise_project::{Attachments, Diagnostic, Document, FORMAT, Project};
use counterpoise_report::check::check_lines;
use counterpoise_report::key_reference::key_lines;
use counterpoise_report::results::describe_check;
use serde::Serialize;
use std::path::PathBuf;

use crate::exit::{CommandResult, ExitStatus};
use crate::options::ResultOutput;
use crate::output::{self, say};

/// Arguments of `check`.
#[derive(Args)]
pub struct CheckOptions {
    /// Project file, or a folder with a project.toml
    #[arg(required_unless_present = "keys")]
    pub project: Option<PathBuf>,
    /// Print the reference of a section of the project file (plant.gearbox), of a key (backlash) or of the figures that a requirement may limit (figures); without
    /// a name the list of all sections
    #[arg(long, value_name = "NAME", num_args = 0..=1, require_equals = true, default_missing_value = "", conflicts_with_all = ["project", "migrate", "json", "data"])]
    pub keys: Option<String>,
    /// Rewrite a file of an older format in the present one, with its comments; nothing else of it changes
    #[arg(long)]
    pub migrate: bool,
    /// The destination of results.
    #[command(flatten)]
    pub results: ResultOutput,
}

/// The errors of a file, as JSON.
#[derive(Serialize)]
struct FileErrors<'a> {
    file: &'a str,
    errors: &'a [Diagnostic],
}

/// Runs the command.
pub fn run(options: &CheckOptions) -> CommandResult {
    let Some(project) = &options.project else {
        return print_keys(options.keys.as_deref().unwrap_or_default());
    };
    let path = project_file(project);
    let (document, attachments) = projects::read_as_written(&path)?;
    if options.migrate {
        return migrate(&document, &attachments);
    }
    match Project::resolve(&document, &attachments) {
        Ok(parsed) => {
            let found = describe_check(check_project(&document, &parsed, options.results.loop_systems()));
            if !output::write_result(&options.results, &found)? {
                output::note_unsaved_edits(&path);
                check_lines(&found).iter().for_each(|line| say!("{line}"));
            }
            Ok(ExitStatus::SUCCESS)
        }
        Err(errors) => {
            let refused = FileErrors { file: document.name(), errors: &errors };
            if output::write_result(&options.results, &refused)? {
                return Ok(ExitStatus::BAD_INPUT);
            }
            Err(BadProject { errors, document }.into())
        }
    }
}

/// Prints the reference of a section or a key.
fn print_keys(asked: &str) -> CommandResult {
    let Some(lines) = key_lines(&Project::reference(), asked) else {
        bail!(
            "the project file has no section or key \"{asked}\"; `counterpoise check --keys` lists the sections"
        );
    };
    lines.iter().for_each(|line| say!("{line}"));
    Ok(ExitStatus::SUCCESS)
}

/// Sets the format of a file and of its parts, after all of them have been read.
fn migrate(document: &Document, attachments: &Attachments) -> CommandResult {
    if let Err(errors) = Project::resolve(document, attachments) {
        return Err(BadProject { errors, document: document.clone() }.into());
    }
    if document.format() == Some(FORMAT) {
        say!("{} is of format {FORMAT} already", document.name());
        return Ok(ExitStatus::SUCCESS);
    }
    let migrated = document.migrate().context("the file cannot be migrated")?;
    let (before, after) = (Project::resolve(document, attachments), Project::resolve(&migrated, attachments));
    let same = before.ok().map(|parsed| parsed.project) == after.ok().map(|parsed| parsed.project);
    if !same {
        bail!("{} would mean something else in format {FORMAT}; nothing was written", document.name());
    }
    projects::write_file(std::path::Path::new(document.name()), migrated.text().as_bytes())?;
    say!("{} is of format {FORMAT} now", document.name());
    Ok(ExitStatus::SUCCESS)
}
