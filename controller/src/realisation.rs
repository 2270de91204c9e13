//! The realisation in which a path runs: chosen so that rounded coefficients move its poles little.

use counterpoise_linalg::{C64, Mat, Schur, balance, inverse, schur, sylvester};
use counterpoise_lti::StateSpace;

use crate::Error;
use crate::tolerance::{CLUSTERS, INTEGRATOR, MODAL_CONDITION};

/// A system in modal form.
#[derive(Debug, Clone, PartialEq)]
pub struct Realisation {
    /// The system: A block-diagonal.
    pub system: StateSpace,
    /// Sizes of the diagonal blocks: 1 for a real pole, 2 for a complex pair `[a b; -b a]`, more if poles are too
    /// close to be told apart (then a triangular block).
    pub blocks: Vec<usize>,
    /// Condition number of the transformation (1-norm).
    pub condition: f64,
    /// |A V - V A_modal| / (|A| |V|) in the 1-norm, from the given system.
    pub residual: f64,
}

/// Returns the modal real form of a system:
///
/// ```text
///     x = V z,   inv(V) A V = diag(A1, A2, ...),   inv(V) B,   C V,   D
/// ```
///
/// Method: real Schur form, eigenvalues that lie close made neighbours, blocks separated by Sylvester equations (Bavely
/// and Stewart 1979), complex pairs rotated to `[a b; -b a]`, whose poles are as insensitive to rounding as a second
/// order section can be, and each block's inputs and outputs balanced by a power of two. Neighbours are merged until the
/// transformation's condition number is below [`MODAL_CONDITION`]. Order n costs about 30 n^3 operations.
///
/// # Errors
/// [`Error::Realisation`] if the Schur form fails.
pub fn modal_form(system: &StateSpace) -> Result<Realisation, Error> {
    let balanced = balance(&system.A).map_err(realisation_error)?;
    let T = &balanced.scale;
    let n = system.order();
    let start = StateSpace {
        A: balanced.A.clone(),
        B: Mat::from_fn(n, system.inputs(), |i, j| system.B[(i, j)] / T[i]),
        C: Mat::from_fn(system.outputs(), n, |i, j| system.C[(i, j)] * T[j]),
        ..system.clone()
    };
    let form = schur(&start.A).map_err(realisation_error)?;
    let mut best = None;
    for closeness in CLUSTERS {
        let candidate = separate(&start, form.clone(), closeness)?;
        let good = candidate.condition <= MODAL_CONDITION;
        best = Some(candidate);
        if good {
            break;
        }
    }
    best.ok_or_else(|| Error::Realisation("no block structure was tried".into()))
}

fn realisation_error(error: counterpoise_linalg::Error) -> Error {
    Error::Realisation(error.to_string())
}

/// Returns the modal form with eigenvalues nearer than `closeness` kept in one block.
fn separate(start: &StateSpace, mut form: Schur, closeness: f64) -> Result<Realisation, Error> {
    let clusters = gather(&mut form, closeness);
    let blocks = merge(&diagonal_blocks(&form.T), &clusters);
    let mut V = form.U.clone();
    let mut A = form.T.clone();
    decouple(&mut A, &mut V, &blocks)?;
    normalise(&mut A, &mut V, &blocks);
    unit_columns(&mut V, &blocks);
    let W = inverse(&V).map_err(realisation_error)?;
    let condition = V.norm_one() * W.norm_one();
    let defect = &(&start.A * &V) - &(&V * &A);
    let residual = defect.norm_one() / (start.A.norm_one() * V.norm_one()).max(f64::MIN_POSITIVE);
    let mut system = StateSpace { A, B: &W * &start.B, C: &start.C * &V, ..start.clone() };
    balance_blocks(&mut system, &blocks);
    Ok(Realisation { system, blocks, condition, residual })
}

/// An eigenvalue, and the label of the cluster that it belongs to.
#[derive(Debug, Clone, Copy)]
struct LabelledEigenvalue {
    value: C64,
    label: usize,
}

/// A block on the diagonal: its first row, and its size.
#[derive(Debug, Clone, Copy)]
struct DiagonalBlock {
    first: usize,
    size: usize,
}

/// Brings eigenvalues that lie close next to each other; returns a label for each diagonal entry.
fn gather(form: &mut Schur, closeness: f64) -> Vec<usize> {
    let labels = cluster(&form.eigenvalues(), closeness);
    let count = labels.iter().map(|each| each.label + 1).max().unwrap_or(0);
    for label in (0..count).rev() {
        let members: Vec<C64> =
            labels.iter().filter(|each| each.label == label).map(|each| each.value).collect();
        let near = |value: C64| nearest_label(&labels, value) == Some(label);
        if members.len() > 1 && form.reorder(near).is_err() {
            // An exchange was refused: the eigenvalues are so close that their order does not matter.
            continue;
        }
    }
    form.eigenvalues().iter().map(|value| nearest_label(&labels, *value).unwrap_or(0)).collect()
}

fn nearest_label(labels: &[LabelledEigenvalue], value: C64) -> Option<usize> {
    let distance = |each: &LabelledEigenvalue| (each.value - value).norm();
    labels.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).map(|each| each.label)
}

