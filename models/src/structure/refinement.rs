//! The dependence of a beam's frequencies on the number and kind of its elements: the columns of the thesis' table 6-1.

use super::element::{Integration, Theory};
use super::fe::{AttachedMasses, FeModel, FeOptions};
use super::mesh::ElementMesh;
use super::modes::{Support, undamped_modes};
use crate::Error;
use crate::parameters::Beam;

/// Elements of the model that the others are compared with, as in the thesis.
pub const REFERENCE: usize = 129;

/// A kind of elements, and how many of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RefinementMesh {
    /// Kind of the elements.
    pub integration: Integration,
    /// Number of elements.
    pub elements: usize,
}

/// Uniform elements of the mean diameter, tapered elements by quadrature, and how many of each: the columns of table 6-1.
pub const COLUMNS: [RefinementMesh; 7] = [
    RefinementMesh { integration: Integration::UniformAverage, elements: 14 },
    RefinementMesh { integration: Integration::UniformAverage, elements: 3 },
    RefinementMesh { integration: Integration::UniformAverage, elements: 2 },
    RefinementMesh { integration: Integration::UniformAverage, elements: 1 },
    RefinementMesh { integration: Integration::Quadrature, elements: 3 },
    RefinementMesh { integration: Integration::Quadrature, elements: 2 },
    RefinementMesh { integration: Integration::Quadrature, elements: 1 },
];

/// The free-free flexible frequencies of one mesh over those of the reference model, mode by mode.
#[derive(Debug, Clone, PartialEq)]
pub struct Refinement {
    /// Kind of the elements.
    pub integration: Integration,
    /// Number of elements; nodes lie at the ends of the sections if there are as many elements as sections.
    pub elements: usize,
    /// Ratio for flexible mode 1, 2, ...: as many as the elements have.
    pub ratios: Vec<f64>,
}

/// The frequencies of a beam with several meshes.
#[derive(Debug, Clone, PartialEq)]
pub struct Refinements {
    /// Free-free flexible frequencies of the reference model, rad/s.
    pub reference_rad_s: Vec<f64>,
    /// One column for each mesh.
    pub columns: Vec<Refinement>,
}

/// Returns the free-free flexible frequencies of the bare beam with several meshes, over those of its reference model.
///
/// # Errors
/// As for [`FeModel::beam`] and [`undamped_modes`].
pub fn compare_refinements(beam: &Beam, columns: &[RefinementMesh]) -> Result<Refinements, Error> {
    let reference = frequencies(beam, Integration::Quadrature, REFERENCE)?;
    let column = |&RefinementMesh { integration, elements }: &RefinementMesh| {
        let found = frequencies(beam, integration, elements)?;
        let ratios = found.iter().zip(&reference).map(|(w, r)| w / r).collect();
        Ok(Refinement { integration, elements, ratios })
    };
    let columns = columns.iter().map(column).collect::<Result<_, Error>>()?;
    Ok(Refinements { reference_rad_s: reference, columns })
}

fn frequencies(beam: &Beam, integration: Integration, elements: usize) -> Result<Vec<f64>, Error> {
    let options =
        FeOptions { mesh: ElementMesh::Sections(elements), theory: Theory::BernoulliEuler, integration };
    let model = FeModel::beam(beam, &AttachedMasses::default(), &options)?;
    Ok(undamped_modes(&model, Support::Free)?.flexible_rad_s().to_vec())
}
