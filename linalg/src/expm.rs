//! The matrix exponential and the integrals of it that discretisation needs.

use crate::balance::{BalancedMatrix, balance_all, balance_beside_own_rates};
use crate::dense::{largest_share, solve};
use crate::error::{Error, check_finite, check_shape, check_square};
use crate::exponential_series::{HeldInput, hold_by_series, precise_hold};
use crate::kernel::vectorised;
use crate::mat::Mat;
use crate::structure::Structure;
use crate::tolerance::{
    EXPM_BALANCE_GAIN, EXPM_COMMUTES, EXPM_ENTRY, EXPM_LONG_CHAIN, EXPM_SHORT_CHAIN, PRECISE_EXPONENTIAL,
    SERIES_STATES,
};
use crate::transition::{Transition, has_many};

/// Returns the exponential of a square matrix.
///
/// Method: balancing by powers of two (kept only where it lowers the 1-norm), scaling and squaring with the diagonal Pade
/// approximant of degree 3 to 13 (Higham, SIAM J. Matrix Anal. 26, 2005). The degree suits the norm and the longest chain of states that
/// act on each other, so that the small entries of long chains are right, too; of stiff matrices the slow states keep their digits, because the diagonal is
/// squared as its change from one. Cost up to about (14 + 2 s) n^3.
///
/// # Errors
/// Not square, or not finite. An exponential that overflows is [`Error::NotFinite`]; a matrix whose norm does, [`Error::OutOfRange`].
pub fn expm(A: &Mat) -> Result<Mat, Error> {
    transition(A, 0).map(|exponential| exponential.Phi)
}

/// Returns the exponential of a matrix that the caller squares so many times.
pub(crate) fn transition(A: &Mat, squarings: i32) -> Result<Transition, Error> {
    check_square("A", A)?;
    let n = A.nrows();
    let balanced = balance_all(A)?;
    if is_good_as_given(A, &balanced, f64::from(squarings).exp2()) {
        return check_transition(pade(A, Entries::AsGiven, squarings)?);
    }
    let back = |inner: Transition, d: &[f64]| check_transition(inner.scale_states(d));
    let entries = Entries::of(&balanced);
    let first = back(pade(&balanced.A, entries, squarings)?, &balanced.scale)?;
    if !balanced.is_wide() {
        return Ok(first);
    }
    let other = || {
        let balanced = balance_beside_own_rates(A)?;
        back(pade(&balanced.A, entries, squarings)?, &balanced.scale)
    };
    let precise = || back(precise_hold(&balanced.A, &Mat::zeros(n, 0))?.transition, &balanced.scale).ok();
    commuting(A, first, other, precise, |E| &E.Phi)
}

/// Returns whether balancing does not pay for a matrix over an interval `h`: it hardly lowers the norm, and the units are not far apart beside rates so fast
/// that the norm is theirs alone.
fn is_good_as_given(A: &Mat, balanced: &BalancedMatrix, h: f64) -> bool {
    let norm = A.norm_one();
    let is_stiff = has_many((norm * h / LARGEST).log2().ceil() as i32);
    balanced.A.norm_one() > EXPM_BALANCE_GAIN * norm && !(is_stiff && balanced.is_wide())
}

/// The origin of the entries of a matrix.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Entries {
    /// They are those of the caller, or nearly so.
    AsGiven,
    /// They were scaled by many decades, so that the largest way from one state to another may be a long one although there is a short one.
    Rescaled,
}

impl Entries {
    fn of(balanced: &BalancedMatrix) -> Self {
        if balanced.is_wide() { Self::Rescaled } else { Self::AsGiven }
    }
}

/// Returns the exponential, which commutes with its matrix; another one, of the matrix balanced otherwise, if the first does not and that comes nearer; one in 32
/// digits if neither does, and the matrix is small.
fn commuting<T>(
    A: &Mat,
    first: T,
    other: impl FnOnce() -> Result<T, Error>,
    precise: impl FnOnce() -> Option<T>,
    exponential: impl Fn(&T) -> &Mat,
) -> Result<T, Error> {
    let distance = commutator(A, exponential(&first));
    if distance <= EXPM_COMMUTES {
        return Ok(first);
    }
    let second = other()?;
    let least = commutator(A, exponential(&second));
    if least > EXPM_COMMUTES
        && A.nrows() <= PRECISE_EXPONENTIAL
        && let Some(precise) = precise()
    {
        return Ok(precise);
    }
    Ok(if least < distance { second } else { first })
}

