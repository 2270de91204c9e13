//! How the frequencies of a beam depend on the number and kind of its elements: the columns of the thesis' table 6-1.

use super::element::{Integration, Theory};
use super::fe::{FeModel, FeOptions, Fitted};
use super::mesh::Mesh;
use super::modes::{Support, modes};
use crate::Error;
use crate::parameters::Beam;

/// Elements of the model that the others are compared with, as in the thesis.
pub const REFERENCE: usize = 129;

/// Uniform elements of the mean diameter, tapered elements by quadrature, and how many of each: the columns of table 6-1.
pub const COLUMNS: [(Integration, usize); 7] = [
    (Integration::UniformAverage, 14),
    (Integration::UniformAverage, 3),
    (Integration::UniformAverage, 2),
    (Integration::UniformAverage, 1),
    (Integration::Quadrature, 3),
    (Integration::Quadrature, 2),
    (Integration::Quadrature, 1),
];

/// The free-free flexible frequencies of one mesh over those of the reference model, mode by mode.
#[derive(Debug, Clone, PartialEq)]
pub struct Refinement {
    /// Kind of the elements.
    pub integration: Integration,
    /// Number of elements; nodes lie at the ends of the sections where there are as many elements as sections.
    pub elements: usize,
    /// Ratio for flexible mode 1, 2, ...: as many as the elements have.
    pub ratios: Vec<f64>,
}

/// Free-free flexible frequencies of the bare beam, rad/s, and its reference model's.
///
/// # Errors
/// As for [`FeModel::beam`] and [`modes`].
pub fn refinements(
    beam: &Beam,
    columns: &[(Integration, usize)],
) -> Result<(Vec<f64>, Vec<Refinement>), Error> {
    let reference = frequencies(beam, Integration::Quadrature, REFERENCE)?;
    let column = |&(integration, elements): &(Integration, usize)| {
        let found = frequencies(beam, integration, elements)?;
        let ratios = found.iter().zip(&reference).map(|(w, r)| w / r).collect();
        Ok(Refinement { integration, elements, ratios })
    };
    let all = columns.iter().map(column).collect::<Result<_, Error>>()?;
    Ok((reference, all))
}

fn frequencies(beam: &Beam, integration: Integration, elements: usize) -> Result<Vec<f64>, Error> {
    let options = FeOptions { mesh: Mesh::Sections(elements), theory: Theory::BernoulliEuler, integration };
    let model = FeModel::beam(beam, &Fitted::default(), &options)?;
    Ok(modes(&model, Support::Free)?.flexible_rad_s().to_vec())
}
