//! The symmetric eigenproblem by its residual, on matrices whose eigenvalues spread over many decades.
#![allow(clippy::unwrap_used, clippy::expect_used, non_snake_case)]

use counterpoise_linalg::{Mat, cholesky, solve, sym_eigen, sym_gen_eigen};

/// Stiffness of a free beam's bending by finite differences, n points: eigenvalues over ten decades.
fn bending(n: usize) -> Mat {
    let D = Mat::from_fn(n - 2, n, |i, j| match j as i64 - i as i64 {
        0 | 2 => 1.0,
        1 => -2.0,
        _ => 0.0,
    });
    let thinning = Mat::diag(&(0..n - 2).map(|i| (-8.0 * i as f64 / n as f64).exp()).collect::<Vec<_>>());
    &D.t() * &(&thinning * &D)
}

/// L^-1 K L^-T, M = L L', of a tapered beam of cubic elements, not held anywhere.
fn beam(elements: usize) -> Mat {
    let (n, l) = (2 * elements + 2, 1.0 / elements as f64);
    let (mut K, mut M) = (Mat::zeros(n, n), Mat::zeros(n, n));
    let k = [
        [12.0, 6.0 * l, -12.0, 6.0 * l],
        [6.0, 4.0 * l, -6.0, 2.0 * l],
        [-12.0, -6.0 * l, 12.0, -6.0 * l],
        [6.0, 2.0 * l, -6.0, 4.0 * l],
    ];
    let m = [
        [156.0, 22.0 * l, 54.0, -13.0 * l],
        [22.0, 4.0 * l, 13.0, -3.0 * l],
        [54.0, 13.0 * l, 156.0, -22.0 * l],
        [-13.0, -3.0 * l, -22.0, 4.0 * l],
    ];
    for e in 0..elements {
        let diameter = 1.0 - 0.7 * (e as f64 + 0.5) / elements as f64;
        for i in 0..4 {
            for j in 0..4 {
                let unit = if i % 2 == 1 { l } else { 1.0 };
                K[(2 * e + i, 2 * e + j)] += diameter.powi(4) * unit * k[i][j] / l.powi(3);
                M[(2 * e + i, 2 * e + j)] += diameter.powi(2) * unit * m[i][j] * l / 420.0;
            }
        }
    }
    let L = cholesky(&M).unwrap();
    solve(&L, &solve(&L, &K).unwrap().t()).unwrap().symmetric_part()
}

#[test]
fn a_beam_of_many_elements_keeps_its_residual() {
    for elements in [20, 64, 70, 129] {
        let A = beam(elements);
        let (values, V) = sym_eigen(&A).unwrap();
        let residual = (&(&A * &V) - &(&V * &Mat::diag(&values))).norm_max() / A.norm_max();
        assert!(residual < 1e-13, "{elements}: {residual:e}");
    }
}

#[test]
fn residual_and_orthogonality_do_not_depend_on_the_size() {
    for n in [20, 120, 140, 260] {
        let A = bending(n);
        let (values, V) = sym_eigen(&A).unwrap();
        let residual = (&(&A * &V) - &(&V * &Mat::diag(&values))).norm_max() / A.norm_max();
        assert!(residual < 1e-13, "{n}: {residual:e}");
        assert!((&(&V.t() * &V) - &Mat::eye(n)).norm_max() < 1e-12, "{n}");
        assert!(values.is_sorted());
    }
}

#[test]
fn the_definite_pencil_is_solved_for_masses_of_many_decades() {
    let n = 140;
    let K = bending(n);
    let M = Mat::diag(&(0..n).map(|i| 10.0_f64.powi(3 - (i % 2) as i32 * 6)).collect::<Vec<_>>());
    let (values, V) = sym_gen_eigen(&K, &M).unwrap();
    let largest = values[n - 1];
    for j in 0..n {
        let v = Mat::col(V.column(j));
        let residual = &(&K * &v) - &(&M * &v).scale(values[j]);
        let scaled: f64 = (0..n).map(|i| (residual[(i, 0)] / M[(i, i)].sqrt()).powi(2)).sum::<f64>().sqrt();
        assert!(scaled < 1e-13 * largest, "{j}: {scaled:e}");
    }
    assert!((&(&V.t() * &(&M * &V)) - &Mat::eye(n)).norm_max() < 1e-12);
}
