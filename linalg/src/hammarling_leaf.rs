//! The factor of a Lyapunov equation in real Schur form, in real arithmetic.
//!
//! With the last diagonal block `tau`, its row `b` of the right-hand side and `P = R R'`, the block's own factor `rho`
//! turns them into `alpha = rho^-1 tau rho` and `beta = rho^-1 b`, `alpha + alpha' + beta beta' = 0`; then
//!
//! ```text
//!     T1 r + r alpha' = -(t rho + B1 beta')        B1 <- B1 - r beta
//! ```
//!
//! and the blocks above go on. A pair's `alpha` and `beta` come from its complex triangular form, without dividing by a
//! `rho` that may be nearly singular (Hammarling 1982; Sorensen and Zhou 2003).

use crate::kernel::vectorised;
use crate::lyapunov_leaf::{Block, diagonal, solve_block_column};
use crate::mat::{C64, Mat};
use crate::tolerance::{DETERMINES_PHASE, EPS};

vectorised! {
    /// The block upper triangular `R`, `P = R R'`, of `T P + P T' + B B' = 0`; `T` stable and quasi-triangular in standard
    /// form.
    pub(crate) fn triangular_factor<'a>(T: &'a Mat, B: &'a Mat) -> Mat {
        let all = diagonal(T);
        let mut B = B.clone();
        let mut R = Mat::zeros(T.nrows(), T.nrows());
        for (index, block) in all.iter().enumerate().rev() {
            let own = if block.size == 1 { real_block(T, &B, block.at) } else { pair(T, &B, block.at) };
            if let Some(own) = own {
                column(T, &mut B, &mut R, &all[..index], block.at, &own);
            }
        }
        R
    }
}

/// A diagonal block's own factor and what it makes of the block and of its row of the right-hand side.
struct OwnFactor {
    /// Column by column.
    rho: [[f64; 2]; 2],
    alpha: Block,
    /// The rows of `beta`; of a real block one.
    beta: Vec<Vec<f64>>,
}

#[inline(always)]
fn real_block(T: &Mat, B: &Mat, k: usize) -> Option<OwnFactor> {
    let row = B.row_vec(k);
    let size = row.iter().map(|e| e * e).sum::<f64>().sqrt();
    if size == 0.0 {
        return None;
    }
    let gain = (-2.0 * T[(k, k)]).sqrt();
    let beta = row.iter().map(|e| e * (gain / size)).collect();
    Some(OwnFactor { rho: [[size / gain, 0.0], [0.0; 2]], alpha: Block::real(T[(k, k)]), beta: vec![beta] })
}

/// The columns of `R` of the block at `k`, and what they take out of the right-hand side; `above` are the blocks above it.
#[inline(always)]
fn column(T: &Mat, B: &mut Mat, R: &mut Mat, above: &[Block], k: usize, own: &OwnFactor) {
    let size = own.alpha.size;
    let mut r = Mat::zeros(k, size);
    for c in 0..size {
        let target = r.column_mut(c);
        for l in 0..size {
            let factor = own.rho[c][l];
            target.iter_mut().zip(T.column(k + l)).for_each(|(x, &t)| *x -= t * factor);
        }
        for (j, &factor) in own.beta[c].iter().enumerate() {
            target.iter_mut().zip(B.column(j)).for_each(|(x, &b)| *x -= b * factor);
        }
    }
    solve_block_column(T, &mut r, above, &own.alpha);
    for c in 0..size {
        for (j, &factor) in own.beta[c].iter().enumerate() {
            B.column_mut(j).iter_mut().zip(r.column(c)).for_each(|(b, &x)| *b -= x * factor);
        }
        let target = R.column_mut(k + c);
        target[..k].copy_from_slice(r.column(c));
        target[k..k + size].copy_from_slice(&own.rho[c][..size]);
    }
}

/// The complex pair at `k`: its complex triangular form `Z' tau Z = [l1 t; 0 l2]` is factored entry by entry, and the
/// complex factor turned into a real one by a unitary matrix.
#[inline(always)]
fn pair(T: &Mat, B: &Mat, k: usize) -> Option<OwnFactor> {
    let (a, b, c) = (T[(k, k)], T[(k, k + 1)], T[(k + 1, k)]);
    let omega = b.abs().sqrt() * c.abs().sqrt();
    let norm = b.hypot(omega);
    // Z = [x j w; j w x].
    let (x, w) = (b / norm, omega / norm);
    let turned = |p: f64, q: f64| (C64::new(x * p, -w * q), C64::new(x * q, -w * p));
    let (mut first, second): (Vec<C64>, Vec<C64>) =
        (0..B.ncols()).map(|j| turned(B[(k, j)], B[(k + 1, j)])).unzip();
    let size = length(&second);
    if size == 0.0 {
        return None;
    }
    let gain = (-2.0 * a).sqrt();
    let across = b * x * x + c * w * w;
    let beta2: Vec<C64> = second.iter().map(|e| e * (gain / size)).collect();
    let rho22 = size / gain;
    let forced = dot(&first, &beta2) + across * rho22;
    // (l1 + conj(l2)) rho12 = -(t rho22 + b1 beta2').
    let rho12 = -forced / (2.0 * C64::new(a, omega));
    first.iter_mut().zip(&beta2).for_each(|(e, &f)| *e -= rho12 * f);
    let size = length(&first);
    let beta1: Vec<C64> = first.iter().map(|e| if size > 0.0 { e * (gain / size) } else { *e }).collect();
    let factor = ComplexFactor { rho11: size / gain, rho12, rho22, beta1, beta2 };
    Some(made_real([x, w], [a, omega], &factor))
}

