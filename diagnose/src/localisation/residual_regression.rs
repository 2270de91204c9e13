//! The regression of the residuals of replays: the balances of the recordings less the same balances of their replays,
//! whitened.
//!
//! The simplifications of the balances are in both, so that they cancel. What an error at a port would do to the balances is a column of the
//! regression; how much of the residual the columns explain is measured on held-out stretches.

use crate::tolerance::identification::NORMAL_95;
use crate::tolerance::localisation::{
    BALANCE_THINNING, EXPLAINED_VARIANCE, REGRESSION_RIDGE, REGRESSION_STRETCHES, REWEIGHTED_FITS,
};
use counterpoise_linalg::{Mat, solve};
use counterpoise_models::Parameters;
use counterpoise_recordings::Channel;

use crate::localisation::error_hypotheses::SignalQuantity;
use crate::localisation::ports::Port;
use crate::localisation::torque_balances::{Balance, BalanceSignals, trim_ends};
use crate::localisation::trend::PeriodicTrend;
use crate::localisation::whitening::Whitener;
use crate::machine::{RedundantSensors, usable_sensors};
use crate::recording::measured_signals::{MeasuredColumn, MeasuredSignals};
use crate::recording::series::correlation_time;
use crate::recording::series::dot;
use crate::simulator_access::{Assessment, ControlSource};
use crate::tolerance::localisation::LEAST_SHARE;

/// One value a sample, recording by recording.
pub(crate) type Series = Vec<Vec<f64>>;

/// A recording with the replay that was assessed on it.
#[derive(Debug, Clone)]
pub struct AssessedReplay {
    /// Its signals.
    pub measured: MeasuredSignals,
    /// The assessment of its replay.
    pub assessment: Assessment,
}

/// An error at a port, one value a sample.
#[derive(Clone, Copy)]
pub(crate) struct ErrorTerm<'a> {
    /// The port at which it acts.
    pub port: Port,
    /// The error.
    pub error: &'a Series,
}

/// A run of rows: one balance, one half of the stretches.
struct Segment {
    balance: usize,
    half: usize,
    rows: std::ops::Range<usize>,
}

/// The residuals of the replays of recordings.
pub(crate) struct ResidualRegression<'a> {
    /// The recordings' signals.
    pub signals: Vec<BalanceSignals<'a>>,
    /// The replays' signals, without noise; `None` if a replay was a playback.
    quiet: Vec<Option<BalanceSignals<'a>>>,
    /// The balances that the sensors allow.
    pub balances: Vec<Balance>,
    /// Residual of the drive's balance, N m: thinned, less its straight line, not whitened.
    torque: Series,
    whiteners: Vec<Whitener>,
    segments: Vec<Segment>,
    target: Vec<f64>,
    nuisances: Vec<Vec<f64>>,
    before: Vec<f64>,
}

impl<'a> ResidualRegression<'a> {
    /// Prepares the regression; returns `None` if a balance is not finite.
    pub fn new(p: &'a Parameters, recordings: &[AssessedReplay]) -> Option<Self> {
        let has = |f: fn(&MeasuredSignals) -> bool| recordings.iter().all(|r| f(&r.measured));
        let recorded = RedundantSensors {
            motor_rate: has(|m| m.recorded.motor_rate),
            hub_position: has(|m| m.recorded.hub_position),
        };
        let balances = Balance::select_allowed(usable_sensors(p, recorded));
        let signals: Vec<BalanceSignals> =
            recordings.iter().map(|r| BalanceSignals::new(p, &r.measured, None)).collect();
        let quiet = recordings.iter().zip(&signals).map(|(r, s)| {
            let in_loop = r.assessment.source == ControlSource::ClosedLoop;
            in_loop.then(|| BalanceSignals::new(p, &replayed_signals(r), Some(s.slow_rates())))
        });
        let quiet = quiet.collect();
        let pairs = signals.iter().zip(recordings);
        let apart: Vec<[Vec<Vec<f64>>; 2]> =
            pairs.map(|(s, r)| balance_departures(p, s, r, &balances)).collect();
        let of = |which: usize, b: usize| apart.iter().map(|a| a[which][b].clone()).collect::<Series>();
        let drive = balances.iter().position(|b| *b == Balance::Drive)?;
        let whiteners = (0..balances.len()).map(|b| Whitener::of(&of(1, b))).collect();
        let mut out = Self {
            torque: of(0, drive).iter().map(|series| remove_trend(series)).collect(),
            signals,
            quiet,
            whiteners,
            segments: Vec::new(),
            target: Vec::new(),
            nuisances: Vec::new(),
            before: Vec::new(),
            balances,
        };
        let all: Vec<Series> = (0..out.balances.len()).map(|b| of(0, b)).collect();
        out.segments = out.segments_of(&all);
        out.target = out.rows(&all);
        out.nuisances = out.starts();
        out.before = out.held_out(&[])?;
        Some(out)
    }