/// The largest entry of `A E - E A`, each over the sum of the moduli of its terms.
fn commutator(A: &Mat, E: &Mat) -> f64 {
    let (a, e) = (A.map(f64::abs), E.map(f64::abs));
    let (difference, size) = (A * E - E * A, &a * &e + &e * &a);
    largest_share(&difference, &size)
}

pub(crate) fn check_exponential(result: Mat) -> Result<Mat, Error> {
    check_finite("the exponential", &result)?;
    Ok(result)
}

fn check_transition(result: Transition) -> Result<Transition, Error> {
    check_finite("the exponential", &result.Phi)?;
    Ok(result)
}

/// Largest 1-norm for which the approximant of each degree is good to double precision, and its coefficients.
const DEGREES: [(f64, &[f64]); 4] = [
    (1.495585217958292e-2, &[120.0, 60.0, 12.0, 1.0]),
    (2.53939833006323e-1, &[30240.0, 15120.0, 3360.0, 420.0, 30.0, 1.0]),
    (9.504178996162932e-1, &[17297280.0, 8648640.0, 1995840.0, 277200.0, 25200.0, 1512.0, 56.0, 1.0]),
    (
        2.097847961257068,
        &[
            17643225600.0,
            8821612800.0,
            2075673600.0,
            302702400.0,
            30270240.0,
            2162160.0,
            110880.0,
            3960.0,
            90.0,
            1.0,
        ],
    ),
];

/// The same for degree 13.
const LARGEST: f64 = 5.371920351148152;
const COEFFICIENTS_13: [f64; 14] = [
    64764752532480000.0,
    32382376266240000.0,
    7771770303897600.0,
    1187353796428800.0,
    129060195264000.0,
    10559470521600.0,
    670442572800.0,
    33522128640.0,
    1323241920.0,
    40840800.0,
    960960.0,
    16380.0,
    182.0,
    1.0,
];

/// Returns the exponential of a matrix that the caller squares `further` times.
fn pade(A: &Mat, entries: Entries, further: i32) -> Result<Transition, Error> {
    let structure = Structure::of(A);
    let chain = chain_steps(&structure, A);
    let ScaledMatrix { A: scaled, squarings, mut degree } = scale_for_approximant(A, chain)?;
    if is_long_chain(chain, squarings, A.nrows()) {
        return hold_by_series(A, &Mat::zeros(A.nrows(), 0), chain).map(|held| held.transition);
    }
    let A = scaled;
    if squarings == 0 && (structure.longest_path > EXPM_SHORT_CHAIN || entries == Entries::Rescaled) {
        degree = raise_degree(&A, degree);
    }
    let (W, V) = approximant(&A, degree);
    let U = &A * &W;
    let has_many = has_many(squarings.saturating_add(further));
    let mut X = solve(&(&V - &U), &if has_many { U.scale(2.0) } else { &V + &U })?;
    structure.clear_unreached(&mut X);
    let mut power = if has_many { Transition::of_change(X) } else { Transition::of_rounded(X) };
    for _ in 0..squarings {
        power = power.square();
        check_finite("the exponential", &power.Phi)?;
    }
    Ok(power)
}

/// Returns the number of steps of the longest chain of states, those of the largest terms if the chain of a small matrix is long.
fn chain_steps(structure: &Structure, A: &Mat) -> usize {
    if is_long_chain(structure.longest_path, 0, A.nrows()) {
        structure.count_steps_of_largest_terms(A)
    } else {
        structure.longest_path
    }
}

/// Returns whether the states of a small matrix form a chain so long that an approximant loses the digits of its last entries.
fn is_long_chain(chain: usize, squarings: i32, states: usize) -> bool {
    states <= SERIES_STATES && chain as f64 > EXPM_LONG_CHAIN * f64::from(squarings).exp2()
}

/// A matrix over a power of two, the exponent, and the degree of the approximant that is good for it.
struct ScaledMatrix {
    A: Mat,
    squarings: i32,
    degree: usize,
}

/// Returns the matrix over the least power of two, with the lowest degree, for which the approximant is good to double precision beside the norm, and
/// entry by entry along chains of up to `chain` steps.
///
/// # Errors
/// [`Error::OutOfRange`] if the norm is beyond the largest double: no power would do.
fn scale_for_approximant(A: &Mat, chain: usize) -> Result<ScaledMatrix, Error> {
    let norm = A.norm_one();
    if !norm.is_finite() {
        return Err(Error::OutOfRange { what: "the matrix of an exponential" });
    }
    let mut squarings = (norm / LARGEST).log2().ceil().max(0.0) as i32;
    let degree = loop {
        let scaled = norm * (-squarings as f64).exp2();
        let is_good = |&(degree, limit): &(usize, f64)| {
            let is_accurate = chain_error(degree, scaled, squarings, chain) <= EXPM_ENTRY.log2();
            scaled <= limit && is_accurate
        };
        let limits = DEGREES.iter().map(|(limit, b)| (b.len() - 1, *limit)).chain([(13, f64::INFINITY)]);
        if let Some((degree, _)) = limits.into_iter().find(is_good) {
            break degree;
        }
        squarings += 1;
    };
    Ok(ScaledMatrix { A: A.scale((-squarings as f64).exp2()), squarings, degree })
}

