//! Points of a campaign: Latin hypercube, from a seed, by a portable generator.

use ndarray::Array2;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::Error;
use crate::tolerance::NORMAL_CUT;

/// Distribution of a factor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Distribution {
    /// Evenly between two factors.
    Uniform {
        /// Lowest.
        low: f64,
        /// Highest.
        high: f64,
    },
    /// Evenly in the logarithm between two factors.
    LogUniform {
        /// Lowest, positive.
        low: f64,
        /// Highest.
        high: f64,
    },
    /// About 1 with a standard deviation, cut off at three of them.
    Normal {
        /// Standard deviation.
        deviation: f64,
    },
}

/// Layout of the points of a campaign.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PointLayout {
    /// Each coordinate once in each of as many strata as there are samples.
    #[default]
    LatinHypercube,
    /// Sobol's sequence with a digital shift: a longer campaign holds the shorter one's points.
    Sobol,
}

impl PointLayout {
    /// Returns points of the open unit cube, samples x dimensions.
    ///
    /// # Errors
    /// As [`super::sobol()`].
    pub fn sample_points(self, samples: usize, dimensions: usize, seed: u64) -> Result<Array2<f64>, Error> {
        match self {
            PointLayout::LatinHypercube => Ok(latin_hypercube(samples, dimensions, seed)),
            PointLayout::Sobol => super::sobol(samples, dimensions, seed),
        }
    }
}

impl Distribution {
    /// Returns the factor below which a share `u` of all factors lies, 0 < u < 1.
    pub fn quantile(self, u: f64) -> f64 {
        match self {
            Distribution::Uniform { low, high } => low + u * (high - low),
            Distribution::LogUniform { low, high } => low * (high / low).powf(u),
            Distribution::Normal { deviation } => {
                let tail = normal_below(-NORMAL_CUT);
                1.0 + deviation * normal_quantile(tail + u * (1.0 - 2.0 * tail))
            }
        }
    }

    /// Refuses ranges that are reversed, not finite, or reach below 0.
    ///
    /// # Errors
    /// [`Error::Range`].
    pub fn check(self) -> Result<(), Error> {
        let (low, high) = (self.quantile(0.0), self.quantile(1.0));
        let least = if matches!(self, Distribution::LogUniform { .. }) { f64::MIN_POSITIVE } else { 0.0 };
        if low.is_finite() && high.is_finite() && low >= least && high >= low {
            return Ok(());
        }
        Err(Error::Range {
            what: "lowest factor of a variation",
            value: low,
            allowed: "0 or more, and below the highest",
        })
    }
}

/// Returns `samples` points of the open unit cube, samples x dimensions, each coordinate once in each of `samples` equal strata: a pure function of its arguments.
pub fn latin_hypercube(samples: usize, dimensions: usize, seed: u64) -> Array2<f64> {
    let mut points = Array2::zeros((samples, dimensions));
    for (dimension, mut column) in points.columns_mut().into_iter().enumerate() {
        let mut source = ChaCha8Rng::seed_from_u64(seed);
        source.set_stream(dimension as u64 + 1);
        let strata = permutation(samples, &mut source);
        for (u, stratum) in column.iter_mut().zip(strata) {
            *u = (stratum as f64 + next_uniform(&mut source)) / samples as f64;
        }
    }
    points
}

/// Fisher and Yates.
fn permutation(count: usize, source: &mut ChaCha8Rng) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    for i in (1..count).rev() {
        let j = (next_uniform(source) * (i + 1) as f64) as usize;
        order.swap(i, j.min(i));
    }
    order
}

/// Uniform in the open interval (0, 1), 53 bits.
fn next_uniform(source: &mut ChaCha8Rng) -> f64 {
    ((source.next_u64() >> 11) as f64 + 0.5) / (1u64 << 53) as f64
}

/// The share of a normal distribution below `z`, by the complementary error function's continued fraction (z < -2).
fn normal_below(z: f64) -> f64 {
    let x = -z;
    let fraction = (1..=40).rev().fold(x, |tail, k| x + f64::from(k) / tail);
    (-0.5 * x * x).exp() / (fraction * std::f64::consts::TAU.sqrt())
}

/// The normal quantile by Acklam's rational approximation, relative error 1.2e-9.
fn normal_quantile(p: f64) -> f64 {
    const A: [f64; 6] = [
        -3.969_683_028_665_376e1,
        2.209_460_984_245_205e2,
        -2.759_285_104_469_687e2,
        1.383_577_518_672_69e2,
        -3.066_479_806_614_716e1,
        2.506_628_277_459_239,
    ];
    const B: [f64; 5] = [
        -5.447_609_879_822_406e1,
        1.615_858_368_580_409e2,
        -1.556_989_798_598_866e2,
        6.680_131_188_771_972e1,
        -1.328_068_155_288_572e1,
    ];
    const C: [f64; 6] = [
        -7.784_894_002_430_293e-3,
        -3.223_964_580_411_365e-1,
        -2.400_758_277_161_838,
        -2.549_732_539_343_734,
        4.374_664_141_464_968,
        2.938_163_982_698_783,
    ];
    const D: [f64; 4] =
        [7.784_695_709_041_462e-3, 3.224_671_290_700_398e-1, 2.445_134_137_142_996, 3.754_408_661_907_416];
    const LOW: f64 = 0.024_25;
    let polynomial = |c: &[f64], x: f64| c.iter().fold(0.0, |sum, k| sum * x + k);
    if p < LOW {
        let q = (-2.0 * p.ln()).sqrt();
        return polynomial(&C, q) / (polynomial(&D, q) * q + 1.0);
    }
    if p > 1.0 - LOW {
        return -normal_quantile(1.0 - p);
    }
    let q = p - 0.5;
    polynomial(&A, q * q) * q / (polynomial(&B, q * q) * q * q + 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stratum_is_met_once_and_a_seed_repeats() {
        let points = latin_hypercube(100, 3, 7);
        for dimension in 0..3 {
            let mut strata: Vec<usize> =
                points.column(dimension).iter().map(|u| (u * 100.0) as usize).collect();
            strata.sort_unstable();
            assert_eq!(strata, (0..100).collect::<Vec<_>>());
        }
        assert_eq!(points, latin_hypercube(100, 3, 7));
        assert_ne!(points, latin_hypercube(100, 3, 8));
        let correlation: f64 =
            points.rows().into_iter().map(|p| (p[0] - 0.5) * (p[1] - 0.5)).sum::<f64>() * 12.0 / 100.0;
        assert!(correlation.abs() < 0.3, "{correlation}");
    }

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (p, z) in [(0.975, 1.959_963_985), (0.5, 0.0), (0.01, -2.326_347_874), (0.999, 3.090_232_306)] {
            assert!((normal_quantile(p) - z).abs() < 1e-7, "{p}");
        }
        assert!((normal_below(-3.0) / 1.349_898_031_6e-3 - 1.0).abs() < 1e-6);
        let normal = Distribution::Normal { deviation: 0.1 };
        assert!((normal.quantile(0.5) - 1.0).abs() < 1e-9 && (normal.quantile(1e-12) - 0.7).abs() < 1e-6);
        assert!((Distribution::LogUniform { low: 0.5, high: 2.0 }.quantile(0.5) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn impossible_ranges_are_refused() {
        assert!(Distribution::Uniform { low: 2.0, high: 1.0 }.check().is_err());
        assert!(Distribution::Normal { deviation: 0.4 }.check().is_err());
        assert!(Distribution::LogUniform { low: 0.0, high: 1.0 }.check().is_err());
        assert!(Distribution::Uniform { low: 0.5, high: 2.0 }.check().is_ok());
    }
}
