//! The imperfections of a sampled loop: the clock's errors, the codes that a converter misses, and the drift of gyroscopes.
//!
//! Everything is drawn from the run's seed, each source from a stream of its own, so that one source does not change another.

use counterpoise_models::{Clock, Drift};

use crate::noise::Noise;
use crate::tolerance::{FLICKER_LONGEST_S, FLICKER_RATIO};

/// The stream of the clock; those of the sensors' drifts follow.
const CLOCK_STREAM: u64 = 1;
/// The first stream of a sensor's drift.
pub(crate) const DRIFT_STREAM: u64 = 2;
/// Stream of the white noise of the surge accelerometer: fitting one leaves the noise of the other sensors as it was.
pub(crate) const SURGE_STREAM: u64 = 16;

/// The imperfections of one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SampleError {
    /// Instant at which the sensors are read after the instant of an ideal clock, in periods.
    pub offset: f64,
    /// Outcome of the controller's step.
    pub step: Step,
}

/// The fate of the controller's step in a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Step {
    /// The controller runs, and its control acts at once.
    InTime,
    /// The controller runs, and its control acts one period later.
    Late,
    /// The controller does not run.
    Missed,
}

impl SampleError {
    /// A sample of an ideal clock.
    pub const NONE: Self = Self { offset: 0.0, step: Step::InTime };
}

/// A clock with errors.
#[derive(Debug, Clone)]
pub(crate) struct ErrantClock {
    clock: Clock,
    period_s: f64,
    noise: Noise,
}

impl ErrantClock {
    /// Returns the clock of a run; `None` if it is ideal.
    pub fn new(clock: Clock, period_s: f64, seed: u64) -> Option<Self> {
        let noise = Noise::from_stream(seed, CLOCK_STREAM);
        (clock != Clock::IDEAL).then_some(Self { clock, period_s, noise })
    }

    /// Returns what happens to the next sample.
    pub fn next(&mut self) -> SampleError {
        let offset = self.clock.jitter_s / self.period_s * self.noise.next();
        let (missed, late) = (self.clock.missed_samples, self.clock.late_samples);
        let drawn = self.noise.next_uniform();
        let step = match drawn {
            drawn if drawn <= missed => Step::Missed,
            drawn if drawn <= missed + late => Step::Late,
            _ => Step::InTime,
        };
        SampleError { offset, step }
    }
}

/// Returns whether a converter with a share of missing codes misses this one: the same codes in every run.
pub(crate) fn is_missing(code: i64, share: f64) -> bool {
    // S. Vigna's splitmix64: neighbouring codes are missing independently of each other
    let mut mixed = (code as u64).wrapping_add(0x9e37_79b9_7f4a_7c15);
    mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    let uniform = ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1u64 << 53) as f64;
    uniform < share
}

/// The drift of one sensor.
///
/// Flicker noise is a sum of first-order Gauss-Markov processes whose correlation times tau are in the ratio r: with the variance
/// B^2 ln(r) / pi each, the sum of their densities 2 sigma^2 tau / (1 + (2 pi f tau)^2) is B^2 / (2 pi f) between the fastest and the
/// slowest (W. Press, Comments on Astrophysics 7, 1978, has the principle).
#[derive(Debug, Clone)]
pub(crate) struct DriftNoise {
    noise: Noise,
    white: f64,
    walk_step: f64,
    walk: f64,
    flicker: Vec<GaussMarkov>,
}

/// x[k+1] = keep x[k] + kick w[k].
#[derive(Debug, Clone)]
struct GaussMarkov {
    value: f64,
    keep: f64,
    kick: f64,
}

impl DriftNoise {
    /// Returns the drift of a run; `None` if the sensor has none.
    pub fn new(drift: Drift, period_s: f64, seed: u64, stream: u64) -> Option<Self> {
        if drift == Drift::NONE {
            return None;
        }
        let mut noise = Noise::from_stream(seed, stream);
        let deviation = drift.bias_instability * (FLICKER_RATIO.ln() / std::f64::consts::PI).sqrt();
        let mut flicker = Vec::new();
        let mut time_s = period_s;
        while drift.bias_instability > 0.0 && time_s <= FLICKER_LONGEST_S {
            let keep = (-period_s / time_s).exp();
            let kick = deviation * (1.0 - keep * keep).sqrt();
            flicker.push(GaussMarkov { value: deviation * noise.next(), keep, kick });
            time_s *= FLICKER_RATIO;
        }
        let white = drift.angle_random_walk / period_s.sqrt();
        let walk_step = drift.rate_random_walk * period_s.sqrt();
        Some(Self { noise, white, walk_step, walk: 0.0, flicker })
    }

