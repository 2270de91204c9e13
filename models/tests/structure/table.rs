//! The thesis' table 6-1 on the reference rig's beam: few elements against 129.

use counterpoise_models::reference::rig;
use counterpoise_models::structure::Integration;
use counterpoise_models::structure::refinement::{COLUMNS, RefinementMesh, compare_refinements};

/// Free-free frequencies over those of the model of 129 elements.
fn column(elements: usize, integration: Integration) -> Vec<f64> {
    let mesh = RefinementMesh { integration, elements };
    compare_refinements(&rig().beam.unwrap(), &[mesh]).unwrap().columns[0].ratios.clone()
}

#[test]
fn the_table_has_the_columns_of_the_thesis() {
    let found = compare_refinements(&rig().beam.unwrap(), &COLUMNS).unwrap();
    assert!((found.reference_rad_s[0] / std::f64::consts::TAU - 37.9218).abs() < 1e-3);
    let heads: Vec<(Integration, usize, usize)> =
        found.columns.iter().map(|c| (c.integration, c.elements, c.ratios.len())).collect();
    let uniform = [14, 3, 2, 1].map(|n| (Integration::UniformAverage, n, 2 * n));
    let tapered = [3, 2, 1].map(|n| (Integration::Quadrature, n, 2 * n));
    assert_eq!(heads, uniform.into_iter().chain(tapered).collect::<Vec<_>>());
}

fn mean_error(ratios: &[f64], modes: usize) -> f64 {
    ratios.iter().take(modes).map(|r| (r - 1.0).abs()).sum::<f64>() / modes as f64
}

#[test]
fn columns_have_as_many_modes_as_the_elements_allow() {
    for elements in [1, 2, 3, 14] {
        assert_eq!(column(elements, Integration::UniformAverage).len(), 2 * elements);
    }
}

#[test]
fn uniform_elements_converge() {
    let worst = |n: usize| mean_error(&column(n, Integration::UniformAverage), 2);
    assert!(worst(14) < worst(3) && worst(3) < worst(2) && worst(2) < worst(1));
    assert!(column(14, Integration::UniformAverage)[..5].iter().all(|r| (r - 1.0).abs() < 0.04));
}

#[test]
fn tapered_elements_are_closer_than_uniform_ones_on_the_first_mode() {
    for elements in [1, 2, 3] {
        let error = |integration| (column(elements, integration)[0] - 1.0).abs();
        let uniform = error(Integration::UniformAverage);
        assert!(error(Integration::Quadrature) < uniform && error(Integration::PowerLaw) < uniform);
    }
    assert!((column(3, Integration::PowerLaw)[0] - 1.0).abs() < 0.01);
    assert!((column(3, Integration::Quadrature)[0] - 1.0).abs() < 0.01);
}

#[test]
fn quadrature_is_never_below_the_fine_model() {
    for elements in [1, 2, 3, 14] {
        let ratios = column(elements, Integration::Quadrature);
        assert!(ratios.iter().take(6).all(|&r| r > 1.0), "{elements}: {ratios:?}");
    }
}
