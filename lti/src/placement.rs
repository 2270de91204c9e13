//! Pole placement by state feedback, as insensitive to errors of the plant as one pass over the eigenvectors makes it.
//!
//! Source: Kautsky, Nichols and Van Dooren, Robust pole assignment in linear state feedback, Int. J. Control 41 (1985) 1129,
//! method 0: each eigenvector in turn is chosen, within the space that its pole allows, as orthogonal to all others as can be. If the
//! gain in doubles misses the poles, the one that belongs to these eigenvectors is computed with 32 digits.

use crate::error::OperationContext;
use crate::root_order::sort_roots;
use crate::scaling::balance;
use crate::tolerance::{
    NARROW_UNITS, PLACEMENT_MET, PLACEMENT_PRECISE_STATES, PLACEMENT_RANK, PLACEMENT_SETTLED,
    PLACEMENT_SWEEPS, SAME_POLE,
};
use crate::{C64, CMat, Error, Mat, StateSpace, Timebase};
use counterpoise_linalg as linalg;

/// A feedback u = -F x and what it does.
#[derive(Debug, Clone, PartialEq)]
pub struct Placement {
    /// The gain, m x n.
    pub F: Mat,
    /// The eigenvalues of A - B F as computed from the gain, sorted: how well the poles were met.
    pub poles: Vec<C64>,
    /// Condition number of the eigenvectors of A - B F: an error e of the plant moves no pole by more than about this times e. Of a plant
    /// whose states have units many decades apart, in units in which the rows and columns of A are of one size.
    pub condition: f64,
}

/// Returns the feedback that gives A - B F the wanted poles; A n x n, B n x m, n poles, complex ones in conjugate pairs.
///
/// With several inputs the freedom that is left makes the condition number of the eigenvectors small. A pole may be wanted at most as
/// often as there are independent inputs: with one input all poles must differ.
///
/// # Errors
/// [`Error::Shape`], [`Error::Rational`] for complex poles without their conjugates, [`Error::Range`] for a pole that is wanted too
/// often, [`Error::Pole`] if the inputs do not reach a mode, [`Error::Matrix`] if a decomposition fails.
pub fn place(A: &Mat, B: &Mat, wanted: &[C64]) -> Result<Placement, Error> {
    let n = A.nrows();
    check(A, B, wanted)?;
    if n == 0 {
        return Ok(Placement { F: Mat::zeros(B.ncols(), 0), poles: vec![], condition: 1.0 });
    }
    let poles = order_poles(wanted)?;
    let units = Units::of(A, B)?;
    let placed = place_balanced(&units.A, &units.B, &poles)?;
    Ok(Placement { F: units.restore(&placed.F), ..placed })
}

/// The plant in units in which its entries are of one size, by powers of two.
struct Units {
    A: Mat,
    B: Mat,
    states: Vec<f64>,
    inputs: Vec<f64>,
}

impl Units {
    /// Inputs get columns of size one; states are scaled if their units differ by many decades.
    fn of(A: &Mat, B: &Mat) -> Result<Self, Error> {
        let no_output = Mat::zeros(0, A.nrows());
        let direct = Mat::zeros(0, B.ncols());
        let g = StateSpace::new(A.clone(), B.clone(), no_output, direct, Timebase::Continuous)?;
        let (mut scaled, mut states) = balance(&g);
        let (low, high) = states.iter().fold((1.0_f64, 1.0_f64), |(l, h), &t| (l.min(t), h.max(t)));
        if high <= NARROW_UNITS * low {
            (scaled, states) = (g, vec![1.0; A.nrows()]);
        }
        let size = |k: usize| scaled.B.column(k).iter().map(|b| b.abs()).fold(0.0, f64::max);
        let inputs: Vec<f64> = (0..B.ncols()).map(|k| linalg::unit_power(size(k))).collect();
        let B = &scaled.B * &Mat::diag(&inputs);
        Ok(Self { A: scaled.A, B, states, inputs })
    }

