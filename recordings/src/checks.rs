//! Checks of columns: what is missing, infinite, an outlier or nearly named, and whether the time has the unit that it seems to have.

use ndarray::{Array1, ArrayView1};

use crate::time_unit::{DoubtfulUnit, doubtful_unit};
use crate::tolerance::MOST_OUTLIERS;
use crate::tolerance::OUTLIER_DISTANCE;
use crate::tolerance::OUTLIER_NEIGHBOURS;
use crate::{Channel, Error, RecordingTable, Remark};

/// Most readings of one outlier: an error of a transmission lasts a sample or two, and more of them may be a motion.
const LONGEST_OUTLIER: usize = 3;
/// Names for time, without marks and in lower case, that are not taken for it without being asked.
const TIMES: [&str; 13] = [
    "time",
    "times",
    "timesec",
    "timems",
    "timeus",
    "timens",
    "timestamp",
    "seconds",
    "sec",
    "t",
    "ts",
    "tms",
    "tus",
];

/// Returns how many values of a channel are missing, and where the first one is; `None` if none is.
pub(crate) fn find_missing(channel: Channel, values: ArrayView1<'_, f64>) -> Option<Remark> {
    let first = values.iter().position(|v| !v.is_finite())?;
    let samples = values.iter().filter(|v| !v.is_finite()).count();
    Some(Remark::Missing { channel, samples, first_row: first + 1 })
}

/// Makes infinite values of a channel missing ones and returns how many there are; `None` if there are none.
pub(crate) fn without_infinities(channel: Channel, values: &mut Array1<f64>) -> Option<Remark> {
    let first = values.iter().position(|v| v.is_infinite())?;
    let samples = values.iter().filter(|v| v.is_infinite()).count();
    values.mapv_inplace(|v| if v.is_infinite() { f64::NAN } else { v });
    Some(Remark::Infinite { channel, samples, first_row: first + 1 })
}

/// Makes outliers of a channel missing values and returns how many there are; `None` if there are none, or if the channel holds its
/// value from sample to sample, so that a short pulse may be meant.
///
/// An outlier is a run of at most [`LONGEST_OUTLIER`] readings far from the readings before and after it, which agree with each other,
/// or readings at an end of the recording far outside the range of all others.
pub(crate) fn without_outliers(channel: Channel, values: &mut Array1<f64>) -> Option<Remark> {
    let usual = usual_step(values.view()).filter(|_| !channel.is_held())?;
    let mut found = at_the_ends(values.view());
    let mut from = 1;
    while from + 1 < values.len() {
        let length = run_of_outliers(values.view(), from, usual);
        found.extend(from..from + length);
        from += length.max(1);
    }
    found.sort_unstable();
    found.dedup();
    let first = *found.first()?;
    let is_rare = found.len() as f64 <= (MOST_OUTLIERS * values.len() as f64).max(LONGEST_OUTLIER as f64);
    let (samples, value) = (found.len(), values[first]);
    if !is_rare {
        return None;
    }
    found.iter().for_each(|&k| values[k] = f64::NAN);
    Some(Remark::Outliers { channel, samples, first_row: first + 1, value })
}

/// Returns the length of the outlier that starts at a reading; 0 if none does.
fn run_of_outliers(values: ArrayView1<'_, f64>, from: usize, usual: f64) -> usize {
    let before = values[from - 1];
    let is_run = |length: &usize| {
        let Some(after) = values.get(from + length) else { return false };
        let distance = |k: usize| (values[k] - 0.5 * (before + after)).abs();
        let nearest = (from..from + length).map(distance).fold(f64::INFINITY, f64::min);
        let is_whole = (from..from + length).all(|k| values[k].is_finite());
        is_whole
            && nearest > OUTLIER_DISTANCE * usual
            && (after - before).abs() < OUTLIER_NEIGHBOURS * nearest
    };
    (1..=LONGEST_OUTLIER).find(is_run).unwrap_or(0)
}

