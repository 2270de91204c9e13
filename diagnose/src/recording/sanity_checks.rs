//! Before any physics: are the recordings what they claim to be?
//!
//! Every channel is checked by itself (not finite, stuck, clipped, coarsely quantised), and the three ways to know the
//! hub's rate on the platform (gyroscopes, tachometer over the ratio, the resolver's derivative) against each other.

use counterpoise_models::Parameters;
use counterpoise_simulate::recording::Recording;
use counterpoise_simulate::replay::{Loop, control_fit};

use crate::recording::measured_signals::MeasuredSignals;
use crate::recording::series::rms;

/// Something that is wrong, or worth knowing, about a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Remark {
    /// Name of the recording.
    pub recording: String,
    /// Channel.
    pub channel: &'static str,
    /// What was seen, with its figure.
    pub what: String,
    /// Whether the channel cannot be used.
    pub unusable: bool,
}

/// Checks one recording.
pub fn check_signals(name: &str, measured: &MeasuredSignals, ratio: f64) -> Vec<Remark> {
    let mut remarks = Vec::new();
    let mut say = |channel, what: String, unusable| {
        remarks.push(Remark { recording: name.to_owned(), channel, what, unusable });
    };
    for (channel, series) in channels(measured) {
        if let Some((what, unusable)) = alone(series) {
            say(channel, what, unusable);
        }
    }
    let pairs = redundant(measured, ratio);
    let slopes: Vec<(f64, f64)> = pairs.iter().map(|(_, gyros, other)| regression(gyros, other)).collect();
    if let Some((what, unusable)) = all_against_the_gyros(&slopes) {
        say("hub_rate", what, unusable);
        return remarks;
    }
    for ((channel, gyros, other), (slope, coherence)) in pairs.iter().zip(slopes) {
        if let Some((what, unusable)) = meaning(slope, coherence) {
            say(channel, format!("{slope:.3} times what the gyroscopes say: {what}"), unusable);
        } else if let Some(what) =
            drifting(gyros, other, measured.period_s).or_else(|| shifted(gyros, other, measured.period_s))
        {
            say(channel, what, false);
        }
    }
    remarks
}

/// What is wrong where the recorded control is not what the project's controller makes of the recorded demand and hub rate; none where
/// it is, and where one of the three was not recorded. Of a recording whose columns are the samples that were read, not made from others.
pub fn check_control(base: &Parameters, recording: &Recording, control: &Loop) -> Option<String> {
    let Loop::Closed(controller) = control else { return None };
    let (fit, _) = control_fit(base, recording, controller)?;
    let ratio = fit.rms_error / fit.floor;
    (ratio > FOREIGN).then(|| {
        format!(
            "it is not what the project's controller makes of the recorded demand and hub rate, but {:.3} V RMS off, {ratio:.0} times what \
             rounding leaves: another controller was in the loop, or one of the three is not what it read or gave",
            fit.rms_error
        )
    })
}

/// Times what rounding leaves beyond which a control is not the controller's.
const FOREIGN: f64 = 5.0;

/// Two sensors that agree with each other and not with the gyroscopes: those are wrong.
fn all_against_the_gyros(slopes: &[(f64, f64)]) -> Option<(String, bool)> {
    let &[(a, coherence_a), (b, coherence_b)] = slopes else { return None };
    let agree = (a / b - 1.0).abs() < AGREE;
    let (what, _) = meaning(1.0 / a, coherence_a.min(coherence_b)).filter(|_| agree)?;
    Some((format!("the gyroscopes give {:.3} times what motor and resolver say: {what}", 1.0 / a), false))
}

/// Two slopes within this share of each other agree.
const AGREE: f64 = 0.1;

/// Two clocks whose readings part by more than this are told, s: sensors and gear account for a few milliseconds.
const OFFSET_TOLD_S: f64 = 8e-3;
/// Clock offsets up to this are sought, s.
const OFFSET_SOUGHT_S: f64 = 0.1;
/// Share of the difference between two channels that an offset may leave to be believed: a wide gap between the teeth
/// makes the motor lead, too, but leaves a quarter and more.
const OFFSET_EXPLAINS: f64 = 0.1;