    /// The gain in the units of the caller.
    fn restore(&self, F: &Mat) -> Mat {
        Mat::from_fn(F.nrows(), F.ncols(), |i, j| F[(i, j)] * self.inputs[i] / self.states[j])
    }
}

fn place_balanced(A: &Mat, B: &Mat, wanted: &[C64]) -> Result<Placement, Error> {
    let inputs = Inputs::of(B)?;
    check_multiplicity(wanted, inputs.rank)?;
    let spaces: Result<Vec<CMat>, Error> = wanted.iter().map(|&pole| inputs.space(A, pole)).collect();
    let vectors = Vectors::start(wanted, spaces?).improve_vectors()?;
    let condition = vectors.condition()?;
    let finish = |F: Mat| -> Result<Placement, Error> {
        let mut poles = linalg::eigenvalues(&(A - &(B * &F))).with_operation("pole placement")?;
        sort_roots(&mut poles);
        Ok(Placement { F, poles, condition })
    };
    let found = finish(inputs.gain(A, wanted, &vectors.X)?)?;
    if A.nrows() > PLACEMENT_PRECISE_STATES || are_met(&found.poles, wanted) {
        return Ok(found);
    }
    let V = &inputs.directions;
    let choice = linalg::EigenvectorChoice { A, B, V, eigenvalues: wanted, vectors: &vectors.X };
    let better = linalg::eigenvector_gain(choice).with_operation("pole placement")?;
    better.map_or(Ok(found), finish)
}

/// Returns whether each wanted pole is met by a pole of its own, to rounding of a few digits.
fn are_met(poles: &[C64], wanted: &[C64]) -> bool {
    let mut left = poles.to_vec();
    wanted.iter().all(|pole| {
        let distance = |other: &C64| (other - pole).norm();
        let nearest = (0..left.len()).min_by(|&a, &b| distance(&left[a]).total_cmp(&distance(&left[b])));
        nearest.is_some_and(|at| distance(&left.swap_remove(at)) <= PLACEMENT_MET * pole.norm())
    })
}

fn check(A: &Mat, B: &Mat, wanted: &[C64]) -> Result<(), Error> {
    let n = A.nrows();
    if A.ncols() != n {
        return Err(Error::Shape { what: "A", found: A.shape(), expected: (n, n) });
    }
    if B.nrows() != n {
        return Err(Error::Shape { what: "B", found: B.shape(), expected: (n, B.ncols()) });
    }
    if wanted.len() != n {
        return Err(Error::Shape { what: "poles", found: (wanted.len(), 1), expected: (n, 1) });
    }
    let finite = |M: &Mat| M.is_finite();
    let known = wanted.iter().all(|pole| pole.re.is_finite() && pole.im.is_finite());
    if finite(A) && finite(B) && known { Ok(()) } else { Err(Error::NotFinite { what: "pole placement" }) }
}

/// Real poles first, then pairs, the upper one before its exact conjugate.
fn order_poles(wanted: &[C64]) -> Result<Vec<C64>, Error> {
    let is_real = |pole: &&C64| pole.im.abs() <= SAME_POLE * pole.norm();
    let mut poles: Vec<C64> = wanted.iter().filter(is_real).map(|pole| C64::new(pole.re, 0.0)).collect();
    let mut lower: Vec<C64> = wanted.iter().filter(|pole| !is_real(pole) && pole.im < 0.0).copied().collect();
    let lonely = Error::Rational { what: "pole placement", problem: "a complex pole lacks its conjugate" };
    for pole in wanted.iter().filter(|pole| !is_real(pole) && pole.im > 0.0) {
        let found = lower.iter().position(|other| (other.conj() - pole).norm() <= SAME_POLE * pole.norm());
        let Some(at) = found else { return Err(lonely) };
        lower.swap_remove(at);
        poles.extend([*pole, pole.conj()]);
    }
    if lower.is_empty() { Ok(poles) } else { Err(lonely) }
}