/// Returns the readings at the two ends that lie outside the range of all others by many times that range.
fn at_the_ends(values: ArrayView1<'_, f64>) -> Vec<usize> {
    let last = values.len().saturating_sub(1);
    let inner = values.iter().skip(1).take(last.saturating_sub(1)).copied().filter(|v| v.is_finite());
    let (low, high) = inner.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (v.min(l), v.max(h)));
    let range = high - low;
    let is_far = |k: &usize| {
        let outside = (low - values[*k]).max(values[*k] - high);
        range > 0.0 && outside > OUTLIER_DISTANCE * range
    };
    [0, last].into_iter().filter(|_| last > 1).filter(is_far).collect()
}

/// Returns the size that nine in ten steps between samples do not exceed, and no less than the smallest step; `None` if nothing moves.
fn usual_step(values: ArrayView1<'_, f64>) -> Option<f64> {
    let steps = values.iter().zip(values.iter().skip(1)).map(|(a, b)| (b - a).abs());
    let mut steps: Vec<f64> = steps.filter(|step| step.is_finite()).collect();
    let place = steps.len() * 9 / 10;
    let smallest = steps.iter().copied().filter(|step| *step > 0.0).min_by(f64::total_cmp)?;
    let place = place.min(steps.len() - 1);
    let (_, usual, _) = steps.select_nth_unstable_by(place, f64::total_cmp);
    Some(usual.max(smallest))
}

/// Returns a remark for every unused column with nearly the name of a channel, or of time, that was not found. `is_mapped` tells
/// whether the mapping names a column.
pub(crate) fn nearly_named(
    table: &RecordingTable,
    is_mapped: impl Fn(&str) -> bool,
    found: &[Channel],
    time_s: Option<&Array1<f64>>,
) -> Vec<Remark> {
    let is_unused = |name: &str| !Channel::ALL.iter().any(|c| c.name() == name) && !is_mapped(name);
    let lacking: Vec<&'static str> =
        Channel::ALL.into_iter().filter(|c| !found.contains(c)).map(Channel::name).collect();
    let remark = |name: &str| {
        let last = strip_name(name.rsplit('.').next().unwrap_or(name));
        let whole = strip_name(name);
        let near = |channel: &&str| is_near(&last, channel) || is_near(&whole, channel);
        let channel = lacking.iter().copied().find(near);
        let time = (time_s.is_none() && TIMES.contains(&last.as_str())).then_some("time");
        let meant = channel.or(time)?;
        Some(Remark::NearlyNamed { column: name.to_owned(), meant })
    };
    table.columns.iter().map(|c| c.name.as_str()).filter(|name| is_unused(name)).filter_map(remark).collect()
}

/// Returns a name's letters and digits alone, in lower case.
fn strip_name(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// Returns whether a bare name contains a channel's, or differs from it by one letter at the most.
fn is_near(bare_name: &str, channel: &str) -> bool {
    let channel = strip_name(channel);
    bare_name.contains(&channel) || strsim::damerau_levenshtein(bare_name, &channel) <= 1
}

/// Refuses a time column without a unit whose steps, in seconds, are far from the sample period.
pub(crate) fn check_time_unit(file: &str, time_s: &Array1<f64>, project_s: f64) -> Result<(), Error> {
    let steps = time_s.iter().zip(time_s.iter().skip(1)).map(|(a, b)| b - a);
    let mut steps: Vec<f64> = steps.filter(|step| step.is_finite() && *step > 0.0).collect();
    let middle = steps.len() / 2;
    if steps.is_empty() {
        return Ok(());
    }
    let (_, &mut file_s, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
    match doubtful_unit(file_s, project_s) {
        None => Ok(()),
        Some(DoubtfulUnit { meant }) => {
            Err(Error::TimeUnit { file: file.to_owned(), file_s, project_s, meant })
        }
    }
}
