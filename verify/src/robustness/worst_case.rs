//! The worst case, by a search from the worst samples.

use super::{Campaign, Sample};
use crate::Error;
use crate::tolerance::{FIRST_QUANTILE_STEP, LAST_QUANTILE_STEP};

/// The worst mechanism that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct WorstMechanism {
    /// The factors of the variations.
    pub factors: Vec<f64>,
    /// The requirement's figure there.
    pub value: f64,
    /// The figure of the worst sample, where the search began.
    pub start: f64,
    /// Number of the worst sample, whose sensor noise the search keeps.
    pub sample: usize,
    /// Number of mechanisms that were tried.
    pub tried: usize,
    /// `true` if the search ended because its steps grew small, not because of its limit.
    pub converged: bool,
}

/// Searches from the worst of `samples` for factors inside the variations' ranges with even less room: a compass search in the
/// quantiles (each coordinate up and down, the step halved when nothing is worse), at most `most` mechanisms. It is a lower bound
/// of the true worst case.
///
/// # Errors
/// [`Error::Length`] if no sample can be judged, and those of the campaign.
pub fn worst_case(
    campaign: &Campaign,
    samples: &[Sample],
    requirement: usize,
    most: usize,
) -> Result<WorstMechanism, Error> {
    let limit = campaign.requirements()[requirement].limit;
    let judged = samples.iter().filter(|sample| !sample.values[requirement].is_nan());
    let first = judged.min_by(|a, b| {
        limit
            .distance_to_limit(a.values[requirement])
            .total_cmp(&limit.distance_to_limit(b.values[requirement]))
    });
    let first = first.ok_or(Error::Length { what: "samples to search from", found: 0, needed: 1 })?;
    let mut search = Search { campaign, requirement, sample: first.index, tried: 0 };
    let mut at = search.quantiles(first)?;
    let mut value = search.value(&at)?;
    let mut step = FIRST_QUANTILE_STEP;
    while step >= LAST_QUANTILE_STEP && search.tried < most {
        match search.better_neighbour(&at, value, step, most)? {
            Some((point, worse)) => (at, value) = (point, worse),
            None => step *= 0.5,
        }
    }
    let factors = search.factors(&at);
    Ok(WorstMechanism {
        factors,
        value,
        start: first.values[requirement],
        sample: first.index,
        tried: search.tried,
        converged: step < LAST_QUANTILE_STEP,
    })
}

struct Search<'a> {
    campaign: &'a Campaign,
    requirement: usize,
    sample: usize,
    tried: usize,
}

impl Search<'_> {
    fn factors(&self, quantiles: &[f64]) -> Vec<f64> {
        let both = self.campaign.variations().iter().zip(quantiles);
        both.map(|(variation, u)| variation.distribution.quantile(*u)).collect()
    }

    fn quantiles(&self, sample: &Sample) -> Result<Vec<f64>, Error> {
        self.campaign.quantiles(sample.index)
    }

    /// The figure there; NaN if there is no mechanism, at the end of a range that begins at 0.
    fn value(&mut self, quantiles: &[f64]) -> Result<f64, Error> {
        self.tried += 1;
        let figure = self.campaign.requirements()[self.requirement].figure;
        match self.campaign.values_at(&self.factors(quantiles), self.sample, &[figure]) {
            Ok(values) => Ok(values[0]),
            Err(Error::Models(_) | Error::Controller(_)) => Ok(f64::NAN),
            Err(error) => Err(error),
        }
    }

    /// The first neighbour with less room.
    fn better_neighbour(
        &mut self,
        at: &[f64],
        value: f64,
        step: f64,
        most: usize,
    ) -> Result<Option<(Vec<f64>, f64)>, Error> {
        let limit = self.campaign.requirements()[self.requirement].limit;
        for k in 0..at.len() {
            for sign in [1.0, -1.0] {
                let mut point = at.to_vec();
                point[k] = (point[k] + sign * step).clamp(0.0, 1.0);
                if point[k] == at[k] || self.tried >= most {
                    continue;
                }
                let found = self.value(&point)?;
                if limit.distance_to_limit(found) < limit.distance_to_limit(value) {
                    return Ok(Some((point, found)));
                }
            }
        }
        Ok(None)
    }
}
