//! The error budget of the line of sight as plain data.

use counterpoise_verify::{Contribution, ErrorBudget};
use serde::Serialize;

/// Values of the line of sight: at the hub and at the tip, over the whole run and within an exposure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SightValues {
    /// Hub, about its mean over the run.
    pub hub: f64,
    /// Hub, about its mean in each exposure.
    pub hub_jitter: f64,
    /// Tip, about its mean over the run.
    pub tip: f64,
    /// Tip, about its mean in each exposure.
    pub tip_jitter: f64,
    /// Tip against hub, about its mean.
    pub tip_against_hub: f64,
}

/// What the error of the line of sight is made of.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ErrorBudgetResult {
    /// RMS with all sources, rad.
    pub total_rad: SightValues,
    /// RMS with none of them: what the start of the run leaves, rad.
    pub none_rad: SightValues,
    /// Root of the sum of all shares, rad.
    pub sum_rad: SightValues,
    /// Root of the sum of the squares of what each source makes alone, rad: the RMS if superposition held.
    pub superposed_rad: SightValues,
    /// The sources.
    pub contributions: Vec<ContributionResult>,
}

/// What one source makes of the error.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ContributionResult {
    /// The source.
    pub source: &'static str,
    /// Its share of the mean square, rad^2; negative if it reduces the error of the others.
    pub share_rad2: SightValues,
    /// RMS with this source alone, rad.
    pub alone_rad: SightValues,
}

impl From<[f64; 5]> for SightValues {
    fn from([hub, hub_jitter, tip, tip_jitter, tip_against_hub]: [f64; 5]) -> Self {
        Self { hub, hub_jitter, tip, tip_jitter, tip_against_hub }
    }
}

impl From<&Contribution> for ContributionResult {
    fn from(one: &Contribution) -> Self {
        Self { source: one.source.name(), share_rad2: one.share_rad2.into(), alone_rad: one.alone_rad.into() }
    }
}

impl From<&ErrorBudget> for ErrorBudgetResult {
    fn from(budget: &ErrorBudget) -> Self {
        Self {
            total_rad: budget.total_rad.into(),
            none_rad: budget.none_rad.into(),
            sum_rad: budget.sum_rad().into(),
            superposed_rad: budget.superposed_rad().into(),
            contributions: budget.contributions.iter().map(Into::into).collect(),
        }
    }
}
