//! The statistics of a campaign: shares, quantiles, and which parameter matters.

use super::{Campaign, Sample};
use crate::tolerance::CLEAR_RANK;

/// A figure over all samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Smallest value that is a number.
    pub lowest: f64,
    /// 5 % quantile.
    pub q05: f64,
    /// Median.
    pub median: f64,
    /// 95 % quantile.
    pub q95: f64,
    /// Largest value; infinite if a sample diverged.
    pub highest: f64,
    /// Share of the samples that meet the requirement, of those that could be judged.
    pub share: f64,
    /// Confidence interval of that share, 95 %, after Wilson.
    pub interval: (f64, f64),
    /// The sample with the least room.
    pub worst: Option<usize>,
}

/// Influence of a parameter on a figure.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterInfluence {
    /// Index of the variation.
    pub variation: usize,
    /// Spearman's rank correlation, -1 to 1, between the figure and what `sense` says.
    pub correlation: f64,
    /// Property of the factor that is compared.
    pub sense: Sense,
}

/// Property of a factor that correlates with a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sense {
    /// The factor: more of it raises the figure, or lowers it.
    Directed,
    /// The factor's distance from 1 in either direction, |ln factor|: whatever differs from the design.
    EitherWay,
}

const NORMAL_975: f64 = 1.959_963_984_540_054;

/// Returns the requirement's figure over the samples.
pub fn summarise_requirement(campaign: &Campaign, samples: &[Sample], requirement: usize) -> Summary {
    let limit = campaign.requirements()[requirement].limit;
    let judged: Vec<(usize, f64)> = samples
        .iter()
        .map(|s| (s.index, s.values[requirement]))
        .filter(|(_, value)| !value.is_nan())
        .collect();
    let mut sorted: Vec<f64> = judged.iter().map(|(_, value)| *value).collect();
    sorted.sort_by(f64::total_cmp);
    let good = sorted.iter().filter(|value| limit.distance_to_limit(**value) >= 0.0).count();
    let worst =
        judged.iter().min_by(|a, b| limit.distance_to_limit(a.1).total_cmp(&limit.distance_to_limit(b.1)));
    Summary {
        lowest: quantile(&sorted, 0.0),
        q05: quantile(&sorted, 0.05),
        median: quantile(&sorted, 0.5),
        q95: quantile(&sorted, 0.95),
        highest: quantile(&sorted, 1.0),
        share: good as f64 / sorted.len().max(1) as f64,
        interval: wilson(good, sorted.len()),
        worst: worst.map(|(index, _)| *index),
    }
}

/// Returns the parameters by the size of their rank correlation with the requirement's figure, strongest first. A figure that any
/// deviation from the design spoils (the rejection by a feedforward) has no order in the factor itself: then its distance from 1 is
/// compared.
pub fn rank_parameters(
    campaign: &Campaign,
    samples: &[Sample],
    requirement: usize,
) -> Vec<ParameterInfluence> {
    let judged: Vec<&Sample> = samples.iter().filter(|s| !s.values[requirement].is_nan()).collect();
    let figure = ranks(&judged.iter().map(|s| s.values[requirement]).collect::<Vec<f64>>());
    let one = |variation: usize| {
        let against = |of: fn(f64) -> f64| {
            let factor = judged.iter().map(|s| of(s.factors[variation])).collect::<Vec<f64>>();
            correlation(&ranks(&factor), &figure)
        };
        let (directed, either) = (against(|factor| factor), against(|factor| factor.ln().abs()));
        let (correlation, sense) = match either.abs() > directed.abs() + CLEAR_RANK {
            true => (either, Sense::EitherWay),
            false => (directed, Sense::Directed),
        };
        ParameterInfluence { variation, correlation, sense }
    };
    let mut all: Vec<ParameterInfluence> = (0..campaign.variations().len()).map(one).collect();
    all.sort_by(|a, b| b.correlation.abs().total_cmp(&a.correlation.abs()));
    all
}

/// The quantile of a sorted series, between neighbours by a straight line; NaN of an empty one.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let at = share * last as f64;
    let (low, high) = (sorted[at.floor() as usize], sorted[at.ceil() as usize]);
    if low == high { low } else { low + at.fract() * (high - low) }
}

/// Wilson's interval of a share, 95 %.
fn wilson(good: usize, all: usize) -> (f64, f64) {
    if all == 0 {
        return (0.0, 1.0);
    }
    let (n, z2) = (all as f64, NORMAL_975 * NORMAL_975);
    let share = good as f64 / n;
    let centre = (share + 0.5 * z2 / n) / (1.0 + z2 / n);
    let half = NORMAL_975 / (1.0 + z2 / n) * (share * (1.0 - share) / n + 0.25 * z2 / (n * n)).sqrt();
    ((centre - half).max(0.0), (centre + half).min(1.0))
}

/// Ranks from 0; equal values share the mean of theirs.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    let mut from = 0;
    while from < order.len() {
        let to = (from..order.len()).take_while(|k| values[order[*k]] == values[order[from]]).count() + from;
        order[from..to].iter().for_each(|&k| ranks[k] = 0.5 * (from + to - 1) as f64);
        from = to;
    }
    ranks
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let middle = 0.5 * (a.len() as f64 - 1.0);
    let sum = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(p, q)| (p - middle) * (q - middle)).sum::<f64>();
    let size = (sum(a, a) * sum(b, b)).sqrt();
    if size > 0.0 { sum(a, b) / size } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_and_quantiles() {
        assert_eq!(ranks(&[3.0, 1.0, 3.0, f64::INFINITY]), [1.5, 0.0, 1.5, 3.0]);
        let rising = [1.0, 2.0, 5.0, 9.0];
        assert!((correlation(&ranks(&rising), &ranks(&rising.map(|x| x * x))) - 1.0).abs() < 1e-12);
        assert_eq!(quantile(&rising, 0.5), 3.5);
        assert!(quantile(&[], 0.5).is_nan());
        assert_eq!(quantile(&[1.0, f64::INFINITY, f64::INFINITY], 1.0), f64::INFINITY);
    }

    #[test]
    fn wilson_is_that_of_the_book() {
        // 81 of 263: Newcombe 1998, table I: 0.2553 to 0.3662
        let (low, high) = wilson(81, 263);
        assert!((low - 0.2553).abs() < 5e-5 && (high - 0.3662).abs() < 5e-5, "{low} {high}");
    }
}
