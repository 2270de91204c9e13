//! A large imported structure is condensed once, as long as nothing that it is made from changes.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use std::ops::ControlFlow;

use counterpoise_linalg::{Sparse, sparse::Entry};
use counterpoise_models::structure::AttachedMasses;
use counterpoise_models::structure::Condensation;
use counterpoise_models::structure::import::{Dof, Imported, NodeMap};
use counterpoise_project::resolve::import::ImportedContent;

/// Returns a chain of beam elements of length 1 with two unknowns a node, free at both ends; more unknowns than are analysed
/// densely.
fn content(elements: usize, stiffness: f64) -> ImportedContent {
    let n = 2 * (elements + 1);
    let (mut M, mut K) = (Vec::new(), Vec::new());
    let k =
        [[12.0, 6.0, -12.0, 6.0], [6.0, 4.0, -6.0, 2.0], [-12.0, -6.0, 12.0, -6.0], [6.0, 2.0, -6.0, 4.0]];
    for element in 0..elements {
        for (i, row) in k.iter().enumerate() {
            for (j, value) in row.iter().enumerate() {
                K.push(Entry { row: 2 * element + i, col: 2 * element + j, value: stiffness * value });
            }
        }
    }
    (0..n)
        .for_each(|i| M.push(Entry { row: i, col: i, value: if i.is_multiple_of(2) { 1.0 } else { 0.01 } }));
    let dof =
        |row: usize| Dof { grid: (row / 2 + 1) as u64, component: if row.is_multiple_of(2) { 3 } else { 5 } };
    let map = NodeMap {
        deflection: 3,
        rotation: 5,
        rotation_sign: 1.0,
        pivot: 1,
        tip: elements as u64 + 1,
        axial: None,
        axial_sign: 1.0,
        positions_m: (0..=elements).map(|k| (k as u64 + 1, k as f64)).collect(),
        heights_m: Default::default(),
        rows: (0..n).map(dof).collect(),
    };
    let sparse = |list: &[Entry]| Sparse::from_entries(n, n, list).unwrap();
    ImportedContent { matrices: Imported::from_row_order(&map, sparse(&M), None, sparse(&K)), map }
}

/// Returns the number of steps that making the structure took.
fn steps(content: &ImportedContent, fitted: &AttachedMasses, modes: usize) -> usize {
    let mut count = 0;
    let mut watch = |_| {
        count += 1;
        ControlFlow::Continue(())
    };
    content.structure(fitted, &Condensation::modes(modes), &mut watch).unwrap();
    count
}

#[test]
fn the_same_structure_is_condensed_once() {
    let (plain, stiffer) = (content(320, 1e6), content(320, 1.5e6));
    let none = AttachedMasses::default();
    assert!(steps(&plain, &none, 3) > 0);
    assert_eq!(steps(&plain, &none, 3), 0);
    assert_eq!(steps(&content(320, 1e6), &none, 3), 0, "read again, and equal");
    assert!(steps(&plain, &none, 4) > 0, "another number of modes");
    assert!(steps(&stiffer, &none, 3) > 0, "another stiffness");
    let heavy = AttachedMasses { hub_inertia_kg_m2: 2.0, ..AttachedMasses::default() };
    assert!(steps(&plain, &heavy, 3) > 0, "something fitted");
    let mut forget = |_| ControlFlow::Continue(());
    let mut three = || plain.structure(&heavy, &Condensation::modes(3), &mut forget).unwrap();
    assert_eq!(three(), three());
}
