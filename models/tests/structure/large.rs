use super::{assert_all, assert_close, options, uniform_beam};
use counterpoise_linalg::{Mat, Sparse};
use counterpoise_models::structure::{
    AttachedMasses, Condensation, Direction, ElementMesh, FeModel, Integration, NodeRows, Shapes,
    SparseStructure, Support, pinned_modes, undamped_modes,
};
use counterpoise_models::{Error, PointMass};
use std::ops::ControlFlow;

/// A beam with a mass at its tip, so that its rigid motions couple, and its sparse form.
fn structures(elements: usize) -> (FeModel, SparseStructure) {
    let mut beam = uniform_beam();
    beam.pivot_m = 0.25;
    let mass = PointMass { name: "sight".to_owned(), position_m: 1.0, mass_kg: 3.0, inertia_kg_m2: 0.02 };
    let fitted = AttachedMasses { masses: vec![mass], hub_inertia_kg_m2: 0.5 };
    let mut fe =
        FeModel::beam(&beam, &fitted, &options(ElementMesh::Equal(elements), Integration::Quadrature))
            .unwrap();
    fe.C = Some(&fe.K.scale(1e-5) + &fe.M.scale(0.3));
    let node = |k: usize| NodeRows { deflection: 2 * k, rotation: 2 * k + 1 };
    let sparse = SparseStructure {
        M: Sparse::from_dense(&fe.M),
        K: Sparse::from_dense(&fe.K),
        C: fe.C.as_ref().map(Sparse::from_dense),
        heave: fe.heave.clone(),
        pitch: fe.pitch.clone(),
        hub: fe.hub.unwrap(),
        tip: fe.tip,
        tip_arm_m: fe.tip_arm_m,
        nodes: (0..=elements).map(node).collect(),
    };
    (fe, sparse)
}

#[test]
fn a_condensed_structure_has_the_modes_and_the_flexibility_of_the_whole() {
    let (whole, sparse) = structures(40);
    let mut stages = Vec::new();
    let small = sparse
        .condense(&Condensation::modes(4), &mut |at| {
            stages.push(at.stage);
            ControlFlow::Continue(())
        })
        .unwrap();
    assert!(small.M.nrows() < 60 && stages.len() > 4);
    for (support, count) in [(Support::Free, 6), (Support::Pinned, 8), (Support::Clamped, 6)] {
        let (exact, found) =
            (undamped_modes(&whole, support).unwrap(), undamped_modes(&small, support).unwrap());
        assert_all(&found.flexible_rad_s()[..count], &exact.flexible_rad_s()[..count], 1e-7);
        for direction in [Direction::Heave, Direction::Pitch] {
            let (a, b) = (exact.effective_mass(&whole, direction), found.effective_mass(&small, direction));
            (0..count)
                .for_each(|k| assert_close(a[exact.rigid + k], b[found.rigid + k], 1e-6 * whole.mass_kg()));
        }
    }
    let (exact, found) = (pinned_modes(&whole, &[], 4).unwrap(), pinned_modes(&small, &[], 4).unwrap());
    assert_close(found.body.inertia_kg_m2 / exact.body.inertia_kg_m2, 1.0, 1e-10);
    assert_close(found.body.out_of_balance_kg_m / exact.body.out_of_balance_kg_m, 1.0, 1e-10);
    let ratio = found.residual_flexibility_rad_nm / exact.residual_flexibility_rad_nm;
    assert_close(ratio, 1.0, 1e-6);
    for (a, b) in found.body.modes.iter().zip(&exact.body.modes) {
        assert_close(a.damping_ratio / b.damping_ratio, 1.0, 1e-6);
        assert_close(a.tip_shape / b.tip_shape, 1.0, 1e-6);
    }
}

#[test]
fn a_structure_that_moves_otherwise_is_refused() {
    let (_, mut sparse) = structures(12);
    // One more unknown that nothing holds.
    let n = sparse.heave.len();
    let grown = |A: &Sparse, corner: f64| {
        let mut dense = Mat::zeros(n + 1, n + 1);
        dense.set_block(0, 0, &A.to_dense());
        dense[(n, n)] = corner;
        Sparse::from_dense(&dense)
    };
    (sparse.M, sparse.K, sparse.C) = (grown(&sparse.M, 1.0), grown(&sparse.K, 0.0), None);
    sparse.heave.push(0.0);
    sparse.pitch.push(0.0);
    let answer = sparse.condense(&Condensation::modes(2), &mut |_| ControlFlow::Continue(()));
    assert!(matches!(answer, Err(Error::MovesFreely { .. })), "{answer:?}");
    let (_, sparse) = structures(12);
    assert!(sparse.condense(&Condensation::modes(2), &mut |_| ControlFlow::Break(())).is_err());
}

