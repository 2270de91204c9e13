//! What is solved for each kind.
#![allow(non_snake_case)]

use std::path::Path;

use counterpoise_linalg::{Mat, care, lyap};
use counterpoise_lti::{Discretisation, StateSpace, Timebase, c2d, frequency_response};
use counterpoise_reduce::{Balanced, Method};
use counterpoise_synth::{Generalised, Outcome, h2syn, hinfsyn};

use crate::files;

/// Named matrices.
pub type Answer = Vec<(&'static str, Mat)>;

/// The matrices and settings of one problem.
pub struct Problem {
    A: Mat,
    B1: Mat,
    B2: Mat,
    C1: Mat,
    C2: Mat,
    D12: Mat,
    D21: Mat,
    Q: Mat,
    R: Mat,
    meta: serde_json::Value,
}

impl Problem {
    /// Reads the folder of a problem.
    pub fn read(folder: &Path) -> Self {
        let matrix = |name: &str| files::read(&folder.join(format!("{name}.mtx")));
        let meta = std::fs::read_to_string(folder.join("meta.json")).expect("meta.json");
        Self {
            A: matrix("A"),
            B1: matrix("B1"),
            B2: matrix("B2"),
            C1: matrix("C1"),
            C2: matrix("C2"),
            D12: matrix("D12"),
            D21: matrix("D21"),
            Q: matrix("Q").symmetric_part(),
            R: matrix("R"),
            meta: serde_json::from_str(&meta).expect("JSON"),
        }
    }

    fn setting(&self, key: &str) -> f64 {
        self.meta[key].as_f64().unwrap_or_else(|| panic!("meta.json has no {key}"))
    }

    /// From the control to the measurement.
    fn plant(&self) -> StateSpace {
        let D = Mat::zeros(self.C2.nrows(), self.B2.ncols());
        system(&self.A, &self.B2, &self.C2, D)
    }

    fn generalised(&self) -> Result<Generalised, String> {
        let B = self.B1.hstack(&self.B2);
        let C = self.C1.vstack(&self.C2);
        let D11 = Mat::zeros(self.C1.nrows(), self.B1.ncols());
        let D22 = Mat::zeros(self.C2.nrows(), self.B2.ncols());
        let D = Mat::from_blocks(&[&[&D11, &self.D12], &[&self.D21, &D22]]);
        let system = system(&self.A, &B, &C, D);
        Generalised::new(system, self.B2.ncols(), self.C2.nrows()).map_err(text)
    }
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
        "zoh" => |p| sampled(p, Discretisation::ZeroOrderHold),
        "tustin" => |p| sampled(p, Discretisation::Tustin { prewarp_rad_s: None }),
        "h2" => |p| {
            let solution = solved(h2syn(&p.generalised()?).map_err(text)?)?;
            Ok(controller(solution.controller))
        },
        "hinf" => |p| {
            let solution = solved(hinfsyn(&p.generalised()?, HINF_TOLERANCE).map_err(text)?)?;
            let mut answer = controller(solution.controller);
            answer.push(("gam", Mat::eye(1).scale(solution.bound)));
            Ok(answer)
        },
        "bt" => reduced,
        "freq" => response,
        other => panic!("unknown kind {other}"),
    }
}

/// Relative accuracy asked of the H-infinity bound, as of the peers.
const HINF_TOLERANCE: f64 = 1e-3;

fn solved<T>(outcome: Outcome<T>) -> Result<T, String> {
    let why: Vec<String> = outcome.findings().iter().map(text).collect();
    outcome.solved().ok_or_else(|| why.join("; "))
}

fn controller(K: StateSpace) -> Answer {
    vec![("Ak", K.A), ("Bk", K.B), ("Ck", K.C), ("Dk", K.D)]
}

fn sampled(p: &Problem, method: Discretisation) -> Result<Answer, String> {
    let G = c2d(&p.plant(), p.setting("Ts"), method).map_err(text)?;
    Ok(vec![("Ad", G.A), ("Bd", G.B), ("Cd", G.C), ("Dd", G.D)])
}

fn reduced(p: &Problem) -> Result<Answer, String> {
    let order = p.setting("bt_order") as usize;
    let G = Balanced::of(&p.plant()).and_then(|b| b.reduce(order, Method::SquareRoot)).map_err(text)?;
    Ok(vec![("Ar", G.A), ("Br", G.B), ("Cr", G.C), ("Dr", G.D)])
}

/// One row a frequency, the entries of the response column by column.
fn response(p: &Problem) -> Result<Answer, String> {
    let (low, high) = (p.setting("wmin").log10(), p.setting("wmax").log10());
    let count = p.setting("nfreq") as usize;
    let rate = |i: usize| 10f64.powf(low + (high - low) * i as f64 / (count - 1) as f64);
    let rates: Vec<f64> = (0..count).map(rate).collect();
    let G = frequency_response(&p.plant(), &rates).map_err(text)?;
    let width = p.C2.nrows() * p.B2.ncols();
    let re = Mat::from_fn(count, width, |i, j| G[i].as_slice()[j].re);
    let im = Mat::from_fn(count, width, |i, j| G[i].as_slice()[j].im);
    Ok(vec![("Hre", re), ("Him", im)])
}
