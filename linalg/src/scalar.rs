//! The operations of an entry of a matrix, and the product of two matrices of such entries.

use std::fmt;
use std::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

use crate::kernel::vectorised;

/// A double-precision complex number.
pub type C64 = num_complex::Complex<f64>;

/// Operations of an entry of a matrix.
pub trait Scalar:
    Copy
    + PartialEq
    + fmt::Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + Send
    + Sync
    + 'static
{
    /// The additive neutral element.
    const ZERO: Self;
    /// The multiplicative neutral element.
    const ONE: Self;
    /// The modulus.
    fn modulus(self) -> f64;
    /// The complex conjugate (the number itself where it is real).
    fn conjugate(self) -> Self;
    /// The sum of the squared moduli, which may overflow.
    fn sum_of_squares(data: &[Self]) -> f64;
    /// Returns whether every entry is finite.
    fn all_finite(data: &[Self]) -> bool;
    /// `C += A B` for column-major data; `A` is m x k, `B` is k x n.
    fn gemm(m: usize, k: usize, n: usize, a: &[Self], b: &[Self], c: &mut [Self]);
}

impl Scalar for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    fn modulus(self) -> f64 {
        self.abs()
    }
    fn conjugate(self) -> Self {
        self
    }
    fn sum_of_squares(data: &[Self]) -> f64 {
        sum_of_squares(data)
    }
    fn all_finite(data: &[Self]) -> bool {
        all_finite(data)
    }
    fn gemm(m: usize, k: usize, n: usize, a: &[Self], b: &[Self], c: &mut [Self]) {
        if m * k * n < LARGE_PRODUCT {
            return small_gemm_f64(m, k, n, a, b, c);
        }
        faer::linalg::matmul::matmul(
            faer::MatMut::from_column_major_slice_mut(c, m, n),
            faer::Accum::Add,
            faer::MatRef::from_column_major_slice(a, m, k),
            faer::MatRef::from_column_major_slice(b, k, n),
            1.0,
            faer::Par::Seq,
        );
    }
}

impl Scalar for C64 {
    const ZERO: Self = C64 { re: 0.0, im: 0.0 };
    const ONE: Self = C64 { re: 1.0, im: 0.0 };
    fn modulus(self) -> f64 {
        self.norm()
    }
    fn conjugate(self) -> Self {
        self.conj()
    }
    fn sum_of_squares(data: &[Self]) -> f64 {
        data.iter().map(|e| e.norm_sqr()).sum()
    }
    fn all_finite(data: &[Self]) -> bool {
        data.iter().all(|e| e.re.is_finite() && e.im.is_finite())
    }
    fn gemm(m: usize, k: usize, n: usize, a: &[Self], b: &[Self], c: &mut [Self]) {
        if m * k * n < LARGE_PRODUCT {
            return small_gemm_c64(m, k, n, a, b, c);
        }
        faer::linalg::matmul::matmul(
            faer::MatMut::from_column_major_slice_mut(c, m, n),
            faer::Accum::Add,
            faer::MatRef::from_column_major_slice(a, m, k),
            faer::MatRef::from_column_major_slice(b, k, n),
            C64::ONE,
            faer::Par::Seq,
        );
    }
}

vectorised! {
    /// Eight partial sums, so that the additions overlap.
    fn sum_of_squares<'a>(data: &'a [f64]) -> f64 {
        let mut sums = [0.0; 8];
        let chunks = data.chunks_exact(8);
        let rest: f64 = chunks.remainder().iter().map(|e| e * e).sum();
        for chunk in chunks {
            sums.iter_mut().zip(chunk).for_each(|(s, e)| *s += e * e);
        }
        sums.iter().sum::<f64>() + rest
    }
}

vectorised! {
    /// Zero times a number that is not finite is no number.
    fn all_finite<'a>(data: &'a [f64]) -> bool {
        let mut sums = [0.0; 8];
        let chunks = data.chunks_exact(8);
        let rest: f64 = chunks.remainder().iter().map(|e| e * 0.0).sum();
        for chunk in chunks {
            sums.iter_mut().zip(chunk).for_each(|(s, e)| *s += e * 0.0);
        }
        sums.iter().sum::<f64>() + rest == 0.0
    }
}

/// Products with more multiplications than this go to faer's blocked kernel.
const LARGE_PRODUCT: usize = 16 * 16 * 16;

vectorised! {
    fn small_gemm_f64<'a>(m: usize, k: usize, n: usize, a: &'a [f64], b: &'a [f64], c: &'a mut [f64]) -> () {
        if m >= PANEL_ROWS && k > 0 {
            panelled_gemm(m, k, n, a, b, c);
        } else {
            small_gemm(m, k, n, a, b, c);
        }
    }
}

vectorised! {
    fn small_gemm_c64<'a>(m: usize, k: usize, n: usize, a: &'a [C64], b: &'a [C64], c: &'a mut [C64]) -> () {
        small_gemm(m, k, n, a, b, c);
    }
}

/// Rows and columns of a block of the product whose sums stay in registers.
const PANEL_ROWS: usize = 8;
const PANEL_COLUMNS: usize = 4;