    /// Returns the error of the next sample, in the measured unit.
    pub fn next(&mut self) -> f64 {
        let white = self.white * self.noise.next();
        let walk = self.walk;
        self.walk += self.walk_step * self.noise.next();
        let mut sum = white + walk;
        for part in &mut self.flicker {
            sum += part.value;
            part.value = part.keep * part.value + part.kick * self.noise.next();
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// The Allan deviation of a series at an averaging time of `cluster` samples, clusters overlapping by half.
    fn allan(values: &[f64], cluster: usize) -> f64 {
        let means: Vec<f64> = (0..values.len() / cluster)
            .map(|k| values[k * cluster..(k + 1) * cluster].iter().sum::<f64>() / cluster as f64)
            .collect();
        let squares: f64 = means.windows(2).map(|w| (w[1] - w[0]) * (w[1] - w[0])).sum();
        (squares / (2.0 * (means.len() - 1) as f64)).sqrt()
    }

    fn series(drift: Drift, period_s: f64, count: usize) -> Vec<f64> {
        let mut noise = DriftNoise::new(drift, period_s, 3, DRIFT_STREAM).unwrap();
        (0..count).map(|_| noise.next()).collect()
    }

    #[test]
    fn each_part_of_the_drift_has_its_allan_deviation() {
        let (count, period_s) = (2_000_000, 1e-2);
        let walk = series(Drift { angle_random_walk: 1e-3, ..Drift::NONE }, period_s, count);
        for cluster in [1, 100, 1000] {
            let expected = 1e-3 / (cluster as f64 * period_s).sqrt();
            assert!((allan(&walk, cluster) / expected - 1.0).abs() < 0.1, "{cluster}");
        }
        let flicker = series(Drift { bias_instability: 1e-3, ..Drift::NONE }, period_s, count);
        for cluster in [100, 1000, 10_000] {
            let ratio = allan(&flicker, cluster) / 0.664e-3;
            assert!((ratio - 1.0).abs() < 0.15, "{cluster}: {ratio}");
        }
        let rate = series(Drift { rate_random_walk: 1e-3, ..Drift::NONE }, period_s, count);
        for cluster in [1000, 10_000] {
            let expected = 1e-3 * (cluster as f64 * period_s / 3.0).sqrt();
            assert!((allan(&rate, cluster) / expected - 1.0).abs() < 0.2, "{cluster}");
        }
    }

    #[test]
    fn a_clock_has_the_jitter_and_the_shares_that_it_states() {
        let clock = Clock { jitter_s: 5e-5, missed_samples: 0.02, late_samples: 0.05 };
        let mut errant = ErrantClock::new(clock, 1e-3, 1).unwrap();
        let all: Vec<SampleError> = (0..100_000).map(|_| errant.next()).collect();
        let rms = (all.iter().map(|one| one.offset * one.offset).sum::<f64>() / 1e5).sqrt();
        let share = |step: Step| all.iter().filter(|one| one.step == step).count() as f64 / 1e5;
        assert!((rms - 0.05).abs() < 1e-3);
        assert!((share(Step::Missed) - 0.02).abs() < 2e-3 && (share(Step::Late) - 0.05).abs() < 3e-3);
        assert!(ErrantClock::new(Clock::IDEAL, 1e-3, 1).is_none());
    }

    #[test]
    fn the_share_of_missing_codes_is_the_one_stated() {
        let missing = (-32_768..32_768).filter(|&code| is_missing(code, 0.1)).count();
        assert!((missing as f64 / 65_536.0 - 0.1).abs() < 0.005);
        assert!((-100..100).all(|code| !is_missing(code, 0.0)));
    }
}
