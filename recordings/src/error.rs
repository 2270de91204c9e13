//! The errors of recordings.

use crate::UnreadReason;

/// The ways in which a recording can be refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file cannot be read as what it seems to be.
    #[error("{file}: not a readable {kind} file: {why}")]
    Unreadable {
        /// The file.
        file: String,
        /// The format that it seems to have.
        kind: &'static str,
        /// The message of the reader.
        why: String,
    },
    /// The first bytes are neither text nor those of a format that is read.
    #[error(
        "{file}: this is neither text nor a file of a known format; recordings are CSV, Parquet, MATLAB (version 5 or 7.3), \
         HDF5 or NumPy (.npy, .npz) files, not packed in another archive"
    )]
    UnknownFormat {
        /// The file.
        file: String,
    },
    /// Reading the file would take more memory than its size makes plausible.
    #[error(
        "{file}: reading it would take {} MiB, more than the {} MiB that are allowed for a file of this size; \
         read a shorter part, check the shape of \"{column}\", or save it as CSV, which `replay` reads in parts",
        bytes >> 20,
        limit >> 20
    )]
    TooLarge {
        /// The file.
        file: String,
        /// The column at which the limit was exceeded.
        column: String,
        /// Estimated memory, bytes.
        bytes: u64,
        /// Allowed memory, bytes.
        limit: u64,
    },
    /// The checksum of a column does not match its values.
    #[error("{file}: column \"{column}\" is damaged ({why}): copy the file again from where it was recorded")]
    Checksum {
        /// The file.
        file: String,
        /// The column.
        column: String,
        /// The message of the reader.
        why: String,
    },
    /// A CSV file whose first row holds numbers.
    #[error(
        "{file}: the first row ({first}) holds numbers, but must name the columns: put a row such as \
         \"time [s],hub_rate [rad/s]\" before it"
    )]
    NoHeader {
        /// The file.
        file: String,
        /// The first row.
        first: String,
    },
    /// A cell that is not a number.
    #[error(
        "{file}:{line}: column \"{column}\": \"{}\" is not a number; a cell holds one number (such as 0.25 or 1e-3), or is empty if the \
         sample is missing",
        shorten_text(value)
    )]
    Cell {
        /// The file.
        file: String,
        /// Line of the file, from 1.
        line: u64,
        /// Name of the column.
        column: String,
        /// The text that stands there.
        value: String,
    },
    /// A row with more or fewer cells than the header.
    #[error(
        "{file}:{line}: {cells} cells, but the header has {columns}: every row needs as many cells as the header; separate them by commas, \
         or by semicolons if the comma is the decimal mark"
    )]
    Row {
        /// The file.
        file: String,
        /// Line of the file, from 1.
        line: u64,
        /// Cells of the row.
        cells: usize,
        /// Cells of the header.
        columns: usize,
    },
    /// No rows.
    #[error(
        "{file}: there is no row of numbers: write the names of the columns in one row, and one row for each sample below it"
    )]
    Empty {
        /// The file.
        file: String,
    },
    /// No column could be read.
    #[error("{file}: there is no column of numbers: column \"{column}\" was not read: {why}")]
    NothingRead {
        /// The file.
        file: String,
        /// The first column that was not read.
        column: String,
        /// Why.
        why: UnreadReason,
    },
    /// Two columns of one name.
    #[error("{file}: two columns are named \"{column}\": give every column a name of its own")]
    SameName {
        /// The file.
        file: String,
        /// The name.
        column: String,
    },
    /// Columns of different length.
    #[error("{file}: column \"{column}\" has {length} values, the first column {rows}")]
    Length {
        /// The file.
        file: String,
        /// The column.
        column: String,
        /// Length.
        length: usize,
        /// Length of the first column.
        rows: usize,
    },
    /// A column that the file does not have.
    #[error("{file}: there is no column \"{column}\"; it has {known}{}", hint.as_ref().map_or(String::new(), |h| format!(" (did you mean \"{h}\"?)")))]
    NoColumn {
        /// The file.
        file: String,
        /// The column asked for.
        column: String,
        /// The columns that there are.
        known: String,
        /// The nearest of them.
        hint: Option<String>,
    },
    /// A unit that is not known.
    #[error(
        "{file}: column \"{column}\": unit [{unit}] is not known; units are made of rad, deg, m, s, g, V, A, N and the like, for example \
         [deg/s], [mV] or [m/s^2]"
    )]
    UnknownUnit {
        /// The file.
        file: String,
        /// The column.
        column: String,
        /// The unit as written.
        unit: String,
    },
    /// A unit of another quantity.
    #[error("{file}: column \"{column}\" is in [{unit}], but {channel} is in [{wanted}]")]
    WrongUnit {
        /// The file.
        file: String,
        /// The column.
        column: String,
        /// The unit as written.
        unit: String,
        /// The channel.
        channel: &'static str,
        /// The channel's unit.
        wanted: &'static str,
    },
    /// Neither a time column nor a sample period.
    #[error(
        "{file}: there is no time column and no recording.sample_period in the project file: name a column \"time [s]\", or set the period"
    )]
    NoTime {
        /// The file.
        file: String,
    },
    /// The time column has no unit, and its steps are far from the project's sample period.
    #[error(
        "{file}: the time column has no unit, and in seconds its steps of {file_s} s are far from the sample period of {project_s} s{}: \
         write the unit in the column's heading, such as \"time [ms]\", or give it where the project file maps time",
        meant.map_or(String::new(), |unit| format!("; are they {unit}?"))
    )]
    TimeUnit {
        /// The file.
        file: String,
        /// Median step of the time column, taken as seconds.
        file_s: f64,
        /// Sample period of the project, s.
        project_s: f64,
        /// The unit in which the steps would match the sample period.
        meant: Option<&'static str>,
    },
    /// Time does not grow.
    #[error(
        "{file}: time does not grow: row {row} is at {time_s} s after {before_s} s; split the file there, or sort its rows"
    )]
    TimeStandsStill {
        /// The file.
        file: String,
        /// Row, from 1.
        row: usize,
        /// Time of the row, s.
        time_s: f64,
        /// Time of the row before it, s.
        before_s: f64,
    },
    /// Time leaps by far more than the recording's length.
    #[error("{file}: time leaps: row {row} is at {time_s} s after {before_s} s; split the file there")]
    TimeLeaps {
        /// The file.
        file: String,
        /// Row, from 1.
        row: usize,
        /// Time of the row, s.
        time_s: f64,
        /// Time of the row before it, s.
        before_s: f64,
    },
    /// A window that the recording does not cover.
    #[error(
        "{file}: recording.windows: from {from_s} s to {to_s} s is not within the recording's 0 to {length_s} s"
    )]
    Window {
        /// The file.
        file: String,
        /// Start of the window, s from the first sample.
        from_s: f64,
        /// End of the window, s.
        to_s: f64,
        /// Length of the recording, s.
        length_s: f64,
    },
    /// A recording that cannot serve as the platform's motion.
    #[error("{file}: not usable as a road: {why}")]
    Road {
        /// The file.
        file: String,
        /// Why.
        why: String,
    },
    /// On the sample period, the recording would take too much memory.
    #[error(
        "{file}: every {period_s} s it would have {samples} samples, which take {} MiB, but at most {} MiB are allowed: \
         check the unit of its time column, or give a longer sample period",
        bytes >> 20,
        limit >> 20
    )]
    TooLong {
        /// The file.
        file: String,
        /// Sample period, s.
        period_s: f64,
        /// Number of samples.
        samples: f64,
        /// Estimated memory, bytes.
        bytes: u64,
        /// Allowed memory, bytes.
        limit: u64,
    },
    /// Too few rows to tell a sample period.
    #[error("{file}: a recording needs at least 3 rows with a time, and this file has {rows}")]
    TooShort {
        /// The file.
        file: String,
        /// Rows with a time.
        rows: usize,
    },
}

/// Returns a text that a message quotes, cut if it is long.
fn shorten_text(text: &str) -> String {
    /// Characters of a quoted text.
    const LONGEST: usize = 40;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}
