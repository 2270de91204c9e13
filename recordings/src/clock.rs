//! The clock of a file: its sample period, what is wrong with it, and signals on a uniform clock.

use ndarray::{Array2, ArrayView1, ArrayView2, ShapeBuilder as _};

use crate::tolerance::{EVEN_STEPS, FEWEST_ROWS, GAP_PERIODS, LONGEST_GAP, SAME_PERIOD_BY_ROUNDING};
use crate::{Error, Remark};

/// Signals on a uniform clock may take so many bytes in all.
const LARGEST: u64 = 1 << 30;

/// Signals on one uniform clock.
#[derive(Debug, Clone, PartialEq)]
pub struct UniformSignals {
    /// Sample period, s.
    pub period_s: f64,
    /// Time of the first sample, s.
    pub start_s: f64,
    /// The signals, time x signal, each column contiguous in memory; NaN inside gaps.
    pub signals: Array2<f64>,
    /// Remarks on the clock.
    pub remarks: Vec<Remark>,
}

/// The rows of a file that count, and the steps between them.
struct Steps {
    /// Rows with a time, without those that repeat the row before them.
    rows: Vec<usize>,
    /// Steps between those rows, s.
    steps_s: Vec<f64>,
    /// Median step, s.
    median_s: f64,
    /// Rows that repeat the row before them.
    repeated: Vec<usize>,
}

/// Returns signals on a uniform clock, from the time of each of their samples; `signals` is time x signal.
///
/// Even time is kept; uneven time is evened out by linear interpolation; gaps become NaN; rows without a time and rows that repeat
/// the row before them are dropped. A period that is within rounding of `wanted_s` is set to it.
///
/// # Errors
/// Time does not grow, it leaps by many times the recording's length, or too few rows have a time.
pub fn to_uniform_clock(
    file: &str,
    time_s: ArrayView1<'_, f64>,
    wanted_s: Option<f64>,
    signals: Array2<f64>,
) -> Result<UniformSignals, Error> {
    let found = Steps::of(file, time_s, &signals)?;
    let Steps { rows, steps_s, median_s, .. } = &found;
    let regular: Vec<f64> = steps_s.iter().copied().filter(|s| *s < GAP_PERIODS * median_s).collect();
    let jitter = deviation(&regular, mean(&regular)) / mean(&regular);
    let has_gaps = steps_s.len() != regular.len() || rows.len() != time_s.len();
    let (first, last) = (rows[0], rows[rows.len() - 1]);
    let period_s = if jitter > EVEN_STEPS {
        wanted_s.unwrap_or_else(|| mean(&regular))
    } else if has_gaps {
        mean(&regular)
    } else {
        (time_s[last] - time_s[first]) / (rows.len() - 1) as f64
    };
    let period_s = round_period(period_s, wanted_s, *median_s);
    let mut remarks = found.remarks();
    if jitter > EVEN_STEPS {
        remarks.push(Remark::Uneven { jitter, period_s });
    }
    let is_uneven = has_gaps || jitter > EVEN_STEPS;
    if is_uneven {
        check_length(file, time_s[last] - time_s[first], period_s, signals.ncols())?;
    }
    let signals =
        if is_uneven { interpolate_signals(time_s, rows, period_s, signals.view()) } else { signals };
    Ok(UniformSignals { period_s, start_s: time_s[first], signals, remarks })
}

impl Steps {
    fn of(file: &str, time_s: ArrayView1<'_, f64>, signals: &Array2<f64>) -> Result<Self, Error> {
        let repeated: Vec<usize> =
            (1..time_s.len()).filter(|row| is_repeated(*row, time_s, signals)).collect();
        let counts = |row: &usize| time_s[*row].is_finite() && repeated.binary_search(row).is_err();
        let rows: Vec<usize> = (0..time_s.len()).filter(counts).collect();
        if rows.len() < FEWEST_ROWS {
            return Err(Error::TooShort { file: file.to_owned(), rows: rows.len() });
        }
        let steps_s = steps(file, time_s, &rows)?;
        let median_s = median(&steps_s);
        Ok(Self { rows, steps_s, median_s, repeated })
    }

    /// Returns where samples are missing, and how many rows are repeated.
    fn remarks(&self) -> Vec<Remark> {
        let gap = |(at, step): (usize, &f64)| {
            let samples = (step / self.median_s).round() as usize - 1;
            (*step >= GAP_PERIODS * self.median_s).then(|| Remark::Gap { row: self.rows[at] + 1, samples })
        };
        let rows = self.repeated.len();
        let repeated = self.repeated.first().map(|row| Remark::Repeated { rows, first_row: row + 1 });
        self.steps_s.iter().enumerate().filter_map(gap).chain(repeated).collect()
    }
}

/// Returns columns as one array, time x signal, each column contiguous in memory; a column that is shorter than others ends in NaN.
pub fn stack_columns<'a>(columns: impl IntoIterator<Item = ArrayView1<'a, f64>>) -> Array2<f64> {
    let columns: Vec<ArrayView1<'a, f64>> = columns.into_iter().collect();
    let rows = columns.iter().map(ArrayView1::len).max().unwrap_or(0);
    let mut signals = Array2::from_elem((rows, columns.len()).f(), f64::NAN);
    for (mut signal, values) in signals.columns_mut().into_iter().zip(&columns) {
        signal.iter_mut().zip(values).for_each(|(sample, value)| *sample = *value);
    }
    signals
}

