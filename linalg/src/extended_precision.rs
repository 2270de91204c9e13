//! Matrices in twice the working precision, as the sum of two doubles: what residuals are computed with.
//!
//! Products are split into slices whose products are exact in double precision, so that the fast kernels do the work.
//! Source: Ozaki, Ogita, Oishi and Rump, Error-free transformations of matrix multiplication, Numer. Algorithms 59 (2012).

use crate::dense::{LARGE_SYMMETRIC, add_lower_half, copy_lower_to_upper, view};
use crate::kernel::vectorised;
use crate::mat::Mat;

/// `high + low`, where `low` (absent: zero) is of the size of the rounding error of `high`.
#[derive(Clone)]
pub(crate) struct ExtendedMatrix {
    pub(crate) high: Mat,
    pub(crate) low: Option<Mat>,
}

impl From<Mat> for ExtendedMatrix {
    fn from(high: Mat) -> Self {
        Self { high, low: None }
    }
}

impl ExtendedMatrix {
    /// The nearest double matrix.
    pub(crate) fn to_double(&self) -> Mat {
        match &self.low {
            None => self.high.clone(),
            Some(low) => &self.high + low,
        }
    }

    pub(crate) fn t(&self) -> Self {
        Self { high: self.high.t(), low: self.low.as_ref().map(Mat::t) }
    }

    pub(crate) fn neg(&self) -> Self {
        Self { high: -&self.high, low: self.low.as_ref().map(|low| -low) }
    }

    pub(crate) fn add(&self, other: &Self) -> Self {
        let mut high = self.high.clone();
        let mut low = match (&self.low, &other.low) {
            (None, None) => Mat::zeros(high.nrows(), high.ncols()),
            (Some(one), None) | (None, Some(one)) => one.clone(),
            (Some(one), Some(two)) => one + two,
        };
        accumulate(&mut high, &mut low, &other.high);
        renormalise(&mut high, &mut low);
        Self { high, low: Some(low) }
    }

    /// The product with an error of about 2^-95 times the norms.
    pub(crate) fn times(&self, other: &Self) -> Self {
        let product = exact_product(&self.high, &other.high);
        self.with_low_parts(other, product, Extent::Whole)
    }

    /// The same of two matrices whose product is symmetric: half of it is computed if it is large.
    pub(crate) fn symmetric_times(&self, other: &Self) -> Self {
        if self.high.nrows() <= LARGE_SYMMETRIC {
            return self.times(other);
        }
        let half = sliced_product(&self.high, &other.high, Extent::LowerHalf);
        let mut product = self.with_low_parts(other, half, Extent::LowerHalf);
        copy_lower_to_upper(&mut product.high);
        product.low.as_mut().into_iter().for_each(copy_lower_to_upper);
        product
    }

    /// Adds what the low parts make of a product of the high ones.
    fn with_low_parts(&self, other: &Self, mut product: Self, extent: Extent) -> Self {
        if let (Some(sum), Some(low)) = (product.low.as_mut(), other.low.as_ref()) {
            extent.add_sum(sum, &self.high, low);
        }
        if let (Some(sum), Some(low)) = (product.low.as_mut(), self.low.as_ref()) {
            extent.add_sum(sum, low, &other.high);
        }
        product
    }
}

/// The entries of a product that are computed.
#[derive(Clone, Copy)]
enum Extent {
    Whole,
    LowerHalf,
}

impl Extent {
    /// Adds `A B` to a sum of such products.
    fn add(self, sum: &mut Mat, A: &Mat, B: &Mat) {
        match self {
            Self::Whole => sum.add_product(A, B),
            Self::LowerHalf => add_lower_half(sum, view(A), view(B)),
        }
    }

    /// Adds `A B`, summed apart, to a matrix of another size.
    fn add_sum(self, sum: &mut Mat, A: &Mat, B: &Mat) {
        match self {
            Self::Whole => *sum += &(A * B),
            Self::LowerHalf => add_lower_half(sum, view(A), view(B)),
        }
    }
}

vectorised! {
    /// `high + low += term`, the rounding error of the sum kept in `low`.
    fn accumulate<'a>(high: &'a mut Mat, low: &'a mut Mat, term: &'a Mat) -> () {
        for ((h, l), &t) in high.as_mut_slice().iter_mut().zip(low.as_mut_slice()).zip(term.as_slice()) {
            let sum = *h + t;
            let back = sum - *h;
            *l += (*h - (sum - back)) + (t - back);
            *h = sum;
        }
    }
}

