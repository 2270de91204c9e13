//! Algebraic Riccati equations, continuous and discrete, each answer with its certificate.
//!
//! The road: fold the cross term away, scale by powers of two, solve (ordered Schur form of the Hamiltonian for small
//! problems, structured doubling for large ones, each the fallback of the other), refine by Newton steps whose residual
//! is computed in twice the working precision, certify, and either hand over or say which mode is in the way.

mod certificate;
mod continuous_equation;
mod decision;
mod discrete_equation;
mod doubling;
mod equation;
mod long_solution;
mod modes;
mod newton;
mod reason;
mod scaling;
mod subspace;

use std::fmt;

use crate::mat::{C64, Mat};
use crate::tolerance::{EPS, SENSITIVE};

pub use continuous_equation::{care, care_g};
pub use discrete_equation::dare;
pub use reason::Reason;

/// Outcome of a problem: a solution, or the reason why there is none.
#[derive(Clone, Debug)]
pub enum Outcome<T> {
    /// The solution.
    Solved(T),
    /// There is none, or none that double precision can certify.
    Infeasible(Reason),
}

impl<T> Outcome<T> {
    /// Returns the solution, if there is one.
    pub fn solution(self) -> Option<T> {
        match self {
            Self::Solved(solution) => Some(solution),
            Self::Infeasible(_) => None,
        }
    }

    /// Returns the solution as a `Result`, for callers to whom a missing solution is the end.
    ///
    /// # Errors
    /// The reason why there is none.
    pub fn into_result(self) -> Result<T, Reason> {
        match self {
            Self::Solved(solution) => Ok(solution),
            Self::Infeasible(reason) => Err(reason),
        }
    }

    /// The outcome with `change` applied to the solution, which may fail.
    pub(crate) fn try_map<U, E>(self, change: impl FnOnce(T) -> Result<U, E>) -> Result<Outcome<U>, E> {
        match self {
            Self::Solved(solution) => change(solution).map(Outcome::Solved),
            Self::Infeasible(reason) => Ok(Outcome::Infeasible(reason)),
        }
    }

    /// Returns the outcome with `change` applied to the solution.
    pub fn map<U>(self, change: impl FnOnce(T) -> U) -> Outcome<U> {
        match self {
            Self::Solved(solution) => Outcome::Solved(change(solution)),
            Self::Infeasible(reason) => Outcome::Infeasible(reason),
        }
    }
}

/// The stabilising solution of a Riccati equation.
#[derive(Clone, Debug)]
pub struct Riccati {
    /// The symmetric solution, n x n.
    pub X: Mat,
    /// The gain, m x n: `R^-1 (B'X + S')`, or `(R + B'XB)^-1 (B'XA + S')` in discrete time. For [`care_g`], which knows
    /// no input, `G X`.
    pub F: Mat,
    /// The eigenvalues of `A - B F` (of `A - G X`), sorted by real part.
    pub closed_loop: Vec<C64>,
    /// Certificate of the solution.
    pub certificate: RiccatiCertificate,
}

