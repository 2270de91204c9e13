//! Why a Riccati equation has no stabilising solution: the mode that is in the way.

use std::fmt;

use crate::boundary::Boundary;
use crate::decomposition::csingular_values;
use crate::error::ShortNumber;
use crate::mat::{C64, CMat, Mat};
use crate::schur::eigenvalues;
use crate::spectrum::Reach;
use crate::sylvester::Kind;
use crate::tolerance::{
    AXIS_NEIGHBOUR, AXIS_REAL_PART, AXIS_ROUNDING, EPS, EXACT_MODE_STATES, HAMILTONIAN_BOUNDARY,
    LARGEST_FEEDBACK, LOST_MODE, MODE_CANDIDATES, PRECISE_STATES,
};

use super::modes::{Mode, Modes};
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
        /// Distance from the boundary, relative to the norm of the matrix.
        distance: f64,
    },
    /// The stable subspace exists but gives no finite solution.
    NoGraph,
    /// `R` (in discrete time `R + B'XB`) is singular.
    SingularWeight {
        /// Reciprocal condition number.
        rcond: f64,
    },
    /// An approximation was found, and it is not good enough to be handed over.
    Inaccurate {
        /// Relative residual.
        residual: f64,
        /// The largest real part (modulus in discrete time) of its closed loop.
        stability: f64,
        /// Of the modes that are not stable the one that the input reaches least, and its relative distance from reach.
        hardest: Option<(C64, f64)>,
    },
}

impl std::error::Error for Reason {}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Uncontrollable { mode, distance } => {
                write!(f, "the mode {} is not stable and the input does not reach it", Eigenvalue(*mode))?;
                write!(f, " (relative distance from reach {distance:.1e})")
            }
            Self::Unobservable { mode, distance } => {
                write!(
                    f,
                    "the mode {} lies on the stability boundary and the cost does not see it",
                    Eigenvalue(*mode)
                )?;
                write!(f, " (relative distance from sight {distance:.1e})")
            }
            Self::OnBoundary { eigenvalue, distance } => {
                write!(
                    f,
                    "the Hamiltonian has the eigenvalue {} on the stability boundary",
                    Eigenvalue(*eigenvalue)
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
                let Some((mode, reach)) = hardest else {
                    return f.write_str("; the equation is too sensitive for double precision");
                };
                write!(f, "; the mode {} is not stable and the input hardly reaches it", Eigenvalue(*mode))?;
                write!(f, " (relative distance from reach {reach:.1e})")
            }
        }
    }
}

/// An eigenvalue as an engineer reads it.
struct Eigenvalue(C64);

impl fmt::Display for Eigenvalue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let part = |x: f64| ShortNumber(C64::new(x, 0.0));
        if self.0.im == 0.0 {
            return part(self.0.re).fmt(f);
        }
        write!(f, "{} +/- {}j", part(self.0.re), part(self.0.im.abs()))
    }
}

/// The modes that count as on the stability boundary.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Nearness {
    /// Those that rounding the entries of `A` may move there: to judge a problem that has been solved.
    Rounding,
    /// Those within [`HAMILTONIAN_BOUNDARY`] of it, relative to the norm of `A`: to explain why a problem could not be solved.
    Broad,
}

/// Returns the mode in the way: one that is not safely stable and that the input does not reach, or one on the boundary
/// that the cost does not see.
pub(super) fn lost_mode(modes: &Modes, nearness: Nearness) -> Option<Reason> {
    let (Problem { A, G, Q }, kind) = (modes.problem, modes.kind);
    let n = A.nrows() as f64;
    let broad = HAMILTONIAN_BOUNDARY * boundary_scale(A.norm_fro(), kind);
    let near = |mode: Mode| match nearness {
        Nearness::Broad => broad,
        Nearness::Rounding => mode.rounding_error(),
    };
    let candidates: Vec<Mode> = modes.all().filter(|m| excess(m.value(), kind) > -near(*m)).collect();
    let reached = least(candidates.iter().map(|m| m.reachability()), |mode| distance(A, G, mode), A.nrows());
    if let Some((mode, reach)) = reached.filter(|(_, reach)| *reach < n * LOST_MODE) {
        return Some(Reason::Uncontrollable { mode, distance: reach });
    }
    let candidates: Vec<Mode> = modes.all().filter(|m| excess(m.value(), kind).abs() < near(*m)).collect();
    let seen =
        least(candidates.iter().map(|m| m.observability()), |mode| distance(&A.t(), Q, mode), A.nrows());
    let (mode, sight) = seen.filter(|(_, sight)| *sight < n * LOST_MODE)?;
    Some(Reason::Unobservable { mode, distance: sight })
}

/// Returns a mode that is not stable and that the input does not reach for certain: not normwise, and not entry by entry.
pub(super) fn certainly_lost(modes: &Modes) -> Option<Reason> {
    let n = modes.problem.A.nrows() as f64;
    let unstable = modes.all().filter(|m| excess(m.value(), modes.kind) >= 0.0);
    let mut reaches = unstable.map(Mode::reachability);
    let lost = reaches.find(|reach| reach.normwise.max(reach.entrywise) < n * LOST_MODE)?;
    // The normwise distance of a mode at the end of the range of doubles is not known.
    let distance = if lost.normwise.is_nan() { lost.entrywise } else { lost.normwise };
    Some(Reason::Uncontrollable { mode: lost.mode, distance })
}