/// Refuses a sample period on which signals of a duration would take too much memory; this is checked before any of it is
/// allocated.
///
/// # Errors
/// [`Error::TooLong`], with the estimate.
pub(crate) fn check_length(file: &str, duration_s: f64, period_s: f64, signals: usize) -> Result<(), Error> {
    let samples = (duration_s / period_s).ceil();
    let bytes = (samples * signals as f64 * size_of::<f64>() as f64) as u64;
    if bytes <= LARGEST {
        return Ok(());
    }
    Err(Error::TooLong { file: file.to_owned(), period_s, samples, bytes, limit: LARGEST })
}

/// Returns whether a row equals the one before it, its time included.
fn is_repeated(row: usize, time_s: ArrayView1<'_, f64>, signals: &Array2<f64>) -> bool {
    let same = |now: f64, before: f64| now.to_bits() == before.to_bits();
    same(time_s[row], time_s[row - 1])
        && (0..signals.ncols()).all(|signal| same(signals[(row, signal)], signals[(row - 1, signal)]))
}

fn steps(file: &str, time_s: ArrayView1<'_, f64>, rows: &[usize]) -> Result<Vec<f64>, Error> {
    let stands = |row: usize, time_s, before_s| Error::TimeStandsStill {
        file: file.to_owned(),
        row: row + 1,
        time_s,
        before_s,
    };
    let step = |two: &[usize]| {
        let (before, now) = (time_s[two[0]], time_s[two[1]]);
        if now > before { Ok(now - before) } else { Err(stands(two[1], now, before)) }
    };
    let steps: Vec<f64> = rows.windows(2).map(step).collect::<Result<_, _>>()?;
    let longest = LONGEST_GAP * rows.len() as f64 * median(&steps);
    match steps.iter().position(|s| *s > longest) {
        None => Ok(steps),
        Some(at) => {
            let (before_s, time_s) = (time_s[rows[at]], time_s[rows[at + 1]]);
            Err(Error::TimeLeaps { file: file.to_owned(), row: rows[at + 1] + 1, time_s, before_s })
        }
    }
}

/// Returns the period of the project, or a period of a whole number of microseconds, if the file's is near enough to mean it.
fn round_period(period_s: f64, wanted_s: Option<f64>, median_s: f64) -> f64 {
    let micro = (median_s * 1e6).round() * 1e-6;
    let is_near = |p: f64| p > 0.0 && (period_s - p).abs() <= SAME_PERIOD_BY_ROUNDING * p;
    wanted_s.filter(|w| is_near(*w)).unwrap_or(if is_near(micro) { micro } else { period_s })
}

/// Returns the median, the lower one of an even number: of two steps the longer one may be a leap.
fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len().saturating_sub(1) / 2;
    sorted.get(middle).copied().unwrap_or(f64::NAN)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn deviation(values: &[f64], centre: f64) -> f64 {
    (values.iter().map(|v| (v - centre) * (v - centre)).sum::<f64>() / values.len() as f64).sqrt()
}

/// Returns signals by linear interpolation on a uniform clock, NaN inside gaps.
fn interpolate_signals(
    time_s: ArrayView1<'_, f64>,
    rows: &[usize],
    period_s: f64,
    signals: ArrayView2<'_, f64>,
) -> Array2<f64> {
    let instants = instants(time_s, rows, period_s);
    let at = |values: ArrayView1<'_, f64>, (row, fraction): (usize, Option<f64>)| match fraction {
        Some(0.0) => values[rows[row]],
        Some(f) => values[rows[row]] * (1.0 - f) + values[rows[row + 1]] * f,
        None => f64::NAN,
    };
    let mut even = Array2::zeros((instants.len(), signals.ncols()).f());
    for (mut column, values) in even.columns_mut().into_iter().zip(signals.columns()) {
        column.iter_mut().zip(&instants).for_each(|(sample, place)| *sample = at(values, *place));
    }
    even
}

/// Returns for each uniform instant the row at or before it, and the fraction of the way to the next row; no fraction inside a
/// gap.
fn instants(time_s: ArrayView1<'_, f64>, rows: &[usize], period_s: f64) -> Vec<(usize, Option<f64>)> {
    let (first, last) = (time_s[rows[0]], time_s[rows[rows.len() - 1]]);
    let count = ((last - first) / period_s + EVEN_STEPS).floor() as usize + 1;
    let mut row = 0;
    let place = |index: usize| {
        let t = first + index as f64 * period_s;
        while row + 1 < rows.len() && time_s[rows[row + 1]] <= t {
            row += 1;
        }
        if row + 1 == rows.len() {
            return (row, Some(0.0));
        }
        let step = time_s[rows[row + 1]] - time_s[rows[row]];
        let fraction = (t - time_s[rows[row]]) / step;
        let inside = if step < GAP_PERIODS * period_s { Some(fraction) } else { None };
        let is_on_a_sample = fraction * step < EVEN_STEPS * period_s;
        (row, if is_on_a_sample { Some(0.0) } else { inside })
    };
    (0..count).map(place).collect()
}
