//! Runs of a design that is drawn over the current one, on the full plant.

use std::sync::Arc;

use counterpoise_host::worker::{BackgroundWorker, CancelToken, WakeWindow};
use counterpoise_pipeline as pipeline;
use counterpoise_pipeline::preview::DesignPreview;
use counterpoise_verify::Verification;

use super::verification::VerificationRequest;
use crate::design_overlays::OverlayName;

/// A design to run.
#[derive(Debug, Clone)]
pub struct OverlayRunRequest {
    /// The name of the design.
    pub name: OverlayName,
    /// The design, with the folder of its project.
    pub request: VerificationRequest,
}

/// The runs of a design.
#[derive(Debug, Clone)]
pub struct OverlayRunResult {
    /// The name of the design.
    pub name: OverlayName,
    /// The design.
    pub design: Arc<DesignPreview>,
    /// Its verification; `None` if it could not be verified.
    pub found: Option<Arc<Verification>>,
}

/// Runs designs.
pub type OverlayRunWorker = BackgroundWorker<OverlayRunRequest, OverlayRunResult>;

/// Returns a worker that verifies designs to draw their runs.
pub fn overlay_run_worker(wake: &WakeWindow) -> OverlayRunWorker {
    BackgroundWorker::new(Arc::clone(wake), |job: OverlayRunRequest, token: &CancelToken| {
        let OverlayRunRequest { name, request: VerificationRequest { design, folder } } = job;
        let mut observer = |_: &Verification| !token.is_cancelled();
        let found = pipeline::verify_watched(
            &design.project,
            &design.modelled,
            &design.synthesised,
            &folder,
            &mut observer,
        );
        let found = found.ok().flatten().map(|verified| Arc::new(verified.into_parts().1));
        OverlayRunResult { name, design, found }
    })
}