    fn segments_of(&self, all: &[Series]) -> Vec<Segment> {
        let (mut out, mut next) = (Vec::new(), 0);
        for (balance, series) in all.iter().enumerate() {
            let whitener = &self.whiteners[balance];
            let lengths: Vec<usize> = series.iter().map(|s| whitener.whiten(s).len()).collect();
            for half in 0..2 {
                let count: usize =
                    lengths.iter().map(|&n| (0..n).filter(|&k| half_of(k, n) == half).count()).sum();
                out.push(Segment { balance, half, rows: next..next + count });
                next += count;
            }
        }
        out
    }

    /// Returns the whitened balances of all recordings, in the order of the segments.
    fn rows(&self, all: &[Series]) -> Vec<f64> {
        let mut out = Vec::new();
        for (series, whitener) in all.iter().zip(&self.whiteners) {
            let white: Series = series.iter().map(|s| whitener.whiten(s)).collect();
            for half in 0..2 {
                for one in &white {
                    let kept = one.iter().enumerate().filter(|(k, _)| half_of(*k, one.len()) == half);
                    out.extend(kept.map(|(_, v)| *v));
                }
            }
        }
        out
    }

    /// Returns a quantity at every sample of every recording. One that is mostly noise is taken from the replay, because the noise
    /// that a balance contains would explain itself.
    pub fn all(&self, quantity: SignalQuantity) -> Series {
        let of = |(s, quiet): (&BalanceSignals, &Option<BalanceSignals>)| match quiet {
            Some(quiet) if quantity.is_mostly_noise() => quantity.of(quiet),
            _ => quantity.of(s),
        };
        self.signals.iter().zip(&self.quiet).map(of).collect()
    }

    /// Returns one column for each error at a port.
    pub fn columns(&self, port: Port, errors: &[Series]) -> Vec<Vec<f64>> {
        errors.iter().map(|error| self.column(&[ErrorTerm { port, error }])).collect()
    }

    /// Finds how the drive's balance repeats along a variable.
    pub fn repetition(&self, variable: &Series) -> Option<PeriodicTrend> {
        let along: Vec<f64> = variable.iter().flat_map(|v| trim_ends(v)).collect();
        PeriodicTrend::of(&self.torque.concat(), &along)
    }

    /// Returns what errors at ports do to the balances together, in the order of the target.
    pub fn column(&self, terms: &[ErrorTerm]) -> Vec<f64> {
        let shown = |balance: Balance| -> Series {
            let of = |r: usize| {
                let mut sum = vec![0.0; self.signals[r].len()];
                for term in terms {
                    let part = term.port.balance_error(balance, &term.error[r], &self.signals[r]);
                    sum.iter_mut().zip(part).for_each(|(s, p)| *s += p);
                }
                trim_ends(&sum)
            };
            (0..self.signals.len()).map(of).collect()
        };
        self.rows(&self.balances.iter().map(|b| shown(*b)).collect::<Vec<_>>())
    }