/// Returns why a continuous problem has no solution for certain: a mode out of reach; of a large problem, which is not solved in more
/// digits, also a mode on the boundary that the cost does not see, or a Hamiltonian matrix with an eigenvalue there. The last question takes as
/// long as a solution and is not asked if the approximation `X` is beyond doubles anyway.
pub(super) fn certainly_unsolvable(modes: &Modes, X: &Mat) -> Option<Reason> {
    let lost = certainly_lost(modes);
    if lost.is_some() || modes.problem.A.nrows() <= PRECISE_STATES {
        return lost;
    }
    let unseen = certainly_unseen(modes);
    if unseen.is_some() || is_beyond_doubles(X, modes) {
        return unseen;
    }
    certainly_on_boundary(modes.problem)
}

/// Returns a mode that lies on the imaginary axis as far as the entries of `A` say, and that the cost does not see for certain.
fn certainly_unseen(modes: &Modes) -> Option<Reason> {
    let n = modes.problem.A.nrows() as f64;
    let sights = modes.modes_on_boundary(Boundary::ImaginaryAxis).into_iter().map(Mode::observability);
    let mut unseen = sights.filter(|sight| sight.normwise.max(sight.entrywise) < n * LOST_MODE);
    unseen.next().map(|sight| Reason::Unobservable { mode: sight.mode, distance: sight.normwise })
}

/// Returns whether an approximation that Newton's method could not follow is larger than doubles can tell from infinity: what is left of the stable
/// subspace's upper half, which every other method in doubles inverts, is then rounding.
pub(super) fn is_beyond_doubles(first: &Mat, modes: &Modes) -> bool {
    let feedback = first.norm_fro() * modes.problem.G.norm_fro();
    feedback * EPS > boundary_scale(modes.problem.A.norm_fro(), modes.kind)
}

/// Returns whether an approximation is so large that it may be what rounding makes of a mode out of reach.
pub(super) fn is_suspicious(first: &Mat, modes: &Modes) -> bool {
    let feedback = first.norm_fro() * modes.problem.G.norm_fro();
    feedback > LARGEST_FEEDBACK * boundary_scale(modes.problem.A.norm_fro(), modes.kind)
}

/// Of the modes that are not stable the one that the input reaches least, and its relative distance from reach.
pub(super) fn hardest_mode(modes: &Modes) -> Option<(C64, f64)> {
    let Problem { A, G, .. } = modes.problem;
    let candidates: Vec<Mode> = modes.all().filter(|m| excess(m.value(), modes.kind) >= 0.0).collect();
    least(candidates.iter().map(|m| m.reachability()), |mode| distance(A, G, mode), A.nrows())
}

/// The mode that is reached (or seen) least, and its relative distance from reach, which a small problem's best candidates have by
/// `exact`.
fn least<'a>(
    reaches: impl Iterator<Item = &'a Reach>,
    exact: impl Fn(C64) -> f64,
    states: usize,
) -> Option<(C64, f64)> {
    let mut list: Vec<(C64, f64)> = reaches.map(|reach| (reach.mode, reach.normwise)).collect();
    list.sort_by(|a, b| a.1.total_cmp(&b.1));
    if states <= EXACT_MODE_STATES {
        list.truncate(MODE_CANDIDATES);
        list.iter_mut().for_each(|(mode, reach)| *reach = exact(*mode));
    }
    list.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Returns how far beyond the stability boundary an eigenvalue lies.
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

/// The facts that are known of the eigenvalue of the Hamiltonian matrix nearest to the boundary of stability.
#[derive(Clone, Copy)]
pub(super) enum NearestEigenvalue {
    /// It has not been computed.
    Unknown,
    /// The value.
    Known(C64),
    /// It is not what is in the way.
    Immaterial,
}

/// Returns why a problem that was not solved has no solution.
pub(super) fn diagnose(modes: &Modes, known: NearestEigenvalue) -> Option<Reason> {
    if let Some(reason) = lost_mode(modes, Nearness::Broad) {
        return Some(reason);
    }
    if modes.kind == Kind::Discrete {
        return None;
    }
    let H = hamiltonian(modes.problem);
    let size = H.norm_fro();
    let computed = || eigenvalues(&H).ok()?.into_iter().min_by(|a, b| a.re.abs().total_cmp(&b.re.abs()));
    let nearest = match known {
        NearestEigenvalue::Immaterial => return None,
        NearestEigenvalue::Known(value) => value,
        NearestEigenvalue::Unknown => computed()?,
    };
    let distance = nearest.re.abs() / size;
    (distance < HAMILTONIAN_BOUNDARY).then_some(Reason::OnBoundary { eigenvalue: nearest, distance })
}

/// Returns an eigenvalue of the Hamiltonian matrix that lies on the imaginary axis for certain.
///
/// The spectrum is symmetric to the axis. An eigenvalue beside the axis has its mirror image near, so that one without any
/// neighbour is its own mirror image.
pub(super) fn certainly_on_boundary(problem: &Problem) -> Option<Reason> {
    let H = hamiltonian(problem);
    let (values, size) = (eigenvalues(&H).ok()?, H.norm_fro());
    let rounding = AXIS_ROUNDING * size;
    let candidates =
        values.iter().enumerate().filter(|(_, l)| l.im > 0.0 && l.re.abs() < AXIS_REAL_PART * l.norm());
    let alone = |(k, l): &(usize, &C64)| {
        let others = values.iter().enumerate().filter(|(j, _)| j != k);
        let nearest = others.map(|(_, other)| (other - **l).norm()).fold(f64::INFINITY, f64::min);
        nearest > AXIS_NEIGHBOUR * l.norm() && nearest > rounding / AXIS_NEIGHBOUR
    };
    let (_, &eigenvalue) = candidates.into_iter().find(alone)?;
    Some(Reason::OnBoundary { eigenvalue, distance: eigenvalue.re.abs() / size })
}
