//! The corrected closed forms against a fine quadrature of the same power law.

use super::{assert_close, options, unit_beam};
use counterpoise_models::structure::element::ElementShape;
use counterpoise_models::structure::power_law::{PowerLaw, element_mass, element_stiffness};
use counterpoise_models::structure::{AttachedMasses, ElementMesh, FeModel, Integration};
use counterpoise_models::{Error, SectionShape};

/// int_0^1 (1 + excess xi^exponent) f(xi) dxi by Simpson's rule in t, xi = t^4, which removes the kink at 0.
fn weighted_integral(law: &PowerLaw, f: impl Fn(f64) -> f64) -> f64 {
    let steps = 4000;
    let g = |t: f64| {
        let xi = t.powi(4);
        (1.0 + law.excess * xi.powf(law.exponent)) * f(xi) * 4.0 * t.powi(3)
    };
    let sum: f64 = (0..=steps)
        .map(|k| {
            let weight = if k == 0 || k == steps {
                1.0
            } else if k % 2 == 1 {
                4.0
            } else {
                2.0
            };
            weight * g(f64::from(k) / f64::from(steps))
        })
        .sum();
    sum / (3.0 * f64::from(steps))
}

#[test]
fn closed_forms_equal_quadrature() {
    let laws = [(-0.6, 0.8), (0.9, 1.7), (-0.3, 2.4), (2.5, 1.1), (-0.9, 3.2)];
    for (k, (excess, exponent)) in laws.into_iter().enumerate() {
        let law = PowerLaw { excess, exponent };
        let length = 0.7 + 0.3 * k as f64;
        let shape = ElementShape::hermite(0.0, length);
        let (m, s) = (element_mass(3.0, length, &law), element_stiffness(5.0, length, &law));
        let mass_scale = m[(0, 0)];
        for i in 0..4 {
            for j in 0..4 {
                let deflections = |xi: f64| {
                    let local = shape.at(xi * length);
                    local.deflection[i] * local.deflection[j]
                };
                let curvatures = |xi: f64| {
                    let local = shape.at(xi * length);
                    local.curvature[i] * local.curvature[j]
                };
                assert_close(
                    m[(i, j)],
                    3.0 * length * weighted_integral(&law, deflections),
                    1e-11 * mass_scale,
                );
                assert_close(
                    s[(i, j)],
                    5.0 * length * weighted_integral(&law, curvatures),
                    1e-10 * s[(0, 0)].max(s[(1, 1)]),
                );
            }
        }
    }
}

#[test]
fn rigid_motions_are_free_and_the_mass_is_the_laws() {
    let law = PowerLaw { excess: -0.4, exponent: 1.3 };
    let (m, s) = (element_mass(3.0, 0.9, &law), element_stiffness(5.0, 0.9, &law));
    for rigid in [[1.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.9, 1.0]] {
        for row in s.row_iter() {
            assert_close(row.iter().zip(rigid).map(|(a, b)| a * b).sum(), 0.0, 1e-12 * s[(0, 0)]);
        }
    }
    let along = |a: [f64; 4], b: [f64; 4]| -> f64 {
        (0..4).map(|i| (0..4).map(|j| a[i] * m[(i, j)] * b[j]).sum::<f64>()).sum()
    };
    let (heave, pitch) = ([1.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.9, 1.0]);
    let moment = |power: f64| 3.0 * 0.9_f64.powf(power + 1.0) * (1.0 / (power + 1.0) - 0.4 / (power + 2.3));
    assert_close(along(heave, heave), moment(0.0), 1e-13);
    assert_close(along(heave, pitch), moment(1.0), 1e-13);
    assert_close(along(pitch, pitch), moment(2.0), 1e-13);
}

#[test]
fn a_uniform_element_is_the_thesis_uniform_element() {
    let law = PowerLaw { excess: 0.0, exponent: 1.0 };
    let l = 0.6;
    let m = element_mass(420.0 / l, l, &law);
    let s = element_stiffness(l * l * l, l, &law);
    let expected_mass = [[156.0, 22.0 * l, 54.0, -13.0 * l], [22.0 * l, 4.0 * l * l, 13.0 * l, -3.0 * l * l]];
    let expected_stiffness = [[12.0, 6.0 * l, -12.0, 6.0 * l], [6.0 * l, 4.0 * l * l, -6.0 * l, 2.0 * l * l]];
    for i in 0..2 {
        for j in 0..4 {
            assert_close(m[(i, j)], expected_mass[i][j], 1e-12);
            assert_close(s[(i, j)], expected_stiffness[i][j], 1e-12);
        }
    }
}

#[test]
fn a_section_that_bulges_is_refused_and_quadrature_takes_it() {
    let mut beam =
        unit_beam(SectionShape::Tube { outer_diameter_m: [0.1, 0.2], inner_diameter_m: [0.0, 0.0] });
    let mut second = beam.sections[0].clone();
    beam.sections[0].to_m = 0.5;
    second.from_m = 0.5;
    second.shape = SectionShape::Tube { outer_diameter_m: [0.2, 0.12], inner_diameter_m: [0.0, 0.0] };
    beam.sections.push(second);
    let build = |integration| {
        FeModel::beam(&beam, &AttachedMasses::default(), &options(ElementMesh::Equal(1), integration))
    };
    assert!(matches!(build(Integration::PowerLaw), Err(Error::PowerLaw { .. })));
    assert!(build(Integration::Quadrature).is_ok());
}
