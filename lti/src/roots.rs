//! Poles and zeros.

use crate::components::components;
use crate::entrywise_zeros::{EntrywiseZeros, entrywise_zeros};
use crate::error::OperationContext;
use crate::root_order::sort_roots;
use crate::scaling::balance;
use crate::tolerance::{
    BAUER_STEPS, CANCELLED, CANCELLED_TO_ROUNDING, DETERMINED_ZERO, DIRECT_GROWTH, DISPLACED_ZERO,
    PRECISE_SIZE, SAME_ROOT, SETTLED_ROOT, SINGULAR_ROUNDINGS, SUSPECT_POLE, ZERO_RANK,
};
use crate::{C64, CMat, Error, Mat, StateSpace, Timebase};
use counterpoise_linalg::{self as linalg, Boundary, RangeBasis};

/// Returns the poles: the eigenvalues of A, sorted by real, then imaginary part.
///
/// Groups of states that act on each other are taken one by one, so that the poles of blocks in series do not blur.
///
/// # Errors
/// [`Error::Matrix`] if the eigenvalue iteration fails.
pub fn poles(g: &StateSpace) -> Result<Vec<C64>, Error> {
    let A = balance(g).0.A;
    let mut poles = Vec::with_capacity(A.nrows());
    for group in components(&A) {
        poles.extend(linalg::eigenvalues(&A.select(&group, &group)).with_operation("poles")?);
    }
    sort_roots(&mut poles);
    Ok(poles)
}

/// Returns whether every pole lies inside the region of stability: left half plane, or unit disk. Poles on its border do
/// not, and neither do those that only rounding may have moved inside ([`poles_on_boundary`]).
///
/// # Errors
/// As [`poles`].
pub fn is_stable(g: &StateSpace) -> Result<bool, Error> {
    let poles = poles(g)?;
    let inside = poles.iter().all(|&pole| is_stable_pole(pole, g.timebase));
    Ok(inside && examine_poles(g, &poles)?.is_empty())
}

/// Returns the poles, one of each conjugate pair, that lie on the boundary of stability as far as the entries of A can tell:
/// the one rule for stability, norms, Gramians and reduction ([`linalg::boundary_eigenvalues`]).
///
/// # Errors
/// As [`poles`].
pub fn poles_on_boundary(g: &StateSpace) -> Result<Vec<C64>, Error> {
    examine_poles(g, &poles(g)?)
}

/// Returns the poles on the boundary of a system whose poles are known; a pole that is exactly there needs no
/// examination.
pub(crate) fn examine_poles(g: &StateSpace, poles: &[C64]) -> Result<Vec<C64>, Error> {
    let boundary = boundary(g.timebase);
    let size = poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    let distance = |pole: &C64| boundary.excess(*pole).abs();
    let certain = poles.iter().copied().filter(|pole| pole.im >= 0.0 && distance(pole) == 0.0);
    let mut found: Vec<C64> = certain.collect();
    if poles.iter().any(|pole| distance(pole) > 0.0 && distance(pole) <= SUSPECT_POLE * size.max(1.0)) {
        found.extend(linalg::boundary_eigenvalues(&balance(g).0.A, boundary).with_operation("poles")?);
    }
    Ok(found)
}

/// Returns the boundary of the region of stability.
pub(crate) fn boundary(timebase: Timebase) -> Boundary {
    match timebase {
        Timebase::Continuous => Boundary::ImaginaryAxis,
        Timebase::Discrete { .. } => Boundary::UnitCircle,
    }
}

/// Returns the damping ratio of a pole in continuous time, -Re p / |p|; 0 at the origin.
pub fn damping_ratio(pole: C64) -> f64 {
    -pole.re / pole.norm().max(f64::MIN_POSITIVE)
}

/// Returns whether a pole lies strictly inside the region of stability.
pub fn is_stable_pole(pole: C64, timebase: Timebase) -> bool {
    match timebase {
        Timebase::Continuous => pole.re < 0.0,
        Timebase::Discrete { .. } => pole.norm() < 1.0,
    }
}

