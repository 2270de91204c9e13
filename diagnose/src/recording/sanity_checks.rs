//! Sanity checks before any physics: whether the recordings are what they claim to be.
//!
//! Every channel is checked by itself (not finite, stuck, clipped, coarsely quantised), and the three ways to know the
//! hub's rate on the platform (gyroscopes, tachometer over the ratio, the resolver's derivative) against each other.

use counterpoise_controller::AntiWindup;
use counterpoise_models::Parameters;
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::replay::{RecordedController, ReplayLoop, control_fit};

use crate::recording::measured_signals::MeasuredSignals;
use crate::recording::series::rms;
use crate::tolerance::recording::SAME_READING;
use crate::tolerance::recording::{
    CLIPPED_SHARE, COARSE_STEP_SHARE, DRIFT_BENT_SHARE, FLAT_TOP_SAMPLES, FLAT_TOP_STEPS,
    FOREIGN_CONTROL_MULTIPLE, LARGEST_OFFSET_S, LONG_RUN_PART, LONG_RUN_STEPS, OFFSET_REMAINDER,
    REPORTED_OFFSET_S, SLOPE_AGREEMENT, SLOPE_COHERENCE, WRONG_SLOPE,
};

/// Most likely cause of a sensor's disagreement with the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meaning {
    /// The sign of the channel is swapped.
    SignSwapped,
    /// The channel is in degrees.
    InDegrees,
    /// One is in degrees and the other in radians.
    MixedDegreesAndRadians,
    /// The channel is in thousandths.
    InThousandths,
    /// A scale or the gear ratio is wrong.
    WrongScaleOrRatio,
}

/// Place at which readings stand still: at an extreme of the channel or between.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standstill {
    /// At an extreme.
    Clipped,
    /// Between the extremes.
    Stuck,
}

/// Anomaly of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Anomaly {
    /// Samples are missing or not numbers.
    Missing {
        /// Number of samples.
        missing: usize,
        /// Of how many.
        samples: usize,
    },
    /// The channel has one value throughout.
    StuckThroughout {
        /// The value, in the channel's unit.
        value: f64,
    },
    /// Flat tops at an extreme.
    FlatTops {
        /// The extreme, in the channel's unit.
        limit: f64,
        /// Number of samples in them.
        samples: usize,
    },
    /// One long run of equal readings.
    LongRun {
        /// The place of the standstill: at an extreme or not.
        standstill: Standstill,
        /// The value, in the channel's unit.
        value: f64,
        /// Number of samples.
        samples: usize,
        /// The first of them.
        first: usize,
    },
    /// Few steps of the quantiser over the range.
    Coarse {
        /// Steps over the range.
        steps: f64,
    },
    /// The gyroscopes disagree with motor and resolver, which agree with each other.
    GyroscopesDisagree {
        /// The ratio of what the gyroscopes give to what the others give.
        ratio: f64,
        /// The most likely meaning.
        meaning: Meaning,
    },
    /// The channel disagrees with the gyroscopes.
    Disagrees {
        /// The ratio of what it gives to what the gyroscopes give.
        ratio: f64,
        /// The most likely meaning.
        meaning: Meaning,
    },
    /// The clock has an offset.
    ClockOffset {
        /// The delay behind the gyroscopes, s.
        late_s: f64,
    },
    /// The clock runs fast or slow.
    ClockDrift {
        /// The delay behind the gyroscopes at the start, s.
        start_s: f64,
        /// The same at the end, s.
        end_s: f64,
        /// Share by which the clock runs slow.
        slow: f64,
    },
}

impl Anomaly {
    /// Returns whether the channel cannot be used as it is.
    pub fn is_disqualifying(&self) -> bool {
        match self {
            Self::Missing { missing, samples } => missing == samples,
            Self::StuckThroughout { .. } => true,
            Self::Disagrees { meaning, .. } => *meaning != Meaning::WrongScaleOrRatio,
            _ => false,
        }
    }
}

/// Something that is wrong, or worth knowing, about a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct SanityRemark {
    /// Name of the recording.
    pub recording: String,
    /// The channel.
    pub channel: Channel,
    /// Anomaly that was found.
    pub anomaly: Anomaly,
}

