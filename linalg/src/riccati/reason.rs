//! Why a Riccati equation has no stabilising solution: the mode that is in the way.

use std::fmt;

use crate::decomposition::csingular_values;
use crate::mat::{C64, CMat, Mat};
use crate::schur::eigenvalues;
use crate::sylvester::Kind;

use super::scaling::Problem;
use super::subspace::hamiltonian;

/// Why there is no stabilising solution, or none that double precision can certify.
#[derive(Clone, Debug, PartialEq)]
pub enum Reason {
    /// The input does not reach a mode that is not stable.
    Uncontrollable {
        /// The eigenvalue of `A`.
        mode: C64,
        /// Relative distance of `[A - mode I, B]` from losing rank.
        distance: f64,
    },
    /// The cost does not see a mode on the stability boundary.
    Unobservable {
        /// The eigenvalue of `A`.
        mode: C64,
        /// Relative distance of `[A - mode I; Q]` from losing rank.
        distance: f64,
    },
    /// The Hamiltonian matrix (the symplectic pencil) has an eigenvalue on the stability boundary, as it happens where an
    /// H-infinity bound is below what can be reached.
    OnBoundary {
        /// The eigenvalue, up to rounding.
        eigenvalue: C64,
        /// Its distance from the boundary, relative to the norm of the matrix.
        distance: f64,
    },
    /// The stable subspace exists but gives no finite solution.
    NoGraph,
    /// `R` (in discrete time `R + B'XB`) is singular.
    SingularWeight {
        /// Its reciprocal condition number.
        rcond: f64,
    },
    /// An approximation was found, and it is not good enough to be handed over.
    Inaccurate {
        /// Its relative residual.
        residual: f64,
        /// The largest real part (modulus in discrete time) of its closed loop.
        stability: f64,
        /// Of the modes that are not stable the one that the input reaches least, and its relative distance from reach.
        hardest: Option<(C64, f64)>,
    },
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Uncontrollable { mode, distance } => {
                write!(f, "the mode {} is not stable and the input does not reach it", Mode(*mode))?;
                write!(f, " (relative distance from reach {distance:.1e})")
            }
            Self::Unobservable { mode, distance } => {
                write!(
                    f,
                    "the mode {} lies on the stability boundary and the cost does not see it",
                    Mode(*mode)
                )?;
                write!(f, " (relative distance from sight {distance:.1e})")
            }
            Self::OnBoundary { eigenvalue, distance } => {
                write!(
                    f,
                    "the Hamiltonian has the eigenvalue {} on the stability boundary",
                    Mode(*eigenvalue)
                )?;
                write!(f, " (relative distance {distance:.1e}): no stabilising solution")
            }
            Self::NoGraph => f.write_str("the stable subspace gives no finite solution"),
            Self::SingularWeight { rcond } => {
                write!(f, "the weight of the input is singular (reciprocal condition {rcond:.1e})")
            }
            Self::Inaccurate { residual, stability, hardest } => {
                write!(f, "no solution could be certified: relative residual {residual:.1e},")?;
                write!(f, " closed loop reaches {stability:.3e}")?;
                let Some((mode, reach)) = hardest else { return Ok(()) };
                write!(f, "; the mode {} is not stable and the input hardly reaches it", Mode(*mode))?;
                write!(f, " (relative distance from reach {reach:.1e})")
            }
        }
    }
}

/// An eigenvalue as an engineer reads it.
struct Mode(C64);

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.im == 0.0 {
            return write!(f, "{:.6}", self.0.re);
        }
        write!(f, "{:.6} +/- {:.6}j", self.0.re, self.0.im.abs())
    }
}

/// A mode is lost where its distance from reach or sight is below this, relative to the matrices.
const LOST: f64 = 1e-13;

/// An eigenvalue of the Hamiltonian counts as on the boundary within this, relative to its norm: the square root of the
/// rounding error, since a double eigenvalue on the boundary splits by that much.
const BOUNDARY: f64 = 1e-8;

/// Modes that could be in the way: those of `A` that are not safely stable. Returns the first one that the input does
/// not reach, or that lies on the boundary unseen.
pub(super) fn lost_mode(problem: &Problem, kind: Kind) -> Option<Reason> {
    let modes = eigenvalues(&problem.A).ok()?;
    let size = problem.A.norm_fro();
    let suspects =
        modes.iter().filter(|m| m.im >= 0.0 && excess(**m, kind) > -BOUNDARY * boundary_scale(size, kind));
    suspects.filter_map(|&mode| lost(problem, mode, kind)).next()
}

/// Of the modes that are not stable the one that the input reaches least, and its relative distance from reach.
pub(super) fn hardest_mode(problem: &Problem, kind: Kind) -> Option<(C64, f64)> {
    let modes = eigenvalues(&problem.A).ok()?;
    let unstable = modes.into_iter().filter(|m| m.im >= 0.0 && excess(*m, kind) >= 0.0);
    unstable.map(|m| (m, distance(&problem.A, &problem.G, m))).min_by(|a, b| a.1.total_cmp(&b.1))
}

fn lost(problem: &Problem, mode: C64, kind: Kind) -> Option<Reason> {
    let n = problem.A.nrows() as f64;
    let reach = distance(&problem.A, &problem.G, mode);
    if reach < n * LOST {
        return Some(Reason::Uncontrollable { mode, distance: reach });
    }
    let sight = distance(&problem.A.t(), &problem.Q, mode);
    let near = excess(mode, kind).abs() < BOUNDARY * boundary_scale(problem.A.norm_fro(), kind);
    (near && sight < n * LOST).then_some(Reason::Unobservable { mode, distance: sight })
}

/// How far beyond the stability boundary an eigenvalue lies.
pub(super) fn excess(eigenvalue: C64, kind: Kind) -> f64 {
    match kind {
        Kind::Continuous => eigenvalue.re,
        Kind::Discrete => eigenvalue.norm() - 1.0,
    }
}

fn boundary_scale(size: f64, kind: Kind) -> f64 {
    if kind == Kind::Continuous { size } else { 1.0 }
}

/// The smallest singular value of `[A - mode I, M]`, relative to its largest; the columns of `M` are first made as large
/// as those of `A`, since reach does not depend on the size of the input.
fn distance(A: &Mat, M: &Mat, mode: C64) -> f64 {
    let n = A.nrows();
    let size = M.norm_fro();
    let factor = if size > 0.0 { A.norm_fro().max(mode.norm()) / size } else { 0.0 };
    let pencil = CMat::from_fn(n, 2 * n, |i, j| {
        if j >= n {
            return C64::new(factor * M[(i, j - n)], 0.0);
        }
        C64::new(A[(i, j)], 0.0) - if i == j { mode } else { C64::new(0.0, 0.0) }
    });
    match csingular_values(&pencil) {
        Ok(s) if s[0] > 0.0 => s[n - 1] / s[0],
        Ok(_) => 0.0,
        Err(_) => f64::INFINITY,
    }
}

/// Why a continuous problem that was not solved has no solution.
pub(super) fn diagnose(problem: &Problem) -> Option<Reason> {
    if let Some(reason) = lost_mode(problem, Kind::Continuous) {
        return Some(reason);
    }
    let H = hamiltonian(problem);
    let size = H.norm_fro();
    let nearest = eigenvalues(&H).ok()?.into_iter().min_by(|a, b| a.re.abs().total_cmp(&b.re.abs()))?;
    let distance = nearest.re.abs() / size;
    (distance < BOUNDARY).then_some(Reason::OnBoundary { eigenvalue: nearest, distance })
}
