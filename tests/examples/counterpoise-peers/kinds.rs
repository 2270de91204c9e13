//! The problem that is solved for each kind.
#![allow(non_snake_case)]

use std::path::Path;

use counterpoise_linalg::{Mat, care, lyap};
use counterpoise_lti::{Discretisation, StateSpace, Timebase, c2d, frequency_response};
use counterpoise_reduce::{BalancedSystem, Method};
use counterpoise_synth::{GeneralisedPlant, h2syn, hinfsyn};

use crate::files;

/// Named matrices.
pub type Answer = Vec<(&'static str, Mat)>;

/// The matrices and settings of one problem.
pub struct Problem {
    A: Mat,
    B1: Mat,
    B2: Mat,
    Q: Mat,
    R: Mat,
    /// Frequencies in rad/s, one column.
    rates: Mat,
    plant: StateSpace,
    generalised: GeneralisedPlant,
    meta: serde_json::Value,
}

impl Problem {
    /// Reads the folder of a problem.
    pub fn read(folder: &Path) -> Self {
        let matrix = |name: &str| files::read(&folder.join(format!("{name}.mtx")));
        let [A, B1, B2, C1, C2, D12, D21] = ["A", "B1", "B2", "C1", "C2", "D12", "D21"].map(matrix);
        let meta = std::fs::read_to_string(folder.join("meta.json")).expect("meta.json");
        Self {
            plant: system(&A, &B2, &C2, Mat::zeros(C2.nrows(), B2.ncols())),
            generalised: generalised_plant(&A, (&B1, &B2), (&C1, &C2), (&D12, &D21)),
            A,
            B1,
            B2,
            Q: matrix("Q").symmetric_part(),
            R: matrix("R"),
            rates: matrix("w"),
            meta: serde_json::from_str(&meta).expect("JSON"),
        }
    }

    fn setting(&self, key: &str) -> f64 {
        self.meta[key].as_f64().unwrap_or_else(|| panic!("meta.json has no {key}"))
    }
}

/// The generalised plant, without direct paths from disturbance to cost and from control to measurement.
fn generalised_plant(
    A: &Mat,
    (B1, B2): (&Mat, &Mat),
    (C1, C2): (&Mat, &Mat),
    (D12, D21): (&Mat, &Mat),
) -> GeneralisedPlant {
    let D11 = Mat::zeros(C1.nrows(), B1.ncols());
    let D22 = Mat::zeros(C2.nrows(), B2.ncols());
    let D = Mat::from_blocks(&[&[&D11, D12], &[D21, &D22]]);
    let system = system(A, &B1.hstack(B2), &C1.vstack(C2), D);
    GeneralisedPlant::new(system, B2.ncols(), C2.nrows()).expect("shapes that fit")
}

fn system(A: &Mat, B: &Mat, C: &Mat, D: Mat) -> StateSpace {
    StateSpace::new(A.clone(), B.clone(), C.clone(), D, Timebase::Continuous).expect("shapes that fit")
}

fn text(why: impl std::fmt::Display) -> String {
    why.to_string()
}

/// The solver of a kind.
pub fn solver(kind: &str) -> fn(&Problem) -> Result<Answer, String> {
    match kind {
        "care" => |p| {
            let outcome = care(&p.A, &p.B2, &p.Q, &p.R, None).map_err(text)?;
            Ok(vec![("X", outcome.into_result().map_err(text)?.X)])
        },
        "lyap" => |p| Ok(vec![("X", lyap(&p.A, &(&p.B1 * p.B1.t()).symmetric_part()).map_err(text)?)]),
        "zoh" => |p| sampled_plant(p, Discretisation::ZeroOrderHold),
        "tustin" => |p| sampled_plant(p, Discretisation::Tustin { prewarp_rad_s: None }),
        "h2" => |p| {
            let solution = h2syn(&p.generalised).map_err(text)?;
            Ok(controller(solution.controller))
        },
        "hinf" => |p| {
            let solution = hinfsyn(&p.generalised, HINF_TOLERANCE).map_err(text)?;
            let mut answer = controller(solution.controller);
            answer.push(("gam", Mat::eye(1).scale(solution.bound)));
            Ok(answer)
        },
        "bt" => reduced_plant,
        "freq" => response,
        other => panic!("unknown kind {other}"),
    }
}

/// Relative accuracy asked of the H-infinity bound, as of the peers.
const HINF_TOLERANCE: f64 = 1e-3;

fn controller(K: StateSpace) -> Answer {
    vec![("Ak", K.A), ("Bk", K.B), ("Ck", K.C), ("Dk", K.D)]
}

fn sampled_plant(p: &Problem, method: Discretisation) -> Result<Answer, String> {
    let G = c2d(&p.plant, p.setting("Ts"), method).map_err(text)?;
    Ok(vec![("Ad", G.A), ("Bd", G.B), ("Cd", G.C), ("Dd", G.D)])
}

fn reduced_plant(p: &Problem) -> Result<Answer, String> {
    let order = p.setting("bt_order") as usize;
    // Of 400 states of `rand` fewer than the order asked for carry anything above rounding.
    let shortened = |b: BalancedSystem| b.reduce(order.min(b.numerical_order()), Method::SquareRoot);
    let G = BalancedSystem::of(&p.plant).and_then(shortened).map_err(text)?;
    Ok(vec![("Ar", G.A), ("Br", G.B), ("Cr", G.C), ("Dr", G.D)])
}

/// One row a frequency, the entries of the response column by column. The frequencies are read, not computed again: at a
/// resonance of quality 100 the last bits of a logarithmic grid show as 2e-13 of the response.
fn response(p: &Problem) -> Result<Answer, String> {
    let rates = p.rates.as_slice();
    let G = frequency_response(&p.plant, rates).map_err(text)?;
    let width = p.plant.outputs() * p.plant.inputs();
    let re = Mat::from_fn(rates.len(), width, |i, j| G[i].as_slice()[j].re);
    let im = Mat::from_fn(rates.len(), width, |i, j| G[i].as_slice()[j].im);
    Ok(vec![("Hre", re), ("Him", im)])
}