    /// Returns the columns of the hub's balance that no error makes: its constant is unknown and it drifts with integrated noise, a
    /// straight line for each recording.
    fn starts(&self) -> Vec<Vec<f64>> {
        let Some(hub) = self.balances.iter().position(|b| *b == Balance::Hub) else { return Vec::new() };
        let line = |r: usize, power: i32| {
            let of = |b: usize, k: usize| -> Vec<f64> {
                let count = self.torque[k].len();
                let here = if b == hub && k == r { 1.0 } else { 0.0 };
                (0..count).map(|i| here * (2.0 * i as f64 / count as f64 - 1.0).powi(power)).collect()
            };
            let series = |b: usize| (0..self.signals.len()).map(|k| of(b, k)).collect::<Series>();
            self.rows(&(0..self.balances.len()).map(series).collect::<Vec<_>>())
        };
        (0..self.signals.len()).flat_map(|r| [line(r, 0), line(r, 1)]).collect()
    }

    /// Returns the power of the drive's balance at a frequency, its phase free in every recording, (N m)^2 times samples.
    pub fn power_at(&self, frequency_hz: f64) -> f64 {
        let of = |(torque, signals): (&Vec<f64>, &BalanceSignals)| {
            let turn = std::f64::consts::TAU * frequency_hz * BALANCE_THINNING as f64 * signals.period_s;
            let (step_sine, step_cosine) = turn.sin_cos();
            let (mut sine, mut cosine, mut sums) = (0.0, 1.0, [0.0; 2]);
            for y in torque {
                sums = [sums[0] + y * cosine, sums[1] + y * sine];
                (sine, cosine) =
                    (sine * step_cosine + cosine * step_sine, cosine * step_cosine - sine * step_sine);
            }
            (sums[0] * sums[0] + sums[1] * sums[1]) / torque.len().max(1) as f64
        };
        self.torque.iter().zip(&self.signals).map(of).sum()
    }

    /// Returns the half width of the 95 % interval of the period of a sine at a frequency, s.
    pub fn period_doubt(&self, frequency_hz: f64) -> f64 {
        let total: f64 = self.torque.iter().map(|t| dot(t, t)).sum();
        let share =
            (2.0 * self.power_at(frequency_hz) / total.max(f64::MIN_POSITIVE)).clamp(LEAST_SHARE, 0.999);
        let independent: f64 = self.torque.iter().map(|t| t.len() as f64 / correlation_time(t)).sum();
        let longest = self.signals.iter().map(|s| s.len() as f64 * s.period_s).fold(0.0, f64::max);
        let deviation =
            (3.0 * (1.0 - share) / (share * independent.max(4.0))).sqrt() / (std::f64::consts::PI * longest);
        NORMAL_95 * deviation / (frequency_hz * frequency_hz)
    }

    /// Returns the log-likelihood that columns gain on held-out stretches; `None` if they cannot be fitted.
    pub fn gain(&self, columns: &[Vec<f64>]) -> Option<f64> {
        let after = self.held_out(columns)?;
        Some((0..after.len()).map(|b| self.log_likelihood_gain(b, after[b])).sum())
    }

    /// Returns the log-likelihood that a perfect explanation would gain.
    pub fn largest_gain(&self) -> f64 {
        (0..self.before.len()).map(|b| self.log_likelihood_gain(b, EXPLAINED_VARIANCE).max(0.0)).sum()
    }

    /// Returns the log-likelihood gained if a balance's variance becomes another.
    fn log_likelihood_gain(&self, balance: usize, after: f64) -> f64 {
        0.5 * self.count(balance) as f64
            * (self.before[balance].max(EXPLAINED_VARIANCE) / after.max(EXPLAINED_VARIANCE)).ln()
    }

    fn count(&self, balance: usize) -> usize {
        self.segments.iter().filter(|s| s.balance == balance).map(|s| s.rows.len()).sum()
    }