fn check_multiplicity(poles: &[C64], rank: usize) -> Result<(), Error> {
    for pole in poles {
        let same = poles.iter().filter(|other| (*other - pole).norm() <= SAME_POLE * pole.norm()).count();
        if same > rank {
            let allowed = "at most the number of independent inputs (move the poles apart)";
            return Err(Error::Range { what: "times that a pole is wanted", value: same as f64, allowed });
        }
    }
    Ok(())
}

/// B = U0 (R V'), U1 the directions that the inputs do not reach at once.
struct Inputs {
    rank: usize,
    U0: Mat,
    U1: Mat,
    /// The gain of U0'(A - M) is pinv(B) U0: V diag(1/s).
    inverse: Mat,
    /// V: the directions of the inputs that act independently.
    directions: Mat,
}

impl Inputs {
    fn of(B: &Mat) -> Result<Self, Error> {
        let (n, m) = B.shape();
        let padded = if m < n { B.hstack(&Mat::zeros(n, n - m)) } else { B.clone() };
        let parts = linalg::svd(&padded).with_operation("pole placement")?;
        let largest = parts.s.first().copied().unwrap_or(0.0);
        let rank = parts.s.iter().filter(|s| **s > PLACEMENT_RANK * largest).count();
        let inverses: Vec<f64> = parts.s.iter().take(rank).map(|s| 1.0 / s).collect();
        Ok(Self {
            rank,
            U0: parts.U.block(0, 0, n, rank),
            U1: parts.U.block(0, rank, n, n - rank),
            inverse: &parts.V.block(0, 0, m, rank) * &Mat::diag(&inverses),
            directions: parts.V.block(0, 0, m, rank),
        })
    }

    /// Returns an orthonormal basis of the eigenvectors that a pole may have: the null space of U1'(A - pole
    /// I).
    fn space(&self, A: &Mat, pole: C64) -> Result<CMat, Error> {
        let n = A.nrows();
        let rows = n - self.rank;
        let (UA, U) = (self.U1.t() * A, self.U1.t());
        let M = CMat::from_fn(n, n, |i, j| {
            if i < rows { C64::new(UA[(i, j)], 0.0) - pole * U[(i, j)] } else { C64::new(0.0, 0.0) }
        });
        let parts = linalg::csvd(&M).with_operation("pole placement")?;
        let size = A.norm_fro().max(pole.norm());
        if rows > 0 && parts.s[rows - 1] <= PLACEMENT_RANK * size {
            let problem = "was wanted where the inputs do not reach a mode of the same value";
            return Err(Error::Pole { what: "pole placement", re: pole.re, im: pole.im, problem });
        }
        Ok(parts.V.block(0, rows, n, self.rank))
    }

    /// F with A - B F = X diag(poles) X^-1.
    fn gain(&self, A: &Mat, poles: &[C64], X: &CMat) -> Result<Mat, Error> {
        let scaled = CMat::from_fn(X.nrows(), X.ncols(), |i, j| X[(i, j)] * poles[j]);
        // (X Lambda) X^-1 = ((X')^-1 (X Lambda)')'
        let closed = linalg::csolve(&transpose(X), &transpose(&scaled)).with_operation("pole placement")?;
        let closed = transpose(&closed).map(|entry: C64| entry.re);
        Ok(&self.inverse * &(self.U0.t() * (A - &closed)))
    }
}

fn transpose(X: &CMat) -> CMat {
    CMat::from_fn(X.ncols(), X.nrows(), |i, j| X[(j, i)])
}

/// The eigenvectors with the spaces that they are chosen from.
struct Vectors {
    X: CMat,
    spaces: Vec<CMat>,
    /// `true` if column k is the conjugate of column k - 1.
    mirrored: Vec<bool>,
}