/// A complex pair's own factor `[rho11 rho12; 0 rho22]` in complex triangular form, and the rows of its `beta`.
struct ComplexFactor {
    rho11: f64,
    rho12: C64,
    rho22: f64,
    beta1: Vec<C64>,
    beta2: Vec<C64>,
}

/// `Z [rho11 rho12; 0 rho22] = rho Q` with a real `rho` and a unitary `Q`; `alpha` and `beta` turned by `Q` and brought to standard form.
#[inline(always)]
fn made_real([x, w]: [f64; 2], [a, omega]: [f64; 2], factor: &ComplexFactor) -> OwnFactor {
    let (p, q, s) = (factor.rho11, factor.rho12, factor.rho22);
    let (beta1, beta2) = (&factor.beta1, &factor.beta2);
    let j = C64::new(0.0, 1.0);
    let upper = [C64::from(x * p), q * x + j * (w * s)];
    let lower = [j * (w * p), j * w * q + x * s];
    let rho22 = (lower[0].norm_sqr() + lower[1].norm_sqr()).sqrt();
    let q2 = [lower[0] / rho22, lower[1] / rho22];
    let across = [-q2[1].conj(), q2[0].conj()];
    let along = upper[0] * across[0].conj() + upper[1] * across[1].conj();
    let coupling = -dot(beta1, beta2);
    let entry = |u: [C64; 2], v: [C64; 2]| {
        let pair = C64::new(a, omega) * u[0] * v[0].conj() + C64::new(a, -omega) * u[1] * v[1].conj();
        pair + coupling * u[0] * v[1].conj()
    };
    let turned =
        |u: [C64; 2]| -> Vec<C64> { beta1.iter().zip(beta2).map(|(e, f)| u[0] * e + u[1] * f).collect() };
    let size = (upper[0].norm_sqr() + upper[1].norm_sqr()).sqrt();
    let phase = if along.norm() > DETERMINES_PHASE * size {
        along / along.norm()
    } else {
        // A factor that is nearly singular does not determine the phase; alpha and beta, which are real as well, do.
        phase_of_real(entry(across, q2) / a.hypot(omega), &turned(across), a.abs().sqrt())
    };
    let q1 = [phase * across[0], phase * across[1]];
    let rho11 = (along * phase.conj()).re;
    let rho12 = (upper[0] * q2[0].conj() + upper[1] * q2[1].conj()).re;
    let alpha = [entry(q1, q1), entry(q1, q2), entry(q2, q1), entry(q2, q2)].map(|e| e.re);
    let real = |row: Vec<C64>| row.iter().map(|e| e.re).collect();
    standard([[rho11, 0.0], [rho12, rho22]], alpha, [real(turned(q1)), real(turned(q2))])
}

/// Returns the phase by which an entry and a row must be turned to be real, from the larger of them; `size` is that to which the row is compared.
fn phase_of_real(entry: C64, row: &[C64], size: f64) -> C64 {
    let square = row.iter().map(|e| e * e).sum::<C64>().sqrt() / size;
    let larger = if entry.norm() >= square.norm() { entry } else { square };
    if larger.norm() > 0.0 { larger.conj() / larger.norm() } else { C64::from(1.0) }
}

/// A rotation makes the diagonal entries of `alpha` equal.
#[inline(always)]
fn standard(rho: [[f64; 2]; 2], [p, q, r, t]: [f64; 4], [beta1, beta2]: [Vec<f64>; 2]) -> OwnFactor {
    let (apart, sum) = (p - t, q + r);
    let size = apart.hypot(sum);
    let (c, s) = if size > 0.0 {
        let c = (0.5 * (1.0 + sum.abs() / size)).sqrt();
        (c, -apart.copysign(apart * sum) / (2.0 * c * size))
    } else {
        (1.0, 0.0)
    };
    // V = [c -s; s c]: rho V, V' beta, V' alpha V.
    let mixed = |u: f64, v: f64| (c * u + s * v, c * v - s * u);
    let ((r11, r12), (r21, r22)) = (mixed(rho[0][0], rho[1][0]), mixed(rho[0][1], rho[1][1]));
    let (beta1, beta2) = beta1.iter().zip(&beta2).map(|(&u, &v)| mixed(u, v)).unzip();
    let off = c * c * q - s * s * r + c * s * (t - p);
    let below = c * c * r - s * s * q + c * s * (t - p);
    let alpha = Block::pair(0, pair_entries(0.5 * (p + t), off, below));
    OwnFactor { rho: [[r11, r21], [r12, r22]], alpha, beta: vec![beta1, beta2] }
}

/// Entries of a complex pair: where rounding made its eigenvalues real, a relative change of eps makes them a pair again.
fn pair_entries(a: f64, b: f64, c: f64) -> [f64; 3] {
    let size = b.abs().max(c.abs()).max(EPS * a.abs()).max(f64::MIN_POSITIVE);
    match (b.abs() < c.abs(), b * c < 0.0) {
        (_, true) => [a, b, c],
        (false, false) => [a, size.copysign(b), -(EPS * size).copysign(b)],
        (true, false) => [a, -(EPS * size).copysign(c), size.copysign(c)],
    }
}

fn length(row: &[C64]) -> f64 {
    row.iter().map(|e| e.norm_sqr()).sum::<f64>().sqrt()
}

/// `u v^H`
fn dot(u: &[C64], v: &[C64]) -> C64 {
    u.iter().zip(v).map(|(e, f)| e * f.conj()).sum()
}
