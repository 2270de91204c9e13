//! The designs that are drawn over the current one, computed when they are needed.

use std::sync::Arc;

use counterpoise_host::worker::{BackgroundWorker, CancelToken, WakeWindow};
use counterpoise_pipeline::preview::{DesignPreview, PreviewCache, PreviewRequest, preview_design};
use counterpoise_pool::Serial;
use counterpoise_project::{Attachments, Document, Project};

use crate::design_overlays::OverlayName;

/// The designs to compute.
#[derive(Debug, Clone)]
pub struct KeptRequest {
    /// The project's document; kept texts are read with the files that it names.
    pub document: Document,
    /// The files that the project names.
    pub attachments: Attachments,
    /// The texts of the projects.
    pub texts: Vec<KeptText>,
}

/// The text of a project whose design is drawn.
#[derive(Debug, Clone)]
pub struct KeptText {
    /// The name of the design.
    pub name: OverlayName,
    /// The text.
    pub text: String,
}

/// A design that was computed again.
#[derive(Debug, Clone)]
pub struct RestoredDesign {
    /// The name of the design.
    pub name: OverlayName,
    /// The design, or why it cannot be computed.
    pub design: Result<Arc<DesignPreview>, String>,
}

/// Computes designs.
pub type KeptDesignWorker = BackgroundWorker<KeptRequest, Vec<RestoredDesign>>;

/// Returns a worker that computes designs.
pub fn kept_design_worker(wake: &WakeWindow) -> KeptDesignWorker {
    BackgroundWorker::new(Arc::clone(wake), |request: KeptRequest, token: &CancelToken| {
        restore_kept_designs(&request, token)
    })
}

fn restore_kept_designs(request: &KeptRequest, token: &CancelToken) -> Vec<RestoredDesign> {
    let mut cache = PreviewCache::default();
    let mut restore = |KeptText { name, text }: &KeptText| {
        if token.is_cancelled() {
            return None;
        }
        let document = request.document.with_text(text);
        let design = match Project::resolve(&document, &request.attachments) {
            Ok(parsed) => {
                let project = Arc::new(parsed.project);
                let preview = PreviewRequest { project, out_of_balance_kg_m: None };
                preview_design(&preview, &mut cache, &Serial).map(Arc::new).map_err(|error| error.to_string())
            }
            Err(errors) => Err(errors.first().map_or_else(String::new, ToString::to_string)),
        };
        Some(RestoredDesign { name: name.clone(), design })
    };
    request.texts.iter().filter_map(&mut restore).collect()
}
