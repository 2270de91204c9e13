//! The clock of a recording: its sample period, and what is wrong with it.

use super::shaping::{resampled as on_period, samples_of};
use super::{Channel, RecordingError};

/// Channels on one uniform clock.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Name of the file.
    pub name: String,
    /// Sample period, s.
    pub sample_period_s: f64,
    /// Time of the first sample on the file's clock, s.
    pub start_s: f64,
    /// Channels in SI units; NaN where a sample is missing.
    pub channels: Vec<(Channel, Vec<f64>)>,
    /// What was found on the way.
    pub findings: Vec<Finding>,
}

/// Something about a recording that its reader should know.
#[derive(Debug, Clone, PartialEq)]
pub enum Finding {
    /// There was no time column: the project's sample period was taken.
    PeriodAssumed {
        /// Sample period, s.
        period_s: f64,
    },
    /// Time steps are uneven; the channels were interpolated on a uniform clock.
    Uneven {
        /// Standard deviation of the steps without gaps, as a fraction of the period.
        jitter: f64,
        /// Uniform sample period, s.
        period_s: f64,
    },
    /// Samples are missing in the middle; they are NaN.
    Gap {
        /// Row after which they are missing, from 1.
        row: usize,
        /// How many.
        samples: usize,
    },
    /// Rows were written twice; they count once.
    Repeated {
        /// How many.
        rows: usize,
        /// The first, from 1.
        first_row: usize,
    },
    /// A channel has missing values.
    Missing {
        /// The channel.
        channel: Channel,
        /// How many values are missing.
        samples: usize,
        /// Row of the first, from 1.
        first_row: usize,
    },
    /// The file's period is not the one that the project gives: it was put on that.
    Resampled {
        /// Of the file, s.
        file_s: f64,
        /// Of the project, s.
        project_s: f64,
    },
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::PeriodAssumed { period_s } => {
                write!(f, "no time column: the project's sample period of {period_s} s was taken")
            }
            Self::Repeated { rows, first_row } => {
                write!(
                    f,
                    "{rows} rows repeat the row before them, the first in row {first_row}: they count once"
                )
            }
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

impl Record {
    /// A channel's values, where it was recorded.
    pub fn channel(&self, channel: Channel) -> Option<&[f64]> {
        self.channels.iter().find(|(c, _)| *c == channel).map(|(_, values)| values.as_slice())
    }

    /// Puts every channel on another period, where it is another.
    pub(super) fn resample(&mut self, wanted: Option<f64>) {
        let file_s = self.sample_period_s;
        let Some(project_s) = wanted.filter(|w| (file_s - w).abs() > SAME_PERIOD * w) else { return };
        for (channel, values) in &mut self.channels {
            *values = on_period(*channel, values, file_s, project_s);
        }
        self.sample_period_s = project_s;
        self.findings.push(Finding::Resampled { file_s, project_s });
    }

    /// The part from one time to another, s from the first sample.
    ///
    /// # Errors
    /// [`RecordingError::Window`] where the recording does not cover it.
    pub fn window(&self, window_s: [f64; 2]) -> Result<Self, RecordingError> {
        let length = self.channels.first().map_or(0, |(_, values)| values.len());
        let range = samples_of(&self.name, window_s, self.sample_period_s, length)?;
        let part = |(channel, values): &(Channel, Vec<f64>)| (*channel, values[range.clone()].to_vec());
        Ok(Self {
            name: format!("{}, {} to {} s", self.name, window_s[0], window_s[1]),
            sample_period_s: self.sample_period_s,
            start_s: self.start_s + range.start as f64 * self.sample_period_s,
            channels: self.channels.iter().map(part).collect(),
            findings: self.findings.clone(),
        })
    }

