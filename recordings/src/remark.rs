//! Remarks: what the reader of a recording should know although the recording can be used.

use std::fmt;

use crate::Channel;

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
            Self::Resampled { file_s, project_s } if file_s < project_s => {
                write!(f, "sampled every {file_s} s: averaged to the project's {project_s} s")
            }
            Self::Resampled { file_s, project_s } => {
                write!(f, "sampled every {file_s} s: interpolated to the project's {project_s} s")
            }
        }
    }
}
