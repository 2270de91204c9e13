//! The line of sight as plain data: how it is judged, and what its error is made of.

use counterpoise_controller::Controller;
use counterpoise_models::plant::Plant;
use counterpoise_verify::line_of_sight::sight_experiment;
use counterpoise_verify::sight_spectrum::SightSpectrum;
use counterpoise_verify::{
    BudgetRun, Contribution, ErrorBudget, ErrorSource, LinearContribution, Model, Procedure, Verification,
    budget_angles,
};
use serde::Serialize;

use super::verification_data::history_name;
use crate::PipelineError;
use crate::studies::advice::KeptDesigns;

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

/// Procedure by which the line of sight is assessed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SightProcedureResult {
    /// Name of the time history on which it is judged.
    pub experiment: String,
    /// Time at the beginning that is left out, s.
    pub settle_s: f64,
    /// Length of one exposure, s.
    pub exposure_s: f64,
    /// The window within which shots are released; absent if none are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coincidence: Option<CoincidenceResult>,
    /// The optics whose image moves; absent without a camera.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub optics: Option<OpticsResult>,
}

/// The window within which shots are released, and the target.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CoincidenceResult {
    /// Largest error of the hub at which a shot is released, rad.
    pub window_rad: f64,
    /// Time from the release to the instant at which the projectile leaves the tip, s.
    pub delay_s: f64,
    /// Largest error of the tip that hits, rad.
    pub target_rad: f64,
    /// RMS dispersion of the rounds about the tip's direction, rad.
    pub dispersion_rad: f64,
}

/// The optics of a sight.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OpticsResult {
    /// Focal length, m.
    pub focal_length_m: f64,
    /// Spatial frequency in the image, 1/m.
    pub spatial_frequency_m: f64,
}

impl SightProcedureResult {
    /// Returns how a procedure judges the line of sight; `None` if it does not.
    pub fn of(procedure: &Procedure) -> Option<Self> {
        let sight = procedure.line_of_sight?;
        Some(Self {
            experiment: history_name(Model::Nonlinear, sight_experiment(procedure)),
            settle_s: procedure.sight_settle_s(),
            exposure_s: sight.exposure_s,
            coincidence: sight.coincidence.map(|asked| CoincidenceResult {
                window_rad: asked.window_rad,
                delay_s: asked.delay_s,
                target_rad: asked.target_rad,
                dispersion_rad: asked.dispersion_rad,
            }),
            optics: sight.optics.map(|optics| OpticsResult {
                focal_length_m: optics.focal_length_m,
                spatial_frequency_m: optics.spatial_frequency_m,
            }),
        })
    }
}

/// Error budget of the line of sight: the contribution of every source.
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
    /// The runs from which all of this is computed: none of the sources, one after the other in the order of `contributions`, the same in the
    /// opposite order, and each alone.
    pub runs: Vec<BudgetRunResult>,
}

/// A run with some of the sources.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BudgetRunResult {
    /// The sources that are switched on.
    pub on: Vec<&'static str>,
    /// RMS, rad.
    pub rms_rad: SightValues,
    /// Sample time, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sample_time_s: Option<f64>,
    /// The error of the line of sight at the hub about its mean, from the settling time on, rad; absent unless time histories were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hub_rad: Vec<f64>,
    /// The same at the tip.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tip_rad: Vec<f64>,
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

/// Contribution of one source to the error.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ContributionResult {
    /// The source.
    pub source: &'static str,
    /// Share of the mean square, rad^2; negative if it reduces the error of the others.
    pub share_rad2: SightValues,
    /// RMS with this source alone, rad.
    pub alone_rad: SightValues,
    /// The share in each band, rad^2.
    pub share_bands_rad2: SightBands,
    /// Contribution of the source in the linear loop; absent if it has no place there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub linear: Option<LinearContributionResult>,
}

/// Contribution of a source in the linear loop.
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
            runs: budget.runs.iter().map(Into::into).collect(),
        }
    }
}

impl From<&BudgetRun> for BudgetRunResult {
    fn from(run: &BudgetRun) -> Self {
        Self {
            on: run.on.iter().map(|source| source.name()).collect(),
            rms_rad: run.error_rad.into(),
            sample_time_s: None,
            hub_rad: Vec::new(),
            tip_rad: Vec::new(),
        }
    }
}

/// Returns the error budget of a verification as plain data, with the angles of its runs if time histories are kept; `None` if there is none.
///
/// # Errors
/// Those of the simulator.
pub fn error_budget_result(
    found: &Verification,
    plant: &Plant,
    controller: &Controller,
    kept: KeptDesigns,
) -> Result<Option<ErrorBudgetResult>, PipelineError> {
    let Some(budget) = found.error_budget.as_ref().map(ErrorBudgetResult::from) else { return Ok(None) };
    Ok(Some(match kept {
        KeptDesigns::Histories => budget.with_angles(plant, controller, &found.evidence.procedure)?,
        KeptDesigns::Systems => budget,
    }))
}

impl ErrorBudgetResult {
    /// Adds the angles of every run, which are simulated once more: a budget of a long procedure would not hold them in memory.
    fn with_angles(
        mut self,
        plant: &Plant,
        controller: &Controller,
        procedure: &Procedure,
    ) -> Result<Self, PipelineError> {
        for run in &mut self.runs {
            let is_on = |source: &ErrorSource| run.on.contains(&source.name());
            let on: Vec<ErrorSource> = ErrorSource::ALL.into_iter().filter(is_on).collect();
            let Some(angles) = budget_angles(plant, controller, procedure, &on)? else { continue };
            (run.sample_time_s, run.hub_rad, run.tip_rad) =
                (Some(angles.period_s), angles.hub_rad, angles.tip_rad);
        }
        Ok(self)
    }
}