    /// Returns the variance of each balance on the half that was not fitted, the balances weighted by it.
    fn held_out(&self, columns: &[Vec<f64>]) -> Option<Vec<f64>> {
        let all: Vec<&[f64]> = self.nuisances.iter().chain(columns).map(Vec::as_slice).collect();
        let parts: Vec<NormalEquations> = self.segments.iter().map(|s| self.normal(s, &all)).collect();
        let mut left = vec![EXPLAINED_VARIANCE; self.balances.len()];
        for _ in 0..REWEIGHTED_FITS {
            let mut sums = vec![0.0; left.len()];
            for half in 0..2 {
                let fitted = self.fit_half(&parts, half, &left)?;
                for (s, part) in self.segments.iter().zip(&parts).filter(|(s, _)| s.half != half) {
                    sums[s.balance] += part.remaining_squares(&fitted);
                }
            }
            left = (0..left.len()).map(|b| sums[b] / self.count(b).max(1) as f64).collect();
        }
        left.iter().all(|v| v.is_finite()).then_some(left)
    }

    fn normal(&self, segment: &Segment, all: &[&[f64]]) -> NormalEquations {
        let target = &self.target[segment.rows.clone()];
        let columns: Vec<&[f64]> = all.iter().map(|c| &c[segment.rows.clone()]).collect();
        let mut gram = Mat::zeros(all.len(), all.len());
        for i in 0..columns.len() {
            for j in 0..=i {
                gram[(i, j)] = dot(columns[i], columns[j]);
                gram[(j, i)] = gram[(i, j)];
            }
        }
        let right = columns.iter().map(|c| dot(c, target)).collect();
        NormalEquations { gram, right, power: dot(target, target) }
    }

    /// Returns the coefficients fitted to one half of the stretches, the balances weighted by their residual variance.
    fn fit_half(&self, parts: &[NormalEquations], half: usize, left: &[f64]) -> Option<Vec<f64>> {
        let count = parts.first()?.right.len();
        let (mut gram, mut right) = (Mat::zeros(count, count), vec![0.0; count]);
        for (segment, part) in self.segments.iter().zip(parts).filter(|(s, _)| s.half == half) {
            let weight = 1.0 / left[segment.balance].max(EXPLAINED_VARIANCE);
            gram = &gram + &part.gram.scale(weight);
            right.iter_mut().zip(&part.right).for_each(|(r, x)| *r += weight * x);
        }
        solve_normal_equations(&gram, &right)
    }

    /// Returns the coefficients of columns that fit best, without those of the straight lines; `None` if they cannot be fitted.
    pub fn coefficients(&self, columns: &[Vec<f64>]) -> Option<Vec<f64>> {
        let all: Vec<&[f64]> = self.nuisances.iter().chain(columns).map(Vec::as_slice).collect();
        let whole = Segment { balance: 0, half: 0, rows: 0..self.target.len() };
        let normal = self.normal(&whole, &all);
        solve_normal_equations(&normal.gram, &normal.right).map(|x| x[self.nuisances.len()..].to_vec())
    }
}

/// Returns a series less its best straight line.
fn remove_trend(series: &[f64]) -> Vec<f64> {
    let count = series.len() as f64;
    let along = |k: usize| k as f64 - 0.5 * (count - 1.0);
    let mean = series.iter().sum::<f64>() / count.max(1.0);
    let square = (0..series.len()).map(|k| along(k).powi(2)).sum::<f64>().max(1.0);
    let slope = series.iter().enumerate().map(|(k, v)| along(k) * v).sum::<f64>() / square;
    series.iter().enumerate().map(|(k, v)| v - mean - slope * along(k)).collect()
}

/// Returns the half of the stretches in which a row lies.
fn half_of(row: usize, rows: usize) -> usize {
    (row / (rows / REGRESSION_STRETCHES).max(1)) % 2
}

/// Normal equations of one segment.
struct NormalEquations {
    gram: Mat,
    right: Vec<f64>,
    power: f64,
}

impl NormalEquations {
    /// Returns the sum of squares that coefficients leave.
    fn remaining_squares(&self, x: &[f64]) -> f64 {
        let column = Mat::col(x);
        let square = if x.is_empty() { 0.0 } else { (&column.t() * &(&self.gram * &column))[(0, 0)] };
        (self.power - 2.0 * dot(x, &self.right) + square).max(0.0)
    }
}

