//! The exponential and its integral as sums of their power series, in doubles or in 32 digits.
//!
//! An approximant of Padé divides by a polynomial of mixed signs, so that the error of the entry d states along a chain grows as 2^d beside that entry. A
//! series divides by nothing: every entry is known to some roundings of the sum of the moduli of its terms. Evaluated as by Paterson and Stockmeyer,
//! SIAM J. Comput. 2 (1973), with about twice the root of the degree in products.

use crate::error::{Error, check_finite};
use crate::long_matrix::{LongMatrix, LongReal};
use crate::mat::Mat;
use crate::structure::Moduli;
use crate::tolerance::{SERIES_ENTRY, SERIES_NORM, SERIES_SQUARINGS};
use crate::transition::Transition;

/// A matrix whose power series can be summed.
trait Term: Clone {
    /// Returns the number of rows.
    fn size(&self) -> usize;
    /// Returns the identity times a number.
    fn identity(n: usize, factor: LongReal) -> Self;
    /// Returns `self other`.
    fn product(&self, other: &Self) -> Self;
    /// Adds a multiple of another matrix.
    fn add_multiple(&mut self, other: &Self, factor: LongReal);
}

impl Term for Mat {
    fn size(&self) -> usize {
        self.nrows()
    }

    fn identity(n: usize, factor: LongReal) -> Self {
        Self::eye(n).scale(factor.high)
    }

    fn product(&self, other: &Self) -> Self {
        self * other
    }

    fn add_multiple(&mut self, other: &Self, factor: LongReal) {
        self.as_mut_slice().iter_mut().zip(other.as_slice()).for_each(|(s, &t)| *s += factor.high * t);
    }
}

impl Term for LongMatrix {
    fn size(&self) -> usize {
        self.high.nrows()
    }

    fn identity(n: usize, factor: LongReal) -> Self {
        let part = |value: f64| Mat::eye(n).scale(value);
        Self { high: part(factor.high), low: part(factor.low) }
    }

    fn product(&self, other: &Self) -> Self {
        self.times(other)
    }

    fn add_multiple(&mut self, other: &Self, factor: LongReal) {
        self.add_times(other, factor);
    }
}

/// A matrix over a power of two whose series converges quickly, and the degree that leaves rounding errors only.
struct SeriesScale {
    squarings: i32,
    degree: usize,
}

impl SeriesScale {
    /// Returns the scaling of a matrix for a series that ends `terms` terms after the first one of an entry. An entry that is `chain` steps away has its first
    /// term there; of the steps of a chain every factor of a power takes its share.
    fn of(A: &Mat, chain: usize, terms: usize) -> Self {
        let squarings = (A.norm_one() / SERIES_NORM).log2().ceil().max(0.0);
        let share = (chain as f64 / squarings.exp2()).ceil() as usize;
        Self { squarings: squarings as i32, degree: share + terms }
    }

    fn factor(&self) -> f64 {
        (-f64::from(self.squarings)).exp2()
    }

    /// Raises the degree until what is left out is rounding beside every entry that is reached within `steps` steps. `A` is the scaled matrix.
    fn reach_every_entry(&mut self, A: &Mat, steps: usize) {
        let mut terms = Moduli::of(A);
        let longest = self.degree + A.nrows();
        let mut settled = 0;
        for k in 1..longest {
            let is_small = terms.advance(k, steps) <= SERIES_ENTRY;
            settled = if k > self.degree && is_small { settled + 1 } else { 0 };
            // Of a matrix with two sorts of states every other term of an entry is zero.
            if settled == 2 {
                self.degree = k - 2;
                return;
            }
        }
        self.degree = longest;
    }
}

/// The exponential of a matrix, and the integral of `exp(A s) B` over s from 0 to 1.
pub(crate) struct HeldInput {
    pub(crate) transition: Transition,
    pub(crate) Gamma: Mat,
}

