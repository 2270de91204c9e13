//! The designs that were kept for comparison, computed again when their project is opened.

use std::sync::Arc;

use counterpoise_host::worker::CancelToken;
use counterpoise_pipeline::preview::{DesignPreview, PreviewCache, PreviewRequest, preview_design};
use counterpoise_pool::Serial;
use counterpoise_project::{Document, Project};

use crate::command::DesignSlot;

/// The designs to compute.
#[derive(Debug, Clone)]
pub struct KeptRequest {
    /// The project's document; kept texts are read with the files that it names.
    pub document: Document,
    /// The files that the project names.
    pub attachments: counterpoise_project::Attachments,
    /// The texts of the projects, by slot.
    pub texts: Vec<(DesignSlot, String)>,
}

/// A kept design that was computed again.
#[derive(Debug, Clone)]
pub struct RestoredDesign {
    /// Slot.
    pub slot: DesignSlot,
    /// The design.
    pub design: Arc<DesignPreview>,
}

/// Computes kept designs; one that cannot be computed any more is left out.
pub fn restore_kept_designs(request: KeptRequest, token: &CancelToken) -> Vec<RestoredDesign> {
    let mut cache = PreviewCache::default();
    let mut restore = |(slot, text): &(DesignSlot, String)| {
        if token.is_cancelled() {
            return None;
        }
        let document = request.document.with_text(text);
        let project = Project::resolve(&document, &request.attachments).ok()?.project;
        let preview = PreviewRequest { project: Arc::new(project), out_of_balance_kg_m: None };
        let design = preview_design(&preview, &mut cache, &Serial).ok()?;
        Some(RestoredDesign { slot: *slot, design: Arc::new(design) })
    };
    request.texts.iter().filter_map(&mut restore).collect()
}
