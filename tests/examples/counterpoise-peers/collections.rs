//! The examples of the Riccati collections: A, B, Q, R and S in one folder.
#![allow(non_snake_case)]

use std::path::Path;

use counterpoise_linalg::{Mat, care, dare};

use crate::files;
use crate::kinds::Answer;

/// The data of one Riccati equation.
pub struct Equation {
    A: Mat,
    B: Mat,
    Q: Mat,
    R: Mat,
    S: Mat,
    discrete: bool,
}

impl Equation {
    /// Reads a folder; `kind` is carex or darex.
    pub fn read(kind: &str, folder: &Path) -> Self {
        let matrix = |name: &str| files::read(&folder.join(format!("{name}.mtx")));
        let (Q, R) = (matrix("Q").symmetric_part(), matrix("R").symmetric_part());
        Self { A: matrix("A"), B: matrix("B"), Q, R, S: matrix("S"), discrete: kind == "darex" }
    }

    /// The stabilising solution.
    pub fn solve(&self) -> Result<Answer, String> {
        let Self { A, B, Q, R, S, .. } = self;
        let cross = (S.norm_max() > 0.0).then_some(S);
        let outcome = if self.discrete { dare(A, B, Q, R, cross) } else { care(A, B, Q, R, cross) };
        let outcome = outcome.map_err(|why| why.to_string())?;
        Ok(vec![("X", outcome.into_result().map_err(|why| why.to_string())?.X)])
    }
}
