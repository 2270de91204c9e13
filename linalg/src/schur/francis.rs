//! The real Schur form of a small Hessenberg matrix: Francis' implicit double shift.
//!
//! Source: Golub and Van Loan, Matrix Computations, 7.5; deflation test of Ahues and Tisseur (LAPACK working note 122);
//! standard 2 x 2 blocks as in LAPACK's dlanv2.

use super::block::{Rotation, standardise};
use crate::error::Error;
use crate::kernel::vectorised;
use crate::mat::{C64, Mat};
use crate::tolerance::{EPS, NEGLIGIBLE_SUBDIAGONAL, QR_ITERATIONS};

vectorised! {
    /// Turns rows and columns `lo..=hi` of the Hessenberg matrix `H` into Schur form; the whole of `H` and `Z` follow.
    pub(super) fn francis<'a>(H: &'a mut Mat, Z: &'a mut Mat, lo: usize, hi: usize) -> Result<(), Error> {
        Iteration { lo, H, Z, scope: Scope::Form }.run(hi)
    }
}

vectorised! {
    /// Leaves on the diagonal of the Hessenberg matrix `H` the blocks of its Schur form, to the last bit those of [`francis`]; what lies
    /// beside the block that is worked on is not kept up to date.
    pub(super) fn francis_values<'a>(H: &'a mut Mat) -> Result<(), Error> {
        let last = H.nrows() - 1;
        let none = &mut Mat::zeros(0, H.nrows());
        Iteration { lo: 0, H, Z: none, scope: Scope::Values }.run(last)
    }
}

/// The matrices that the iteration keeps up to date.
#[derive(Clone, Copy, PartialEq)]
enum Scope {
    /// The whole matrix and the transformation.
    Form,
    /// The unreduced block that is worked on.
    Values,
}

struct Iteration<'a> {
    lo: usize,
    H: &'a mut Mat,
    Z: &'a mut Mat,
    scope: Scope,
}

impl Iteration<'_> {
    #[inline(always)]
    fn run(&mut self, hi: usize) -> Result<(), Error> {
        let limit = QR_ITERATIONS * (hi + 1 - self.lo).max(10);
        let mut end = hi;
        let mut tries = 0;
        for _ in 0..limit {
            let start = self.active_start(end);
            if start + 1 >= end {
                if start + 1 == end {
                    standardise(self.H, self.Z, start);
                }
                let size = end + 1 - start;
                if end < self.lo + size {
                    return Ok(());
                }
                end -= size;
                tries = 0;
            } else {
                tries += 1;
                self.sweep(start, end, tries);
            }
        }
        Err(Error::NoConvergence { what: "the QR iteration", limit })
    }

    /// First row of the unreduced block that ends at `end`; its subdiagonal on the left is set to zero.
    #[inline(always)]
    fn active_start(&mut self, end: usize) -> usize {
        let mut k = end;
        while k > self.lo {
            if is_negligible(self.H, k) {
                self.H[(k, k - 1)] = 0.0;
                break;
            }
            k -= 1;
        }
        k
    }

    /// Sum and product of the two shifts; every tenth try an exceptional pair.
    #[inline(always)]
    fn shifts(&self, end: usize, tries: usize) -> [f64; 4] {
        let H = &self.H;
        if tries.is_multiple_of(10) {
            let s = H[(end, end - 1)].abs() + H[(end - 1, end - 2)].abs();
            let h11 = 0.75 * s + H[(end, end)];
            return [h11, -0.4375 * s, s, h11];
        }
        [H[(end - 1, end - 1)], H[(end - 1, end)], H[(end, end - 1)], H[(end, end)]]
    }

    #[inline(always)]
    fn sweep(&mut self, start: usize, end: usize, tries: usize) {
        let shift = self.shifts(end, tries);
        let (mut first, mut v) = (end - 2, first_column(self.H, end - 2, real_pair(shift)));
        while first > start && !self.may_start(first, v) {
            first -= 1;
            v = first_column(self.H, first, real_pair(shift));
        }
        for k in first..end {
            let size = 3.min(end + 1 - k);
            if k > first {
                v = [
                    self.H[(k, k - 1)],
                    self.H[(k + 1, k - 1)],
                    if size == 3 { self.H[(k + 2, k - 1)] } else { 0.0 },
                ];
            }
            let reflector = Reflector::new(v, size);
            if k > first {
                self.H[(k, k - 1)] = reflector.beta;
                self.H[(k + 1, k - 1)] = 0.0;
                if size == 3 {
                    self.H[(k + 2, k - 1)] = 0.0;
                }
            } else if k > start {
                self.H[(k, k - 1)] *= 1.0 - reflector.tau;
            }
            self.reflect(&reflector, k, start, end);
        }
    }

    /// Returns whether two small subdiagonals in a row let the sweep start at `m`.
    #[inline(always)]
    fn may_start(&self, m: usize, v: [f64; 3]) -> bool {
        let H = &self.H;
        let h = H[(m, m - 1)].abs() * (v[1].abs() + v[2].abs());
        let around = H[(m - 1, m - 1)].abs() + H[(m, m)].abs() + H[(m + 1, m + 1)].abs();
        h <= EPS * v[0].abs() * around
    }

    #[inline(always)]
    fn reflect(&mut self, reflector: &Reflector, k: usize, start: usize, end: usize) {
        let n = self.H.nrows();
        let (top, right) = match self.scope {
            Scope::Form => (0, n),
            Scope::Values => (start, end + 1),
        };
        reflector.apply_left(self.H.as_mut_slice(), n, k, k..right);
        let rows = top..(k + 4).min(end + 1);
        reflector.apply_right(self.H.as_mut_slice(), n, k, rows);
        if self.scope == Scope::Form {
            let rows = self.Z.nrows();
            reflector.apply_right(self.Z.as_mut_slice(), rows, k, 0..rows);
        }
    }
}