/// Checks the channels of one recording by themselves and against each other; `ratio` is the gear's, motor turns per hub turn.
pub fn check_signals(name: &str, measured: &MeasuredSignals, ratio: f64) -> Vec<SanityRemark> {
    let mut remarks = Vec::new();
    let mut note = |channel, anomaly| {
        remarks.push(SanityRemark { recording: name.to_owned(), channel, anomaly });
    };
    for (channel, series) in channels(measured) {
        if let Some(anomaly) = check_alone(series) {
            note(channel, anomaly);
        }
    }
    let pairs = redundant_rates(measured, ratio);
    let slopes: Vec<Slope> = pairs.iter().map(|(_, gyros, other)| regression(gyros, other)).collect();
    if let Some(anomaly) = all_against_the_gyros(&slopes) {
        note(Channel::HubRate, anomaly);
        return remarks;
    }
    for ((channel, gyros, other), Slope { slope, coherence }) in pairs.iter().zip(slopes) {
        if let Some(meaning) = meaning(slope, coherence) {
            note(*channel, Anomaly::Disagrees { ratio: slope, meaning });
        } else if let Some(anomaly) = detect_clock_drift(gyros, other, measured.period_s)
            .or_else(|| detect_clock_offset(gyros, other, measured.period_s))
        {
            note(*channel, anomaly);
        }
    }
    remarks
}

/// The recorded control is not what the project's controller makes of the recorded demand and hub rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControlMismatch {
    /// RMS of the difference, V.
    pub rms_v: f64,
    /// The same as a multiple of what rounding leaves.
    pub ratio: f64,
    /// A rule against windup with which the same controller makes the recorded control; `None` if none does.
    pub with_anti_windup: Option<AntiWindup>,
}

/// Compares the recorded control with what the project's controller makes of the recorded demand and hub rate. Returns `None` if they
/// agree, if one of the three was not recorded, or if no controller is known. The columns must be the samples that were read, not
/// made from others.
pub fn check_control(
    base: &Parameters,
    recording: &Recording,
    control: &ReplayLoop,
) -> Option<ControlMismatch> {
    let ReplayLoop::Closed(controller) = control else { return None };
    let (fit, _) = control_fit(base, recording, controller)?;
    let ratio = fit.residual_over_floor();
    (ratio > FOREIGN_CONTROL_MULTIPLE).then(|| ControlMismatch {
        rms_v: fit.rms_error,
        ratio,
        with_anti_windup: find_anti_windup(base, recording, controller),
    })
}

/// Returns the rule against windup with which a controller that states none makes the recorded control, which reached its limit.
fn find_anti_windup(
    base: &Parameters,
    recording: &Recording,
    controller: &RecordedController,
) -> Option<AntiWindup> {
    let control = recording.samples(Channel::Control)?;
    let limit = control.iter().copied().filter(|v| v.is_finite()).map(f64::abs).fold(0.0, f64::max);
    let rules = [AntiWindup::Hold(limit), AntiWindup::HoldOutward(limit), AntiWindup::Clamp(limit)];
    let fits = |rule: &AntiWindup| {
        let other = controller.with_anti_windup(*rule);
        let found = other.and_then(|other| control_fit(base, recording, &other));
        found.is_some_and(|(fit, _)| fit.residual_over_floor() <= FOREIGN_CONTROL_MULTIPLE)
    };
    rules.into_iter().find(fits)
}

/// Detects that the gyroscopes are wrong: two other sensors agree with each other and not with them.
fn all_against_the_gyros(slopes: &[Slope]) -> Option<Anomaly> {
    let [Slope { slope: a, coherence: coherence_a }, Slope { slope: b, coherence: coherence_b }] = *slopes
    else {
        return None;
    };
    let agree = (a / b - 1.0).abs() < SLOPE_AGREEMENT;
    let meaning = meaning(1.0 / a, coherence_a.min(coherence_b)).filter(|_| agree)?;
    Some(Anomaly::GyroscopesDisagree { ratio: 1.0 / a, meaning })
}

/// Detects a clock offset: the shift with the smallest difference to the gyroscopes.
fn detect_clock_offset(reference: &[f64], rate: &[f64], period_s: f64) -> Option<Anomaly> {
    let (offset_s, believed) = offset(reference, rate, period_s)?;
    (believed && offset_s.abs() > REPORTED_OFFSET_S).then_some(Anomaly::ClockOffset { late_s: offset_s })
}