    /// The record as replay and diagnosis take it; motor angle and current are left behind.
    pub fn recording(&self) -> counterpoise_simulate::recording::Recording {
        let column = |channel| self.channel(channel).map(<[f64]>::to_vec);
        counterpoise_simulate::recording::Recording {
            name: self.name.clone(),
            sample_period_s: self.sample_period_s,
            demand_rad_s: column(Channel::Demand),
            control_v: column(Channel::Control),
            hub_rate_rad_s: column(Channel::HubRate),
            platform_rate_rad_s: column(Channel::PlatformRate),
            platform_accel_m_s2: column(Channel::PlatformAccel),
            motor_rate_rad_s: column(Channel::MotorRate),
            hub_position_rad: column(Channel::HubPosition),
        }
    }
}

/// A step that exceeds this many periods is a gap.
const GAP: f64 = 3.0;
/// Steps that scatter by less than this fraction of the period are even.
const EVEN: f64 = 1e-3;
/// A file's period may differ from the project's by this fraction.
const SAME_PERIOD: f64 = 1e-3;
/// A gap of more than this many times the recording itself is no gap but a broken clock.
const LONGEST_GAP: f64 = 10.0;
/// Fewest rows of a recording.
const FEWEST_ROWS: usize = 3;

/// Channels and their times as a record.
pub(super) fn record(
    name: &str,
    time: Option<Vec<f64>>,
    period_s: Option<f64>,
    channels: Vec<(Channel, Vec<f64>)>,
) -> Result<Record, RecordingError> {
    let mut record = match (time, period_s) {
        (Some(time), wanted) => timed(name, &time, wanted, channels)?,
        (None, Some(period_s)) => {
            let findings = vec![Finding::PeriodAssumed { period_s }];
            Record { name: name.to_owned(), sample_period_s: period_s, start_s: 0.0, channels, findings }
        }
        (None, None) => return Err(RecordingError::NoTime { file: name.to_owned() }),
    };
    let missing = record.channels.iter().filter_map(|(channel, values)| missing(*channel, values));
    record.findings.extend(missing.collect::<Vec<_>>());
    Ok(record)
}

fn missing(channel: Channel, values: &[f64]) -> Option<Finding> {
    let first = values.iter().position(|v| !v.is_finite())?;
    let samples = values.iter().filter(|v| !v.is_finite()).count();
    Some(Finding::Missing { channel, samples, first_row: first + 1 })
}

fn timed(
    name: &str,
    time: &[f64],
    wanted: Option<f64>,
    channels: Vec<(Channel, Vec<f64>)>,
) -> Result<Record, RecordingError> {
    let repeated: Vec<usize> = (1..time.len()).filter(|row| is_repeated(*row, time, &channels)).collect();
    let written = |row: &usize| time[*row].is_finite() && repeated.binary_search(row).is_err();
    let rows: Vec<usize> = (0..time.len()).filter(written).collect();
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return Err(too_short(name, 0)) };
    if rows.len() < FEWEST_ROWS {
        return Err(too_short(name, rows.len()));
    }
    let steps = steps(name, time, &rows)?;
    let median = median(&steps);
    let regular: Vec<f64> = steps.iter().copied().filter(|s| *s < GAP * median).collect();
    let jitter = deviation(&regular, mean(&regular)) / mean(&regular);
    let gaps = steps.len() != regular.len() || rows.len() != time.len();
    let mut findings = gap_findings(&rows, &steps, median);
    let again = repeated.first().map(|row| Finding::Repeated { rows: repeated.len(), first_row: row + 1 });
    findings.extend(again);
    let period = if jitter > EVEN {
        wanted.unwrap_or_else(|| mean(&regular))
    } else if gaps {
        mean(&regular)
    } else {
        (time[*last] - time[*first]) / (rows.len() - 1) as f64
    };
    let period = rounded(period, wanted, median);
    if jitter > EVEN {
        findings.push(Finding::Uneven { jitter, period_s: period });
    }
    let channels = if gaps || jitter > EVEN { resampled(time, &rows, period, channels) } else { channels };
    Ok(Record { name: name.to_owned(), sample_period_s: period, start_s: time[*first], channels, findings })
}

/// Whether a row is the one before it once more, its time included.
fn is_repeated(row: usize, time: &[f64], channels: &[(Channel, Vec<f64>)]) -> bool {
    let same = |values: &[f64]| values[row].to_bits() == values[row - 1].to_bits();
    same(time) && channels.iter().all(|(_, values)| same(values))
}

fn too_short(name: &str, rows: usize) -> RecordingError {
    RecordingError::TooShort { file: name.to_owned(), rows }
}