/// Solves normal equations with columns at a common size and a small ridge.
fn solve_normal_equations(gram: &Mat, right: &[f64]) -> Option<Vec<f64>> {
    let count = right.len();
    if count == 0 {
        return Some(Vec::new());
    }
    let size = |i: usize| if gram[(i, i)] > 0.0 { gram[(i, i)].sqrt() } else { 1.0 };
    let ridge = |i, j| if i == j { REGRESSION_RIDGE } else { 0.0 };
    let scaled = Mat::from_fn(count, count, |i, j| gram[(i, j)] / (size(i) * size(j)) + ridge(i, j));
    let right: Vec<f64> = right.iter().enumerate().map(|(i, r)| r / size(i)).collect();
    let x = solve(&scaled, &Mat::col(&right)).ok()?;
    Some(x.as_slice().iter().enumerate().map(|(i, x)| x / size(i)).collect())
}

/// Returns the balances of a recording less those of its replay, and what noise alone would make of them.
fn balance_departures(
    p: &Parameters,
    recorded: &BalanceSignals,
    recording: &AssessedReplay,
    balances: &[Balance],
) -> [Vec<Vec<f64>>; 2] {
    let replay = replayed_signals(recording);
    let slow = Some(recorded.slow_rates());
    let simulated = BalanceSignals::new(p, &replay, slow);
    let noisy = BalanceSignals::new(p, &add_noise(p, &replay, &recording.assessment), slow);
    let apart = |other: &BalanceSignals, balance: Balance| {
        let pairs =
            trim_ends(&other.residual(balance)).into_iter().zip(trim_ends(&simulated.residual(balance)));
        pairs.map(|(a, b)| a - b).collect()
    };
    let of = |other: &BalanceSignals| balances.iter().map(|b| apart(other, *b)).collect();
    [of(recorded), of(&noisy)]
}

/// Returns the readings of the replay: the recorded ones less the residuals. A control that was played back is the recorded one.
fn replayed_signals(recording: &AssessedReplay) -> MeasuredSignals {
    let AssessedReplay { measured, assessment: judged } = recording;
    let mut out = measured.clone();
    for channel in &judged.channels {
        let column = match channel.channel {
            Channel::Control if judged.source == ControlSource::ClosedLoop => MeasuredColumn::Control,
            Channel::HubRate => MeasuredColumn::HubRate,
            Channel::MotorRate => MeasuredColumn::MotorRate,
            Channel::HubPosition => MeasuredColumn::HubPosition,
            _ => continue,
        };
        let pairs = out.recorded_mut(column).iter_mut().zip(&channel.residual);
        pairs.for_each(|(value, residual)| *value -= residual * channel.floor);
    }
    out
}

/// Returns readings with noise of the size of each channel's floor and of the platform's sensors (a fixed sequence).
fn add_noise(p: &Parameters, replay: &MeasuredSignals, judged: &Assessment) -> MeasuredSignals {
    let floor =
        |channel: Channel| judged.channels.iter().find(|m| m.channel == channel).map_or(0.0, |m| m.floor);
    let mut out = replay.clone();
    let columns = [
        (MeasuredColumn::Control, floor(Channel::Control)),
        (MeasuredColumn::HubRate, floor(Channel::HubRate)),
        (MeasuredColumn::MotorRate, floor(Channel::MotorRate)),
        (MeasuredColumn::HubPosition, floor(Channel::HubPosition)),
        (MeasuredColumn::PlatformRate, p.sensors.platform_gyro.noise_rms),
        (MeasuredColumn::PlatformAccel, p.sensors.platform_accelerometer.noise_rms),
    ];
    let mut normal = normals();
    for (column, size) in columns {
        out.recorded_mut(column).iter_mut().for_each(|value| *value += size * normal());
    }
    out
}

/// Returns a generator of normal numbers, always the same.
fn normals() -> impl FnMut() -> f64 {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut uniform = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    move || (0..12).map(|_| uniform()).sum::<f64>() - 6.0
}