/// The same sums as those of [`small_gemm`], in the same order.
#[inline(always)]
fn panelled_gemm(m: usize, k: usize, n: usize, a: &[f64], b: &[f64], c: &mut [f64]) {
    for j in (0..n).step_by(PANEL_COLUMNS) {
        if j + PANEL_COLUMNS > n {
            (j..n).for_each(|j| panel_rows::<1>([m, k], a, &b[j * k..], &mut c[j * m..]));
        } else {
            panel_rows::<PANEL_COLUMNS>([m, k], a, &b[j * k..], &mut c[j * m..]);
        }
    }
}

/// Some columns of the product, block by block of rows.
#[inline(always)]
fn panel_rows<const COLUMNS: usize>([m, k]: [usize; 2], a: &[f64], b: &[f64], c: &mut [f64]) {
    let mut i = 0;
    while i + 8 <= m {
        panel::<8, COLUMNS>([m, k], &a[i..], b, &mut c[i..]);
        i += 8;
    }
    if i + 4 <= m {
        panel::<4, COLUMNS>([m, k], &a[i..], b, &mut c[i..]);
        i += 4;
    }
    if i + 2 <= m {
        panel::<2, COLUMNS>([m, k], &a[i..], b, &mut c[i..]);
        i += 2;
    }
    if i < m {
        panel::<1, COLUMNS>([m, k], &a[i..], b, &mut c[i..]);
    }
}

/// One block of the product: its sums over k are added one after the other.
#[inline(always)]
fn panel<const ROWS: usize, const COLUMNS: usize>([m, k]: [usize; 2], a: &[f64], b: &[f64], c: &mut [f64]) {
    let mut sums = [[0.0; ROWS]; COLUMNS];
    for (q, sum) in sums.iter_mut().enumerate() {
        sum.copy_from_slice(&c[q * m..q * m + ROWS]);
    }
    let factors: [&[f64]; COLUMNS] = std::array::from_fn(|q| &b[q * k..(q + 1) * k]);
    for (l, column) in a.chunks(m).take(k).enumerate() {
        let Some(column) = column.first_chunk::<ROWS>() else { break };
        for (sum, factors) in sums.iter_mut().zip(factors) {
            let factor = factors[l];
            sum.iter_mut().zip(column).for_each(|(sum, &a)| *sum += a * factor);
        }
    }
    for (q, sum) in sums.iter().enumerate() {
        c[q * m..q * m + ROWS].copy_from_slice(sum);
    }
}

#[inline(always)]
fn small_gemm<T: Scalar>(m: usize, k: usize, n: usize, a: &[T], b: &[T], c: &mut [T]) {
    if m == 0 {
        return;
    }
    for j in 0..n {
        let column = &mut c[j * m..(j + 1) * m];
        let (factors, mut sources) = (&b[j * k..(j + 1) * k], a);
        // Four columns at a time, added one after the other: the target is read and written a quarter as often.
        let fours = factors.chunks_exact(4);
        let rest = fours.remainder();
        for f in fours {
            let (four, others) = sources.split_at(4 * m);
            sources = others;
            let ((p, q), (r, s)) = (four[..2 * m].split_at(m), four[2 * m..].split_at(m));
            for ((target, (&p, &q)), (&r, &s)) in column.iter_mut().zip(p.iter().zip(q)).zip(r.iter().zip(s))
            {
                *target = *target + p * f[0] + q * f[1] + r * f[2] + s * f[3];
            }
        }
        for (&factor, source) in rest.iter().zip(sources.chunks_exact(m)) {
            column.iter_mut().zip(source).for_each(|(target, &source)| *target += source * factor);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mat::Mat;

    #[test]
    fn sums_in_registers_are_the_same_doubles() {
        let entry = |i: usize, j: usize| ((7 * i + 3 * j) as f64).sin() * ((i + 1) as f64).exp();
        for [m, k, n] in [[8, 1, 1], [9, 3, 5], [10, 10, 10], [15, 7, 6], [12, 12, 9]] {
            let (a, b) = (Mat::from_fn(m, k, entry), Mat::from_fn(k, n, |i, j| entry(j, i)));
            let mut expected = Mat::from_fn(m, n, |i, j| entry(i + 1, j));
            let mut found = expected.clone();
            small_gemm(m, k, n, a.as_slice(), b.as_slice(), expected.as_mut_slice());
            panelled_gemm(m, k, n, a.as_slice(), b.as_slice(), found.as_mut_slice());
            assert_eq!(found, expected, "{m} {k} {n}");
        }
    }

    #[test]
    fn large_and_small_products_agree() {
        let entry = |i: usize, j: usize| ((7 * i + 3 * j) % 11) as f64 - 5.0;
        let a = Mat::from_fn(33, 41, entry);
        let b = Mat::from_fn(41, 29, entry);
        let mut expected = Mat::zeros(33, 29);
        small_gemm(33, 41, 29, a.as_slice(), b.as_slice(), expected.as_mut_slice());
        assert_eq!(&a * &b, expected);
    }
}
