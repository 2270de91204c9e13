//! Verification on the full plant, which shows what it has found while it runs, and the trade-off and the loop around the design.

use counterpoise_host::clock::Moment;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use counterpoise_host::files::ProjectFolder;
use counterpoise_host::worker::{BackgroundWorker, CancelToken, WakeWindow};
use counterpoise_pipeline::loop_view::LoopView;
use counterpoise_pipeline::preview::{DesignPreview, preview_loop};
use counterpoise_pipeline::studies::trade_off::{EffortPoint, trade_off_points, usual_error_weight_factors};
use counterpoise_pipeline::{self as pipeline, World};
use counterpoise_verify::{Verification, VerifiedController};

use super::error_lines::{ErrorLines, error_lines};
use crate::versioned_results::VersionedResult;

/// Input of a verification.
#[derive(Debug, Clone)]
pub struct VerificationRequest {
    /// The design.
    pub design: Arc<DesignPreview>,
    /// The folder with the project's files.
    pub folder: ProjectFolder,
}

/// Results of a running verification so far.
pub type PartialVerification = Arc<Mutex<Option<VersionedResult<Arc<Verification>>>>>;

/// Verifies; the answer is `None` if the job was cancelled.
pub type VerificationWorker =
    BackgroundWorker<VersionedResult<VerificationRequest>, Result<Option<VerifiedController>, ErrorLines>>;

/// Computes error against effort around a design; the answer is `None` if the job was cancelled or there is no such curve.
pub type TradeOffWorker = BackgroundWorker<Arc<DesignPreview>, Option<Vec<EffortPoint>>>;

/// Computes the loop of a design as charts of the plane show it; the answer is `None` if there is none.
pub type LoopViewWorker = BackgroundWorker<Arc<DesignPreview>, Option<LoopView>>;

/// Shortest time between two partial results: more would cost frames and show nothing new.
const PARTIAL_INTERVAL: Duration = Duration::from_millis(60);

/// Returns a worker that verifies, and leaves what it has found so far in `partial`.
pub fn verification_worker(wake: &WakeWindow, partial: &PartialVerification) -> VerificationWorker {
    let (partial, partial_wake) = (Arc::clone(partial), Arc::clone(wake));
    BackgroundWorker::new(
        Arc::clone(wake),
        move |request: VersionedResult<VerificationRequest>, token: &CancelToken| {
            let (design, mut last_partial) = (&request.value.design, None::<Moment>);
            let mut observer = |found: &Verification| {
                if last_partial.is_none_or(|at| at.elapsed() > PARTIAL_INTERVAL) {
                    if let Ok(mut slot) = partial.lock() {
                        *slot = Some(VersionedResult {
                            revision: request.revision,
                            value: Arc::new(found.clone()),
                        });
                    }
                    last_partial = Some(Moment::now());
                    partial_wake();
                }
                !token.is_cancelled()
            };
            let folder: &dyn World = &request.value.folder;
            let found = pipeline::verify_watched(
                &design.project,
                &design.modelled,
                &design.synthesised,
                folder,
                &mut observer,
            );
            found.map_err(|error| error_lines(&error))
        },
    )
}

/// Returns a worker that computes error against effort.
pub fn trade_off_worker(wake: &WakeWindow) -> TradeOffWorker {
    BackgroundWorker::new(Arc::clone(wake), |design: Arc<DesignPreview>, token: &CancelToken| {
        let go_on = || !token.is_cancelled();
        let factors = usual_error_weight_factors();
        trade_off_points(&design.project, &design.modelled, &design.reduced, &factors, &go_on).ok()?
    })
}

/// Returns a worker that computes path and root locus of the loop.
pub fn loop_view_worker(wake: &WakeWindow) -> LoopViewWorker {
    BackgroundWorker::new(Arc::clone(wake), |design: Arc<DesignPreview>, _: &CancelToken| {
        preview_loop(&design).ok()
    })
}
