//! Longer measurements of a verified design: the analyser's map, and the requirements over many mechanisms.

use std::sync::{Arc, Mutex};

use counterpoise_host::progress::{CancellablePool, SharedProgress};
use counterpoise_host::worker::{BackgroundWorker, CancelToken, WakeWindow};
use counterpoise_pipeline as pipeline;
use counterpoise_pipeline::studies::fra::{Analyser, LoopController, ResponseMap};
use counterpoise_pipeline::studies::fra_plan::quick_plan;
use counterpoise_pipeline::studies::sweep::{RequirementSpread, requirement_spreads};
use counterpoise_pool::map;
use counterpoise_report::wording::recordings::describe_map;
use counterpoise_verify::VerifiedController;
use counterpoise_verify::robustness::{Campaign, Sample};

use super::error_lines::{ErrorLines, error_lines};
use super::verification::VerificationRequest;
use crate::versioned_results::VersionedResult;

/// The last measurements.
#[derive(Debug, Clone, Default)]
pub struct Measurements {
    /// The analyser's map, or why there is none.
    pub map: Option<VersionedResult<Result<Box<ResponseMap>, ErrorLines>>>,
    /// The campaign, or why there is none.
    pub campaign: Option<VersionedResult<Result<CampaignView, ErrorLines>>>,
}

/// Kind and input of a measurement.
#[derive(Debug, Clone)]
pub enum MeasurementRequest {
    /// The analyser's map from platform rate to hub rate.
    Map(VerificationRequest),
    /// The robustness campaign of the project.
    Campaign(VerificationRequest, Arc<VerifiedController>),
}

/// Result of a measurement.
#[derive(Debug, Clone)]
pub enum MeasurementResult {
    /// The map.
    Map(Result<Box<ResponseMap>, ErrorLines>),
    /// The campaign.
    Campaign(Result<CampaignView, ErrorLines>),
}

/// The requirements over many mechanisms.
#[derive(Debug, Clone)]
pub struct CampaignView {
    /// One row for each requirement.
    pub rows: Vec<RequirementSpread>,
    /// Number of mechanisms that were simulated.
    pub done: usize,
    /// Number of mechanisms of the whole campaign.
    pub total: usize,
}

/// Results of a running campaign so far.
pub type PartialCampaign = Arc<Mutex<Option<CampaignView>>>;

/// Measures.
pub type MeasurementWorker = BackgroundWorker<MeasurementRequest, MeasurementResult>;

/// Mechanisms between two partial results of a campaign.
const PARTIAL_INTERVAL: usize = 10;

/// Returns a worker that measures, says its progress, and leaves what a campaign has found so far in `partial`.
pub fn measurement_worker(
    wake: &WakeWindow,
    progress: &SharedProgress,
    partial: &PartialCampaign,
) -> MeasurementWorker {
    let (progress, own_wake, partial) = (progress.clone(), Arc::clone(wake), Arc::clone(partial));
    BackgroundWorker::new(Arc::clone(wake), move |request: MeasurementRequest, token: &CancelToken| {
        let watch = CancellablePool { token, progress: &progress, wake: &own_wake };
        watch.progress.begin();
        match &request {
            MeasurementRequest::Map(of) => MeasurementResult::Map(
                measure_map(of, &watch).map(Box::new).map_err(|error| error_lines(&error)),
            ),
            MeasurementRequest::Campaign(of, verified) => {
                MeasurementResult::Campaign(run_campaign(of, verified, &partial, &watch))
            }
        }
    })
}

fn measure_map(
    of: &VerificationRequest,
    watch: &CancellablePool,
) -> Result<ResponseMap, pipeline::PipelineError> {
    let plan = quick_plan();
    let analyser = Analyser::new(&of.design.project, &of.design.modelled, &plan, LoopController::Simulation)?;
    let map = analyser.compare(&analyser.measure(&plan, watch)?, watch)?;
    Ok(describe_map(map))
}

fn run_campaign(
    of: &VerificationRequest,
    verified: &VerifiedController,
    partial: &PartialCampaign,
    watch: &CancellablePool,
) -> Result<CampaignView, ErrorLines> {
    let design = &of.design;
    let campaign = pipeline::prepare_campaign(&design.project, &design.modelled, verified, &of.folder)
        .map_err(|error| error_lines(&error))?;
    let mut samples: Vec<Sample> = Vec::new();
    while samples.len() < campaign.len() {
        let (from, count) = (samples.len(), PARTIAL_INTERVAL.min(campaign.len() - samples.len()));
        let made = map(watch, count, |k| campaign.run(from + k));
        if made.len() < count {
            break;
        }
        samples.extend(made.into_iter().collect::<Result<Vec<_>, _>>().map_err(|e| vec![e.to_string()])?);
        if let Ok(mut slot) = partial.lock() {
            *slot = Some(campaign_result(&campaign, &samples));
        }
        watch.progress.say(format!("mechanism {} of {}", samples.len(), campaign.len()));
        (watch.wake)();
    }
    Ok(campaign_result(&campaign, &samples))
}

fn campaign_result(campaign: &Campaign, samples: &[Sample]) -> CampaignView {
    let rows = requirement_spreads(campaign, samples);
    CampaignView { rows, done: samples.len(), total: campaign.len() }
}
