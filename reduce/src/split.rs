//! A system as the sum of two that share no poles: stable and the rest, slow and fast.

use crate::Error;
use crate::error::StepContext;
use crate::tolerance::{BORDER, BORDER_NORM, CLUSTER_REACH, REORDERING_SHIFT, SUSPECT_POLE};
use counterpoise_linalg as linalg;
use counterpoise_linalg::{Boundary, C64, Mat, Schur};
use counterpoise_lti::components::components;
use counterpoise_lti::scaling::balance;
use counterpoise_lti::{StateSpace, Timebase, gramian_factors, parallel};

/// `g = first + second`, no pole in common; the direct path is with the first.
#[derive(Debug, Clone, PartialEq)]
pub struct Split {
    /// The part with the wanted poles and the direct path.
    pub first: StateSpace,
    /// The part with the other poles.
    pub second: StateSpace,
}

impl Split {
    /// Returns the sum of both parts.
    ///
    /// # Errors
    /// [`Error::System`] if the parts do not fit, which those of one split do.
    pub fn sum(&self) -> Result<StateSpace, Error> {
        Ok(parallel(&self.first, &self.second)?)
    }
}

/// Returns the stable part (with the direct path) and the rest: integrators, poles on the border, unstable poles.
///
/// A pole is on the border if rounding the entries of A may have moved it from there, so that a rigid body in physical
/// coordinates, whose double pole at zero splits, is kept whole.
///
/// # Errors
/// As [`split_by`].
pub fn split_stable(g: &StateSpace) -> Result<Split, Error> {
    let (scaled, _) = balance(g);
    let form = block_schur(&scaled.A)?;
    let (boundary, timebase) = (boundary(g.timebase), g.timebase);
    let rounding = Rounding::of(&scaled.A, &form);
    let radius = cluster_radius(&scaled.A, &form, boundary)?;
    let is_stable = |pole: C64| {
        let border = match timebase {
            Timebase::Continuous => BORDER * pole.norm() + BORDER_NORM * rounding.size(pole),
            Timebase::Discrete { .. } => BORDER,
        };
        boundary.excess(pole) < -border && boundary.excess(pole) < -radius
    };
    let near = |pole: C64| boundary.excess(pole).abs() < SUSPECT_POLE * scaled.A.norm_fro().max(1.0);
    let is_suspect = form.eigenvalues().into_iter().any(near);
    let is_whole = form.eigenvalues().into_iter().all(is_stable);
    // A rotation rounds the damping of light modes and splits multiple ones: a system that is stable as a whole keeps its entries.
    if is_whole || (is_suspect && is_lightly_damped(&scaled, &form)?) {
        let rest = Mat::zeros(scaled.outputs(), scaled.inputs());
        return Ok(Split { second: StateSpace::gain(rest, timebase)?, first: scaled });
    }
    split_form(scaled, form, is_stable)
}

/// Returns whether all modes of a system are stable although doubles do not tell: none lies on the boundary as far as the entries of A can tell, and
/// the Gramians, in 32 digits if need be, exist.
fn is_lightly_damped(g: &StateSpace, form: &Schur) -> Result<bool, Error> {
    let boundary = boundary(g.timebase);
    let close = SUSPECT_POLE * g.A.norm_fro().max(1.0);
    if form.eigenvalues().into_iter().any(|pole| boundary.excess(pole) >= close) {
        return Ok(false);
    }
    let found = linalg::boundary_eigenvalues(&g.A, boundary).with_step("splitting")?;
    Ok(found.is_empty() && gramian_factors(g).is_ok())
}

/// The size of the numbers from which each pole is computed.
struct Rounding {
    poles: Vec<(C64, f64)>,
}

impl Rounding {
    /// Returns the sizes of the poles of a block Schur form: a group of states that act on each other owes its poles to its own entries, however
    /// large those of another group are.
    fn of(A: &Mat, form: &Schur) -> Self {
        let size = |group: &Vec<usize>| vec![A.select(group, group).norm_max(); group.len()];
        let sizes = components(A).iter().flat_map(size).collect::<Vec<f64>>();
        Self { poles: form.eigenvalues().into_iter().zip(sizes).collect() }
    }

    /// Returns the size that belongs to a pole, which reordering may have moved by rounding.
    fn size(&self, pole: C64) -> f64 {
        let distance = |known: &C64| (known - pole).norm();
        let nearest = self.poles.iter().min_by(|a, b| distance(&a.0).total_cmp(&distance(&b.0)));
        nearest.map_or(0.0, |known| known.1)
    }
}

/// Returns the boundary of stability in a timebase.
fn boundary(timebase: Timebase) -> Boundary {
    match timebase {
        Timebase::Continuous => Boundary::ImaginaryAxis,
        Timebase::Discrete { .. } => Boundary::UnitCircle,
    }
}

