//! A Monte Carlo campaign: every sample a pure function of the campaign and its own number.

use std::ops::Range;

use counterpoise_controller::Controller;
use counterpoise_models::ControlledQuantity;
use counterpoise_models::parameters::Parameters;
use counterpoise_models::plant::Plant;
use ndarray::Array2;

use super::{Distribution, PointLayout, VariedParameter, figures_of};
use crate::measure::Value;
use crate::{Error, PerformanceFigure, Procedure, Requirement};

/// A parameter and how its factor is distributed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Variation {
    /// Parameter.
    pub parameter: VariedParameter,
    /// Factor.
    pub distribution: Distribution,
}

/// Everything that defines a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Campaign {
    nominal: Parameters,
    controller: Controller,
    procedure: Procedure,
    variations: Vec<Variation>,
    requirements: Vec<Requirement>,
    /// Quantiles, sample x variation.
    points: Array2<f64>,
}

/// One mechanism of the campaign, and its figures.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Number.
    pub index: usize,
    /// The factor of each variation.
    pub factors: Vec<f64>,
    /// The figure of each requirement; NaN if there is no such number, infinite if the loop diverges.
    pub values: Vec<f64>,
}

/// Layout of the mechanisms of a campaign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layout {
    /// Number of mechanisms.
    pub samples: usize,
    /// Seed of the layout.
    pub seed: u64,
    /// The method.
    pub points: PointLayout,
}

impl Campaign {
    /// Returns a campaign of a number of mechanisms, laid out from a seed.
    ///
    /// # Errors
    /// [`Error::Range`] for no samples, no variations or an impossible distribution, and those of [`Procedure::check`].
    pub fn new(
        nominal: Parameters,
        controller: Controller,
        procedure: Procedure,
        variations: Vec<Variation>,
        requirements: Vec<Requirement>,
        layout: Layout,
    ) -> Result<Self, Error> {
        procedure.check()?;
        for (what, count) in [
            ("samples", layout.samples),
            ("variations", variations.len()),
            ("requirements", requirements.len()),
        ] {
            if count == 0 {
                return Err(Error::Range { what, value: 0.0, allowed: "at least 1" });
            }
        }
        variations.iter().try_for_each(|variation| variation.distribution.check())?;
        let points = layout.points.sample_points(layout.samples, variations.len(), layout.seed)?;
        Ok(Self { nominal, controller, procedure, variations, requirements, points })
    }

    /// Returns the number of samples.
    pub fn len(&self) -> usize {
        self.points.nrows()
    }

    /// Returns whether there is no sample: never.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Returns the variations.
    pub fn variations(&self) -> &[Variation] {
        &self.variations
    }

    /// Returns what the loop controls.
    pub fn controlled_quantity(&self) -> ControlledQuantity {
        self.nominal.controlled_quantity()
    }

    /// Returns the requirements, whose figures are measured.
    pub fn requirements(&self) -> &[Requirement] {
        &self.requirements
    }

    /// Returns the quantiles of a sample, one a variation.
    ///
    /// # Errors
    /// [`Error::Range`] if there is no such sample.
    pub fn quantiles(&self, index: usize) -> Result<Vec<f64>, Error> {
        let none = Error::Range {
            what: "number of the sample",
            value: index as f64,
            allowed: "below the number of samples",
        };
        if index < self.len() { Ok(self.points.row(index).to_vec()) } else { Err(none) }
    }

    /// Returns the factors of a sample.
    ///
    /// # Errors
    /// [`Error::Range`] if there is no such sample.
    pub fn factors(&self, index: usize) -> Result<Vec<f64>, Error> {
        let point = self.quantiles(index)?;
        Ok(self
            .variations
            .iter()
            .zip(&point)
            .map(|(variation, u)| variation.distribution.quantile(*u))
            .collect())
    }

    /// Returns the mechanism with each variation's factor.
    ///
    /// # Errors
    /// Factors that make no mechanism.
    pub fn parameters(&self, factors: &[f64]) -> Result<Parameters, Error> {
        let mut parameters = self.nominal.clone();
        for (variation, &factor) in self.variations.iter().zip(factors) {
            variation.parameter.scale(&mut parameters, factor)?;
        }
        Ok(parameters)
    }

