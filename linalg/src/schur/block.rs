//! The 2 x 2 blocks of a real Schur form, and plane rotations.

use crate::mat::{C64, Mat};
use crate::tolerance::EPS;

/// The plane rotation `[c s; -s c]`.
#[derive(Clone, Copy)]
pub(super) struct Rotation {
    pub(super) c: f64,
    pub(super) s: f64,
}

impl Rotation {
    /// The rotation that takes `[x; y]` to `[r; 0]`.
    pub(super) fn zeroing(x: f64, y: f64) -> Self {
        let r = x.hypot(y);
        if r == 0.0 { Self { c: 1.0, s: 0.0 } } else { Self { c: x / r, s: y / r } }
    }

    /// Rows `k`, `k + 1` of the columns from `from` on.
    #[inline(always)]
    pub(super) fn apply_left(self, H: &mut Mat, k: usize, from: usize) {
        let ld = H.nrows();
        for column in H.as_mut_slice()[from * ld..].chunks_exact_mut(ld) {
            let (x, y) = (column[k], column[k + 1]);
            column[k] = self.c * x + self.s * y;
            column[k + 1] = self.c * y - self.s * x;
        }
    }

    /// Columns `k`, `k + 1` of the first `rows` rows.
    #[inline(always)]
    pub(super) fn apply_right(self, H: &mut Mat, k: usize, rows: usize) {
        let ld = H.nrows();
        let (left, right) = H.as_mut_slice()[k * ld..(k + 2) * ld].split_at_mut(ld);
        for (x, y) in left[..rows].iter_mut().zip(&mut right[..rows]) {
            (*x, *y) = (self.c * *x + self.s * *y, self.c * *y - self.s * *x);
        }
    }

    /// Two columns times the reflection with vector `[1 v]` and factor `tau`.
    #[inline(always)]
    pub(super) fn reflect_columns(left: &mut [f64], right: &mut [f64], v: f64, tau: f64) {
        for (x, y) in left.iter_mut().zip(right) {
            let sum = (*x + v * *y) * tau;
            *x -= sum;
            *y -= sum * v;
        }
    }
}

/// Brings the diagonal block in rows `k`, `k + 1` to standard form: two real eigenvalues on the diagonal of a triangle,
/// or equal diagonal entries and off-diagonal entries of opposite sign. `T` and `U` follow.
#[inline(always)]
pub(super) fn standardise(T: &mut Mat, U: &mut Mat, k: usize) {
    let block = [T[(k, k)], T[(k, k + 1)], T[(k + 1, k)], T[(k + 1, k + 1)]];
    let ([a, b, c, d], turn) = standard(block);
    turn.apply_left(T, k, k);
    turn.apply_right(T, k, k + 2);
    let rows = U.nrows();
    turn.apply_right(U, k, rows);
    T[(k, k)] = a;
    T[(k, k + 1)] = b;
    T[(k + 1, k)] = c;
    T[(k + 1, k + 1)] = d;
}

/// The standard form of `[a b; c d]` and the rotation that gives it (LAPACK's dlanv2).
pub(super) fn standard([a, b, c, d]: [f64; 4]) -> ([f64; 4], Rotation) {
    let none = Rotation { c: 1.0, s: 0.0 };
    if c == 0.0 {
        return ([a, b, 0.0, d], none);
    }
    if b == 0.0 {
        return ([d, -c, 0.0, a], Rotation { c: 0.0, s: 1.0 });
    }
    if a - d == 0.0 && b.signum() != c.signum() {
        return ([a, b, c, d], none);
    }
    let p = 0.5 * (a - d);
    let larger = b.abs().max(c.abs());
    let smaller = b.abs().min(c.abs()) * b.signum() * c.signum();
    let scale = p.abs().max(larger);
    let z = p / scale * p + larger / scale * smaller;
    if z >= 4.0 * EPS {
        let z = p + (scale.sqrt() * z.sqrt()).copysign(p);
        let tau = c.hypot(z);
        let turn = Rotation { c: z / tau, s: c / tau };
        return ([d + z, b - c, 0.0, d - larger / z * smaller], turn);
    }
    equal_diagonal([a, b, c, d])
}

/// The block has complex or nearly equal real eigenvalues: make its diagonal entries equal.
fn equal_diagonal([a, b, c, d]: [f64; 4]) -> ([f64; 4], Rotation) {
    let sigma = b + c;
    let difference = a - d;
    let tau = sigma.hypot(difference);
    let cs = (0.5 * (1.0 + sigma.abs() / tau)).sqrt();
    let sn = -(0.5 * difference / (tau * cs)) * 1.0_f64.copysign(sigma);
    let (aa, bb, cc, dd) = (a * cs + b * sn, -a * sn + b * cs, c * cs + d * sn, -c * sn + d * cs);
    let (a, b, c, d) = (aa * cs + cc * sn, bb * cs + dd * sn, -aa * sn + cc * cs, -bb * sn + dd * cs);
    let mean = 0.5 * (a + d);
    let turn = Rotation { c: cs, s: sn };
    if c == 0.0 {
        return ([mean, b, 0.0, mean], turn);
    }
    if b == 0.0 {
        return ([mean, -c, 0.0, mean], Rotation { c: -turn.s, s: turn.c });
    }
    if b.signum() != c.signum() {
        return ([mean, b, c, mean], turn);
    }
    let (sab, sac) = (b.abs().sqrt(), c.abs().sqrt());
    let p = (sab * sac).copysign(c);
    let tau = 1.0 / (b + c).abs().sqrt();
    let (cs1, sn1) = (sab * tau, sac * tau);
    let combined = Rotation { c: turn.c * cs1 - turn.s * sn1, s: turn.c * sn1 + turn.s * cs1 };
    ([mean + p, b - c, 0.0, mean - p], combined)
}

/// The eigenvalues of a standardised 2 x 2 block.
pub(super) fn pair(a: f64, b: f64, c: f64, d: f64) -> [C64; 2] {
    if c == 0.0 {
        return [C64::new(a, 0.0), C64::new(d, 0.0)];
    }
    let imaginary = b.abs().sqrt() * c.abs().sqrt();
    [C64::new(a, imaginary), C64::new(d, -imaginary)]
}
