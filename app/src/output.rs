//! The printed output: results for a person or a machine, errors with their cause, times of stages.

use std::io::Write;
use std::path::Path;

use anyhow::Result;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::options::ResultOutput;
use counterpoise_host::files::state_folder;
use counterpoise_host::journals::has_unsaved_edits;
use counterpoise_host::json::json_text;
use counterpoise_host::projects::{self, BadProject, ProjectOnDisk};
use counterpoise_host::result_files::{ResultFolder, ResultTable, number_cell};
use counterpoise_host::stages::ProgressDisplay;
use counterpoise_host::terminal::escape_controls;
use counterpoise_host::terminal::{error_causes, print_message};
use counterpoise_pipeline::exchange::SCHEMA;
use counterpoise_pipeline::recordings::tracks::{ChannelTrack, TrackColumn};
use counterpoise_project::diagnostic::first_findings;
use counterpoise_report::adaptation::{EXPORTED_BY_BANDS, LEFT_OUT_BY_TRIALS};
use counterpoise_report::figure_tables::{FigureRow, figure_tables};
use counterpoise_report::wording::errors::describe_error;
use counterpoise_report::{Report, html_page};

/// Exit code of a program whose standard output was lost: a full disk, or a reader that has gone away.
const LOST: i32 = 3;

/// Writes to standard output, harmless on a terminal. Where this fails the result is lost, so the program ends with [`LOST`]; a reader
/// that has gone away, as in `| head`, knows why and is told nothing.
pub fn write_out(text: &str) {
    let mut out = std::io::stdout().lock();
    if let Err(error) = out.write_all(escape_controls(text).as_bytes()).and_then(|()| out.flush()) {
        if error.kind() != std::io::ErrorKind::BrokenPipe {
            print_message(&format!("error: the result could not be written to the standard output: {error}"));
        }
        std::process::exit(LOST);
    }
}

/// `println!` for results: see [`write_out`].
macro_rules! say {
    () => { $crate::output::write_out("\n") };
    ($($text:tt)*) => { $crate::output::write_out(&(format!($($text)*) + "\n")) };
}
pub(crate) use say;

/// Prints lines to standard output.
pub fn print_lines(lines: &[String]) {
    lines.iter().for_each(|line| say!("{line}"));
}

/// Returns an error and its causes, one below the other. A cause that the line above it quotes is not repeated.
/// The errors of a project file say of themselves that they are errors, each after its place.
pub fn error_chain(error: &anyhow::Error) -> String {
    let told = error_causes(error, describe_error).join("\n  because: ");
    let is_list = error.chain().next().is_some_and(|first| first.is::<BadProject>());
    if is_list { told } else { format!("error: {told}") }
}

/// Writes a result as JSON and as files of data where that was asked for; says whether the JSON went to standard output.
pub fn write_result<T: Serialize>(results: &ResultOutput, result: &T) -> Result<bool> {
    if let Some(folder) = &results.data {
        let mut files = ResultFolder::new(folder).with_matlab(results.matlab);
        files.write_result(result)?;
        files.write_contents()?;
    }
    let Some(target) = &results.json else { return Ok(false) };
    let text = with_schema(json_text(result)?);
    if [Path::new("-"), Path::new("/dev/stdout")].contains(&target.as_path()) {
        write_out(&text);
        return Ok(true);
    }
    projects::write_file(target, text.as_bytes())?;
    Ok(false)
}

/// Writes a list as [`write_result`] does; it stands under a key so that the result can state its schema.
pub fn write_list<T: Serialize>(results: &ResultOutput, key: &'static str, list: &[T]) -> Result<bool> {
    write_result(results, &KeyedList { key, list })
}

/// Writes a report, and the tables of its figures where files of data were asked for.
pub fn write_report(path: &Path, results: &ResultOutput, report: &Report) -> Result<()> {
    projects::write_file(path, html_page(report).as_bytes())?;
    write_figures(results, report)
}

/// Writes the tables of a report's figures where files of data were asked for.
pub fn write_figures(results: &ResultOutput, report: &Report) -> Result<()> {
    let Some(folder) = &results.data else { return Ok(()) };
    let mut files = ResultFolder::new(&folder.join("figures"));
    for (k, table) in figure_tables(report).into_iter().enumerate() {
        let name = format!("{:03}_{}", k + 1, table.title);
        let cells = |row: FigureRow| {
            std::iter::once(row.curve).chain(row.values.iter().map(|value| number_cell(*value))).collect()
        };
        let rows = table.rows.into_iter().map(cells).collect();
        files.write_table(&ResultTable { name, columns: table.columns, rows })?;
    }
    files.write_contents()
}

