//! The recordings that two machines would make in an experiment, and the certainty of a decision between them.

use counterpoise_linalg::{Mat, solve};
use counterpoise_models::Parameters;

use crate::library::EffectParameter;
use crate::recording::series::dot;
use crate::tolerance::AMBIGUOUS;
use crate::tolerance::experiment::REFIT_RIDGE;

/// A machine that the recordings leave possible.
#[derive(Debug, Clone)]
pub struct PossibleMachine {
    /// Name.
    pub name: String,
    /// The mechanism.
    pub parameters: Parameters,
    /// Parameters that a fit to the new recording would adapt.
    pub free: Vec<&'static EffectParameter>,
}

/// Separation of two machines by an experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct Separation {
    /// Index of one machine.
    pub first: usize,
    /// Index of the other.
    pub second: usize,
    /// Expected log-likelihood ratio of the true one against the other, fitted anew: the smaller of both directions.
    pub log_likelihood_ratio: f64,
    /// Probability that the ratio exceeds what a decision needs.
    pub probability: f64,
    /// The first as true and the second fitted to it, then the other way round.
    pub refits: [Refit; 2],
}

/// The linear fit of a rival to the machine that is true, of which the expected log-likelihood ratio is what it leaves. Everything is over the noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Refit {
    /// Squared distance of what both record.
    pub squared_distance: f64,
    /// Products of the slopes of the rival's recording with each other, a row a parameter, with the ridge on its diagonal.
    pub slopes: Vec<Vec<f64>>,
    /// Products of the slopes with the distance.
    pub slopes_with_distance: Vec<f64>,
}

/// The recording that a machine would make, over the noise floors, and how that changes with each of its fitted parameters.
pub(super) struct ExpectedSignals {
    pub signals: Vec<f64>,
    pub slopes: Vec<Vec<f64>>,
}

/// Returns how well two machines are separated: half the squared distance of what they record, over the noise, after the one that is not
/// true was fitted to the other (Hunter, Reiner 1965; Atkinson, Fedorov 1975: T-optimality, linearised).
pub(super) fn separation(
    indices: [usize; 2],
    first: &ExpectedSignals,
    second: &ExpectedSignals,
) -> Separation {
    let refits = [refit(first, second), refit(second, first)];
    let log_likelihood_ratio = refits[0].expected_ratio().min(refits[1].expected_ratio());
    Separation {
        first: indices[0],
        second: indices[1],
        log_likelihood_ratio,
        probability: probability(log_likelihood_ratio),
        refits,
    }
}

/// Returns the fit of a rival to the machine that is true.
fn refit(truth: &ExpectedSignals, rival: &ExpectedSignals) -> Refit {
    let difference: Vec<f64> = truth.signals.iter().zip(&rival.signals).map(|(t, r)| t - r).collect();
    let product = |(i, j): (usize, usize)| {
        let own = dot(&rival.slopes[i], &rival.slopes[j]);
        if i == j { own * (1.0 + REFIT_RIDGE) + f64::MIN_POSITIVE } else { own }
    };
    let count = rival.slopes.len();
    Refit {
        squared_distance: dot(&difference, &difference),
        slopes: (0..count).map(|i| (0..count).map(|j| product((i, j))).collect()).collect(),
        slopes_with_distance: rival.slopes.iter().map(|slope| dot(slope, &difference)).collect(),
    }
}

impl Refit {
    /// Returns the expected log-likelihood ratio.
    fn expected_ratio(&self) -> f64 {
        let (all, right) = (self.squared_distance, &self.slopes_with_distance);
        if right.is_empty() {
            return 0.5 * all;
        }
        let normal = Mat::from_fn(right.len(), right.len(), |i, j| self.slopes[i][j]);
        let explained = solve(&normal, &Mat::col(right)).map_or(0.0, |step| dot(step.as_slice(), right));
        0.5 * (all - explained).max(0.0)
    }
}

/// Returns the probability that a log-likelihood ratio of this mean, and of twice the mean as its variance, exceeds what a decision needs.
fn probability(log_likelihood_ratio: f64) -> f64 {
    if log_likelihood_ratio <= 0.0 {
        return 0.0;
    }
    normal_share((log_likelihood_ratio - AMBIGUOUS) / (2.0 * log_likelihood_ratio).sqrt())
}

/// Returns the share of the standard normal distribution below a value (Abramowitz, Stegun 1964, 26.2.17; error below 1e-7).
fn normal_share(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.231_641_9 * x.abs());
    let series = t
        * (0.319_381_530
            + t * (-0.356_563_782 + t * (1.781_477_937 + t * (-1.821_255_978 + t * 1.330_274_429))));
    let above = (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt() * series;
    if x >= 0.0 { 1.0 - above } else { above }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_parameter_explains_does_not_separate() {
        let signals =
            |of: &dyn Fn(f64) -> f64| (0..200).map(|k| of(f64::from(k) * 0.05)).collect::<Vec<f64>>();
        let truth = ExpectedSignals { signals: signals(&|t| 3.0 * t), slopes: Vec::new() };
        let line = ExpectedSignals { signals: signals(&|_| 0.0), slopes: vec![signals(&|t| t)] };
        let wave = ExpectedSignals { signals: signals(&|_| 0.0), slopes: vec![signals(&|t| t.sin())] };
        assert!(refit(&truth, &line).expected_ratio() < 1e-3);
        assert!(refit(&truth, &wave).expected_ratio() > 1e3);
        assert_eq!(separation([0, 1], &truth, &line).probability, 0.0);
    }

    #[test]
    fn the_probability_is_that_of_a_normal_distribution() {
        assert!(
            (normal_share(1.96) - 0.975_002).abs() < 1e-5 && (normal_share(-1.0) - 0.158_655).abs() < 1e-5
        );
        assert!((probability(AMBIGUOUS) - 0.5).abs() < 1e-6 && probability(100.0) > 0.99);
    }
}
