//! The published collections CAREX and DAREX: residual, symmetry, spectrum, and the exact solution where it is known.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

mod common;

use common::difference;
use counterpoise_linalg::{Mat, Riccati, care, care_g, cond, dare, eigenvalues, solve};
use serde_json::Value;

/// Returns the examples of a file of the collection, which lies beside the checkout.
fn collection(name: &str) -> Vec<(String, Value)> {
    let path = format!("{}/../../shared/benchmarks/riccati/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
    let all: Value = serde_json::from_str(&text).unwrap();
    all.as_object().unwrap().iter().map(|(key, value)| (key.clone(), value.clone())).collect()
}

fn matrix(example: &Value, key: &str) -> Option<Mat> {
    let rows = example[key].as_array()?;
    let rows: Vec<Vec<f64>> =
        rows.iter().map(|r| r.as_array().unwrap().iter().map(|e| e.as_f64().unwrap()).collect()).collect();
    Some(Mat::from_rows(&rows))
}

/// The relative residual of the continuous equation in the caller's units.
fn residual(A: &Mat, G: &Mat, Q: &Mat, X: &Mat) -> f64 {
    let (AX, XGX) = (A.t() * X, X * G * X);
    (&AX + &AX.t() - &XGX + Q).norm_fro() / (2.0 * AX.norm_fro() + XGX.norm_fro() + Q.norm_fro())
}

fn report(name: &str, solution: &Riccati, residual: f64, error: Option<f64>) {
    let error = error.map_or_else(|| "-".into(), |e| format!("{e:.1e}"));
    println!("{name:12} residual {residual:.1e}, error {error}; {}", solution.certificate);
}

#[test]
fn carex() {
    for (name, example) in collection("carex.json") {
        let get = |key| matrix(&example, key).unwrap();
        let (A, B, Q, R, G) =
            (get("A"), get("B"), get("Q").symmetric_part(), get("R"), get("G").symmetric_part());
        let outcome = care(&A, &B, &Q, &R, None).unwrap();
        let solution = outcome.into_result().unwrap_or_else(|reason| panic!("{name}: {reason}"));
        // R F = B'X: the residual without an inverse of R, which is nearly singular in 2.2.
        let (AX, term) = (A.t() * &solution.X, &solution.X * &B * &solution.F);
        let size =
            (&AX + &AX.t() - &term + &Q).norm_fro() / (2.0 * AX.norm_fro() + term.norm_fro() + Q.norm_fro());
        let error = matrix(&example, "X").map(|X| difference(&solution.X, &X));
        report(&name, &solution, size, error);
        // X rounded to double leaves this residual, since the gain divides it by R.
        let rounding = f64::EPSILON * cond(&R).unwrap();
        assert!(size < rounding.max(1e-14), "{name}");
        assert_eq!(solution.X, solution.X.t(), "{name}");
        assert!(solution.closed_loop.iter().all(|l| l.re < 0.0), "{name}");
        if let Some(error) = error {
            let data = f64::EPSILON * solution.certificate.condition;
            assert!(error < data.max(1e-14), "{name}: {error:e}");
        }
        let by_g = care_g(&A, &G, &Q).unwrap().into_result().unwrap();
        // Rounding X moves X G X by this much.
        let (x, terms) = (by_g.X.norm_fro(), 2.0 * AX.norm_fro() + term.norm_fro() + Q.norm_fro());
        let rounding = 2.0 * f64::EPSILON * x * x * G.norm_fro() / terms;
        assert!(residual(&A, &G, &Q, &by_g.X) < rounding.max(1e-14), "{name}");
        let data = difference(&(&B * solve(&R, &B.t()).unwrap()), &G);
        let agreed = difference(&by_g.X, &solution.X);
        assert!(
            agreed < (data + 1e-15) * solution.certificate.condition,
            "{name}: two entries differ by {agreed:e}"
        );
    }
}

#[test]
fn darex() {
    for (name, example) in collection("darex.json") {
        let get = |key| matrix(&example, key).unwrap();
        let (A, B, Q, R, S) =
            (get("A"), get("B"), get("Q").symmetric_part(), get("R").symmetric_part(), get("S"));
        let outcome = dare(&A, &B, &Q, &R, Some(&S)).unwrap();
        let solution = outcome.into_result().unwrap_or_else(|reason| panic!("{name}: {reason}"));
        let residual = |X: &Mat| {
            let AXA = A.t() * X * &A;
            let right = B.t() * X * &A + S.t();
            let term = right.t() * solve(&(&R + &(B.t() * X * &B)), &right).unwrap();
            let size = AXA.norm_fro() + X.norm_fro() + term.norm_fro() + Q.norm_fro();
            (&AXA - X - &term + &Q).norm_fro() / size
        };
        let size = residual(&solution.X);
        // The solution printed for 1.4 does not satisfy its equation (the entry (3, 3) is -9.9, not 0).
        let printed = matrix(&example, "X").filter(|X| residual(X) < 1e-12);
        let error = printed.map(|X| difference(&solution.X, &X));
        report(&name, &solution, size, error);
        assert!(size < 1e-13, "{name}");
        let poles = eigenvalues(&(&A - &(&B * &solution.F))).unwrap();
        assert!(poles.iter().all(|l| l.norm() < 1.0 + 1e-12), "{name}");
        if let Some(error) = error {
            assert!(error < 1e-11, "{name}: {error:e}");
        }
    }
}
