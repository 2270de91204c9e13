//! What can be wrong with a recording.

/// The ways in which a recording can be refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file cannot be read as what it seems to be.
    #[error("{file}: not a readable {kind} file: {why}")]
    Unreadable {
        /// The file.
        file: String,
        /// What it seems to be.
        kind: &'static str,
        /// What the reader says.
        why: String,
    },
    /// A cell that is not a number.
    #[error("{file}:{line}: column \"{column}\": \"{value}\" is not a number")]
    Cell {
        /// The file.
        file: String,
        /// Line of the file, from 1.
        line: u64,
        /// Name of the column.
        column: String,
        /// What stands there.
        value: String,
    },
    /// A row with more or fewer cells than the header.
    #[error("{file}:{line}: {cells} cells, but the header has {columns}")]
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
    #[error("{file}: there is no row of numbers")]
    Empty {
        /// The file.
        file: String,
    },
    /// Two columns of one name.
    #[error("{file}: two columns are named \"{column}\"")]
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
        /// Its length.
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
    #[error("{file}: column \"{column}\": unit [{unit}] is not known")]
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
    #[error("{file}: there is no time column and no recording.sample_period in the project file")]
    NoTime {
        /// The file.
        file: String,
    },
    /// Time does not grow.
    #[error("{file}: time does not grow: row {row} is at {time_s} s after {before_s} s")]
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
    #[error("{file}: time leaps: row {row} is at {time_s} s after {before_s} s")]
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
    /// Too few rows to tell a sample period.
    #[error("{file}: {rows} rows with a time are too few for a recording")]
    TooShort {
        /// The file.
        file: String,
        /// Rows with a time.
        rows: usize,
    },
}
