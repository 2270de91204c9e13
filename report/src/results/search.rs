//! The search for weights as a result file has it.

use counterpoise_pipeline::studies::search::{SearchAnswer, TradeOffPoint};
use serde::Serialize;

use crate::trade_off::VerifiedPoint;
use crate::wording::weights::describe_weights;

/// The search, for another program.
#[derive(Debug, Serialize)]
pub struct SearchText {
    /// How the search ended.
    pub settled: &'static str,
    /// Designs that were tried.
    pub trials: usize,
    /// What is missed on the design plant; 0 if the requirements hold.
    pub missed: f64,
    /// The same on the plant before its reduction.
    pub missed_on_full_plant: f64,
    /// The weights that were found, in words.
    pub weights: Vec<String>,
    /// The points of the trade-off.
    pub curve: Vec<CurvePoint>,
    /// The points as they were verified on the nonlinear plant.
    pub verified: Vec<VerifiedPoint>,
}

/// A point of the trade-off curve.
#[derive(Debug, Serialize)]
pub struct CurvePoint {
    /// Limit of the largest sensitivity.
    pub max_sensitivity_limit: f64,
    /// Largest sensitivity.
    pub max_sensitivity: f64,
    /// Modulus of the sensitivity over the band.
    pub rejection: f64,
    /// Noise gain.
    pub noise_gain: f64,
    /// What is missed; 0 if the requirements hold.
    pub missed: f64,
}

impl SearchText {
    /// Returns the result of a search, with its points as they were verified.
    pub fn new(found: &SearchAnswer, verified: Vec<VerifiedPoint>) -> Self {
        let point = |TradeOffPoint { ms_limit, found }: &TradeOffPoint| CurvePoint {
            max_sensitivity_limit: *ms_limit,
            max_sensitivity: found.best.figures.ms,
            rejection: found.best.figures.rejection,
            noise_gain: found.best.figures.noise_gain,
            missed: found.best.missed,
        };
        Self {
            settled: found.found.ended.name(),
            trials: found.found.trials,
            missed: found.found.best.missed,
            missed_on_full_plant: found.missed_on_full_plant,
            weights: describe_weights(&found.asked),
            curve: found.curve.iter().map(point).collect(),
            verified,
        }
    }
}
