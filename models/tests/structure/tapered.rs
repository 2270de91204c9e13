use super::{assert_all, assert_close, cone, frequencies, options, unit_beam};
use counterpoise_models::structure::{AttachedMasses, ElementMesh, Integration, Support};
use counterpoise_models::{Beam, SectionShape};

fn numbers(tip: f64, elements: usize, integration: Integration, support: Support) -> Vec<f64> {
    let (beam, factor) = cone(tip);
    let found = frequencies(
        &beam,
        &AttachedMasses::default(),
        &options(ElementMesh::Equal(elements), integration),
        support,
    );
    found.into_iter().map(|w| w * factor).collect()
}

#[test]
fn clamped_cones_have_the_published_frequencies() {
    let table = [
        (0.2, [6.196391, 18.3854674, 39.8336299, 71.2417565]),
        (0.4, [5.0090333, 19.0648608, 45.7383613, 85.3438225]),
        (0.5, [4.6251503, 19.5476132, 48.5788993, 91.8127683]),
        (0.6, [4.3187786, 20.0499839, 51.3346326, 98.004972]),
        (0.8, [3.8551168, 21.0567454, 56.6303451, 109.7629974]),
        (1.0, [3.5160153, 22.0344916, 61.6972144, 120.9019161]),
    ];
    for (tip, expected) in table {
        assert_all(&numbers(tip, 60, Integration::Quadrature, Support::Clamped), &expected, 5e-6);
    }
}

#[test]
fn a_full_cone_has_the_classic_frequencies() {
    let found = numbers(0.0, 120, Integration::Quadrature, Support::Clamped);
    assert_all(&found, &[8.7193, 21.1457, 38.4538, 60.6801], 2e-5);
}

/// A wedge of unit breadth, and the factor from its w to w sqrt(rho A_0 L^4 / (E I_0)): I_0 = 1/12.
fn wedge(tip: f64) -> (Beam, f64) {
    let shape = SectionShape::Rectangle { height_m: [1.0, tip], width_m: [1.0, 1.0] };
    (unit_beam(shape), 12_f64.sqrt())
}

fn wedge_numbers(tip: f64, elements: usize) -> Vec<f64> {
    let (beam, factor) = wedge(tip);
    let options = options(ElementMesh::Equal(elements), Integration::Quadrature);
    let found = frequencies(&beam, &AttachedMasses::default(), &options, Support::Clamped);
    found.into_iter().map(|w| w * factor).collect()
}

#[test]
fn clamped_wedges_have_the_published_frequencies() {
    let table = [
        (0.2, [4.2924945, 15.7427002, 36.8845533, 68.1164222]),
        (0.4, [3.9342775, 17.4878552, 44.0248094, 83.554072]),
        (0.5, [3.8237848, 18.3172609, 47.264827, 90.4504777]),
        (0.6, [3.7370761, 19.1138128, 50.3536546, 96.995394]),
        (0.8, [3.6082749, 20.6210176, 56.1922784, 109.318401]),
        (1.0, [3.5160153, 22.0344916, 61.6972144, 120.9019161]),
    ];
    for (tip, expected) in table {
        assert_all(&wedge_numbers(tip, 60), &expected, 5e-6);
    }
}

#[test]
fn a_full_wedge_has_the_classic_frequencies() {
    assert_all(&wedge_numbers(0.0, 120), &[5.3151, 15.2072, 30.0198, 49.7633], 2e-5);
}

#[test]
fn errors_of_a_wedge_fall_with_the_fourth_power_from_above() {
    let exact = [3.8237848, 18.3172609, 47.264827, 90.4504777];
    for mode in 1..4 {
        let errors = [12, 24, 48].map(|n| wedge_numbers(0.5, n)[mode] / exact[mode] - 1.0);
        assert!(errors.iter().all(|&e| e > 0.0));
        assert!(errors.windows(2).all(|e| (e[0] / e[1]).log2() >= 3.8), "{mode}: {errors:?}");
    }
}

#[test]
fn a_rectangle_is_its_area_and_second_moment_whatever_its_kind() {
    let given = SectionShape::Given { area_m2: [0.02; 2], second_moment_m4: [0.2 * 0.001 / 12.0; 2] };
    let rectangle = SectionShape::Rectangle { height_m: [0.1; 2], width_m: [0.2; 2] };
    let options = options(ElementMesh::Equal(6), Integration::Quadrature);
    let of = |shape| frequencies(&unit_beam(shape), &AttachedMasses::default(), &options, Support::Free);
    assert_all(&of(rectangle), &of(given), 1e-12);
}

#[test]
fn free_and_pinned_cones_have_the_published_frequencies() {
    let free = [
        (0.2, [14.9484651, 36.3290224, 67.7230426, 109.3037203]),
        (0.5, [17.0793338, 45.9629822, 89.2138763, 146.79466]),
        (0.8, [20.1706482, 55.465066, 108.6200902, 179.4676766]),
    ];
    for (tip, expected) in free {
        assert_all(&numbers(tip, 60, Integration::Quadrature, Support::Free), &expected, 5e-6);
    }
    let pinned =
        [(0.2, [12.6127218, 31.6606087]), (0.5, [13.189392, 38.6336976]), (0.8, [14.5041254, 45.5171475])];
    for (tip, expected) in pinned {
        assert_all(&numbers(tip, 60, Integration::Quadrature, Support::Pinned), &expected, 5e-6);
    }
}

#[test]
fn each_kind_of_element_has_its_published_error() {
    let exact = [17.0793338, 45.9629822];
    let published = [
        (Integration::UniformAverage, 3, [-4.7, -4.9]),
        (Integration::PowerLaw, 3, [-0.06, 1.5]),
        (Integration::Quadrature, 3, [0.24, 2.0]),
    ];
    for (integration, elements, percent) in published {
        let found = numbers(0.5, elements, integration, Support::Free);
        for mode in 0..2 {
            let error = 100.0 * (found[mode] / exact[mode] - 1.0);
            assert_close(error, percent[mode], 0.05);
        }
    }
    for (integration, elements, percent, last_digit) in [
        (Integration::UniformAverage, 6, -1.2, 0.05),
        (Integration::UniformAverage, 14, -0.24, 0.01),
        (Integration::PowerLaw, 6, -0.03, 0.005),
        (Integration::PowerLaw, 14, -0.008, 0.001),
        (Integration::Quadrature, 6, 0.024, 0.001),
        (Integration::Quadrature, 14, 0.001, 0.0005),
    ] {
        let error = 100.0 * (numbers(0.5, elements, integration, Support::Free)[0] / exact[0] - 1.0);
        assert_close(error, percent, last_digit);
    }
}

#[test]
fn tapered_errors_fall_with_the_fourth_power_from_above() {
    let exact = [17.0793338, 45.9629822, 89.2138763];
    for mode in 0..3 {
        let errors = [12, 24, 48]
            .map(|n| numbers(0.5, n, Integration::Quadrature, Support::Free)[mode] / exact[mode] - 1.0);
        assert!(errors.iter().all(|&e| e > 0.0));
        assert!(errors.windows(2).all(|e| (e[0] / e[1]).log2() > 3.8), "{mode}: {errors:?}");
    }
}