fn steps(name: &str, time: &[f64], rows: &[usize]) -> Result<Vec<f64>, RecordingError> {
    let step = |two: &[usize]| {
        let (before_s, time_s) = (time[two[0]], time[two[1]]);
        let stands =
            || RecordingError::TimeStandsStill { file: name.to_owned(), row: two[1] + 1, time_s, before_s };
        if time_s > before_s { Ok(time_s - before_s) } else { Err(stands()) }
    };
    let steps: Vec<f64> = rows.windows(2).map(step).collect::<Result<_, _>>()?;
    let longest = LONGEST_GAP * rows.len() as f64 * median(&steps);
    match steps.iter().position(|s| *s > longest) {
        None => Ok(steps),
        Some(at) => {
            let (before_s, time_s) = (time[rows[at]], time[rows[at + 1]]);
            Err(RecordingError::TimeLeaps { file: name.to_owned(), row: rows[at + 1] + 1, time_s, before_s })
        }
    }
}

/// Period and columns on a uniform clock.
pub(super) fn even(
    name: &str,
    time: &[f64],
    columns: Vec<Vec<f64>>,
) -> Result<(f64, Vec<Vec<f64>>), RecordingError> {
    let numbered = columns.into_iter().zip(Channel::ALL).map(|(values, channel)| (channel, values)).collect();
    let record = timed(name, time, None, numbered)?;
    Ok((record.sample_period_s, record.channels.into_iter().map(|(_, values)| values).collect()))
}

/// The period of the project, or a period of a whole number of microseconds, where the file's means it.
fn rounded(period: f64, wanted: Option<f64>, median: f64) -> f64 {
    const MEANT: f64 = 1e-6;
    let micro = (median * 1e6).round() * 1e-6;
    let near = |p: f64| p > 0.0 && (period - p).abs() <= MEANT * p;
    wanted.filter(|w| near(*w)).unwrap_or(if near(micro) { micro } else { period })
}

fn gap_findings(rows: &[usize], steps: &[f64], median: f64) -> Vec<Finding> {
    let gap = |(at, step): (usize, &f64)| {
        let samples = (step / median).round() as usize - 1;
        (*step >= GAP * median).then(|| Finding::Gap { row: rows[at] + 1, samples })
    };
    steps.iter().enumerate().filter_map(gap).collect()
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn deviation(values: &[f64], centre: f64) -> f64 {
    (values.iter().map(|v| (v - centre) * (v - centre)).sum::<f64>() / values.len() as f64).sqrt()
}

/// Channels by linear interpolation on a uniform clock, NaN inside gaps.
fn resampled(
    time: &[f64],
    rows: &[usize],
    period: f64,
    channels: Vec<(Channel, Vec<f64>)>,
) -> Vec<(Channel, Vec<f64>)> {
    let instants = instants(time, rows, period);
    let at = |values: &[f64], (row, fraction): (usize, Option<f64>)| match fraction {
        Some(0.0) => values[rows[row]],
        Some(f) => values[rows[row]] * (1.0 - f) + values[rows[row + 1]] * f,
        None => f64::NAN,
    };
    let channel = |(channel, values): (Channel, Vec<f64>)| {
        (channel, instants.iter().map(|place| at(&values, *place)).collect())
    };
    channels.into_iter().map(channel).collect()
}

/// For each uniform instant: the row at or before it, and how far it lies to the next row (none inside a gap).
fn instants(time: &[f64], rows: &[usize], period: f64) -> Vec<(usize, Option<f64>)> {
    let (first, last) = (time[rows[0]], time[rows[rows.len() - 1]]);
    let count = ((last - first) / period + EVEN).floor() as usize + 1;
    let mut row = 0;
    let place = |index: usize| {
        let t = first + index as f64 * period;
        while row + 1 < rows.len() && time[rows[row + 1]] <= t {
            row += 1;
        }
        if row + 1 == rows.len() {
            return (row, Some(0.0));
        }
        let step = time[rows[row + 1]] - time[rows[row]];
        let fraction = (t - time[rows[row]]) / step;
        let inside = if step < GAP * period { Some(fraction) } else { None };
        let on_a_sample = fraction * step < EVEN * period;
        (row, if on_a_sample { Some(0.0) } else { inside })
    };
    (0..count).map(place).collect()
}
