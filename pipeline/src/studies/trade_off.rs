//! The trade-off between error and effort: the feedback as its error weight is raised and lowered.

use counterpoise_synth::{DesignPlant, Figures, Requirements, Sampling, Specification, sampled_loop_figures};
use counterpoise_synth::{attempt, design, discretise};

use crate::synth::{design_plant, sampling};
use crate::{PipelineError, PlantModel, ReducedPlant};
use counterpoise_project::Project;

/// Error against effort at one factor on the error weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EffortPoint {
    /// Factor on the error weight of the project; 1 is the design itself.
    pub factor: f64,
    /// Figures of the sampled feedback loop.
    pub figures: Figures,
}

/// Returns the usual factors on the error weight: half octaves from 1/8 to 8.
pub fn usual_error_weight_factors() -> Vec<f64> {
    (-6..=6).map(|k| 2f64.powf(0.5 * f64::from(k))).collect()
}

/// Returns the feedback for each factor on its error weight: |S| over the band of the project's search (its usual one where the
/// project asks for none) against the control that noise costs. A factor without a stable sampled loop is left out; `None` if
/// `go_on` returned `false` before the end.
///
/// # Errors
/// A project without weights, and those of the plant.
pub fn trade_off_points(
    project: &Project,
    modelled: &PlantModel,
    reduced: &ReducedPlant,
    factors: &[f64],
    go_on: &dyn Fn() -> bool,
) -> Result<Option<Vec<EffortPoint>>, PipelineError> {
    let missing = PipelineError::Missing { section: "synth", needed_by: "the trade-off" };
    let asked = project.synth.as_ref().ok_or(missing)?;
    let band_rad_s = asked
        .options
        .search
        .as_ref()
        .map_or(Requirements::thesis().band_rad_s, |search| search.requirements.band_rad_s);
    let (plant, sampling) = (design_plant(asked, modelled, reduced)?, sampling(asked, modelled)?);
    let alone = Specification { heave: None, pitch: None, ..asked.specification.clone() };
    let mut points = Vec::new();
    for &factor in factors {
        if !go_on() {
            return Ok(None);
        }
        let mut wanted = alone.clone();
        wanted.feedback.error = alone.feedback.error.scale_by(factor);
        let found = loop_figures(&plant, &wanted, &sampling, band_rad_s)?;
        points.extend(found.map(|figures| EffortPoint { factor, figures }));
    }
    Ok(Some(points))
}

fn loop_figures(
    plant: &DesignPlant,
    wanted: &Specification,
    sampling: &Sampling,
    band_rad_s: [f64; 2],
) -> Result<Option<Figures>, PipelineError> {
    let Ok(designed) = attempt(design(plant, wanted))? else { return Ok(None) };
    let Ok(sampled) = attempt(discretise(&designed, sampling))? else { return Ok(None) };
    Ok(Some(sampled_loop_figures(plant, &sampled, sampling, band_rad_s)?))
}
