//! Remarks: what the reader of a recording should know although the recording can be used.

use std::fmt;

use crate::Channel;
use crate::time_unit::{DoubtfulUnit, doubtful_unit};

/// Why a column of a file was not read.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Unread {
    /// It holds something else than real numbers.
    Type {
        /// What it holds, in the plural.
        holds: String,
    },
    /// It has another length than the columns that were read.
    Length {
        /// Its length.
        length: usize,
        /// Length of the columns that were read.
        rows: usize,
    },
    /// It has more than two dimensions, or its dimensions do not match its values.
    Shape {
        /// Its dimensions.
        shape: Vec<u64>,
    },
    /// Its values cannot be decoded.
    Undecodable {
        /// What the reader says.
        why: String,
    },
}

/// Something that the user of a recording should know.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Remark {
    /// The file has no time column, so the project's sample period was used.
    PeriodAssumed {
        /// Sample period, s.
        period_s: f64,
    },
    /// The time steps are uneven, so the channels were interpolated on a uniform clock.
    Uneven {
        /// Standard deviation of the steps without gaps, as a fraction of the period.
        jitter: f64,
        /// Uniform sample period, s.
        period_s: f64,
    },
    /// Samples are missing between two rows; they are NaN.
    Gap {
        /// Row after which they are missing, from 1.
        row: usize,
        /// Number of missing samples.
        samples: usize,
    },
    /// Rows repeat the row before them; they count once.
    Repeated {
        /// Number of such rows.
        rows: usize,
        /// The first of them, from 1.
        first_row: usize,
    },
    /// A channel has missing values.
    Missing {
        /// The channel.
        channel: Channel,
        /// Number of missing values.
        samples: usize,
        /// Row of the first, from 1.
        first_row: usize,
    },
    /// A column of the file was not read.
    Unread {
        /// The column.
        column: String,
        /// Why.
        why: Unread,
    },
    /// A column that is not used has nearly the name of a channel, or of time, that was not found.
    NearlyNamed {
        /// The column.
        column: String,
        /// The name of the channel, or `time`.
        meant: &'static str,
    },
    /// A channel has infinite values; they count as missing.
    Infinite {
        /// The channel.
        channel: Channel,
        /// Number of infinite values.
        samples: usize,
        /// Row of the first, from 1.
        first_row: usize,
    },
    /// Further columns were not read or are not used.
    Further {
        /// Number of columns.
        columns: usize,
    },
    /// Readings of a channel are far from those before and after, which agree with each other; they count as missing.
    Outliers {
        /// The channel.
        channel: Channel,
        /// Number of such readings.
        samples: usize,
        /// The first of them, from 1.
        first_row: usize,
        /// Its value, in the channel's unit.
        value: f64,
    },
    /// The file's sample period differs from the project's, so the channels were put on the project's.
    Resampled {
        /// Sample period of the file, s.
        file_s: f64,
        /// Sample period of the project, s.
        project_s: f64,
    },
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PeriodAssumed { period_s } => {
                write!(f, "no time column: the project's sample period of {period_s} s was taken")
            }
            Self::Repeated { rows, first_row } => write!(
                f,
                "{rows} rows repeat the row before them, the first in row {first_row}: they count once"
            ),
            Self::Uneven { jitter, period_s } => {
                write!(f, "time steps vary by {:.2} %: interpolated every {period_s:.6} s", 100.0 * jitter)
            }
            Self::Gap { row, samples } => write!(f, "{samples} samples are missing after row {row}"),
            Self::Missing { channel, samples, first_row } => {
                write!(f, "{}: {samples} values are missing, the first in row {first_row}", channel.name())
            }
            Self::Unread { column, why } => write!(f, "column \"{column}\" was not read: {why}"),
            Self::NearlyNamed { column, meant } => write!(
                f,
                "column \"{column}\" is not used: if it is {meant}, name it so, or map {meant} to it in the project file"
            ),
            Self::Infinite { channel, samples, first_row } => write!(
                f,
                "{}: {samples} values are infinite, the first in row {first_row}: they count as missing",
                channel.name()
            ),
            Self::Outliers { channel, samples, first_row, value } => write!(
                f,
                "{}: {samples} reading{} far from those before and after, the first in row {first_row} ({value} {}): \
                 {} as missing; check the recorder",
                channel.name(),
                if *samples == 1 { " is" } else { "s are" },
                channel.unit(),
                if *samples == 1 { "it counts" } else { "they count" }
            ),
            Self::Further { columns } => {
                write!(f, "{columns} further columns were not read or are not used")
            }
            Self::Resampled { file_s, project_s } => {
                let how = if file_s < project_s { "averaged" } else { "interpolated" };
                write!(f, "sampled every {file_s} s: {how} to the project's {project_s} s")?;
                match doubtful_unit(*file_s, *project_s) {
                    Some(DoubtfulUnit { meant: Some(unit) }) => write!(f, "; is its time in {unit}?"),
                    Some(DoubtfulUnit { meant: None }) => write!(f, "; check the unit of its time"),
                    None => Ok(()),
                }
            }
        }
    }
}

impl fmt::Display for Unread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Type { holds } => write!(f, "it holds {holds}, not real numbers"),
            Self::Length { length, rows } => {
                write!(f, "it has {length} values, the columns that were read {rows}")
            }
            Self::Shape { shape } => {
                let sizes: Vec<String> = shape.iter().map(u64::to_string).collect();
                write!(f, "its shape is {}, but a column or a matrix of columns is needed", sizes.join(" x "))
            }
            Self::Undecodable { why } => write!(f, "it cannot be decoded: {why}"),
        }
    }
}