/// Ahues and Tisseur's test of the subdiagonal left of row `k`.
#[inline(always)]
pub(super) fn is_negligible(H: &Mat, k: usize) -> bool {
    let sub = H[(k, k - 1)].abs();
    if sub <= NEGLIGIBLE_SUBDIAGONAL {
        return true;
    }
    let (upper, lower) = (H[(k - 1, k - 1)], H[(k, k)]);
    let mut scale = upper.abs() + lower.abs();
    if scale == 0.0 {
        if k >= 2 {
            scale += H[(k - 1, k - 2)].abs();
        }
        if k + 1 < H.nrows() {
            scale += H[(k + 1, k)].abs();
        }
    }
    if sub > EPS * scale {
        return false;
    }
    let sup = H[(k - 1, k)].abs();
    let (ab, ba) = (sub.max(sup), sub.min(sup));
    let difference = (upper - lower).abs();
    let (aa, bb) = (lower.abs().max(difference), lower.abs().min(difference));
    let s = aa + ab;
    ba * (ab / s) <= NEGLIGIBLE_SUBDIAGONAL.max(EPS * (bb * (aa / s)))
}

/// A pair of real shifts is replaced by the one nearer to the last diagonal entry, twice.
#[inline(always)]
fn real_pair([a, b, c, d]: [f64; 4]) -> [C64; 2] {
    let s = a.abs() + b.abs() + c.abs() + d.abs();
    if s == 0.0 {
        return [C64::new(0.0, 0.0); 2];
    }
    let (a, b, c, d) = (a / s, b / s, c / s, d / s);
    let mean = 0.5 * (a + d);
    let discriminant = (a - mean) * (d - mean) - b * c;
    let root = discriminant.abs().sqrt();
    if discriminant >= 0.0 {
        return [C64::new(mean * s, root * s), C64::new(mean * s, -root * s)];
    }
    let (one, two) = (mean + root, mean - root);
    let near = if (one - d).abs() <= (two - d).abs() { one } else { two };
    [C64::new(near * s, 0.0); 2]
}

