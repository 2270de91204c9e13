//! The structure as plain data: the matrices of its finite elements, the modes that they have, and what few elements make of the beam.

use counterpoise_linalg::Mat;
use counterpoise_models::Beam;
use counterpoise_models::parameters::{BeamSection, SectionShape};
use counterpoise_models::structure::FeModel;
use serde::Serialize;

use crate::plant_views::{MeshComparison, ModeSet, PlantViews};

/// The structure of a plant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StructureResult {
    /// The flexible modes, one set for each way in which the hub is held.
    pub modes: Vec<SupportedModesResult>,
    /// The finite elements whose modes these are; absent if the plant has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elements: Option<ElementsResult>,
    /// Frequencies of the bare beam with few elements; absent without a beam.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub meshes: Option<MeshComparison>,
    /// The bare beam of which those meshes are made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beam: Option<BeamResult>,
}

/// The first flexible modes of a structure held in one way.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SupportedModesResult {
    /// `free`, `pinned` or `clamped` at the hub.
    pub support: &'static str,
    /// The modes, rising.
    pub modes: Vec<ModeResult>,
}

/// A flexible mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModeResult {
    /// Natural frequency, Hz.
    pub frequency_hz: f64,
    /// Effective mass in heave, kg.
    pub effective_mass_kg: f64,
    /// Effective inertia in pitch about the pivot, kg m^2.
    pub effective_inertia_kg_m2: f64,
}

/// Finite elements: M q'' + K q = 0 in the unknowns q.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)]
pub struct ElementsResult {
    /// Mass matrix.
    pub M: SymmetricResult,
    /// Stiffness matrix.
    pub K: SymmetricResult,
    /// The unknowns under a rigid upward translation by 1 m.
    pub heave: Vec<f64>,
    /// The unknowns under a rigid rotation by 1 rad about the pivot.
    pub pitch: Vec<f64>,
    /// Numbers of the hub's deflection and rotation among the unknowns, counted from 0; empty if no node lies at the pivot.
    pub hub: Vec<usize>,
}

/// A symmetric matrix by its entries other than 0, diagonal and above.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SymmetricResult {
    /// Rows, counted from 0.
    pub rows: Vec<usize>,
    /// Columns.
    pub columns: Vec<usize>,
    /// Entries.
    pub values: Vec<f64>,
}

/// A beam without what is fitted to it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BeamResult {
    /// Young's modulus, Pa.
    pub youngs_modulus_pa: f64,
    /// Density, kg/m^3.
    pub density_kg_m3: f64,
    /// Sections from the near to the far end.
    pub sections: Vec<SectionResult>,
}

/// A section of a beam; dimensions are those at its near and at its far end, linear between them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SectionResult {
    /// Beginning, m.
    pub from_m: f64,
    /// End, m.
    pub to_m: f64,
    /// `tube`, `rectangle` or `given`.
    pub shape: &'static str,
    /// Outer and inner diameters, m, of a tube; heights and widths, m, of a rectangle; areas, m^2, and second moments, m^4, if given.
    pub dimensions: [[f64; 2]; 2],
}

impl StructureResult {
    /// Returns the structure of a plant; `None` if it has no flexible one.
    pub fn of(views: &PlantViews, beam: Option<&Beam>) -> Option<Self> {
        let meshes = views.meshes.clone();
        (meshes.is_some() || !views.modes.is_empty()).then(|| Self {
            modes: views.modes.iter().map(SupportedModesResult::of).collect(),
            elements: views.elements.as_ref().map(ElementsResult::of),
            beam: beam.filter(|_| meshes.is_some()).map(BeamResult::of),
            meshes,
        })
    }
}

impl SupportedModesResult {
    fn of(set: &ModeSet) -> Self {
        let mode = |mode: &crate::plant_views::PlantMode| ModeResult {
            frequency_hz: mode.frequency_hz,
            effective_mass_kg: mode.effective_mass_kg,
            effective_inertia_kg_m2: mode.effective_inertia_kg_m2,
        };
        Self { support: set.support, modes: set.modes.iter().map(mode).collect() }
    }
}

impl ElementsResult {
    fn of(fe: &FeModel) -> Self {
        Self {
            M: SymmetricResult::of(&fe.M),
            K: SymmetricResult::of(&fe.K),
            heave: fe.heave.clone(),
            pitch: fe.pitch.clone(),
            hub: fe.hub.iter().flat_map(|hub| [hub.deflection, hub.rotation]).collect(),
        }
    }
}

impl SymmetricResult {
    fn of(matrix: &Mat) -> Self {
        let mut out = Self { rows: Vec::new(), columns: Vec::new(), values: Vec::new() };
        for row in 0..matrix.nrows() {
            for column in (row..matrix.ncols()).filter(|&column| matrix[(row, column)] != 0.0) {
                out.rows.push(row);
                out.columns.push(column);
                out.values.push(matrix[(row, column)]);
            }
        }
        out
    }
}

impl BeamResult {
    fn of(beam: &Beam) -> Self {
        Self {
            youngs_modulus_pa: beam.youngs_modulus_pa,
            density_kg_m3: beam.density_kg_m3,
            sections: beam.sections.iter().map(SectionResult::of).collect(),
        }
    }
}

impl SectionResult {
    fn of(section: &BeamSection) -> Self {
        let (shape, dimensions) = match section.shape {
            SectionShape::Tube { outer_diameter_m, inner_diameter_m } => {
                ("tube", [outer_diameter_m, inner_diameter_m])
            }
            SectionShape::Rectangle { height_m, width_m } => ("rectangle", [height_m, width_m]),
            SectionShape::Given { area_m2, second_moment_m4 } => ("given", [area_m2, second_moment_m4]),
        };
        Self { from_m: section.from_m, to_m: section.to_m, shape, dimensions }
    }
}