/// Returns the binary logarithm of the relative error of the entry at the end of a chain of equal steps, exp(x) of which holds x^d / d!.
///
/// The approximant of degree m misses 1 / C(2m, m) of the power 2m + 1. Of the d steps of the chain, or of 2m + 1 steps if it is shorter, those that
/// fall into one of 2^s factors have this error. As logarithms, because a large matrix to the power 2m + 1 is beyond the largest double.
fn chain_error(degree: usize, scaled: f64, squarings: i32, chain: usize) -> f64 {
    let missed = 2 * degree + 1;
    let ratio: f64 = if chain < missed {
        (chain + 1..=missed).map(|k| scaled.log2() + f64::from(squarings) - (k as f64).log2()).sum()
    } else {
        (1..=missed).map(|k| ((chain - missed + k) as f64 / k as f64).log2()).sum()
    };
    missed_share(degree).log2() + ratio - 2.0 * degree as f64 * f64::from(squarings)
}

/// Returns 1 / C(2m, m).
fn missed_share(degree: usize) -> f64 {
    (1..=degree).map(|k| k as f64 / (degree + k) as f64).product()
}

/// Returns the lowest degree from the given one on whose error is small beside every entry of the exponential of `A`, which is not halved. Steps of a
/// chain that differ by many decades, and states that act back, make the error of its last entries larger than that of equal steps.
fn raise_degree(A: &Mat, mut degree: usize) -> usize {
    let higher = |degree: usize| DEGREES.iter().map(|(_, b)| b.len() - 1).find(|&m| m > degree).unwrap_or(13);
    while degree < 13 && entry_error(A, degree) > EXPM_ENTRY {
        degree = higher(degree);
    }
    degree
}

/// Returns the largest error of an entry, over the sum of the moduli of what its series is made of.
fn entry_error(A: &Mat, degree: usize) -> f64 {
    let A = A.map(f64::abs);
    let mut term = A.clone();
    let mut sum = &A + &Mat::eye(A.nrows());
    for k in 2..=2 * degree + 1 {
        term = (&term * &A).scale(1.0 / k as f64);
        sum += &term;
    }
    let ratios = term.as_slice().iter().zip(sum.as_slice()).filter(|(missed, _)| **missed > 0.0);
    missed_share(degree) * ratios.map(|(missed, sum)| missed / sum).fold(0.0, f64::max)
}

/// `W` and `V` of one degree.
fn approximant(A: &Mat, degree: usize) -> (Mat, Mat) {
    let lower = DEGREES.iter().find(|(_, b)| b.len() == degree + 1);
    lower.map_or_else(|| degree_13(A), |(_, coefficients)| low_degree(A, coefficients))
}

/// `W` and `V` of `A` for one degree: the odd part of the numerator is `A W`, the even part `V`.
fn low_degree(A: &Mat, b: &[f64]) -> (Mat, Mat) {
    let n = A.nrows();
    let square = A * A;
    let (mut odd, mut even) = (Mat::eye(n).scale(b[1]), Mat::eye(n).scale(b[0]));
    let mut power = square.clone();
    for (k, pair) in b.chunks(2).enumerate().skip(1) {
        if k > 1 {
            power = &power * &square;
        }
        add_scaled(&mut even, &power, pair[0]);
        add_scaled(&mut odd, &power, pair[1]);
    }
    (odd, even)
}

/// The same for degree 13, with three powers.
fn degree_13(A: &Mat) -> (Mat, Mat) {
    let b = &COEFFICIENTS_13;
    let A2 = A * A;
    let A4 = &A2 * &A2;
    let A6 = &A4 * &A2;
    let identity = Mat::eye(A.nrows());
    let sum = |c: [f64; 4]| {
        let mut total = identity.scale(c[0]);
        add_scaled(&mut total, &A2, c[1]);
        add_scaled(&mut total, &A4, c[2]);
        add_scaled(&mut total, &A6, c[3]);
        total
    };
    let odd = &A6 * sum([0.0, b[9], b[11], b[13]]) + sum([b[1], b[3], b[5], b[7]]);
    let even = &A6 * sum([0.0, b[8], b[10], b[12]]) + sum([b[0], b[2], b[4], b[6]]);
    (odd, even)
}