/// Detects a clock that runs fast or slow: the offsets at the start and at the end differ.
fn detect_clock_drift(reference: &[f64], rate: &[f64], period_s: f64) -> Option<Anomaly> {
    let third = reference.len() / 3;
    let at = |from: usize| offset(&reference[from..from + third], &rate[from..from + third], period_s);
    let ((start_s, first), (end_s, last)) = (at(0)?, at(reference.len() - third)?);
    let (middle_s, _) = at(third)?;
    let apart_s = end_s - start_s;
    // a clock drifts evenly; an elastic drive that leads and lags as it is loaded does not
    let bent = (middle_s - 0.5 * (start_s + end_s)).abs();
    if bent > DRIFT_BENT_SHARE * apart_s.abs() + period_s {
        return None;
    }
    let part = apart_s / (2.0 * third as f64 * period_s);
    let told = (first || last) && apart_s.abs() > REPORTED_OFFSET_S;
    told.then_some(Anomaly::ClockDrift { start_s, end_s, slow: part })
}

/// Returns the offset, s, with the smallest difference, and whether it explains enough to be believed.
fn offset(reference: &[f64], rate: &[f64], period_s: f64) -> Option<(f64, bool)> {
    let most = (LARGEST_OFFSET_S / period_s).round() as usize;
    let inside = most..reference.len().checked_sub(most).filter(|end| *end > 2 * most)?;
    let apart = |lag: isize| {
        let difference = |k: usize| rate[k.saturating_add_signed(lag)] - reference[k];
        rms(&inside.clone().map(difference).filter(|d| d.is_finite()).collect::<Vec<f64>>()).powi(2)
    };
    let most = isize::try_from(most).ok()?;
    let (lag, least) = (-most..=most).map(|lag| (lag, apart(lag))).min_by(|a, b| a.1.total_cmp(&b.1))?;
    let inside = lag.abs() < most;
    Some((lag as f64 * period_s, inside && least < OFFSET_REMAINDER * apart(0)))
}

fn channels(m: &MeasuredSignals) -> Vec<(Channel, &[f64])> {
    let mut out: Vec<(Channel, &[f64])> = vec![
        (Channel::Control, m.control()),
        (Channel::HubRate, m.hub_rate()),
        (Channel::PlatformRate, m.platform_rate()),
        (Channel::PlatformAccel, m.platform_accel()),
    ];
    out.extend(m.motor_rate().map(|series| (Channel::MotorRate, series)));
    out.extend(m.hub_position().map(|series| (Channel::HubPosition, series)));
    out
}

/// Checks a channel by itself.
fn check_alone(series: &[f64]) -> Option<Anomaly> {
    let bad = series.iter().filter(|v| !v.is_finite()).count();
    if bad > 0 {
        return Some(Anomaly::Missing { missing: bad, samples: series.len() });
    }
    let (run, at) = longest_run(series);
    let (low, high) = extent(series);
    if run == series.len() && series.len() > 1 {
        return (low != 0.0).then_some(Anomaly::StuckThroughout { value: low });
    }
    let quantum = step(series);
    if let Some(anomaly) = detect_clipping(series, low, high, quantum) {
        return Some(anomaly);
    }
    if run > series.len() / LONG_RUN_PART && high - low > LONG_RUN_STEPS * quantum {
        let value = series[at];
        let standstill = if value == low || value == high { Standstill::Clipped } else { Standstill::Stuck };
        return Some(Anomaly::LongRun { standstill, value, samples: run, first: at });
    }
    (quantum > COARSE_STEP_SHARE * (high - low)).then(|| Anomaly::Coarse { steps: (high - low) / quantum })
}

/// Detects repeated flat tops at an extreme: a limit, not a coincidence.
fn detect_clipping(series: &[f64], low: f64, high: f64, quantum: f64) -> Option<Anomaly> {
    if high - low < FLAT_TOP_STEPS * quantum {
        return None;
    }
    let flat = |limit: f64| {
        let tops =
            series.chunk_by(|a, b| a == b).filter(|top| top[0] == limit && top.len() >= FLAT_TOP_SAMPLES);
        tops.map(<[f64]>::len).sum::<usize>()
    };
    let (limit, samples) = [(low, flat(low)), (high, flat(high))].into_iter().max_by_key(|(_, n)| *n)?;
    (samples as f64 > CLIPPED_SHARE * series.len() as f64).then_some(Anomaly::FlatTops { limit, samples })
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

/// Returns the quantiser's step: the smallest difference between two different neighbouring values.
fn step(series: &[f64]) -> f64 {
    let (low, high) = extent(series);
    let negligible = SAME_READING * (high - low);
    let differences = series.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|d| *d > negligible);
    differences.fold(f64::INFINITY, f64::min).min(high - low)
}