impl HeldInput {
    /// Returns both for an interval that is doubled so many times.
    ///
    /// # Errors
    /// An exponential that overflows.
    pub(crate) fn square_repeatedly(self, squarings: i32) -> Result<Self, Error> {
        let (mut power, mut Gamma) = (self.transition.prepare_squarings(squarings), self.Gamma);
        for _ in 0..squarings {
            Gamma = &Gamma + &(&power.Phi * &Gamma);
            power = power.square();
            check_finite("the exponential", &power.Phi)?;
        }
        Ok(Self { transition: power, Gamma })
    }
}

/// Terms of a series in doubles and in 32 digits: what is left out is below 1 / 19! and 1 / 30! of the largest term, for the norm [`SERIES_NORM`].
const TERMS: usize = 18;
const LONG_TERMS: usize = 29;

/// Returns the exponential and the integral in doubles. `chain` is the number of steps of the longest chain of states, the input among them.
///
/// # Errors
/// An exponential that overflows.
pub(crate) fn hold_by_series(A: &Mat, B: &Mat, chain: usize) -> Result<HeldInput, Error> {
    let mut scaled = SeriesScale::of(A, chain, TERMS);
    let A = A.scale(scaled.factor());
    // The factors of a power do not take equal shares of every way.
    scaled.reach_every_entry(&A, scaled.degree - TERMS / 2);
    let [change, Gamma] = hold(&A, &B.scale(scaled.factor()), scaled.degree);
    HeldInput { transition: Transition::of_change(change), Gamma }.square_repeatedly(scaled.squarings)
}

/// Returns the exponential and the integral in 32 digits, rounded, each entry right beside the sum of the moduli of its terms whatever the units of the states
/// are; `None` if the matrix is so large that squaring would leave less than a double.
pub(crate) fn precise_hold(A: &Mat, B: &Mat) -> Option<HeldInput> {
    let scaled = SeriesScale::of(A, A.nrows(), LONG_TERMS);
    if scaled.squarings > SERIES_SQUARINGS {
        return None;
    }
    let long = |M: &Mat| LongMatrix::from(&M.scale(scaled.factor()));
    let (one, identity) = (LongReal::from(1.0), LongMatrix::identity(A.nrows(), 1.0));
    let [mut Phi, mut Gamma] = hold(&long(A), &long(B), scaled.degree);
    Phi.add_times(&identity, one);
    for _ in 0..scaled.squarings {
        Gamma.add_times(&Phi.times(&Gamma), one);
        Phi = Phi.times(&Phi);
    }
    let change = Phi.difference(&identity).round().diagonal();
    Some(HeldInput {
        transition: Transition { change: Some(change), Phi: Phi.round() },
        Gamma: Gamma.round(),
    })
}

/// Returns the exponential less the identity and the integral, of a matrix and an input that were scaled for a series of this degree.
fn hold<M: Term>(A: &M, B: &M, degree: usize) -> [M; 2] {
    let sum = integral(A, degree);
    [A.product(&sum), sum.product(B)]
}

/// Returns the sum of `A^k / (k + 1)!` up to k = `degree`.
fn integral<M: Term>(A: &M, degree: usize) -> M {
    let n = A.size();
    let width = (degree as f64 + 1.0).sqrt().ceil() as usize;
    let mut powers = vec![A.clone()];
    for k in 1..width {
        powers.push(powers[k - 1].product(A));
    }
    let mut coefficients = vec![LongReal::from(1.0)];
    for k in 1..=degree {
        coefficients.push(coefficients[k - 1] / LongReal::from((k + 1) as f64));
    }
    let part = |coefficients: &[LongReal]| {
        let mut sum = M::identity(n, coefficients[0]);
        coefficients[1..].iter().zip(&powers).for_each(|(&c, power)| sum.add_multiple(power, c));
        sum
    };
    let mut parts = coefficients.chunks(width).rev().map(part);
    let last = parts.next().unwrap_or_else(|| M::identity(n, LongReal::from(1.0)));
    parts.fold(last, |sum, mut part| {
        part.add_multiple(&powers[width - 1].product(&sum), LongReal::from(1.0));
        part
    })
}