    /// Returns the controller with each variation's factor that belongs to it: those of its friction observers.
    ///
    /// # Errors
    /// Factors that make no controller.
    pub fn controller(&self, factors: &[f64]) -> Result<Controller, Error> {
        let mut controller = self.controller.clone();
        for (variation, &factor) in self.variations.iter().zip(factors) {
            if variation.parameter.is_of_controller() {
                controller = variation.parameter.scaled_controller(&controller, factor)?;
            }
        }
        Ok(controller)
    }

    /// Runs one sample: the same bytes whoever runs it, and in whatever order. Its sensor noise has its own seed.
    ///
    /// # Errors
    /// As [`figures_of`].
    pub fn run(&self, index: usize) -> Result<Sample, Error> {
        self.run_with(index, self.factors(index)?)
    }

    /// Runs one sample with other factors in the place of its own, and its own sensor noise.
    ///
    /// # Errors
    /// As [`figures_of`].
    pub fn run_with(&self, index: usize, factors: Vec<f64>) -> Result<Sample, Error> {
        let figures: Vec<PerformanceFigure> =
            self.requirements.iter().map(|requirement| requirement.figure).collect();
        let values = self.values_at(&factors, index, &figures)?;
        Ok(Sample { index, factors, values })
    }

    /// Returns some figures of the mechanism with the given factors, with the sensor noise of a sample; NaN if there is no such number.
    ///
    /// # Errors
    /// As [`figures_of`].
    pub fn values_at(
        &self,
        factors: &[f64],
        index: usize,
        figures: &[PerformanceFigure],
    ) -> Result<Vec<f64>, Error> {
        let plant = Plant::from_lumped(&self.parameters(factors)?)?;
        let controller = self.controller(factors)?;
        let seed = self.procedure.seed.wrapping_add(index as u64);
        let procedure = Procedure { seed, ..self.procedure.clone() };
        let values = figures_of(&plant, &controller, &procedure, figures)?;
        Ok(values
            .iter()
            .map(|value| if let Value::Is(number) = value { *number } else { f64::NAN })
            .collect())
    }

    /// Returns the numbers of the samples of one shard of `shards`: neighbouring, all together every sample once.
    ///
    /// # Errors
    /// [`Error::Range`] if there is no such shard.
    pub fn shard(&self, shard: usize, shards: usize) -> Result<Range<usize>, Error> {
        if shards == 0 || shard >= shards {
            return Err(Error::Range {
                what: "number of the shard",
                value: shard as f64,
                allowed: "below the number of shards",
            });
        }
        let edge = |k: usize| (k as u128 * self.len() as u128 / shards as u128) as usize;
        Ok(edge(shard)..edge(shard + 1))
    }

    /// Returns whether a sample meets every requirement that could be judged.
    pub fn passes(&self, sample: &Sample) -> bool {
        let judged = self.requirements.iter().zip(&sample.values);
        judged
            .into_iter()
            .all(|(requirement, value)| value.is_nan() || requirement.limit.distance_to_limit(*value) >= 0.0)
    }
}

/// Puts the samples of shards together, by number.
///
/// # Errors
/// [`Error::Length`] if samples are missing or there are too many, [`Error::Range`] if one comes twice.
pub fn merge_shards(campaign: &Campaign, shards: Vec<Vec<Sample>>) -> Result<Vec<Sample>, Error> {
    let mut all: Vec<Sample> = shards.into_iter().flatten().collect();
    all.sort_by_key(|sample| sample.index);
    if let Some(pair) = all.windows(2).find(|pair| pair[0].index == pair[1].index) {
        let value = pair[0].index as f64;
        return Err(Error::Range { what: "number of a sample", value, allowed: "there once" });
    }
    if all.len() != campaign.len() {
        return Err(Error::Length { what: "merged samples", found: all.len(), needed: campaign.len() });
    }
    Ok(all)
}