/// Whether a channel comes later or earlier than the gyroscopes: the offset with the smallest difference.
fn shifted(reference: &[f64], rate: &[f64], period_s: f64) -> Option<String> {
    let (offset_s, believed) = offset(reference, rate, period_s)?;
    let word = if offset_s > 0.0 { "later" } else { "earlier" };
    (believed && offset_s.abs() > OFFSET_TOLD_S).then(|| {
        format!("{:.0} ms {word} than the gyroscopes: its clock has an offset", 1e3 * offset_s.abs())
    })
}

/// Whether a channel's clock runs fast or slow: other offsets at the start and at the end.
fn drifting(reference: &[f64], rate: &[f64], period_s: f64) -> Option<String> {
    let third = reference.len() / 3;
    let at = |from: usize| offset(&reference[from..from + third], &rate[from..from + third], period_s);
    let ((start_s, first), (end_s, last)) = (at(0)?, at(reference.len() - third)?);
    let apart_s = end_s - start_s;
    let part = apart_s / (2.0 * third as f64 * period_s);
    let told = (first || last) && apart_s.abs() > OFFSET_TOLD_S;
    let word = if apart_s > 0.0 { "slow" } else { "fast" };
    told.then(|| {
        format!(
            "{:.0} ms off the gyroscopes at the start, {:.0} ms at the end: its clock runs {:.2} % {word}",
            1e3 * start_s,
            1e3 * end_s,
            100.0 * part.abs()
        )
    })
}

/// The offset, s, with the smallest difference, and whether it explains so much that it is believed.
fn offset(reference: &[f64], rate: &[f64], period_s: f64) -> Option<(f64, bool)> {
    let most = (OFFSET_SOUGHT_S / period_s).round() as usize;
    let inside = most..reference.len().checked_sub(most).filter(|end| *end > 2 * most)?;
    let apart = |lag: isize| {
        let difference = |k: usize| rate[k.saturating_add_signed(lag)] - reference[k];
        rms(&inside.clone().map(difference).filter(|d| d.is_finite()).collect::<Vec<f64>>()).powi(2)
    };
    let most = isize::try_from(most).ok()?;
    let (lag, least) = (-most..=most).map(|lag| (lag, apart(lag))).min_by(|a, b| a.1.total_cmp(&b.1))?;
    let inside = lag.abs() < most;
    Some((lag as f64 * period_s, inside && least < OFFSET_EXPLAINS * apart(0)))
}

fn channels(m: &MeasuredSignals) -> Vec<(&'static str, &[f64])> {
    let mut out: Vec<(&'static str, &[f64])> = vec![
        ("control", &m.control),
        ("hub_rate", &m.hub_rate),
        ("platform_rate", &m.platform_rate),
        ("platform_accel", &m.platform_accel),
    ];
    out.extend(m.motor_rate.as_deref().map(|series| ("motor_rate", series)));
    out.extend(m.hub_position.as_deref().map(|series| ("hub_position", series)));
    out
}

/// What a channel says about itself.
fn alone(series: &[f64]) -> Option<(String, bool)> {
    let bad = series.iter().filter(|v| !v.is_finite()).count();
    if bad > 0 {
        let all = bad == series.len();
        return Some((format!("{bad} of {} samples are missing or not numbers", series.len()), all));
    }
    let (run, at) = longest_run(series);
    let (low, high) = extent(series);
    if run == series.len() && series.len() > 1 {
        return (low != 0.0).then(|| (format!("stuck at {low} throughout"), true));
    }
    let quantum = step(series);
    if let Some(what) = clipped(series, low, high, quantum) {
        return Some((what, false));
    }
    if run > series.len() / 10 && high - low > 20.0 * quantum {
        let value = series[at];
        let word = if value == low || value == high { "clipped" } else { "stuck" };
        return Some((format!("{word} at {value} for {run} samples from sample {at}"), false));
    }
    (quantum > 0.05 * (high - low))
        .then(|| (format!("only {:.0} steps over its range", (high - low) / quantum), false))
}

/// Samples that stay at one extreme for this long make a flat top.
const FLAT_TOP: usize = 5;
/// A channel is clipped where flat tops at one extreme hold this share of it.
const CLIPPED_SHARE: f64 = 0.01;
/// Fewest steps of the quantiser over the range for which a flat top means something.
const FINE_STEPS: f64 = 200.0;

