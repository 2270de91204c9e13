use super::{assert_all, assert_close, frequencies, mass, options, uniform_beam};
use counterpoise_models::structure::{
    AttachedMasses, Direction, ElementMesh, FeModel, Integration, Support, undamped_modes,
};

const CLAMPED: [f64; 5] = [1.87510406871, 4.69409113297, 7.85475743824, 10.9955407349, 14.137168391];
const FREE: [f64; 5] = [4.73004074486, 7.8532046241, 10.995607838, 14.1371654913, 17.2787596574];
const PINNED: [f64; 4] = [3.92660231205, 7.06858274563, 10.2101761228, 13.3517687778];

fn betas(elements: usize, support: Support, fitted: &AttachedMasses) -> Vec<f64> {
    let options = options(ElementMesh::Equal(elements), Integration::Quadrature);
    frequencies(&uniform_beam(), fitted, &options, support).into_iter().map(f64::sqrt).collect()
}

#[test]
fn frequencies_are_the_closed_forms() {
    let bare = AttachedMasses::default();
    assert_all(&betas(40, Support::Clamped, &bare), &CLAMPED, 6e-6);
    assert_all(&betas(40, Support::Free, &bare), &FREE, 1.3e-5);
    assert_all(&betas(40, Support::Pinned, &bare), &PINNED, 5e-6);
}

#[test]
fn errors_fall_with_the_fourth_power_from_above() {
    for (support, betas_of) in
        [(Support::Free, &FREE[..]), (Support::Pinned, &PINNED), (Support::Clamped, &CLAMPED)]
    {
        for mode in 0..3 {
            let error = |n| {
                betas(n, support, &AttachedMasses::default())[mode].powi(2) / betas_of[mode].powi(2) - 1.0
            };
            let errors = [8, 16, 32].map(error);
            assert!(errors.iter().all(|&e| e > 0.0), "{support:?} {mode}: {errors:?}");
            for pair in errors.windows(2) {
                let order = (pair[0] / pair[1]).log2();
                assert!(order >= 3.8, "{support:?} {mode}: order {order}");
            }
        }
    }
}

#[test]
fn free_errors_are_the_published_ones() {
    let cases = [
        (2, [2.2e-3, 1.4e-1]),
        (4, [1.1e-3, 6.2e-3]),
        (8, [8.1e-5, 5.8e-4]),
        (16, [5.2e-6, 3.9e-5]),
        (32, [3.3e-7, 2.5e-6]),
    ];
    for (elements, published) in cases {
        let found = betas(elements, Support::Free, &AttachedMasses::default());
        for mode in 0..2 {
            let error = (found[mode] / FREE[mode]).powi(2) - 1.0;
            assert!(
                (error / published[mode] - 1.0).abs() < 0.05,
                "{elements} elements: {error} for {}",
                published[mode]
            );
        }
    }
}

#[test]
fn a_hub_inertia_moves_the_pinned_modes_as_published() {
    let cases = [
        (0.01, [3.640541719, 5.615996082]),
        (0.1, [2.638924696, 4.79377085]),
        (1.0, [2.010003322, 4.703794262]),
        (10.0, [1.89007648, 4.695058307]),
    ];
    for (hub_inertia_kg_m2, expected) in cases {
        let fitted = AttachedMasses { hub_inertia_kg_m2, ..AttachedMasses::default() };
        assert_all(&betas(40, Support::Pinned, &fitted), &expected, 1e-6);
    }
}

#[test]
fn a_tip_mass_moves_the_clamped_mode_as_its_characteristic_equation_says() {
    let ratio = 0.7;
    let fitted = AttachedMasses { masses: vec![mass(1.0, ratio, 0.0)], ..AttachedMasses::default() };
    let b = betas(40, Support::Clamped, &fitted)[0];
    let residual = 1.0 + b.cos() * b.cosh() + ratio * b * (b.cos() * b.sinh() - b.sin() * b.cosh());
    assert_close(residual, 0.0, 1e-6);
}