impl Vectors {
    /// Returns a vector of each space, not the same one for poles that are repeated.
    fn start(poles: &[C64], spaces: Vec<CMat>) -> Self {
        let n = poles.len();
        let mirrored: Vec<bool> = (0..n).map(|k| poles[k].im < 0.0).collect();
        let mut X = CMat::zeros(n, n);
        for k in 0..n {
            if mirrored[k] {
                let conjugate: Vec<C64> = X.column(k - 1).iter().map(|x| x.conj()).collect();
                X.column_mut(k).copy_from_slice(&conjugate);
                continue;
            }
            let space = &spaces[k];
            for c in 0..space.ncols() {
                // A complex vector that is a multiple of a real one equals its conjugate.
                let turn = if poles[k].im == 0.0 { 0 } else { c };
                let weight = C64::from_polar(1.0, (1 + k * (c + 1) + turn) as f64);
                let weight = if poles[k].im == 0.0 { C64::new(weight.re + 0.1, 0.0) } else { weight };
                let column = X.column_mut(k);
                column.iter_mut().zip(space.column(c)).for_each(|(x, s)| *x += weight * s);
            }
            if poles[k].im == 0.0 {
                make_real(X.column_mut(k));
            }
            normalise(X.column_mut(k));
        }
        Self { X, spaces, mirrored }
    }

    /// Returns the vectors after sweeps that each make one of them as orthogonal to the others as its space
    /// allows.
    fn improve_vectors(mut self) -> Result<Self, Error> {
        let mut best = self.condition()?;
        let mut kept = self.X.clone();
        for _ in 0..PLACEMENT_SWEEPS {
            for k in 0..self.X.ncols() {
                self.turn(k);
            }
            let now = self.condition()?;
            if now < best {
                kept = self.X.clone();
            }
            if now >= best * (1.0 - PLACEMENT_SETTLED) || now.is_nan() {
                break;
            }
            best = now;
        }
        self.X = kept;
        Ok(self)
    }

    /// Replaces one vector by the projection, onto its space, of the direction orthogonal to all others.
    fn turn(&mut self, k: usize) {
        if self.mirrored[k] || self.spaces[k].ncols() < 2 {
            return;
        }
        let n = self.X.nrows();
        // Row k of X^-1 is orthogonal to all other columns.
        let mut unit = CMat::zeros(n, 1);
        unit[(k, 0)] = C64::new(1.0, 0.0);
        let Ok(direction) = linalg::csolve(&transpose(&self.X), &unit) else { return };
        let direction = direction.map(|entry: C64| entry.conj());
        let space = &self.spaces[k];
        let mut x = (space * &(&space.h() * &direction)).column(0).to_vec();
        let real = self.X.column(k).iter().all(|entry| entry.im == 0.0);
        if real {
            make_real(&mut x);
        }
        if x.iter().map(|entry| entry.norm_sqr()).sum::<f64>() == 0.0 {
            return;
        }
        normalise(&mut x);
        self.X.column_mut(k).copy_from_slice(&x);
        if self.mirrored.get(k + 1) == Some(&true) {
            x.iter_mut().for_each(|entry| *entry = entry.conj());
            self.X.column_mut(k + 1).copy_from_slice(&x);
        }
    }

    fn condition(&self) -> Result<f64, Error> {
        let s = linalg::csingular_values(&self.X).with_operation("pole placement")?;
        let last = s.last().copied().unwrap_or(0.0);
        Ok(if last > 0.0 { s[0] / last } else { f64::INFINITY })
    }
}

/// A real vector of the span of a real space: the real part, or the imaginary one if that is the larger.
fn make_real(x: &mut [C64]) {
    let size = |part: fn(&C64) -> f64, x: &[C64]| x.iter().map(|e| part(e).powi(2)).sum::<f64>();
    let imaginary = size(|e| e.im, x) > size(|e| e.re, x);
    x.iter_mut().for_each(|e| *e = C64::new(if imaginary { e.im } else { e.re }, 0.0));
}