vectorised! {
    fn add_scaled<'a>(sum: &'a mut Mat, term: &'a Mat, factor: f64) -> () {
        sum.as_mut_slice().iter_mut().zip(term.as_slice()).for_each(|(s, &t)| *s += factor * t);
    }
}

/// Returns the zero-order hold: `Phi = exp(A h)` and `Gamma = integral of exp(A s) B ds from 0 to h`; `A` n x n, `B` n x m,
/// `h > 0` in seconds (or any unit that agrees with `A`).
///
/// Method: the exponential of `[A B; 0 0] h` (Van Loan) by its Pade approximant, of which the first n rows are computed
/// only; with `A W` and `V` the odd and the even part of the numerator, `(V - A W) [Phi - I, Gamma] = 2 [A W, W B]`. `A` is
/// balanced by powers of two, the size of `B` plays no part. The degree is chosen as for [`expm`].
///
/// # Errors
/// Wrong shapes, entries that are not finite.
pub fn expm_integral(A: &Mat, B: &Mat, h: f64) -> Result<(Mat, Mat), Error> {
    check_square("A", A)?;
    check_shape("B", B, A.nrows(), B.ncols())?;
    let balanced = balance_all(A)?;
    if is_good_as_given(A, &balanced, h) {
        return hold_integral(&A.scale(h), &B.scale(h), Entries::AsGiven).map(HeldInput::into_pair);
    }
    let input = |d: &[f64]| Mat::from_fn(B.nrows(), B.ncols(), |i, j| B[(i, j)] * h / d[i]);
    let entries = Entries::of(&balanced);
    let first =
        hold_integral(&balanced.A.scale(h), &input(&balanced.scale), entries)?.rescale(&balanced.scale)?;
    if !balanced.is_wide() {
        return Ok(first.into_pair());
    }
    let other = || {
        let balanced = balance_beside_own_rates(A)?;
        hold_integral(&balanced.A.scale(h), &input(&balanced.scale), entries)?.rescale(&balanced.scale)
    };
    let precise =
        || precise_hold(&balanced.A.scale(h), &input(&balanced.scale))?.rescale(&balanced.scale).ok();
    commuting(A, first, other, precise, |held| &held.transition.Phi).map(HeldInput::into_pair)
}

impl HeldInput {
    /// Returns both matrices for states in other units: `D Phi D^-1` and `D Gamma`.
    fn rescale(self, d: &[f64]) -> Result<Self, Error> {
        let Gamma = Mat::from_fn(self.Gamma.nrows(), self.Gamma.ncols(), |i, j| self.Gamma[(i, j)] * d[i]);
        Self { transition: self.transition.scale_states(d), Gamma }.check()
    }

    /// Returns both matrices if they are finite.
    fn check(self) -> Result<Self, Error> {
        check_finite("the exponential", &self.transition.Phi)?;
        check_finite("the integral of the exponential", &self.Gamma)?;
        Ok(self)
    }

    fn into_pair(self) -> (Mat, Mat) {
        (self.transition.Phi, self.Gamma)
    }
}

/// `exp(A)` and the integral of `exp(A s) B` from 0 to 1.
fn hold_integral(A: &Mat, B: &Mat, entries: Entries) -> Result<HeldInput, Error> {
    let (n, m) = B.shape();
    let structure = Structure::of(A);
    let chain = chain_steps(&structure, A) + 1;
    let ScaledMatrix { A: scaled, squarings, mut degree } = scale_for_approximant(A, chain)?;
    if is_long_chain(chain, squarings, n) {
        return hold_by_series(A, B, chain)?.check();
    }
    let A = scaled;
    if squarings == 0 && (chain > EXPM_SHORT_CHAIN || entries == Entries::Rescaled) {
        degree = raise_degree(&A.hstack(B).vstack(&Mat::zeros(m, n + m)), degree);
    }
    let B = B.scale((-squarings as f64).exp2());
    let (W, V) = approximant(&A, degree);
    let U = &A * &W;
    let change = solve(&(&V - &U), &U.hstack(&(&W * &B)).scale(2.0))?;
    let (mut Phi, mut Gamma) = (change.block(0, 0, n, n), change.block(0, n, n, m));
    structure.clear_unreached(&mut Phi);
    structure.clear_unreached_by(&B, &mut Gamma);
    HeldInput { transition: Transition::of_change(Phi), Gamma }.square_repeatedly(squarings)?.check()
}
