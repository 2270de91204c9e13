use super::{assert_close, options, uniform_beam};
use counterpoise_linalg::{Mat, solve, sym_gen_eigen};
use counterpoise_models::plant::Body;
use counterpoise_models::structure::{
    AttachedMasses, ElementMesh, FeModel, Integration, Support, locked_modes, pinned_modes, reduce_to_lumped,
    undamped_modes,
};

fn model() -> FeModel {
    let mut beam = uniform_beam();
    beam.pivot_m = 0.3;
    let fitted = AttachedMasses { hub_inertia_kg_m2: 0.05, masses: vec![super::mass(-0.1, 0.2, 0.01)] };
    FeModel::beam(&beam, &fitted, &options(ElementMesh::Pivoted(8), Integration::Quadrature)).unwrap()
}

#[test]
fn all_pinned_modes_together_are_the_static_model() {
    let model = model();
    let hub = model.hub.unwrap();
    let reduced = pinned_modes(&model, &[0.0], usize::MAX).unwrap();
    // A unit hub torque that is balanced by the inertia of a rigid rotation, relative to the rotation of the hub.
    let free: Vec<usize> =
        (0..model.M.nrows()).filter(|&i| i != hub.deflection && i != hub.rotation).collect();
    let inertial = (&model.M * &Mat::col(&model.pitch)).scale(-1.0 / model.inertia_kg_m2());
    let bent = solve(&model.K.select(&free, &free), &inertial.select(&free, &[0])).unwrap();
    let tip = free.iter().position(|&i| i == model.tip.rotation).unwrap();
    let modal: f64 = reduced
        .body
        .modes
        .iter()
        .map(|m| m.hub_shape * (m.tip_shape - m.hub_shape) / m.frequency_rad_s.powi(2))
        .sum();
    assert_close(modal / bent[(tip, 0)], 1.0, 1e-8);
}

#[test]
fn what_truncation_leaves_out_is_reported() {
    let model = model();
    let all = pinned_modes(&model, &[0.0], usize::MAX).unwrap();
    let two = pinned_modes(&model, &[0.0], 2).unwrap();
    let left: f64 = all.body.modes[2..].iter().map(|m| (m.hub_shape / m.frequency_rad_s).powi(2)).sum();
    assert_eq!(two.body.modes.len(), 2);
    assert_close(two.residual_flexibility_rad_nm / left, 1.0, 1e-10);
    assert_eq!(all.residual_flexibility_rad_nm, 0.0);
}

#[test]
fn the_locked_form_has_the_pinned_frequencies() {
    let model = model();
    let form = locked_modes(&model, usize::MAX).unwrap();
    let n = form.modes.len() + 1;
    let (mut M, mut K) = (Mat::eye(n), Mat::zeros(n, n));
    M[(0, 0)] = form.inertia_kg_m2;
    for (k, mode) in form.modes.iter().enumerate() {
        M[(0, k + 1)] = mode.hub_coupling;
        M[(k + 1, 0)] = mode.hub_coupling;
        K[(k + 1, k + 1)] = mode.frequency_rad_s.powi(2);
    }
    let (values, _) = sym_gen_eigen(&K, &M).unwrap();
    let expected = undamped_modes(&model, Support::Pinned).unwrap();
    for k in 0..6 {
        assert_close(values[k + 1].sqrt() / expected.flexible_rad_s()[k], 1.0, 1e-8);
    }
}

#[test]
fn weight_bends_the_locked_beam_as_its_modes_say() {
    let beam = uniform_beam();
    let model = FeModel::beam(
        &beam,
        &AttachedMasses::default(),
        &options(ElementMesh::Equal(10), Integration::Quadrature),
    )
    .unwrap();
    let form = locked_modes(&model, usize::MAX).unwrap();
    let sag: f64 =
        form.modes.iter().map(|m| -m.load_share_kg_m * m.tip_deflection_m / m.frequency_rad_s.powi(2)).sum();
    assert_close(sag, -1.0 / 8.0, 1e-9);
}

#[test]
fn the_lumped_form_keeps_inertia_moment_and_both_frequencies() {
    let model = model();
    let two = reduce_to_lumped(&model, &[0.02, 0.01]).unwrap();
    assert_close(two.hub_inertia_kg_m2 + two.beam_inertia_kg_m2, model.inertia_kg_m2(), 1e-12);
    assert_close(two.out_of_balance_kg_m, model.first_moment_kg_m(), 1e-12);
    let locked = (two.stiffness_nm_rad / two.beam_inertia_kg_m2).sqrt();
    assert_close(locked / undamped_modes(&model, Support::Clamped).unwrap().flexible_rad_s()[0], 1.0, 1e-12);
    let body = Body::from_lumped(&two);
    assert_close(body.modes[0].damping_ratio, 0.02, 1e-12);
    assert_close(
        body.modes[0].frequency_rad_s / undamped_modes(&model, Support::Pinned).unwrap().flexible_rad_s()[0],
        1.0,
        1e-12,
    );
}

#[test]
fn a_damping_matrix_takes_the_place_of_ratios() {
    let mut model = model();
    model.C = Some(model.K.scale(1e-3));
    for mode in pinned_modes(&model, &[0.5], 3).unwrap().body.modes {
        assert_close(mode.damping_ratio, 0.5e-3 * mode.frequency_rad_s, 1e-10);
    }
}

#[test]
fn a_structure_of_negative_or_no_mass_is_refused() {
    for scale in [-1.0, 0.0] {
        let mut model = model();
        model.M = model.M.scale(scale);
        for support in [Support::Free, Support::Pinned] {
            let refused = undamped_modes(&model, support).unwrap_err().to_string();
            assert!(refused.contains("mass"), "{scale}: {refused}");
        }
    }
}