/// Returns each redundant channel's rate of the hub on the platform beside that of the gyroscopes, smoothed alike.
fn redundant_rates(m: &MeasuredSignals, ratio: f64) -> Vec<(Channel, Vec<f64>, Vec<f64>)> {
    let relative = m.relative_rate();
    let half = (0.02 / m.period_s).round() as usize;
    let smooth = |series: &[f64]| remove_mean(&moving(series, half));
    let reference = smooth(&relative);
    let mut out = Vec::new();
    if let Some(motor) = m.motor_rate() {
        let geared: Vec<f64> = motor.iter().map(|w| w / ratio).collect();
        out.push((Channel::MotorRate, reference.clone(), smooth(&geared)));
    }
    if let Some(position) = m.hub_position() {
        let rate: Vec<f64> =
            (0..position.len()).map(|k| slope_at(position, k, half.max(1)) / m.period_s).collect();
        out.push((Channel::HubPosition, reference, remove_mean(&rate)));
    }
    out
}

fn slope_at(series: &[f64], k: usize, half: usize) -> f64 {
    let (from, to) = (k.saturating_sub(half), (k + half).min(series.len() - 1));
    (series[to] - series[from]) / (to - from).max(1) as f64
}

/// Returns the moving mean; not a number if a sample in the window is missing.
fn moving(series: &[f64], half: usize) -> Vec<f64> {
    let at = |k: usize| {
        let window = &series[k.saturating_sub(half)..(k + half + 1).min(series.len())];
        window.iter().sum::<f64>() / window.len() as f64
    };
    (0..series.len()).map(at).collect()
}

/// Returns the series about the mean of the samples that are numbers.
fn remove_mean(series: &[f64]) -> Vec<f64> {
    let there: Vec<f64> = series.iter().copied().filter(|v| v.is_finite()).collect();
    let mean = there.iter().sum::<f64>() / there.len().max(1) as f64;
    series.iter().map(|v| v - mean).collect()
}

/// Slope of one series over another, with their coherence.
struct Slope {
    slope: f64,
    coherence: f64,
}

/// The slope of y over x where both are numbers.
fn regression(x: &[f64], y: &[f64]) -> Slope {
    let both = || x.iter().zip(y).filter(|(a, b)| a.is_finite() && b.is_finite());
    let inner: f64 = both().map(|(a, b)| a * b).sum();
    let power: f64 = both().map(|(a, _)| a * a).sum();
    let other: f64 = both().map(|(_, b)| b * b).sum();
    if power == 0.0 || other == 0.0 {
        Slope { slope: 1.0, coherence: 0.0 }
    } else {
        Slope { slope: inner / power, coherence: inner * inner / (power * other) }
    }
}

/// Returns what a slope that is not 1 most likely means; `None` if it is near 1 or the coherence is low.
fn meaning(slope: f64, coherence: f64) -> Option<Meaning> {
    if coherence.is_nan() || coherence < SLOPE_COHERENCE || (slope - 1.0).abs() < WRONG_SLOPE {
        return None;
    }
    let degrees = 180.0 / std::f64::consts::PI;
    let near = |value: f64| (slope / value - 1.0).abs() < SLOPE_AGREEMENT;
    let guess = if near(-1.0) {
        Meaning::SignSwapped
    } else if near(degrees) || near(-degrees) {
        Meaning::InDegrees
    } else if near(1.0 / degrees) {
        Meaning::MixedDegreesAndRadians
    } else if near(1e3) || near(-1e3) {
        Meaning::InThousandths
    } else {
        Meaning::WrongScaleOrRatio
    };
    Some(guess)
}

#[cfg(test)]
mod tests {
    use counterpoise_recordings::Signals;

    use super::*;
    use crate::machine::RedundantSensors;
    use crate::recording::measured_signals::MeasuredColumn;