vectorised! {
    fn renormalise<'a>(high: &'a mut Mat, low: &'a mut Mat) -> () {
        for (h, l) in high.as_mut_slice().iter_mut().zip(low.as_mut_slice()) {
            let sum = *h + *l;
            *l -= sum - *h;
            *h = sum;
        }
    }
}

/// Products with fewer multiplications than this are summed term by term.
const SMALL_PRODUCT: usize = 24 * 24 * 24;

/// `A B` of two double matrices as a sum of two.
pub(crate) fn exact_product(A: &Mat, B: &Mat) -> ExtendedMatrix {
    let (mut high, mut low) = (Mat::zeros(A.nrows(), B.ncols()), Mat::zeros(A.nrows(), B.ncols()));
    if A.nrows() * A.ncols() * B.ncols() < SMALL_PRODUCT {
        sum_terms(A, B, &mut high, &mut low);
        renormalise(&mut high, &mut low);
        return ExtendedMatrix { high, low: Some(low) };
    }
    sliced_product(A, B, Extent::Whole)
}

vectorised! {
    /// Every product and every sum with its rounding error (Dekker, Knuth).
    fn sum_terms<'a>(A: &'a Mat, B: &'a Mat, high: &'a mut Mat, low: &'a mut Mat) -> () {
        let m = A.nrows();
        for j in 0..B.ncols() {
            let (h, l) = (high.column_mut(j), low.column_mut(j));
            let mut i = 0;
            while i + 8 <= m {
                sum_rows::<8>(A.as_slice().get(i..).unwrap_or_default(), m, B.column(j), &mut h[i..], &mut l[i..]);
                i += 8;
            }
            if i + 4 <= m {
                sum_rows::<4>(A.as_slice().get(i..).unwrap_or_default(), m, B.column(j), &mut h[i..], &mut l[i..]);
                i += 4;
            }
            while i < m {
                sum_rows::<1>(A.as_slice().get(i..).unwrap_or_default(), m, B.column(j), &mut h[i..], &mut l[i..]);
                i += 1;
            }
        }
    }
}

/// Some rows of one column of the product, whose sums stay in registers; `A` begins with the first of them, its columns are `m` entries apart.
#[inline(always)]
fn sum_rows<const ROWS: usize>(A: &[f64], m: usize, factors: &[f64], high: &mut [f64], low: &mut [f64]) {
    let (mut h, mut l) = ([0.0; ROWS], [0.0; ROWS]);
    for (column, &factor) in A.chunks(m).zip(factors) {
        let Some(column) = column.first_chunk::<ROWS>() else { break };
        for ((h, l), &a) in h.iter_mut().zip(&mut l).zip(column) {
            let product = a * factor;
            let lost = a.mul_add(factor, -product);
            let sum = *h + product;
            let back = sum - *h;
            *l += (*h - (sum - back)) + (product - back) + lost;
            *h = sum;
        }
    }
    high[..ROWS].copy_from_slice(&h);
    low[..ROWS].copy_from_slice(&l);
}

/// The same by slices and fast products.
fn sliced_product(A: &Mat, B: &Mat, extent: Extent) -> ExtendedMatrix {
    // The two products of the first slices with the second ones are summed exactly, too: twice as many terms.
    let inner = 2.0 * A.ncols().max(1) as f64;
    let bits = ((53.0 - inner.log2().ceil()) / 2.0).floor() as i32;
    let (a, b) =
        (slices(A, &row_exponents(A), bits, Side::Left), slices(B, &column_exponents(B), bits, Side::Right));
    let empty = || Mat::zeros(A.nrows(), B.ncols());
    let (mut high, mut middle, mut low) = (empty(), empty(), empty());
    extent.add(&mut high, &a.first, &b.first);
    extent.add(&mut middle, &a.first, &b.second);
    extent.add(&mut middle, &a.second, &b.first);
    extent.add(&mut low, &a.second, &b.rest);
    extent.add(&mut low, &a.third, B);
    extent.add(&mut low, &a.first, &b.third);
    accumulate(&mut high, &mut low, &middle);
    renormalise(&mut high, &mut low);
    ExtendedMatrix { high, low: Some(low) }
}

#[derive(Clone, Copy)]
enum Side {
    Left,
    Right,
}

/// The exponent just above the largest entry of each row.
fn row_exponents(A: &Mat) -> Vec<f64> {
    let mut largest = vec![0.0_f64; A.nrows()];
    for j in 0..A.ncols() {
        largest.iter_mut().zip(A.column(j)).for_each(|(m, &a)| *m = m.max(a.abs()));
    }
    largest.into_iter().map(power_above).collect()
}

