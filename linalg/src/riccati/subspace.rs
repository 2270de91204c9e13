//! The stable invariant subspace of the Hamiltonian matrix, by an ordered Schur form.
//!
//! Source: Laub, A Schur method for solving algebraic Riccati equations, IEEE Trans. Automat. Control 24 (1979).

use crate::decomposition::rcond_one;
use crate::dense::solve;
use crate::error::Error;
use crate::mat::{C64, Mat};
use crate::schur::{Schur, schur};

use super::scaling::Problem;

/// The result of the ordered Schur form of the Hamiltonian matrix.
#[derive(Default)]
pub(super) struct SchurStart {
    /// A first approximation of the stabilising solution; `None` if the subspace does not have the right dimension or is no graph.
    pub(super) first: Option<Mat>,
    /// The eigenvalue nearest to the imaginary axis.
    pub(super) nearest: Option<C64>,
}

/// Returns a first approximation of the stabilising solution, and the eigenvalue that is in the way if there is none.
pub(super) fn solve_by_schur(problem: &Problem) -> SchurStart {
    let Ok(form) = schur(&hamiltonian(problem)) else { return SchurStart::default() };
    let nearest = form.eigenvalues().into_iter().min_by(|a, b| a.re.abs().total_cmp(&b.re.abs()));
    SchurStart { first: stable_graph(form), nearest }
}

/// The same for the discrete equation, whose symplectic pencil a Cayley transform makes Hamiltonian.
pub(super) fn solve_by_discrete_schur(problem: &Problem) -> Option<Mat> {
    let Problem { A, G, Q } = problem;
    let identity = Mat::eye(A.nrows());
    let plus = Mat::from_blocks(&[&[&(A + &identity), G], &[&-Q, &(&identity + &A.t())]]);
    let minus = Mat::from_blocks(&[&[&(A - &identity), &-G], &[&-Q, &(&identity - &A.t())]]);
    let (direct, turned) = (rcond_one(&plus), rcond_one(&minus));
    let H = if direct >= turned { solve(&plus, &minus) } else { solve(&minus, &plus) };
    stable_graph(schur(&H.ok()?).ok()?)
}

fn stable_graph(mut form: Schur) -> Option<Mat> {
    let n = form.T.nrows() / 2;
    let count = form.reorder(|l| l.re < 0.0).ok()?;
    if count != n {
        return None;
    }
    solution_from_subspace(&form.U, n).ok()
}

/// `[A -G; -Q -A']`.
pub(super) fn hamiltonian(problem: &Problem) -> Mat {
    let Problem { A, G, Q } = problem;
    Mat::from_blocks(&[&[A, &-G], &[&-Q, &-A.t()]])
}

/// `U2 U1^-1` of the leading columns `[U1; U2]`, made symmetric.
pub(super) fn solution_from_subspace(U: &Mat, n: usize) -> Result<Mat, Error> {
    let (upper, lower) = (U.block(0, 0, n, n), U.block(n, 0, n, n));
    let X = solve(&upper.t(), &lower.t())?;
    Ok(X.symmetric_part())
}