/// Returns how far poles that belong on the boundary may lie beside it.
fn cluster_radius(A: &Mat, form: &Schur, boundary: Boundary) -> Result<f64, Error> {
    let close = SUSPECT_POLE * A.norm_fro().max(1.0);
    let is_suspect = |pole: C64| boundary.excess(pole) != 0.0 && boundary.excess(pole).abs() < close;
    if !form.eigenvalues().into_iter().any(is_suspect) {
        return Ok(0.0);
    }
    let found = linalg::boundary_eigenvalues(A, boundary).with_step("splitting")?;
    // Another computation of the same eigenvalues splits a double one otherwise: as many of these as there are of those belong there.
    let mut rest: Vec<C64> =
        form.eigenvalues().into_iter().filter(|pole| boundary.excess(*pole).abs() < close).collect();
    let mut radius = 0.0_f64;
    for pole in found.iter().flat_map(|p| if p.im == 0.0 { vec![*p] } else { vec![*p, p.conj()] }) {
        let distance = |k: &usize| (rest[*k] - pole).norm();
        let Some(k) = (0..rest.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))) else { break };
        radius = radius.max(boundary.excess(rest.swap_remove(k)).abs());
    }
    Ok(CLUSTER_REACH * radius)
}

/// Returns the part with the poles that `wanted` picks (asked about one of each conjugate pair), and the part with the
/// others.
///
/// Scaled, brought to Schur form group by group of states (so that an integrator's pole stays exactly zero), reordered,
/// and decoupled by a Sylvester equation.
///
/// # Errors
/// [`Error::Matrix`] if two poles, one in each part, are too close to part.
pub fn split_by(g: &StateSpace, wanted: impl Fn(C64) -> bool) -> Result<Split, Error> {
    let (g, _) = balance(g);
    let form = block_schur(&g.A)?;
    split_form(g, form, wanted)
}

/// Splits a scaled system whose Schur form is known.
fn split_form(g: StateSpace, mut form: Schur, wanted: impl Fn(C64) -> bool) -> Result<Split, Error> {
    let k = form.reorder(&wanted).with_step("splitting")?;
    snap(&mut form.T, &lone_poles(&g.A));
    let (n, m, p) = (g.order(), g.inputs(), g.outputs());
    let (T11, T22) = (form.T.block(0, 0, k, k), form.T.block(k, k, n - k, n - k));
    let T12 = form.T.block(0, k, k, n - k);
    let X = if k == 0 || k == n {
        Mat::zeros(k, n - k)
    } else {
        linalg::sylvester(&T11, &-&T22, &-T12).with_step("splitting")?
    };
    let (B, C) = (&form.U.t() * &g.B, &g.C * &form.U);
    let (B2, C1) = (B.block(k, 0, n - k, m), C.block(0, 0, p, k));
    let B1 = &B.block(0, 0, k, m) - &(&X * &B2);
    let C2 = &C.block(0, k, p, n - k) + &(&C1 * &X);
    Ok(Split {
        first: StateSpace::new(T11, B1, C1, g.D, g.timebase)?,
        second: StateSpace::new(T22, B2, C2, Mat::zeros(p, m), g.timebase)?,
    })
}

/// Returns poles that can be read off A: states that act on no state that acts on them.
fn lone_poles(A: &Mat) -> Vec<f64> {
    components(A).iter().filter(|group| group.len() == 1).map(|group| A[(group[0], group[0])]).collect()
}

/// Puts poles that can be read off A back to their exact places after reordering has moved them by rounding.
fn snap(T: &mut Mat, exact: &[f64]) {
    let near = REORDERING_SHIFT * T.norm_max();
    for &pole in exact {
        let alone =
            |k: usize| (k == 0 || T[(k, k - 1)] == 0.0) && (k + 1 == T.nrows() || T[(k + 1, k)] == 0.0);
        let distance = |k: &usize| (T[(*k, *k)] - pole).abs();
        let nearest = (0..T.nrows()).filter(|&k| alone(k)).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        if let Some(k) = nearest.filter(|k| distance(k) <= near) {
            T[(k, k)] = pole;
        }
    }
}

/// Returns a real Schur form put together from those of the groups of states that act on each other.
fn block_schur(A: &Mat) -> Result<Schur, Error> {
    let n = A.nrows();
    let groups = components(A);
    if groups.len() < 2 {
        return linalg::schur(A).with_step("splitting");
    }
    let order: Vec<usize> = groups.iter().flatten().copied().collect();
    let all: Vec<usize> = (0..n).collect();
    let (P, ordered) = (Mat::eye(n).select(&all, &order), A.select(&order, &order));
    let mut U = Mat::eye(n);
    let mut blocks = Vec::new();
    let mut top = 0;
    for size in groups.iter().map(Vec::len) {
        let part = linalg::schur(&ordered.block(top, top, size, size)).with_step("splitting")?;
        U.set_block(top, top, &part.U);
        blocks.push((top, part.T));
        top += size;
    }
    let mut T = &U.t() * &(&ordered * &U);
    blocks.iter().for_each(|(top, block)| T.set_block(*top, *top, block));
    Ok(Schur { T, U: &P * &U })
}