fn column_exponents(A: &Mat) -> Vec<f64> {
    (0..A.ncols()).map(|j| power_above(A.column(j).iter().fold(0.0, |m: f64, &a| m.max(a.abs())))).collect()
}

/// A power of two at or above `value`.
fn power_above(value: f64) -> f64 {
    if value == 0.0 { 1.0 } else { value.log2().ceil().clamp(-900.0, 900.0).exp2() }
}

/// Slices that sum to a matrix (up to its last bits where a row or column spans more than they hold).
struct Slices {
    first: Mat,
    second: Mat,
    third: Mat,
    /// The second and the third.
    rest: Mat,
}

/// The slices of `A`: each of the first two has `bits` bits counted from its row's or column's largest entry.
fn slices(A: &Mat, largest: &[f64], bits: i32, side: Side) -> Slices {
    let anchor: Vec<f64> = largest.iter().map(|l| 1.5 * l * f64::from(52 - bits).exp2()).collect();
    let empty = || Mat::zeros(A.nrows(), A.ncols());
    let mut parts = Slices { first: A.clone(), second: empty(), third: empty(), rest: empty() };
    cut(&anchor, f64::from(-bits).exp2(), side, &mut parts);
    parts
}

vectorised! {
    /// Cuts the matrix that stands in the place of the first slice: the leading bits of each entry survive the addition of the anchor, those
    /// that follow that of the anchor times `step`.
    fn cut<'a>(anchor: &'a [f64], step: f64, side: Side, parts: &'a mut Slices) -> () {
        for j in 0..parts.first.ncols() {
            let columns = (parts.first.column_mut(j).iter_mut().zip(parts.second.column_mut(j)))
                .zip(parts.third.column_mut(j).iter_mut().zip(parts.rest.column_mut(j)));
            match side {
                Side::Left => columns.zip(anchor).for_each(|(((first, second), (third, rest)), &s)| {
                    shave([first, second, third, rest], s, s * step);
                }),
                Side::Right => columns.for_each(|((first, second), (third, rest))| {
                    shave([first, second, third, rest], anchor[j], anchor[j] * step);
                }),
            }
        }
    }
}

/// Cuts one entry, which stands in the place of its first slice.
#[inline(always)]
fn shave([first, second, third, rest]: [&mut f64; 4], anchor: f64, finer: f64) {
    let whole = *first;
    *first = (whole + anchor) - anchor;
    *rest = whole - *first;
    *second = (*rest + finer) - finer;
    *third = *rest - *second;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integers of 50 bits: the product needs 100, and integer arithmetic gives it exactly.
    #[test]
    fn products_carry_twice_the_precision() {
        let entry = |i: usize, j: usize| ((1_i64 << 49) + (i * 7919 + j * 104_729) as i64 * 999_983) as f64;
        let A = Mat::from_fn(9, 7, entry);
        let B = Mat::from_fn(7, 5, |i, j| -entry(j, i));
        for product in [exact_product(&A, &B), sliced_product(&A, &B, Extent::Whole)] {
            check(&A, &B, &product);
        }
    }

    #[test]
    fn half_of_a_symmetric_product_is_as_exact() {
        let n = LARGE_SYMMETRIC + 9;
        let entry =
            |i: usize, j: usize| ((1_i64 << 49) + ((i * 7919 + j * 104_729) % 997) as i64 * 999_983) as f64;
        let A = ExtendedMatrix {
            high: Mat::from_fn(n, n, entry),
            low: Some(Mat::from_fn(n, n, |i, j| entry(j, i) * 1e-17)),
        };
        let (half, whole) = (A.t().symmetric_times(&A), A.t().times(&A));
        let difference = half.add(&whole.neg()).to_double().norm_fro();
        assert!(difference < 1e-29 * whole.high.norm_fro(), "{difference}");
        assert_eq!(half.high, half.high.t());
    }

    fn check(A: &Mat, B: &Mat, product: &ExtendedMatrix) {
        let none = Mat::zeros(9, 5);
        let low = product.low.as_ref().unwrap_or(&none);
        for i in 0..9 {
            for j in 0..5 {
                let exact: i128 = (0..7).map(|k| A[(i, k)] as i128 * B[(k, j)] as i128).sum();
                let rest = exact - product.high[(i, j)] as i128;
                assert!((rest as f64 - low[(i, j)]).abs() < 1e-10 * (rest as f64).abs().max(1.0));
            }
        }
    }
}