/// Flat tops at an extreme, several times over: a limit, not a coincidence.
fn clipped(series: &[f64], low: f64, high: f64, quantum: f64) -> Option<String> {
    if high - low < FINE_STEPS * quantum {
        return None;
    }
    let flat = |limit: f64| {
        let tops = series.chunk_by(|a, b| a == b).filter(|top| top[0] == limit && top.len() >= FLAT_TOP);
        tops.map(<[f64]>::len).sum::<usize>()
    };
    let (limit, samples) = [(low, flat(low)), (high, flat(high))].into_iter().max_by_key(|(_, n)| *n)?;
    (samples as f64 > CLIPPED_SHARE * series.len() as f64)
        .then(|| format!("clipped at {limit}: {samples} samples lie there in flat tops"))
}

fn longest_run(series: &[f64]) -> (usize, usize) {
    let (mut best, mut best_at, mut run, mut start) = (0, 0, 0, 0);
    for k in 0..series.len() {
        if k == 0 || series[k] != series[k - 1] {
            (run, start) = (0, k);
        }
        run += 1;
        if run > best {
            (best, best_at) = (run, start);
        }
    }
    (best, best_at)
}

fn extent(series: &[f64]) -> (f64, f64) {
    series.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)))
}

/// Smallest difference between two different neighbouring values: the quantiser's step.
fn step(series: &[f64]) -> f64 {
    let (low, high) = extent(series);
    let negligible = 1e-9 * (high - low);
    let differences = series.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|d| *d > negligible);
    differences.fold(f64::INFINITY, f64::min).min(high - low)
}

/// Each redundant channel's rate of the hub on the platform beside the gyroscopes', smoothed alike.
fn redundant(m: &MeasuredSignals, ratio: f64) -> Vec<(&'static str, Vec<f64>, Vec<f64>)> {
    let relative: Vec<f64> = m.hub_rate.iter().zip(&m.platform_rate).map(|(h, p)| h - p).collect();
    let half = (0.02 / m.period_s).round() as usize;
    let smooth = |series: &[f64]| centred(&moving(series, half));
    let reference = smooth(&relative);
    let mut out = Vec::new();
    if let Some(motor) = &m.motor_rate {
        let geared: Vec<f64> = motor.iter().map(|w| w / ratio).collect();
        out.push(("motor_rate", reference.clone(), smooth(&geared)));
    }
    if let Some(position) = &m.hub_position {
        let rate: Vec<f64> =
            (0..position.len()).map(|k| slope_at(position, k, half.max(1)) / m.period_s).collect();
        out.push(("hub_position", reference, centred(&rate)));
    }
    out
}

fn slope_at(series: &[f64], k: usize, half: usize) -> f64 {
    let (from, to) = (k.saturating_sub(half), (k + half).min(series.len() - 1));
    (series[to] - series[from]) / (to - from).max(1) as f64
}

/// Moving mean; missing where a sample in the window is missing.
fn moving(series: &[f64], half: usize) -> Vec<f64> {
    let at = |k: usize| {
        let window = &series[k.saturating_sub(half)..(k + half + 1).min(series.len())];
        window.iter().sum::<f64>() / window.len() as f64
    };
    (0..series.len()).map(at).collect()
}

/// The series about the mean of what is there.
fn centred(series: &[f64]) -> Vec<f64> {
    let there: Vec<f64> = series.iter().copied().filter(|v| v.is_finite()).collect();
    let mean = there.iter().sum::<f64>() / there.len().max(1) as f64;
    series.iter().map(|v| v - mean).collect()
}

/// Slope of y over x and their coherence, where both are there.
fn regression(x: &[f64], y: &[f64]) -> (f64, f64) {
    let both = || x.iter().zip(y).filter(|(a, b)| a.is_finite() && b.is_finite());
    let inner: f64 = both().map(|(a, b)| a * b).sum();
    let power: f64 = both().map(|(a, _)| a * a).sum();
    let other: f64 = both().map(|(_, b)| b * b).sum();
    if power == 0.0 || other == 0.0 { (1.0, 0.0) } else { (inner / power, inner * inner / (power * other)) }
}