    fn machine() -> MeasuredSignals {
        let rate: Vec<f64> = (0..5000).map(|k| 0.1 * (k as f64 * 0.004).sin()).collect();
        let mut angle = 0.0;
        let position: Vec<f64> = rate
            .iter()
            .map(|w| {
                angle += w * 1e-3;
                angle
            })
            .collect();
        let times = |factor: f64| rate.iter().map(|w| factor * w).collect::<Vec<f64>>();
        let still = vec![0.0; 5000];
        MeasuredSignals {
            period_s: 1e-3,
            measured: counterpoise_models::FeedbackSignal::HubRate,
            recorded: RedundantSensors { motor_rate: true, hub_position: true },
            signals: Signals::stack([&times(10.0)[..], &rate, &still, &still, &times(200.0), &position]),
        }
    }

    /// Changes every sample of a column.
    fn change(machine: &mut MeasuredSignals, column: MeasuredColumn, to: impl Fn(f64) -> f64) {
        machine.recorded_mut(column).iter_mut().for_each(|value| *value = to(*value));
    }

    /// Replaces the motor's sample `k` by an earlier one.
    fn delay_motor(machine: &mut MeasuredSignals, from: impl Fn(usize) -> usize) {
        let motor = machine.motor_rate().unwrap().to_vec();
        let places = machine.recorded_mut(MeasuredColumn::MotorRate).iter_mut().enumerate();
        places.for_each(|(k, place)| *place = motor[from(k)]);
    }

    /// The first anomaly of a machine.
    fn anomaly(machine: &MeasuredSignals) -> Anomaly {
        check_signals("r", machine, 200.0)[0].anomaly
    }

    #[test]
    fn a_sound_recording_raises_no_remark() {
        assert_eq!(check_signals("sound", &machine(), 200.0), vec![]);
    }

    #[test]
    fn swapped_sign_degrees_and_gaps_are_named() {
        let mut swapped = machine();
        change(&mut swapped, MeasuredColumn::MotorRate, |w| -w);
        assert!(matches!(anomaly(&swapped), Anomaly::Disagrees { meaning: Meaning::SignSwapped, .. }));
        let mut degrees = machine();
        change(&mut degrees, MeasuredColumn::HubPosition, f64::to_degrees);
        assert!(matches!(anomaly(&degrees), Anomaly::Disagrees { meaning: Meaning::InDegrees, .. }));
        let mut gap = machine();
        gap.recorded_mut(MeasuredColumn::HubRate)[17] = f64::NAN;
        let remark = &check_signals("r", &gap, 200.0)[0];
        assert_eq!(
            (remark.channel, remark.anomaly),
            (Channel::HubRate, Anomaly::Missing { missing: 1, samples: 5000 })
        );
    }

    #[test]
    fn a_clock_offset_is_told_with_its_size() {
        let mut late = machine();
        delay_motor(&mut late, |k| k.saturating_sub(30));
        assert!(matches!(anomaly(&late), Anomaly::ClockOffset { late_s } if (late_s - 0.03).abs() < 1e-9));
    }

    #[test]
    fn a_clock_that_drifts_is_told_and_no_slope_is_made_of_missing_samples() {
        let mut slow = machine();
        delay_motor(&mut slow, |k| k - k / 100);
        let remark = &check_signals("r", &slow, 200.0)[0];
        let is_slow =
            matches!(remark.anomaly, Anomaly::ClockDrift { slow, .. } if (slow - 0.01).abs() < 5e-4);
        assert!(remark.channel == Channel::MotorRate && is_slow, "{remark:?}");
        let mut holes = machine();
        holes.recorded_mut(MeasuredColumn::MotorRate)[1000..2500].fill(f64::NAN);
        assert_eq!(check_signals("r", &holes, 200.0).len(), 1);
    }

    #[test]
    fn when_motor_and_resolver_agree_the_gyroscope_is_wrong() {
        let mut swapped = machine();
        change(&mut swapped, MeasuredColumn::HubRate, |w| -w);
        let remarks = check_signals("r", &swapped, 200.0);
        assert_eq!((remarks.len(), remarks[0].channel), (1, Channel::HubRate));
        let swapped =
            matches!(remarks[0].anomaly, Anomaly::GyroscopesDisagree { meaning: Meaning::SignSwapped, .. });
        assert!(swapped, "{remarks:?}");
    }

    #[test]
    fn clipping_is_seen() {
        let mut clipped = machine();
        change(&mut clipped, MeasuredColumn::Control, |u| u.clamp(-0.5, 0.5));
        assert!(matches!(anomaly(&clipped), Anomaly::FlatTops { .. }));
    }
}