/// Returns the finite invariant zeros: the s at which \[A - s I, B; C, D\] loses rank, sorted by real, then
/// imaginary part.
///
/// Scaling by powers of two, then Emami-Naeini and Van Dooren's reduction (Automatica 18 (1982) 415) to a system with an
/// invertible direct path, whose zeros are eigenvalues (generalised ones if the path is nearly singular). The reduction is made twice: by orthogonal
/// transformations, whose ranks are decided by one absolute tolerance, and by eliminations whose ranks are decided entry by
/// entry (`entrywise_zeros`), first coarsely and again, if a sum that counted as zero is more than rounding, by what rounding leaves of a sum. The first is the answer if both agree, because it is the more accurate one for systems of one scale;
/// otherwise the second is, corrected in 32 digits if there are as many inputs as outputs and at most 32 states and inputs
/// ([`linalg::pencil_roots`](fn@linalg::pencil_roots)). A zero that the eliminations place at the origin stays there unless the system matrix is regular
/// under a hundred roundings of each entry. Infinite zeros do not appear. Input and output decoupling zeros are among the answer. O(n^3).
///
/// # Errors
/// [`Error::Matrix`] if a decomposition fails.
pub fn zeros(g: &StateSpace) -> Result<Vec<C64>, Error> {
    let scaled = unit_gains(&balance(g).0);
    let entrywise = entrywise_zeros(&scaled, CANCELLED)?;
    let orthogonal = orthogonal_zeros(scaled.clone());
    if let Ok(zeros) = &orthogonal
        && entrywise.are_clear
        && is_same(zeros, &entrywise.zeros, SETTLED_ROOT)
    {
        return orthogonal;
    }
    let entrywise = supported_zeros(&scaled, entrywise, &orthogonal)?;
    match precise_zeros(&scaled, &entrywise)? {
        Some(zeros) => Ok(zeros),
        None => Ok(agreed_zeros(orthogonal, entrywise)),
    }
}

/// Returns the zeros as [`zeros`] without the correction in 32 digits: a double one is known to 8 digits, which places the points of
/// a grid.
///
/// # Errors
/// As [`zeros`].
pub(crate) fn uncorrected_zeros(g: &StateSpace) -> Result<Vec<C64>, Error> {
    let scaled = unit_gains(&balance(g).0);
    let entrywise = entrywise_zeros(&scaled, CANCELLED)?;
    let orthogonal = orthogonal_zeros(scaled.clone());
    let entrywise = supported_zeros(&scaled, entrywise, &orthogonal)?;
    Ok(agreed_zeros(orthogonal, entrywise))
}

/// Returns the zeros by eliminations, with those that a sum which all but cancels puts far away, or at the origin, if the data determine them and rounding
/// alone may not have made them.
///
/// Two methods that find one number of zeros support each other. If only the finer decision of the eliminations finds more, each of those must move by less
/// than [`DETERMINED_ZERO`] of itself when the entries are rounded.
fn supported_zeros(
    g: &StateSpace,
    entrywise: EntrywiseZeros,
    orthogonal: &Result<Vec<C64>, Error>,
) -> Result<Vec<C64>, Error> {
    let EntrywiseZeros { zeros, are_clear } = entrywise;
    if are_clear {
        return Ok(zeros);
    }
    let fine = entrywise_zeros(g, CANCELLED_TO_ROUNDING)?.zeros;
    let count = orthogonal.as_ref().ok().map(Vec::len);
    let is_second = count == Some(fine.len()) && count != Some(zeros.len());
    let is_supported =
        is_second || fine.len() > zeros.len() && fine.iter().all(|&zero| is_determined(g, zero));
    Ok(if is_supported { fine } else { zeros })
}

/// Returns whether a rounding of each entry of a square system matrix moves a zero by little, to first order.
fn is_determined(g: &StateSpace, zero: C64) -> bool {
    if g.inputs() != 1 || g.outputs() != 1 {
        return false;
    }
    let n = g.order();
    let shifted =
        CMat::from_fn(n, n, |i, j| (if i == j { zero } else { C64::default() }) - C64::new(g.A[(i, j)], 0.0));
    let right = linalg::csolve(&shifted, &g.B.to_complex());
    let left = linalg::csolve(&shifted.t(), &g.C.t().to_complex());
    let (Ok(x), Ok(y)) = (right, left) else { return false };
    // With [x; 1] and [y; 1] as null vectors of the system matrix.
    let moduli = |M: &CMat| M.map(|e| e.norm());
    let (X, Y) = (moduli(&x).vstack(&Mat::eye(1)), moduli(&y).vstack(&Mat::eye(1)));
    let terms = (&Y.t() * &(&system_matrix(g).map(f64::abs) * &X))[(0, 0)];
    let derivative = (0..n).map(|i| x[(i, 0)] * y[(i, 0)]).sum::<C64>().norm();
    f64::EPSILON * terms <= DETERMINED_ZERO * derivative * zero.norm()
}

