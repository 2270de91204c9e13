//! Everything that is stated about a modelled plant: its figures, how much each assumption matters, its pictures, and the simulator's error on it.

use counterpoise_models::structure::Truncation;
use counterpoise_pool::Pool;
use counterpoise_project::{Assumption, Project};

use crate::check::rank_assumptions;
use crate::exchange::StructureResult;
use crate::plant_views::{PlantViews, view_plant};
use crate::results::ModelResult;
use crate::studies::accuracy::simulation_accuracy;
use crate::studies::assumptions::LoopSystems;
use crate::{PipelineError, cannot_hold, model_watched};

/// Whether a study of a plant measures the simulator's error on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SimulatorError {
    /// It is measured.
    Measured,
    /// It is not.
    LeftOut,
}

/// What a study of a plant contains beside its figures.
#[derive(Debug, Clone, Copy)]
pub struct ModelContents<'a> {
    /// The assumptions of the project file.
    pub assumptions: &'a [Assumption],
    /// Systems of the loop from which their effects can be recomputed.
    pub systems: LoopSystems,
    /// The simulator's error.
    pub simulator_error: SimulatorError,
}

/// A plant with everything that is stated about it.
#[derive(Debug)]
pub struct ModelStudy {
    /// Its figures, with the assumptions, the largest effect first.
    pub result: ModelResult,
    /// Its pictures.
    pub views: PlantViews,
    /// Why nothing holds the mechanism; `None` if something does.
    pub unheld: Option<PipelineError>,
    /// Why the assumptions are not ranked; `None` if they are.
    pub unranked: Option<PipelineError>,
    /// What a condensation of the structure left out; `None` if it left nothing out.
    pub truncation: Option<Truncation>,
}

/// Returns a project's plant with everything that is stated about it. The pool shows how far large structures are, and can end them.
///
/// # Errors
/// There is no plant, it was ended, or it cannot be simulated.
pub fn study_model(
    project: &Project,
    contents: ModelContents<'_>,
    pool: &dyn Pool,
) -> Result<ModelStudy, PipelineError> {
    let modelled = model_watched(project, pool)?;
    let mut result = ModelResult::from(&modelled);
    let ranked = rank_assumptions(project, &modelled, contents.assumptions, contents.systems);
    let unranked = match ranked {
        Ok(ranked) => {
            (result.assumptions, result.assumption_effects) = (ranked.assumptions, ranked.effects);
            result.assumed_loop = ranked.assumed_loop;
            None
        }
        Err(why) => {
            result.assumptions = contents.assumptions.to_vec();
            Some(why)
        }
    };
    let views = view_plant(project, &modelled)?;
    result.structure = StructureResult::of(&views, project.plant.beam.as_ref());
    result.frictions.clone_from(&views.frictions);
    if contents.simulator_error == SimulatorError::Measured {
        result.accuracy = simulation_accuracy(&modelled, pool)?;
    }
    let truncation = modelled.elements.as_ref().and_then(|elements| elements.truncation);
    Ok(ModelStudy { result, views, unheld: cannot_hold(&modelled), unranked, truncation })
}
