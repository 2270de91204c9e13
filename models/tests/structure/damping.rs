use super::{assert_close, options, uniform_beam};
use counterpoise_linalg::{Mat, eigenvalues};
use counterpoise_models::structure::damping::{
    modal_damping, modal_with_stiffness, rayleigh_coefficients, rayleigh_damping, state_matrix,
};
use counterpoise_models::structure::{
    AttachedMasses, ElementMesh, FeModel, Integration, Modes, Support, undamped_modes,
};

fn model() -> (FeModel, Modes) {
    let options = options(ElementMesh::Equal(4), Integration::Quadrature);
    let model = FeModel::beam(&uniform_beam(), &AttachedMasses::default(), &options).unwrap();
    let modes = undamped_modes(&model, Support::Clamped).unwrap();
    (model, modes)
}

/// phi_k' C phi_k / (2 w_k) of the clamped modes.
fn ratios(C: &Mat, modes: &Modes) -> Vec<f64> {
    let damped = &modes.shapes.t() * &(C * &modes.shapes);
    modes.flexible_rad_s().iter().enumerate().map(|(k, w)| damped[(k, k)] / (2.0 * w)).collect()
}

#[test]
fn rayleigh_damping_hits_its_two_modes() {
    let (model, modes) = model();
    let w = modes.flexible_rad_s();
    let factors = rayleigh_coefficients([w[0], 0.01].into(), [w[2], 0.03].into()).unwrap();
    let found = ratios(&rayleigh_damping(&model, factors), &modes);
    assert_close(found[0], 0.01, 1e-10);
    assert_close(found[2], 0.03, 1e-10);
    assert_close(found[1], 0.5 * (factors.mass_factor / w[1] + factors.stiffness_factor * w[1]), 1e-10);
    assert!(rayleigh_coefficients([5.0, 0.01].into(), [5.0, 0.02].into()).is_err());
}

#[test]
fn modal_damping_hits_each_mode_and_none_beyond() {
    let (model, modes) = model();
    let found = ratios(&modal_damping(&model, &modes, &[0.01, 0.02, 0.03]), &modes);
    let expected = [0.01, 0.02, 0.03, 0.0, 0.0];
    found.iter().zip(expected).for_each(|(f, e)| assert_close(*f, e, 1e-10));
}

#[test]
fn the_stiffness_part_is_not_counted_twice() {
    let (model, modes) = model();
    let w = modes.flexible_rad_s();
    let found = ratios(&modal_with_stiffness(&model, &modes, &[0.01, 0.02, 0.03]), &modes);
    let expected = [0.01, 0.02, 0.03, 0.03 * w[3] / w[2], 0.03 * w[4] / w[2]];
    found.iter().zip(expected).for_each(|(f, e)| assert_close(*f, e, 1e-9));
}

#[test]
fn the_first_order_form_has_the_damped_poles() {
    let (model, modes) = model();
    let free: Vec<usize> = (2..10).collect();
    let C = modal_damping(&model, &modes, &[0.01; 8]);
    let part = |A: &Mat| A.select(&free, &free);
    let A = state_matrix(&part(&model.M), &part(&C), &part(&model.K)).unwrap();
    let mut poles = eigenvalues(&A).unwrap();
    poles.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
    for (k, w) in modes.flexible_rad_s().iter().take(4).enumerate() {
        assert_close(poles[2 * k].norm() / w, 1.0, 1e-8);
        assert_close(-poles[2 * k].re / poles[2 * k].norm(), 0.01, 1e-8);
    }
}