/// Returns the zeros by orthogonal transformations if both methods agree; otherwise those by eliminations.
fn agreed_zeros(orthogonal: Result<Vec<C64>, Error>, entrywise: Vec<C64>) -> Vec<C64> {
    match orthogonal {
        Ok(zeros) if is_same(&zeros, &entrywise, SAME_ROOT) => zeros,
        _ => entrywise,
    }
}

/// Returns the zeros corrected in 32 digits from approximations of all of them; `None` if the system matrix is not square or too
/// large, or the correction does not converge.
fn precise_zeros(g: &StateSpace, starts: &[C64]) -> Result<Option<Vec<C64>>, Error> {
    let (n, m) = (g.order(), g.inputs());
    if m != g.outputs() || n + m > PRECISE_SIZE {
        return Ok(None);
    }
    let mass: Vec<f64> = (0..n + m).map(|i| if i < n { 1.0 } else { 0.0 }).collect();
    let matrix = system_matrix(g);
    let displaced = if is_certainly_regular(&matrix) { off_the_origin(starts) } else { starts.to_vec() };
    let mut found = linalg::pencil_roots(&matrix, &mass, &displaced).with_operation("zeros")?;
    found.iter_mut().for_each(|zeros| sort_roots(zeros));
    Ok(found)
}

/// Returns whether a matrix stays regular if each entry is rounded by [`SINGULAR_ROUNDINGS`] units: whether the spectral radius of |inv(M)| |M| is
/// below their reciprocal (F. Bauer, Numerische Mathematik 8 (1966) 73), which does not depend on the scaling.
fn is_certainly_regular(M: &Mat) -> bool {
    let n = M.nrows();
    let largest = |i: usize| (0..n).map(|j| M[(i, j)].abs()).fold(0.0, f64::max);
    let rows: Vec<f64> = (0..n).map(|i| linalg::unit_power(largest(i))).collect();
    let scaled = Mat::from_fn(n, n, |i, j| rows[i] * M[(i, j)]);
    let Ok(inverse) = linalg::inverse(&scaled) else { return false };
    let product = &inverse.map(f64::abs) * &scaled.map(f64::abs);
    if !product.is_finite() {
        return false;
    }
    // Largest ratio of an entry of the image of a positive vector to the entry of the vector: an upper bound of the radius, closer after each
    // step (L. Collatz, 1942).
    let mut x = Mat::from_fn(n, 1, |_, _| 1.0);
    let mut radius = f64::INFINITY;
    for _ in 0..BAUER_STEPS {
        let image = &product * &x;
        let quotients = (0..n).map(|i| image[(i, 0)] / x[(i, 0)]);
        radius = quotients.fold(0.0, f64::max).min(radius);
        x = image.scale(1.0 / image.norm_max());
    }
    radius * SINGULAR_ROUNDINGS * f64::EPSILON < 1.0
}

/// Returns the approximations with those at the origin on a small circle about it, in conjugate pairs.
fn off_the_origin(starts: &[C64]) -> Vec<C64> {
    let smallest = starts.iter().map(|s| s.norm()).filter(|&s| s > 0.0).fold(f64::INFINITY, f64::min);
    let radius = if smallest.is_finite() { DISPLACED_ZERO * smallest } else { DISPLACED_ZERO };
    let (at_origin, mut others): (Vec<C64>, Vec<C64>) = starts.iter().partition(|s| s.norm() == 0.0);
    let count = at_origin.len();
    let turn = |k: usize| std::f64::consts::PI * (2 * k + 1) as f64 / count as f64;
    others.extend((0..count).map(|k| match 2 * k + 1 == count {
        true => C64::new(-radius, 0.0),
        false => C64::from_polar(radius, turn(k)),
    }));
    others
}

/// Returns whether two lists hold the same roots, up to a relative difference.
fn is_same(ours: &[C64], theirs: &[C64], tolerance: f64) -> bool {
    let mut rest = theirs.to_vec();
    ours.len() == theirs.len()
        && ours.iter().all(|root| {
            let distance = |other: &C64| (other - root).norm();
            let nearest = (0..rest.len()).min_by(|&a, &b| distance(&rest[a]).total_cmp(&distance(&rest[b])));
            nearest.is_some_and(|k| {
                distance(&rest.swap_remove(k)) <= tolerance * root.norm().max(f64::MIN_POSITIVE)
            })
        })
}

/// Returns the zeros by orthogonal transformations.
fn orthogonal_zeros(scaled: StateSpace) -> Result<Vec<C64>, Error> {
    let tolerance = ZERO_RANK * system_matrix(&scaled).norm_fro();
    let rows = compress(scaled, tolerance)?;
    let square = compress(rows.dual(), tolerance)?.dual();
    finite_eigenvalues(&square)
}

