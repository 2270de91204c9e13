//! The values that the project file leaves open, ranked by how much they matter.

use std::sync::Arc;

use counterpoise_pipeline::PlantModel;
use counterpoise_pipeline::check::{RankedAssumptions, rank_assumptions};
use counterpoise_pipeline::studies::assumptions::LoopSystems;
use counterpoise_project::{Assumption, Project};

/// A project whose assumptions are ranked.
#[derive(Debug, Clone)]
pub struct RankingRequest {
    /// The project.
    pub project: Arc<Project>,
    /// Plant.
    pub modelled: Arc<PlantModel>,
    /// Values that its file leaves open.
    pub assumptions: Vec<Assumption>,
}

/// Ranks the assumptions of a project; if it has no design, they are listed without their effects.
pub fn answer_ranking(request: RankingRequest) -> RankedAssumptions {
    let RankingRequest { project, modelled, assumptions } = request;
    rank_assumptions(&project, &modelled, &assumptions, LoopSystems::LeftOut)
        .unwrap_or(RankedAssumptions { assumptions, ..RankedAssumptions::default() })
}
