//! The pictures of a plant on Plant and Reduce, with the plant that it belongs to.

use std::sync::Arc;

use counterpoise_models::parameters::Beam;
use counterpoise_pipeline::preview::PlantPreview;
use counterpoise_pipeline::reduction_views::{
    PinnedModes, ReductionComparison, compare_reduction, pinned_modes,
};
use counterpoise_pipeline::{PlantModel, ReducedPlant};

/// The full plant of a design beside its reduction.
#[derive(Debug, Clone)]
pub struct ReductionPicture {
    modelled: Arc<PlantModel>,
    reduced: Arc<ReducedPlant>,
    /// The comparison.
    pub comparison: ReductionComparison,
}

impl ReductionPicture {
    /// Compares a plant with its reduction.
    pub fn new(plant: &PlantPreview) -> Self {
        let comparison = compare_reduction(&plant.modelled, &plant.reduced);
        Self { modelled: Arc::clone(&plant.modelled), reduced: Arc::clone(&plant.reduced), comparison }
    }

    /// Returns whether the picture belongs to this plant.
    pub fn belongs_to(&self, plant: &PlantPreview) -> bool {
        Arc::ptr_eq(&self.modelled, &plant.modelled) && Arc::ptr_eq(&self.reduced, &plant.reduced)
    }
}

/// A beam with its modes.
#[derive(Debug, Clone)]
pub struct BeamModes {
    /// The beam.
    pub beam: Beam,
    /// Modes; `None` if they cannot be computed.
    pub modes: Option<PinnedModes>,
}

impl BeamModes {
    /// Computes the modes of a beam.
    pub fn new(beam: Beam) -> Self {
        let modes = pinned_modes(&beam);
        Self { beam, modes }
    }
}
