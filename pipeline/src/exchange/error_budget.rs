//! The error budget of the line of sight as plain data.

use counterpoise_verify::sight_spectrum::SightSpectrum;
use counterpoise_verify::{Contribution, ErrorBudget, LinearContribution};
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
    /// Root of the sum of the squares of what the linear loop makes of each source, rad.
    pub linear_rad: SightValues,
    /// Edges of the bands of frequency of all spectra, Hz: one more than bands.
    pub edges_hz: Vec<f64>,
    /// Mean square in each band with all sources, rad^2. Over the width of its band it is the power spectral density, and its sum up to a
    /// frequency is the square of the cumulative RMS.
    pub total_rad2: SightBands,
    /// Mean square in each band with none of them, rad^2.
    pub none_rad2: SightBands,
    /// The sources.
    pub contributions: Vec<ContributionResult>,
}

/// Mean squares in bands of frequency, rad^2.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SightBands {
    /// Hub.
    pub hub: Vec<f64>,
    /// Tip.
    pub tip: Vec<f64>,
    /// Tip against hub.
    pub tip_against_hub: Vec<f64>,
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
    /// The share in each band, rad^2.
    pub share_bands_rad2: SightBands,
    /// What the linear loop makes of the source; absent if it has no place in a linear loop.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub linear: Option<LinearContributionResult>,
}

/// What the linear loop makes of a source.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LinearContributionResult {
    /// RMS, rad.
    pub rms_rad: SightValues,
    /// Mean square in each band, rad^2.
    pub bands_rad2: SightBands,
}

impl From<[f64; 5]> for SightValues {
    fn from([hub, hub_jitter, tip, tip_jitter, tip_against_hub]: [f64; 5]) -> Self {
        Self { hub, hub_jitter, tip, tip_jitter, tip_against_hub }
    }
}

impl From<&SightSpectrum> for SightBands {
    fn from(spectrum: &SightSpectrum) -> Self {
        Self {
            hub: spectrum.hub_rad2.clone(),
            tip: spectrum.tip_rad2.clone(),
            tip_against_hub: spectrum.bending_rad2.clone(),
        }
    }
}

impl From<&LinearContribution> for LinearContributionResult {
    fn from(linear: &LinearContribution) -> Self {
        Self { rms_rad: linear.rad.into(), bands_rad2: (&linear.spectrum).into() }
    }
}

impl From<&Contribution> for ContributionResult {
    fn from(one: &Contribution) -> Self {
        Self {
            source: one.source.name(),
            share_rad2: one.share_rad2.into(),
            alone_rad: one.alone_rad.into(),
            share_bands_rad2: (&one.share).into(),
            linear: one.linear.as_ref().map(Into::into),
        }
    }
}

impl From<&ErrorBudget> for ErrorBudgetResult {
    fn from(budget: &ErrorBudget) -> Self {
        Self {
            total_rad: budget.total_rad.into(),
            none_rad: budget.none_rad.into(),
            sum_rad: budget.sum_rad().into(),
            superposed_rad: budget.superposed_rad().into(),
            linear_rad: budget.linear_rad().into(),
            edges_hz: budget.edges_hz.clone(),
            total_rad2: (&budget.total).into(),
            none_rad2: (&budget.none).into(),
            contributions: budget.contributions.iter().map(Into::into).collect(),
        }
    }
}