fn normalise(x: &mut [C64]) {
    let length = x.iter().map(|e| e.norm_sqr()).sum::<f64>().sqrt();
    if length > 0.0 {
        x.iter_mut().for_each(|e| *e /= length);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn check_poles(found: &Placement, wanted: &[C64], tolerance: f64) {
        for pole in wanted {
            let distance = found.poles.iter().map(|p| (p - pole).norm()).fold(f64::INFINITY, f64::min);
            assert!(distance < tolerance * pole.norm().max(1.0), "{pole}: {:?}", found.poles);
        }
    }

    #[test]
    fn one_input_has_one_answer() {
        let A = Mat::from_rows(&[&[0.0, 1.0, 0.0], &[0.0, 0.0, 1.0], &[1.0, -2.0, 3.0]]);
        let B = Mat::col(&[0.0, 0.0, 1.0]);
        let wanted = [C64::new(-1.0, 2.0), C64::new(-1.0, -2.0), C64::new(-4.0, 0.0)];
        let found = place(&A, &B, &wanted).unwrap();
        // s^3 + 6 s^2 + 13 s + 20
        let expected = Mat::row(&[21.0, 11.0, 9.0]);
        assert!((&found.F - &expected).norm_max() < 1e-11, "{:?}", found.F);
        assert!(place(&A, &B, &[C64::new(-1.0, 0.0); 3]).is_err());
        assert!(place(&A, &Mat::zeros(3, 1), &wanted).is_err());
    }

    #[test]
    fn several_inputs_make_the_poles_robust() {
        // Chemical reactor, example 1 of Kautsky, Nichols and Van Dooren.
        let A = Mat::from_rows(&[
            &[1.38, -0.2077, 6.715, -5.676],
            &[-0.5814, -4.29, 0.0, 0.675],
            &[1.067, 4.273, -6.654, 5.893],
            &[0.048, 4.273, 1.343, -2.104],
        ]);
        let B = Mat::from_rows(&[&[0.0, 0.0], &[5.679, 0.0], &[1.136, -3.146], &[1.136, 0.0]]);
        let wanted = [-0.2, -0.5, -5.0566, -8.6659].map(|p| C64::new(p, 0.0));
        let found = place(&A, &B, &wanted).unwrap();
        check_poles(&found, &wanted, 1e-12);
        // SciPy's methods end at 4.28 and 4.51.
        assert!(found.condition < 4.6, "{}", found.condition);
        let pairs = [C64::new(-2.0, 3.0), C64::new(-2.0, -3.0), C64::new(-1.0, 0.0), C64::new(-1.0, 0.0)];
        let found = place(&A, &B, &pairs).unwrap();
        check_poles(&found, &pairs, 1e-7);
    }

    #[test]
    fn units_of_states_and_inputs_cost_no_digits() {
        // A chain of integrators in units twelve decades apart, and an input in another: the gains are the coefficients of the polynomial.
        let wanted: Vec<C64> = (1..=6).map(|k| C64::new(-(k as f64), 0.0)).collect();
        let unit = |i: usize| [0, -20, 20, -10, 15, 0][i];
        let power = |k: i32| f64::from(k).exp2();
        let A = Mat::from_fn(6, 6, |i, j| if j == i + 1 { power(unit(i) - unit(j)) } else { 0.0 });
        let B = Mat::from_fn(6, 1, |i, _| if i == 5 { power(-17) } else { 0.0 });
        let found = place(&A, &B, &wanted).unwrap();
        for (k, exact) in [720.0, 1764.0, 1624.0, 735.0, 175.0, 21.0].iter().enumerate() {
            let gain = found.F[(0, k)] * power(unit(k) - 17);
            assert!((gain / exact - 1.0).abs() < 1e-12, "{k}: {gain}");
        }
    }

    #[test]
    fn a_pair_of_poles_is_placed_with_as_many_inputs_as_states() {
        let A = Mat::from_rows(&[&[-0.18, 0.11], &[0.58, -0.54]]);
        let B = Mat::from_rows(&[&[0.09, -0.84], &[0.1, -0.99]]);
        let wanted = [C64::new(-1.2, 0.2), C64::new(-1.2, -0.2)];
        let found = place(&A, &B, &wanted).unwrap();
        check_poles(&found, &wanted, 1e-12);
        assert!(found.condition < 10.0, "{}", found.condition);
    }
}
