//! `counterpoise new`: a folder with a project file to start from, filled in by five questions, like a kind of machine, or in full.

use anyhow::{Result, bail};
use clap::Args;
use counterpoise_host::files::{PROJECT_FILE, create_project};
use counterpoise_host::projects::UnreadProject;
use counterpoise_project::starters::{StarterKind, StarterQuestion, with_answer};
use counterpoise_project::{Document, STARTER};
use std::io::{BufRead, IsTerminal, Write};
use std::path::{Path, PathBuf};

use crate::examples::write_example;
use crate::exit::{CommandResult, ExitStatus};
use crate::output::{say, write_out};

/// Arguments of `new`.
#[derive(Args)]
pub struct NewOptions {
    /// Folder to make, or one without a project.toml; its name becomes the name of the machine
    pub folder: PathBuf,
    /// The machine that the file describes, in at most 25 lines; asked for on a terminal, with four of its values, if absent
    #[arg(long, value_name = "sight|gun|antenna|robot-joint|gimbal|linear-axis|pendulum")]
    pub like: Option<String>,
    /// A complete file of 263 lines instead, with weights, requirements and a campaign
    #[arg(long, conflicts_with = "like")]
    pub full: bool,
    /// An example of the manual instead, with its recordings, for example reference-rig
    #[arg(long, value_name = "NAME", conflicts_with_all = ["like", "full"])]
    pub example: Option<String>,
}

/// Writes the project file; never over another.
pub fn run(options: &NewOptions) -> CommandResult {
    if let Some(name) = &options.example {
        let written = write_example(name, &options.folder)?;
        written.iter().for_each(|path| say!("wrote {}", path.display()));
        return Ok(ExitStatus::SUCCESS);
    }
    let document = match (options.full, &options.like) {
        (true, _) => Document::parse(STARTER, PROJECT_FILE),
        (false, Some(name)) => Document::parse(kind(name)?.text(), PROJECT_FILE),
        (false, None) if std::io::stdin().is_terminal() => ask_for_machine(&mut std::io::stdin().lock())?,
        (false, None) => bail!(
            "there is no terminal to ask on: say what the machine is like with --like {}, or give --full",
            names()
        ),
    };
    create_project(&options.folder, &document).map_err(anyhow::Error::msg)?;
    print_next_steps(&options.folder);
    Ok(ExitStatus::SUCCESS)
}

fn print_next_steps(folder: &Path) {
    say!("wrote {}. Change its values to your own, and run", folder.join(PROJECT_FILE).display());
    let (folder, out) = (shell_word(folder), shell_word(&folder.join("out")));
    say!("    counterpoise check {folder}");
    say!("    counterpoise design {folder} -o {out}");
}

/// Returns how to begin the project that a command did not find; `None` if that is not its error.
pub fn describe_missing_project(error: &anyhow::Error) -> Option<String> {
    let path = &error.downcast_ref::<UnreadProject>().filter(|unread| !unread.path.exists())?.path;
    let is_folder = path.extension().is_none();
    let folder =
        if path.ends_with(PROJECT_FILE) { path.parent() } else { is_folder.then_some(path.as_path()) };
    let folder = folder.filter(|folder| folder.file_name().is_some()).map_or("FOLDER".to_owned(), shell_word);
    Some(format!("note: to begin a project there: counterpoise new {folder} --like sight"))
}

/// Returns a path as one word of a command line.
fn shell_word(path: &Path) -> String {
    let text = path.display().to_string();
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+:\\".contains(c);
    if text.chars().all(is_plain) { text } else { format!("\"{}\"", text.replace('"', "\\\"")) }
}

fn names() -> String {
    StarterKind::ALL.map(StarterKind::name).join("|")
}

fn kind(name: &str) -> Result<StarterKind> {
    match StarterKind::from_name(name) {
        Some(kind) => Ok(kind),
        None => bail!("there is no kind of machine \"{name}\"; known are {}", names()),
    }
}

/// Most answers that are refused before the questions end.
const MOST_REFUSED: usize = 20;

/// Asks what the machine is like, then for four of its values. An empty answer keeps the value in brackets.
fn ask_for_machine(input: &mut dyn BufRead) -> Result<Document> {
    say!(
        "Five questions. A number may have any unit, as in 0.5 mrad, and without one it is in SI units (rad, rad/s, kg m^2, s); an empty answer keeps what is in brackets."
    );
    let mut refused = 0;
    let kind = loop {
        write_out(&format!("What is the machine like: {}? [sight] ", names()));
        let answer = line(input)?;
        let name = if answer.is_empty() { "sight" } else { &answer };
        match kind(name) {
            Ok(kind) => break kind,
            Err(why) => say!("{why}"),
        }
        refused += 1;
        if refused > MOST_REFUSED {
            bail!("no answer of {MOST_REFUSED} could be used; nothing was written");
        }
    };
    let mut document = Document::parse(kind.text(), PROJECT_FILE);
    for question in kind.questions() {
        document = answer(input, document, question, &mut refused)?;
    }
    Ok(document)
}

/// Asks one question until its answer fits.
fn answer(
    input: &mut dyn BufRead,
    document: Document,
    question: &StarterQuestion,
    refused: &mut usize,
) -> Result<Document> {
    loop {
        write_out(&format!(
            "{} [{}] ",
            question.text,
            document.source_text_at(question.path).unwrap_or_default()
        ));
        let answer = line(input)?;
        if answer.is_empty() {
            return Ok(document);
        }
        match with_answer(&document, question.path, &answer) {
            Ok(filled) => return Ok(filled),
            Err(why) => say!("It {why}."),
        }
        *refused += 1;
        if *refused > MOST_REFUSED {
            bail!("no answer of {MOST_REFUSED} could be used; nothing was written");
        }
    }
}

/// Returns the next line without its end; an error at the end of the input.
fn line(input: &mut dyn BufRead) -> Result<String> {
    std::io::stdout().flush()?;
    let mut text = String::new();
    if input.read_line(&mut text)? == 0 {
        bail!("the input ended before the last question; nothing was written");
    }
    Ok(text.trim().to_owned())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn answers_fill_the_file_and_wrong_ones_are_asked_for_again() {
        let mut answers = "crane\ngimbal\n5 V\n800 g cm^2\n\n0.1 deg/s\n2 ms\n".as_bytes();
        let text = ask_for_machine(&mut answers).unwrap().text().to_owned();
        assert!(
            text.contains("inertia = \"800 g cm^2\"") && text.contains("sample_period = \"2 ms\""),
            "{text}"
        );
        assert!(text.contains("limit = \"0.12 N m\""), "an empty answer keeps the value: {text}");
        assert!(ask_for_machine(&mut "gimbal\n".as_bytes()).is_err(), "the input ends too early");
        assert!(ask_for_machine(&mut "x\n".repeat(30).as_bytes()).is_err(), "there is an end of asking");
    }
}