/// Twenty equal oscillators inside a structure give a mode that is repeated twenty times, far more often than the iteration's blocks are wide:
/// none of them may be missed, and none of the modes above them.
#[test]
fn a_mode_that_is_repeated_often_is_found_as_often() {
    const COPIES: usize = 20;
    let (mut whole, mut sparse) = structures(32);
    let lowest = undamped_modes(&whole, Support::Pinned).unwrap().flexible_rad_s()[1];
    let n = whole.M.nrows();
    let grown = |A: &Mat, corner: f64| {
        let mut out = Mat::zeros(n + COPIES, n + COPIES);
        out.set_block(0, 0, A);
        (n..n + COPIES).for_each(|k| out[(k, k)] = corner);
        out
    };
    (whole.M, whole.K, whole.C) =
        (grown(&whole.M, 0.01), grown(&whole.K, 0.01 * (1.1 * lowest).powi(2)), None);
    (sparse.M, sparse.K, sparse.C) = (Sparse::from_dense(&whole.M), Sparse::from_dense(&whole.K), None);
    for motion in [&mut whole.heave, &mut whole.pitch, &mut sparse.heave, &mut sparse.pitch] {
        motion.resize(n + COPIES, 0.0);
    }
    let small = sparse.condense(&Condensation::modes(6), &mut |_| ControlFlow::Continue(())).unwrap();
    for (support, count) in [(Support::Free, 6), (Support::Pinned, 12), (Support::Clamped, 6)] {
        let (exact, found) =
            (undamped_modes(&whole, support).unwrap(), undamped_modes(&small, support).unwrap());
        assert_all(&found.flexible_rad_s()[..count], &exact.flexible_rad_s()[..count], 1e-7);
    }
}

/// A beam with sixty local oscillators below its second mode, which no load reaches: balanced shapes find the modes of the beam among them.
#[test]
fn balanced_shapes_leave_out_what_no_load_moves() {
    const LOCAL: usize = 60;
    let (mut whole, mut sparse) = structures(32);
    let exact = pinned_modes(&whole, &[], 3).unwrap();
    let second = exact.body.modes[1].frequency_rad_s;
    let n = whole.M.nrows();
    let grown = |A: &Mat, corner: &dyn Fn(usize) -> f64| {
        let mut out = Mat::zeros(n + LOCAL, n + LOCAL);
        out.set_block(0, 0, A);
        (0..LOCAL).for_each(|k| out[(n + k, n + k)] = corner(k));
        out
    };
    let square = |k: usize| (second * (0.3 + 0.01 * k as f64)).powi(2);
    whole.M = grown(&whole.M, &|_| 0.01);
    whole.K = grown(&whole.K, &|k| 0.01 * square(k));
    let C = whole.C.as_ref().map(|C| grown(C, &|_| 1e-3)).unwrap();
    (sparse.M, sparse.K, sparse.C) =
        (Sparse::from_dense(&whole.M), Sparse::from_dense(&whole.K), Some(Sparse::from_dense(&C)));
    for motion in [&mut sparse.heave, &mut sparse.pitch] {
        motion.resize(n + LOCAL, 0.0);
    }
    let wanted = Condensation { shapes: Shapes::Balanced, ..Condensation::modes(3) };
    let small = sparse.condense(&wanted, &mut |_| ControlFlow::Continue(())).unwrap();
    let left_out = small.truncation.unwrap();
    assert!(left_out.estimated_error < 1e-3 && left_out.kept <= 18, "{left_out:?}");
    let found = pinned_modes(&small, &[], 3).unwrap();
    assert_close(found.body.inertia_kg_m2 / exact.body.inertia_kg_m2, 1.0, 1e-10);
    for (a, b) in found.body.modes.iter().zip(&exact.body.modes) {
        assert_close(a.frequency_rad_s / b.frequency_rad_s, 1.0, 1e-4);
        assert_close(a.damping_ratio / b.damping_ratio, 1.0, 1e-3);
        assert_close(a.hub_shape / b.hub_shape, 1.0, 1e-2);
    }
    // Without a damping matrix a common ratio ranks the same motions; a mode without damping cannot be balanced.
    let ratio = Condensation { damping_ratio: 0.01, ..wanted };
    let proportional = SparseStructure { C: None, ..sparse.clone() };
    let small = proportional.condense(&ratio, &mut |_| ControlFlow::Continue(())).unwrap();
    let first = pinned_modes(&small, &[0.01], 1).unwrap().body.modes[0].frequency_rad_s;
    assert_close(first / exact.body.modes[0].frequency_rad_s, 1.0, 1e-4);
    sparse.C = sparse.C.map(|C| C.map(|_, _, _| 0.0));
    let answer = sparse.condense(&wanted, &mut |_| ControlFlow::Continue(()));
    assert!(matches!(answer, Err(Error::Parameter { .. })), "{answer:?}");
}
