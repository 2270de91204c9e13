//! The manual's page of commands, written from the grammar of the command line and tested to be current.
//!
//! `WRITE_MANUAL=1 cargo test --release -p counterpoise commands_page` regenerates `docs/reference/commands.md`.

use clap::{Arg, ArgAction, Command, CommandFactory};

use crate::arguments::Arguments;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/reference/commands.md");

const INTRODUCTION: &str = "# Commands

This page is generated from the grammar of the command line; a test keeps it current. The how-to pages explain each command.

`PROJECT` is a project file, or a folder with a `project.toml`. `--json FILE` and `--json=FILE` mean the same; without a file the result goes to
standard output. An option that is not UTF-8 is refused; a path may be any that the system knows.

| exit code | meaning |
|---|---|
| 0 | the work is done, and all verdicts hold |
| 1 | the work is done, and at least one verdict fails: a requirement, code that the project asks for and that cannot be made, or compiled code that answers otherwise than its model |
| 2 | bad input: nothing was done, or it ended before its end; the standard error stream says why |
| 3 | the result could not be written to the standard output (a full disk, or a reader that has gone away) |
| 130 | interrupted by Ctrl-C; what was finished is kept |
";

/// Returns the page: one section for each command, in the order of `--help`.
fn page() -> String {
    let mut grammar = Arguments::command();
    grammar.build();
    let sections = grammar.get_subcommands().filter(|command| command.get_name() != "help").map(section);
    std::iter::once(INTRODUCTION.to_owned()).chain(sections).collect::<Vec<_>>().join("\n")
}

fn section(command: &Command) -> String {
    let name = command.get_name();
    let about = command.get_about().map(ToString::to_string).unwrap_or_default();
    let usage = command.clone().render_usage().to_string();
    let usage = usage.trim_start_matches("Usage: ");
    let shown: Vec<&Arg> =
        command.get_arguments().filter(|a| !a.is_hide_set() && a.get_id() != "help").collect();
    let rows: String = shown.into_iter().map(row).collect();
    format!(
        "## `{name}`\n\n{about}.\n\n    {usage}\n\n| argument | if absent | meaning |\n|---|---|---|\n{rows}"
    )
}

fn row(argument: &Arg) -> String {
    let help = argument.get_help().map(ToString::to_string).unwrap_or_default();
    let choices = choices(argument).unwrap_or_default();
    cells(&[&spelling(argument), &default(argument), &format!("{help}{choices}")])
}

/// Returns the argument as a user writes it: `--report FILE`, `-o, --output FOLDER` or `PROJECT`.
fn spelling(argument: &Arg) -> String {
    let names = [
        argument.get_short().map(|short| format!("-{short}")),
        argument.get_long().map(|long| format!("--{long}")),
    ];
    let names = names.into_iter().flatten().collect::<Vec<_>>().join(", ");
    let values = argument.get_value_names().unwrap_or_default();
    let many = if takes_many(argument) { "..." } else { "" };
    let value = values.iter().map(|value| format!("{value}{many}")).collect::<Vec<_>>().join(" ");
    let takes_value = matches!(argument.get_action(), ArgAction::Set | ArgAction::Append);
    match (names.is_empty(), takes_value) {
        (true, _) => format!("`{value}`"),
        (false, true) => format!("`{names} {value}`"),
        (false, false) => format!("`{names}`"),
    }
}

fn takes_many(argument: &Arg) -> bool {
    let count = argument.get_num_args().is_some_and(|range| range.max_values() > 1);
    count || matches!(argument.get_action(), ArgAction::Append) && argument.get_value_delimiter().is_none()
}

fn default(argument: &Arg) -> String {
    let values: Vec<String> =
        argument.get_default_values().iter().map(|value| format!("`{}`", value.to_string_lossy())).collect();
    let is_flag = !matches!(argument.get_action(), ArgAction::Set | ArgAction::Append);
    match (argument.is_required_set(), is_flag) {
        (true, _) => "required".to_owned(),
        (false, true) => String::new(),
        (false, false) => values.join(", "),
    }
}

/// Returns what the argument may be, each choice with its meaning; `None` if it may be anything.
fn choices(argument: &Arg) -> Option<String> {
    let takes_value = matches!(argument.get_action(), ArgAction::Set | ArgAction::Append);
    let values = argument.get_possible_values();
    let said = |value: &clap::builder::PossibleValue| {
        let help = value.get_help().map(|help| format!(": {help}")).unwrap_or_default();
        format!("<br>`{}`{help}", value.get_name())
    };
    (takes_value && !values.is_empty()).then(|| values.iter().map(said).collect())
}

/// Returns a row of a Markdown table; bars would end a cell, so they are escaped.
fn cells(texts: &[&str]) -> String {
    let escaped: Vec<String> = texts.iter().map(|text| text.replace('|', "\\|").replace('\n', " ")).collect();
    format!("| {} |\n", escaped.join(" | "))
}

#[test]
#[allow(clippy::unwrap_used)]
fn the_page_of_commands_is_current() {
    if std::env::var_os("WRITE_MANUAL").is_some() {
        std::fs::write(PAGE, page()).unwrap();
    }
    let written = std::fs::read_to_string(PAGE).unwrap_or_default();
    for (number, (written, grammar)) in written.lines().zip(page().lines()).enumerate() {
        assert_eq!(written, grammar, "line {} of docs/reference/commands.md", number + 1);
    }
    assert_eq!(written.lines().count(), page().lines().count());
}