/// What a slope that is not 1 most likely means, and whether the channel cannot be used as it is.
fn meaning(slope: f64, coherence: f64) -> Option<(String, bool)> {
    if coherence.is_nan() || coherence < 0.5 || (slope - 1.0).abs() < 0.2 {
        return None;
    }
    let degrees = 180.0 / std::f64::consts::PI;
    let near = |value: f64| (slope / value - 1.0).abs() < 0.1;
    let guess = if near(-1.0) {
        "its sign is swapped"
    } else if near(degrees) || near(-degrees) {
        "it is in degrees"
    } else if near(1.0 / degrees) {
        "one is in degrees where the other is in radians"
    } else if near(1e3) || near(-1e3) {
        "it is in thousandths"
    } else {
        return Some(("a scale or the gear ratio is wrong".to_owned(), false));
    };
    Some((guess.to_owned(), true))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn machine() -> MeasuredSignals {
        let rate: Vec<f64> = (0..5000).map(|k| 0.1 * (k as f64 * 0.004).sin()).collect();
        let mut angle = 0.0;
        let position = rate
            .iter()
            .map(|w| {
                angle += w * 1e-3;
                angle
            })
            .collect();
        MeasuredSignals {
            period_s: 1e-3,
            control: rate.iter().map(|w| 10.0 * w).collect(),
            platform_rate: vec![0.0; 5000],
            platform_accel: vec![0.0; 5000],
            motor_rate: Some(rate.iter().map(|w| 200.0 * w).collect()),
            hub_position: Some(position),
            hub_rate: rate,
        }
    }

    #[test]
    fn a_sound_recording_raises_no_remark() {
        assert_eq!(check_signals("sound", &machine(), 200.0), vec![]);
    }

    #[test]
    fn swapped_sign_degrees_and_gaps_are_named() {
        let mut swapped = machine();
        swapped.motor_rate = swapped.motor_rate.map(|w| w.iter().map(|v| -v).collect());
        assert!(check_signals("r", &swapped, 200.0)[0].what.contains("sign is swapped"));
        let mut degrees = machine();
        degrees.hub_position = degrees.hub_position.map(|a| a.iter().map(|v| v.to_degrees()).collect());
        assert!(check_signals("r", &degrees, 200.0)[0].what.contains("in degrees"));
        let mut gap = machine();
        gap.hub_rate[17] = f64::NAN;
        let remark = &check_signals("r", &gap, 200.0)[0];
        assert!(remark.what.starts_with("1 of 5000") && remark.channel == "hub_rate", "{remark:?}");
    }

    #[test]
    fn a_clock_offset_is_told_with_its_size() {
        let mut late = machine();
        late.motor_rate = late.motor_rate.map(|w| (0..w.len()).map(|k| w[k.saturating_sub(30)]).collect());
        assert_eq!(
            check_signals("r", &late, 200.0)[0].what,
            "30 ms later than the gyroscopes: its clock has an offset"
        );
    }

    #[test]
    fn a_clock_that_drifts_is_told_and_no_slope_is_made_of_missing_samples() {
        let mut slow = machine();
        slow.motor_rate = slow.motor_rate.map(|w| (0..w.len()).map(|k| w[k - k / 100]).collect());
        let remark = &check_signals("r", &slow, 200.0)[0];
        assert!(remark.channel == "motor_rate" && remark.what.contains("its clock runs 1.0"), "{remark:?}");
        let mut holes = machine();
        if let Some(motor) = holes.motor_rate.as_mut() {
            motor[1000..2500].fill(f64::NAN);
        }
        assert_eq!(check_signals("r", &holes, 200.0).len(), 1);
    }

    #[test]
    fn when_motor_and_resolver_agree_the_gyroscope_is_wrong() {
        let mut swapped = machine();
        swapped.hub_rate.iter_mut().for_each(|w| *w = -*w);
        let remarks = check_signals("r", &swapped, 200.0);
        assert_eq!((remarks.len(), remarks[0].channel), (1, "hub_rate"));
        assert!(remarks[0].what.contains("sign is swapped"), "{remarks:?}");
    }

    #[test]
    fn clipping_is_seen() {
        let mut clipped = machine();
        clipped.control.iter_mut().for_each(|u| *u = u.clamp(-0.5, 0.5));
        assert!(check_signals("r", &clipped, 200.0)[0].what.starts_with("clipped at"));
    }
}