#[test]
fn a_mass_on_a_rigid_arm_is_a_mass_with_moment_and_inertia() {
    let options = options(ElementMesh::Equal(10), Integration::Quadrature);
    let model = |fitted: &AttachedMasses| FeModel::beam(&uniform_beam(), fitted, &options).unwrap();
    let hung = model(&AttachedMasses { masses: vec![mass(-0.2, 3.0, 0.1)], ..AttachedMasses::default() });
    assert_close(hung.mass_kg(), 1.0 + 3.0, 1e-12);
    assert_close(hung.first_moment_kg_m(), 0.5 - 0.6, 1e-12);
    assert_close(hung.inertia_kg_m2(), 1.0 / 3.0 + 3.0 * 0.04 + 0.1, 1e-12);
}

#[test]
fn rigid_motions_are_free_and_carry_the_exact_mass() {
    for mesh in [ElementMesh::Equal(1), ElementMesh::Equal(7), ElementMesh::Nodes(vec![0.0, 0.1, 0.9, 1.0])] {
        let model = FeModel::beam(
            &uniform_beam(),
            &AttachedMasses::default(),
            &options(mesh, Integration::Quadrature),
        )
        .unwrap();
        for rigid in [&model.heave, &model.pitch] {
            let resisted = (&model.K * &counterpoise_linalg::Mat::col(rigid)).norm_max();
            assert_close(resisted / model.K.norm_max(), 0.0, 1e-13);
        }
        assert_close(model.mass_kg(), 1.0, 1e-13);
        assert_close(model.first_moment_kg_m(), 0.5, 1e-13);
        assert_close(model.inertia_kg_m2(), 1.0 / 3.0, 1e-13);
    }
}

#[test]
fn modes_are_orthonormal_and_effective_masses_add_up() {
    let options = options(ElementMesh::Equal(12), Integration::Quadrature);
    let model = FeModel::beam(&uniform_beam(), &AttachedMasses::default(), &options).unwrap();
    for support in [Support::Free, Support::Pinned, Support::Clamped] {
        let found = undamped_modes(&model, support).unwrap();
        let gram = &found.shapes.t() * &(&model.M * &found.shapes);
        let off = (&gram - &counterpoise_linalg::Mat::eye(gram.nrows())).norm_max();
        assert_close(off, 0.0, 1e-9);
        if support == Support::Clamped {
            let masses = found.effective_mass(&model, Direction::Heave);
            let first_three = [0.6130, 0.1883, 0.0647];
            masses.iter().zip(first_three).for_each(|(m, expected)| assert_close(*m, expected, 1e-4));
            let inertia: f64 = found.effective_mass(&model, Direction::Pitch).iter().sum();
            assert_close(inertia, 1.0 / 3.0, 1e-4);
        }
    }
}

#[test]
fn every_unknown_carries_its_share_of_the_mass() {
    let options = options(ElementMesh::Equal(4), Integration::Quadrature);
    let model = FeModel::beam(&uniform_beam(), &AttachedMasses::default(), &options).unwrap();
    let carried = model.carried_moments();
    let shares = [0.125, 0.25, 0.25, 0.25, 0.125];
    shares.iter().enumerate().for_each(|(i, share)| assert_close(carried[2 * i], *share, 1e-14));
    let moment: f64 = carried.iter().zip(&model.pitch).map(|(c, p)| c * p).sum();
    assert_close(moment, 0.5, 1e-14);
}

#[test]
fn what_has_no_hub_node_cannot_be_pinned() {
    let mut beam = uniform_beam();
    beam.pivot_m = 0.3;
    let options = options(ElementMesh::Equal(4), Integration::Quadrature);
    let model = FeModel::beam(&beam, &AttachedMasses::default(), &options).unwrap();
    assert_eq!(undamped_modes(&model, Support::Pinned), Err(counterpoise_models::Error::NoHubNode));
    let pivoted = super::options(ElementMesh::Pivoted(4), Integration::Quadrature);
    assert!(FeModel::beam(&beam, &AttachedMasses::default(), &pivoted).unwrap().hub.is_some());
}