/// Labels so that eigenvalues nearer than `closeness` times their distance from 1 (and conjugates) share one.
fn cluster(values: &[C64], closeness: f64) -> Vec<LabelledEigenvalue> {
    let mut labelled: Vec<LabelledEigenvalue> = Vec::new();
    for &value in values {
        let upper = |v: C64| C64::new(v.re, v.im.abs());
        let size = (value - 1.0).norm();
        let near = |other: C64| {
            (upper(other) - upper(value)).norm() <= closeness * size.max((other - 1.0).norm())
                || (other.im != 0.0 && upper(other) == upper(value))
        };
        let found = labelled.iter().find(|other| near(other.value)).map(|other| other.label);
        let next = labelled.iter().map(|each| each.label + 1).max().unwrap_or(0);
        labelled.push(LabelledEigenvalue { value, label: found.unwrap_or(next) });
    }
    labelled
}

/// Returns the blocks of a quasi-triangular matrix.
fn diagonal_blocks(T: &Mat) -> Vec<DiagonalBlock> {
    let mut blocks = Vec::new();
    let mut k = 0;
    while k < T.nrows() {
        let size = if k + 1 < T.nrows() && T[(k + 1, k)] != 0.0 { 2 } else { 1 };
        blocks.push(DiagonalBlock { first: k, size });
        k += size;
    }
    blocks
}

/// Returns sizes of the blocks when everything between the first and the last of a cluster is taken together.
fn merge(blocks: &[DiagonalBlock], labels: &[usize]) -> Vec<usize> {
    let last = |label: usize| labels.iter().rposition(|l| *l == label).unwrap_or(0);
    let mut merged = Vec::new();
    let (mut size, mut until) = (0, 0);
    for &DiagonalBlock { first, size: rows } in blocks {
        until = (first..first + rows).fold(until, |u, row| u.max(last(labels[row])));
        size += rows;
        if first + rows > until {
            merged.push(size);
            size = 0;
        }
    }
    merged
}

/// Removes what couples the blocks: with A11 X - X A22 = -A12, [I X; 0 I] separates the first block from the rest.
fn decouple(A: &mut Mat, V: &mut Mat, blocks: &[usize]) -> Result<(), Error> {
    let n = A.nrows();
    let mut top = 0;
    for &size in blocks {
        let rest = n - top - size;
        if rest > 0 {
            let A11 = A.block(top, top, size, size);
            let A12 = A.block(top, top + size, size, rest);
            let A22 = A.block(top + size, top + size, rest, rest);
            let X = sylvester(&A11, &-&A22, &-&A12).map_err(realisation_error)?;
            let mut V2 = V.block(0, top + size, n, rest);
            V2 += &(&V.block(0, top, n, size) * &X);
            V.set_block(0, top + size, &V2);
            A.set_block(top, top + size, &Mat::zeros(size, rest));
        }
        top += size;
    }
    Ok(())
}

/// Complex pairs become [a b; -b a]; poles at 1 become exactly 1.
fn normalise(A: &mut Mat, V: &mut Mat, blocks: &[usize]) {
    let mut k = 0;
    for &size in blocks {
        if size == 1 && (A[(k, k)] - 1.0).abs() <= INTEGRATOR {
            A[(k, k)] = 1.0;
        }
        if size == 2 && A[(k + 1, k)] != 0.0 {
            let stretch = (-A[(k + 1, k)] / A[(k, k + 1)]).sqrt();
            let rotation = A[(k, k + 1)] * stretch;
            A[(k, k + 1)] = rotation;
            A[(k + 1, k)] = -rotation;
            V.column_mut(k + 1).iter_mut().for_each(|v| *v *= stretch);
        }
        k += size;
    }
}

/// Scales each block by one power of two so that its columns of V are about of length 1.
fn unit_columns(V: &mut Mat, blocks: &[usize]) {
    let mut k = 0;
    for &size in blocks {
        let norm = V.block(0, k, V.nrows(), size).norm_fro();
        let factor = power_of_two(1.0 / norm);
        for j in k..k + size {
            V.column_mut(j).iter_mut().for_each(|v| *v *= factor);
        }
        k += size;
    }
}

/// Inputs and outputs of each block become alike in size, by a power of two.
fn balance_blocks(system: &mut StateSpace, blocks: &[usize]) {
    let mut k = 0;
    for &size in blocks {
        let input = system.B.block(k, 0, size, system.inputs()).norm_fro();
        let output = system.C.block(0, k, system.outputs(), size).norm_fro();
        if input > 0.0 && output > 0.0 {
            let factor = power_of_two((input / output).sqrt());
            let rows = system.B.block(k, 0, size, system.inputs()).scale(1.0 / factor);
            let columns = system.C.block(0, k, system.outputs(), size).scale(factor);
            system.B.set_block(k, 0, &rows);
            system.C.set_block(0, k, &columns);
        }
        k += size;
    }
}

/// Returns the power of two nearest to a positive number, on a logarithmic scale.
fn power_of_two(value: f64) -> f64 {
    if value > 0.0 && value.is_finite() { value.log2().round().exp2() } else { 1.0 }
}

/// Returns the number of coefficients of a realisation that are neither 0 nor 1 nor -1: what a step multiplies.
pub fn count_coefficients(system: &StateSpace) -> usize {
    let matrices = [&system.A, &system.B, &system.C, &system.D];
    let all = matrices.iter().flat_map(|matrix| matrix.as_slice());
    all.filter(|entry| **entry != 0.0 && entry.abs() != 1.0).count()
}

#[cfg(test)]
mod tests;