/// The evidence that a Riccati solution is one.
///
/// `residual_norm`, `term_norm`, `forward_error` and `data_error` are in the caller's units, and `condition` does not depend on
/// units; all can be recomputed from the data, from `X` and from `F`. With `L(H) = (A-BF)'H + H(A-BF)` (discrete:
/// `(A-BF)'H(A-BF) - H`) and moduli entry by entry, `data_error = eps |L^-1(M)|`, where
///
/// ```text
///   M = |A|'|X| + |X||A| + |Q| + |F|'|R||F| + |S||F| + |F|'|S|'                                      continuous
///   M = |A|'|X| + |X||A| + |Q| + |X||G||X|                                                           care_g
///   M = N + N' + |Q| + |F|'|R||F| + |S||F| + |F|'|S|',   N = |A-BF|'|X|(|A| + |B||F|)                discrete
/// ```
///
/// The other figures refer to the problem scaled by `scale`, in which norms over states of different kinds mean something:
/// `A_ij scale_j / scale_i`, `Q_ij scale_i scale_j`, `X_ij scale_i scale_j`.
#[derive(Clone, Debug)]
pub struct RiccatiCertificate {
    /// `norm(residual)` over the sum of the norms of the equation's terms, Frobenius, with `X` as it is returned.
    pub relative_residual: f64,
    /// `norm(residual)` over `norm(Q) + 2 norm(A) norm(X) + norm(G) norm(X)^2`: a few eps means that doubles can hold no
    /// better `X`, even where the relative residual is larger because the terms are small against their factors.
    pub backward_error: f64,
    /// `norm(X - X') / norm(X)`.
    pub symmetry: f64,
    /// Separation of the closed loop from its mirror image: the norm of the inverse Lyapunov operator, inverted
    /// (continuous `A'H + HA`, discrete `A'HA - H`). Small: the solution is sensitive.
    pub separation: f64,
    /// Condition number: the largest entry of `data_error / eps`, each over `sqrt(|x_ii x_jj|)`. A change of every entry of the
    /// data by a share e changes `x_ij` by at most `condition e sqrt(|x_ii x_jj|)` to first order.
    pub condition: f64,
    /// Change of each entry of `X` due to a change of every entry of the data by a share of eps (2^-52), n x n, to first order.
    pub data_error: Mat,
    /// An estimate of the modulus of the error of each entry of `X`, n x n, for the data taken as exact: the Newton step that is left.
    pub forward_error: Mat,
    /// Frobenius norm of the residual of `X` as it is returned.
    pub residual_norm: f64,
    /// Sum of the Frobenius norms of the equation's terms.
    pub term_norm: f64,
    /// The factors of the states, powers of two, in whose units the equation was solved.
    pub scale: Vec<f64>,
    /// Method that gave the first approximation.
    pub method: RiccatiMethod,
    /// Number of Newton steps that refined it.
    pub newton_steps: usize,
}

impl RiccatiCertificate {
    /// Makes figures infinite that could not be computed because a number on the way left the range of doubles: nothing is known of them.
    pub(crate) fn bound_unknown(&mut self) {
        let bounded = |x: f64| if x.is_nan() { f64::INFINITY } else { x };
        self.data_error = self.data_error.map(bounded);
        self.forward_error = self.forward_error.map(bounded);
        self.separation = if self.separation.is_nan() { 0.0 } else { self.separation };
        for figure in [
            &mut self.relative_residual,
            &mut self.backward_error,
            &mut self.symmetry,
            &mut self.condition,
            &mut self.residual_norm,
            &mut self.term_norm,
        ] {
            *figure = bounded(*figure);
        }
    }

    /// Returns whether rounding the data, or the residual, may change the third digit of the solution or an earlier one: the
    /// condition number times the larger of the two exceeds [`SENSITIVE`].
    pub fn is_sensitive(&self) -> bool {
        self.condition * self.relative_residual.max(EPS) > SENSITIVE
    }
}

/// The method behind a Riccati solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RiccatiMethod {
    /// Ordered real Schur form of the Hamiltonian matrix (Laub 1979) or of the symplectic pencil.
    Schur,
    /// Structure-preserving doubling (Chu, Fan and Lin 2005).
    Doubling,
    /// Structured doubling and Newton's method in 32 digits, used when doubles do not settle the problem.
    Precise,
}

impl fmt::Display for RiccatiMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Schur => "ordered Schur form",
            Self::Doubling => "structured doubling",
            Self::Precise => "structured doubling in 32 digits",
        })
    }
}

impl fmt::Display for RiccatiCertificate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "residual {:.1e}, separation {:.1e}, condition {:.1e}, {} and {} Newton step(s)",
            self.relative_residual, self.separation, self.condition, self.method, self.newton_steps
        )
    }
}