/// Writes what was measured beside what the models simulate, a table for each recording, where files of data were asked for: `before` is the
/// model as it was, `after` the improved one if there is one.
pub fn write_tracks<'t>(
    results: &ResultOutput,
    tracks: impl IntoIterator<Item = &'t ChannelTrack>,
) -> Result<()> {
    let Some(folder) = &results.data else { return Ok(()) };
    let mut files = ResultFolder::new(&folder.join("series"));
    let mut groups: Vec<Vec<&ChannelTrack>> = Vec::new();
    for track in tracks {
        // recordings of one name in two folders are two tables
        let belongs = |group: &&mut Vec<&ChannelTrack>| {
            group[0].recording == track.recording && group.iter().all(|other| other.channel != track.channel)
        };
        match groups.last_mut().filter(belongs) {
            Some(group) => group.push(track),
            None => groups.push(vec![track]),
        }
    }
    groups.iter().try_for_each(|group| files.write_table(&track_table(group)))?;
    files.write_contents()
}

/// Returns the channels of a recording as a table over time.
fn track_table(tracks: &[&ChannelTrack]) -> ResultTable {
    let runs =
        [(TrackColumn::Measured, "measured"), (TrackColumn::Before, "before"), (TrackColumn::After, "after")];
    let mut columns = vec!["time [s]".to_owned()];
    let mut series: Vec<&[f64]> = Vec::new();
    for track in tracks {
        for (run, word) in runs.into_iter().filter(|(run, _)| track.signals.has(*run)) {
            columns.push(format!("{} {word} [{}]", track.words.name, track.words.unit));
            series.push(track.signals.column(run));
        }
    }
    let length = series.first().map_or(0, |column| column.len());
    let row = |k: usize| {
        let time = tracks.first().map_or(0.0, |track| k as f64 * track.period_s);
        let values = series.iter().map(|column| column.get(k).copied().unwrap_or(f64::NAN));
        std::iter::once(time).chain(values).map(number_cell).collect()
    };
    let name = tracks.first().map_or_else(String::new, |track| track.recording.clone());
    ResultTable { name, columns, rows: (0..length).map(row).collect() }
}

/// A list under a key.
struct KeyedList<'a, T> {
    key: &'static str,
    list: &'a [T],
}

impl<T: Serialize> Serialize for KeyedList<'_, T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(1))?;
        map.serialize_entry(self.key, self.list)?;
        map.end()
    }
}

/// Returns the JSON of a result, which is an object, with the name and version of its schema first, unless it states them already.
fn with_schema(text: String) -> String {
    let own = "\n  \"schema\": ";
    match text.strip_prefix("{\n") {
        Some(rest) if !text.contains(own) => format!("{{{own}\"{SCHEMA}\",\n{rest}"),
        _ => text,
    }
}

/// Prints a note if the studio holds edits of a project that are not in its file.
pub fn note_unsaved_edits(path: &Path) {
    if has_unsaved_edits(&state_folder(), path) {
        let path = path.display();
        eprintln!(
            "note: the studio holds edits of {path} that are not in the file; open it there to save or discard them"
        );
    }
}

/// Prints what is suspicious in a project file.
pub fn print_warnings(loaded: &ProjectOnDisk, progress: ProgressDisplay) {
    if progress == ProgressDisplay::Shown {
        note_unsaved_edits(&loaded.path);
        if loaded.adaptation_is_left_out() {
            eprintln!("note: {LEFT_OUT_BY_TRIALS}; {EXPORTED_BY_BANDS}");
        }
        let lines = first_findings(&loaded.warnings, ToString::to_string);
        lines.iter().for_each(|warning| print_message(warning));
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_result_states_its_schema_once() {
        let with = |value: serde_json::Value| with_schema(json_text(&value).unwrap());
        assert_eq!(
            with(serde_json::json!({"a": 1})),
            "{\n  \"schema\": \"counterpoise.results/2\",\n  \"a\": 1\n}\n"
        );
        let stated = serde_json::json!({"a": 1, "schema": SCHEMA});
        assert_eq!(with(stated.clone()), json_text(&stated).unwrap());
        let inner = serde_json::json!({"a": {"schema": SCHEMA}});
        assert!(with(inner).starts_with("{\n  \"schema\": "));
        let listed = json_text(&KeyedList { key: "files", list: &["a.c"] }).unwrap();
        let expected = serde_json::json!({"schema": SCHEMA, "files": ["a.c"]});
        assert_eq!(serde_json::from_str::<serde_json::Value>(&with_schema(listed)).unwrap(), expected);
        assert_eq!(with(serde_json::json!({})), "{}\n");
    }

    #[test]
    fn a_cause_that_was_quoted_is_not_said_twice() {
        let cause = anyhow::anyhow!("the matrix is singular");
        assert_eq!(
            error_chain(&cause.context("design: the matrix is singular")),
            "error: design: the matrix is singular"
        );
        let cause = anyhow::anyhow!("no space left");
        assert_eq!(
            error_chain(&cause.context("cannot write a.c")),
            "error: cannot write a.c\n  because: no space left"
        );
    }
}