/// [A B; C D].
fn system_matrix(g: &StateSpace) -> Mat {
    Mat::from_blocks(&[&[&g.A, &g.B], &[&g.C, &g.D]])
}

/// Returns the system with inputs and outputs scaled so that B and C have norms like A; its zeros are the
/// same.
fn unit_gains(g: &StateSpace) -> StateSpace {
    let power = |matrix: &Mat| linalg::unit_power(matrix.norm_max() / g.A.norm_max());
    let (b, c) = (power(&g.B), power(&g.C));
    StateSpace { B: g.B.scale(b), C: g.C.scale(c), D: g.D.scale(b * c), ..g.clone() }
}

/// Returns the system without the states and outputs that hide the zeros: its direct path has full row rank.
///
/// An output combination that the input does not reach directly must vanish; the states that it sees vanish with it,
/// and their own equations become outputs of what is left.
fn compress(mut g: StateSpace, tolerance: f64) -> Result<StateSpace, Error> {
    loop {
        let (p, n, m) = (g.outputs(), g.order(), g.inputs());
        let direct = RangeBasis::of(&g.D, tolerance).with_operation("zeros")?;
        let rank = direct.rank();
        if rank == p {
            return Ok(g);
        }
        let turned = |M: &Mat| direct.transpose_times(M).with_operation("zeros");
        let (C, D) = (turned(&g.C)?, turned(&g.D)?);
        let hidden = RangeBasis::of(&C.block(rank, 0, p - rank, n).t(), tolerance).with_operation("zeros")?;
        let seen = hidden.rank();
        let rows = |M: &Mat| hidden.transpose_times(M).with_operation("zeros");
        let columns = |M: &Mat| hidden.times(M).with_operation("zeros");
        let (A, B, C) = (rows(&columns(&g.A)?)?, rows(&g.B)?, columns(&C.block(0, 0, rank, n))?);
        let kept = n - seen;
        g = StateSpace {
            A: A.block(seen, seen, kept, kept),
            B: B.block(seen, 0, kept, m),
            C: C.block(0, seen, rank, kept).vstack(&A.block(0, seen, seen, kept)),
            D: D.block(0, 0, rank, m).vstack(&B.block(0, 0, seen, m)),
            timebase: g.timebase,
        };
        if seen == 0 {
            return Ok(g);
        }
    }
}

/// The zeros of a system with an invertible direct path: the eigenvalues of A - B inv(D) C if this product is not large beside A;
/// otherwise columns of [C D] are compressed to [0 Df], and what is left of [A - s I, B] is a regular pencil for QZ, which takes
/// three times as long.
fn finite_eigenvalues(g: &StateSpace) -> Result<Vec<C64>, Error> {
    let (n, p) = (g.order(), g.outputs());
    if n == 0 {
        return Ok(Vec::new());
    }
    if p == 0 {
        return linalg::eigenvalues(&g.A).with_operation("zeros");
    }
    if let Some(inner) = without_direct_path(g) {
        return linalg::eigenvalues(&inner).with_operation("zeros");
    }
    let basis = RangeBasis::of(&g.C.hstack(&g.D).t(), 0.0).with_operation("zeros")?;
    let columns = |M: Mat| basis.times(&M).with_operation("zeros");
    let (whole, mass) = (columns(g.A.hstack(&g.B))?, columns(Mat::eye(n).hstack(&Mat::zeros(n, p)))?);
    let pencil = (whole.block(0, p, n, n), mass.block(0, p, n, n));
    let pairs = linalg::gen_eigenvalues(&pencil.0, &pencil.1).with_operation("zeros")?;
    let mut zeros: Vec<C64> = pairs.into_iter().map(|(alpha, beta)| alpha / beta).collect();
    zeros.retain(|zero| zero.re.is_finite() && zero.im.is_finite());
    sort_roots(&mut zeros);
    Ok(zeros)
}

/// A - B inv(D) C for a square D, if neither D nor the product magnifies rounding errors by more than [`DIRECT_GROWTH`].
fn without_direct_path(g: &StateSpace) -> Option<Mat> {
    let inverse = if g.D.is_square() { linalg::inverse(&g.D).ok()? } else { return None };
    let growth = g.B.norm_fro() * inverse.norm_fro() * g.C.norm_fro();
    let is_small = growth <= DIRECT_GROWTH * g.A.norm_fro() && linalg::rcond_one(&g.D) * DIRECT_GROWTH >= 1.0;
    is_small.then(|| &g.A - &(&(&g.B * &inverse) * &g.C))
}
