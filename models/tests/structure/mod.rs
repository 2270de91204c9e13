//! Beams, modes and the reference rig's structure against closed forms and independent figures.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

mod damping;
mod import;
mod large;
mod power_law;
mod reduced;
mod rig;
mod table;
mod tapered;
mod timoshenko;
mod uniform;

use counterpoise_models::structure::{
    AttachedMasses, ElementMesh, FeModel, FeOptions, Integration, Support, Theory, undamped_modes,
};
use counterpoise_models::{Beam, BeamSection, PointMass, SectionShape, StructuralDamping};

/// A beam of unit modulus and density along 0 .. 1, pivot at 0.
pub(crate) fn unit_beam(shape: SectionShape) -> Beam {
    Beam {
        youngs_modulus_pa: 1.0,
        poissons_ratio: 0.3,
        density_kg_m3: 1.0,
        pivot_m: 0.0,
        modal_damping: vec![0.01],
        damping: StructuralDamping::Modal,
        sections: vec![BeamSection { name: "beam".to_owned(), from_m: 0.0, to_m: 1.0, shape }],
        masses: Vec::new(),
    }
}

/// Unit area and second moment: the frequencies are beta squared.
pub(crate) fn uniform_beam() -> Beam {
    unit_beam(SectionShape::Given { area_m2: [1.0, 1.0], second_moment_m4: [1.0, 1.0] })
}

/// A solid cone from unit radius at the root down to `tip` of it, and the factor from its w to
/// w sqrt(rho A_0 L^4 / (E I_0)).
pub(crate) fn cone(tip: f64) -> (Beam, f64) {
    let diameter = 2.0;
    let shape =
        SectionShape::Tube { outer_diameter_m: [diameter, diameter * tip], inner_diameter_m: [0.0, 0.0] };
    (unit_beam(shape), 2.0)
}

pub(crate) fn options(mesh: ElementMesh, integration: Integration) -> FeOptions {
    FeOptions { mesh, theory: Theory::BernoulliEuler, integration }
}

/// Flexible frequencies of a beam.
pub(crate) fn frequencies(
    beam: &Beam,
    fitted: &AttachedMasses,
    options: &FeOptions,
    support: Support,
) -> Vec<f64> {
    let model = FeModel::beam(beam, fitted, options).unwrap();
    undamped_modes(&model, support).unwrap().flexible_rad_s().to_vec()
}

pub(crate) fn mass(position_m: f64, mass_kg: f64, inertia_kg_m2: f64) -> PointMass {
    PointMass { name: "m".to_owned(), position_m, mass_kg, inertia_kg_m2 }
}

pub(crate) fn assert_close(figure: f64, reference: f64, tolerance: f64) {
    assert!(
        (figure - reference).abs() <= tolerance,
        "{figure} differs from {reference} by more than {tolerance}"
    );
}

/// Asserts that figures agree relatively, one by one.
pub(crate) fn assert_all(figures: &[f64], references: &[f64], relative: f64) {
    for (figure, reference) in figures.iter().zip(references) {
        assert_close(figure / reference, 1.0, relative);
    }
}
