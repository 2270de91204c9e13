//! The design that follows a dragged weight: a preview of the pipeline, with the time that it took.

use counterpoise_host::clock::Moment;
use std::time::Duration;

use counterpoise_pipeline::preview::{
    DesignPreview, PlantPreview, PreviewCache, PreviewRequest, preview_design, preview_plant,
};
use counterpoise_pool::Pool;

use super::error_lines::{ErrorLines, error_lines};

/// A plant with its design, and the time that both took.
#[derive(Debug, Clone)]
pub struct TimedPreview {
    /// The plant.
    pub plant: PlantPreview,
    /// The design, or why there is none; `None` if the project asks for no controller.
    pub design: Option<Result<Box<DesignPreview>, ErrorLines>>,
    /// Time from the request to the answer.
    pub took: Duration,
}

/// Makes a plant and its design, and measures the time.
///
/// # Errors
/// Returns why the plant cannot be modelled.
pub fn preview_timed(
    request: &PreviewRequest,
    cache: &mut PreviewCache,
    pool: &dyn Pool,
) -> Result<TimedPreview, ErrorLines> {
    let started = Moment::now();
    let plant = preview_plant(request, cache).map_err(|error| error_lines(&error))?;
    let has_controller = request.project.synth.is_some();
    let design = has_controller
        .then(|| preview_design(request, cache, pool).map(Box::new).map_err(|error| error_lines(&error)));
    Ok(TimedPreview { plant, design, took: started.elapsed() })
}
