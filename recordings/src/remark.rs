//! Remarks: what the reader of a recording should know although the recording can be used.

use crate::Channel;
use crate::time_unit::DoubtfulUnit;

/// Why a column of a file was not read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum UnreadReason {
    /// The column holds something else than real numbers.
    #[error("it holds {holds}, not real numbers")]
    Type {
        /// The contents, in the plural.
        holds: String,
    },
    /// The column has another length than the columns that were read.
    #[error("it has {length} values, the columns that were read {rows}")]
    Length {
        /// Length.
        length: usize,
        /// Length of the columns that were read.
        rows: usize,
    },
    /// The column has more than two dimensions, or its dimensions do not match its values.
    #[error("its shape is {}, but a column or a matrix of columns is needed", sizes(shape))]
    Shape {
        /// Dimensions.
        shape: Vec<u64>,
    },
    /// The values cannot be decoded.
    #[error("it cannot be decoded: {why}")]
    Undecodable {
        /// The message of the reader.
        why: String,
    },
}

fn sizes(shape: &[u64]) -> String {
    shape.iter().map(u64::to_string).collect::<Vec<_>>().join(" x ")
}

/// Something that the user of a recording should know.
#[derive(Debug, Clone, PartialEq)]
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
        why: UnreadReason,
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
        /// Value, in the channel's unit.
        value: f64,
    },
    /// The file's sample period differs from the project's, so the channels were put on the project's.
    Resampled {
        /// Sample period of the file, s.
        file_s: f64,
        /// Sample period of the project, s.
        project_s: f64,
        /// Set if the steps are so far from the project's that the unit of the time is in doubt.
        doubt: Option<DoubtfulUnit>,
    },
}
