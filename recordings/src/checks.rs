//! Checks of columns: what is missing, infinite, an outlier or nearly named, and whether the time has the unit that it seems to have.

use ndarray::{Array1, ArrayView1};

use crate::{Channel, Error, Mapping, Remark, Table};

/// A time column without a unit is refused if its steps differ from the sample period by more than this factor: no experiment is
/// recorded so much slower or faster than its controller runs, but a file in milliseconds is off by a thousand.
const FAR: f64 = 20.0;
/// Units that a time column may be in, with their size in seconds.
const UNITS: [(&str, f64); 4] = [("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9), ("min", 60.0)];
/// In its own unit, the steps of a time column match the sample period within this factor.
const MATCHES: f64 = 3.0;
/// An outlier is this many times farther from its neighbours' mean than nine in ten samples are from the sample before: 46 standard
/// deviations of white noise, which no healthy recorder shows.
const OUTLIER: f64 = 20.0;
/// The neighbours of an outlier agree within this fraction of its distance: in a step or a slope they do not.
const AGREE: f64 = 0.1;
/// A larger fraction of outliers is a signal of pulses.
const MOST_OUTLIERS: f64 = 1e-3;
/// Names for time, without marks and in lower case, that are not taken for it without being asked.
const TIMES: [&str; 7] = ["time", "times", "timesec", "timems", "timeus", "timestamp", "seconds"];

/// Returns how many values of a channel are missing, and where the first one is; `None` if none is.
pub(crate) fn missing(channel: Channel, values: &Array1<f64>) -> Option<Remark> {
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

/// Returns how many single readings are far from both neighbours; `None` if none is, or if the channel holds its value from sample to
/// sample, so that a pulse of one sample may be meant.
pub(crate) fn outliers(channel: Channel, unit: &'static str, values: ArrayView1<'_, f64>) -> Option<Remark> {
    let usual = usual_step(values).filter(|_| !channel.is_held())?;
    let is_outlier = |w: &ArrayView1<'_, f64>| {
        let distance = (w[1] - 0.5 * (w[0] + w[2])).abs();
        distance > OUTLIER * usual && (w[2] - w[0]).abs() < AGREE * distance
    };
    let windows = values.windows(3);
    let found: Vec<usize> =
        windows.into_iter().enumerate().filter(|(_, w)| is_outlier(w)).map(|(k, _)| k + 1).collect();
    let first = *found.first()?;
    let is_rare = found.len() as f64 <= (MOST_OUTLIERS * values.len() as f64).max(1.0);
    let (samples, value) = (found.len(), values[first]);
    is_rare.then_some(Remark::Outliers { channel, samples, first_row: first + 1, value, unit })
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

/// Returns a remark for every unused column with nearly the name of a channel, or of time, that was not found.
pub(crate) fn nearly_named(
    table: &Table,
    mapping: &Mapping,
    found: &[Channel],
    time_s: Option<&Array1<f64>>,
) -> Vec<Remark> {
    let is_unused = |name: &str| {
        let sources = mapping.channels.iter().map(|(_, source)| source).chain(&mapping.time);
        let used = |s: &crate::ChannelSource| {
            [Some(&s.column), s.plus.as_ref(), s.clock.as_ref()]
                .into_iter()
                .flatten()
                .any(|used| used == name)
        };
        !Channel::ALL.iter().any(|c| c.name() == name) && !sources.into_iter().any(used)
    };
    let lacking: Vec<&'static str> =
        Channel::ALL.into_iter().filter(|c| !found.contains(c)).map(Channel::name).collect();
    let remark = |name: &str| {
        let bare = bare(name);
        let channel = lacking.iter().copied().find(|channel| is_near(&bare, channel));
        let time = (time_s.is_none() && TIMES.contains(&bare.as_str())).then_some("time");
        let meant = channel.or(time)?;
        Some(Remark::NearlyNamed { column: name.to_owned(), meant })
    };
    table.columns.iter().map(|c| c.name.as_str()).filter(|name| is_unused(name)).filter_map(remark).collect()
}

/// Returns the last part of a name, its letters and digits alone, in lower case.
fn bare(name: &str) -> String {
    let last = name.rsplit(['.', '/']).next().unwrap_or(name);
    last.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// Returns whether a bare name differs from a channel's by one letter at the most.
fn is_near(bare_name: &str, channel: &str) -> bool {
    strsim::damerau_levenshtein(bare_name, &bare(channel)) <= 1
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
    let is_within = |step_s: f64, factor: f64| step_s < factor * project_s && project_s < factor * step_s;
    if is_within(file_s, FAR) {
        return Ok(());
    }
    let meant = UNITS.into_iter().find(|(_, size)| is_within(file_s * size, MATCHES)).map(|(unit, _)| unit);
    Err(Error::TimeUnit { file: file.to_owned(), file_s, project_s, meant })
}