/// The first column of `(H - s1)(H - s2)`, s1 and s2 being the shifts, from row `m` on, up to a factor, normalised in the 1-norm.
#[inline(always)]
pub(super) fn first_column(H: &Mat, m: usize, [first, second]: [C64; 2]) -> [f64; 3] {
    let (r1, i1, r2, i2) = (first.re, first.im, second.re, second.im);
    let h21 = H[(m + 1, m)];
    let s = (H[(m, m)] - r2).abs() + i2.abs() + h21.abs();
    if s == 0.0 {
        return [0.0; 3];
    }
    let h21s = h21 / s;
    let v0 = h21s * H[(m, m + 1)] + (H[(m, m)] - r1) * ((H[(m, m)] - r2) / s) - i1 * (i2 / s);
    let v1 = h21s * (H[(m, m)] + H[(m + 1, m + 1)] - r1 - r2);
    let v2 = h21s * H[(m + 2, m + 1)];
    let size = v0.abs() + v1.abs() + v2.abs();
    if size == 0.0 { [0.0; 3] } else { [v0 / size, v1 / size, v2 / size] }
}

/// The reflection `I - tau [1 v2 v3]' [1 v2 v3]` that takes a vector to `beta e1`.
pub(super) struct Reflector {
    pub(super) beta: f64,
    pub(super) tau: f64,
    v2: f64,
    v3: f64,
    size: usize,
}

impl Reflector {
    #[inline(always)]
    pub(super) fn new([x, y, z]: [f64; 3], size: usize) -> Self {
        let largest = x.abs().max(y.abs()).max(z.abs());
        if y == 0.0 && z == 0.0 {
            return Self { beta: x, tau: 0.0, v2: 0.0, v3: 0.0, size };
        }
        let (a, b, c) = (x / largest, y / largest, z / largest);
        let beta = -(a * a + b * b + c * c).sqrt().copysign(a);
        let pivot = a - beta;
        Self { beta: beta * largest, tau: (beta - a) / beta, v2: b / pivot, v3: c / pivot, size }
    }

    /// Applies the reflection to rows `k..k + size` of the columns in `range`.
    #[inline(always)]
    pub(super) fn apply_left(&self, h: &mut [f64], ld: usize, k: usize, range: std::ops::Range<usize>) {
        let (t1, v2, v3) = (self.tau, self.v2, self.v3);
        if t1 == 0.0 {
            return;
        }
        let (t2, t3) = (t1 * v2, t1 * v3);
        for column in h[range.start * ld..range.end * ld].chunks_exact_mut(ld) {
            if self.size == 3 {
                let [x, y, z] = &mut column[k..k + 3] else { return };
                let sum = *x + v2 * *y + v3 * *z;
                *x -= sum * t1;
                *y -= sum * t2;
                *z -= sum * t3;
            } else {
                let [x, y] = &mut column[k..k + 2] else { return };
                let sum = *x + v2 * *y;
                *x -= sum * t1;
                *y -= sum * t2;
            }
        }
    }

    /// Applies the reflection to columns `k..k + size` of the rows in `rows`.
    #[inline(always)]
    pub(super) fn apply_right(&self, h: &mut [f64], ld: usize, k: usize, rows: std::ops::Range<usize>) {
        let (t1, v2, v3) = (self.tau, self.v2, self.v3);
        if t1 == 0.0 {
            return;
        }
        let (t2, t3) = (t1 * v2, t1 * v3);
        let (first, rest) = h[k * ld..(k + self.size) * ld].split_at_mut(ld);
        let (second, third) = rest.split_at_mut(ld);
        if self.size == 3 {
            let (first, second, third) =
                (&mut first[rows.clone()], &mut second[rows.clone()], &mut third[rows]);
            for ((x, y), z) in first.iter_mut().zip(second).zip(third) {
                let sum = *x + v2 * *y + v3 * *z;
                *x -= sum * t1;
                *y -= sum * t2;
                *z -= sum * t3;
            }
        } else {
            Rotation::reflect_columns(&mut first[rows.clone()], &mut second[rows], v2, t1);
        }
    }
}
