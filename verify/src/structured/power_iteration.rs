//! The lower bound of the structured singular value, by the power iteration of Young and Doyle (1990) for mixed structures.

use counterpoise_linalg::{C64, CMat};

use super::PerturbationStructure;
use super::blocks::PerturbationBlock;
use crate::tolerance::{POWER_ITERATIONS, POWER_RESIDUAL, POWER_STARTS};

/// A structured perturbation Delta of size 1 with det(I - M Delta / beta) = 0: mu(M) is at least `beta`.
#[derive(Debug, Clone, PartialEq)]
pub struct Perturbation {
    /// The bound.
    pub beta: f64,
    /// One number a block: real and at most 1 in size, or complex of size 1.
    pub delta: Vec<C64>,
}

/// Returns the largest bound that the iteration finds from a few fixed starts; `None` if it converges from none of them, or the bound is 0.
pub fn lower_bound(M: &CMat, structure: &PerturbationStructure) -> Option<Perturbation> {
    let found = (0..POWER_STARTS).filter_map(|start| Iteration::new(M, structure, start).run());
    found.max_by(|a, b| a.beta.total_cmp(&b.beta))
}

struct Iteration<'a> {
    M: &'a CMat,
    Mh: CMat,
    structure: &'a PerturbationStructure,
    a: Vec<C64>,
    b: Vec<C64>,
    w: Vec<C64>,
    delta: Vec<C64>,
}

fn norm(x: &[C64]) -> f64 {
    x.iter().map(|e| e.norm_sqr()).sum::<f64>().sqrt()
}

/// x* y.
fn inner(x: &[C64], y: &[C64]) -> C64 {
    x.iter().zip(y).map(|(p, q)| p.conj() * q).sum()
}

fn times(M: &CMat, x: &[C64]) -> Vec<C64> {
    let mut y = vec![C64::new(0.0, 0.0); M.nrows()];
    for (j, value) in x.iter().enumerate() {
        y.iter_mut().zip(M.column(j)).for_each(|(sum, entry)| *sum += entry * value);
    }
    y
}

/// The vector of unit length, with its length before.
fn unit(x: Vec<C64>) -> Option<(Vec<C64>, f64)> {
    let size = norm(&x);
    (size > 0.0 && size.is_finite()).then(|| (x.iter().map(|e| e / size).collect(), size))
}

impl<'a> Iteration<'a> {
    fn new(M: &'a CMat, structure: &'a PerturbationStructure, start: usize) -> Self {
        let n = M.nrows();
        let turn = |k: usize, by: usize| C64::from_polar(1.0, (by * start * (k + 1)) as f64 * 2.399_963);
        let b: Vec<C64> = (0..n).map(|k| turn(k, 1) / (n as f64).sqrt()).collect();
        let w = (0..n).map(|k| turn(k, 2) / (n as f64).sqrt()).collect();
        let delta = structure.blocks.iter().map(|_| C64::new(1.0, 0.0)).collect();
        Self { M, Mh: M.h(), structure, a: b.clone(), b, w, delta }
    }

    fn run(mut self) -> Option<Perturbation> {
        for _ in 0..POWER_ITERATIONS {
            let beta;
            (self.a, beta) = unit(times(self.M, &self.b))?;
            let z = self.turn_vectors(Turn::Z);
            (self.w, _) = unit(times(&self.Mh, &z))?;
            self.b = self.turn_vectors(Turn::B);
            let Some(found) = self.converged_perturbation(beta) else { continue };
            return Some(found);
        }
        None
    }

    /// z from (a, w), or b from them, block by block; sets the perturbation.
    fn turn_vectors(&mut self, which: Turn) -> Vec<C64> {
        let mut out = vec![C64::new(0.0, 0.0); self.a.len()];
        for (k, (block, rows)) in self.structure.place_blocks().into_iter().enumerate() {
            let (a, w) = (&self.a[rows.clone()], &self.w[rows.clone()]);
            let q = match block {
                PerturbationBlock::Complex => phase(inner(a, w)),
                PerturbationBlock::Real { .. } => {
                    C64::new(real_block(self.delta[k].re, &self.b[rows.clone()], a, w), 0.0)
                }
            };
            self.delta[k] = q;
            let (from, factor) = match which {
                Turn::Z => (w, q.conj()),
                Turn::B => (a, q),
            };
            out[rows].iter_mut().zip(from).for_each(|(to, value)| *to = factor * value);
        }
        out
    }

    /// Returns whether it has settled: M b = beta a with b = Delta a.
    fn converged_perturbation(&self, beta: f64) -> Option<Perturbation> {
        let image = times(self.M, &self.b);
        let off: Vec<C64> = image.iter().zip(&self.a).map(|(y, a)| y - a * beta).collect();
        (norm(&off) < POWER_RESIDUAL * beta).then(|| Perturbation { beta, delta: self.delta.clone() })
    }
}

/// The vector of the power iteration that is turned by the perturbation.
#[derive(Debug, Clone, Copy)]
enum Turn {
    /// z, from w.
    Z,
    /// b, from a.
    B,
}

/// The unit number with the phase of x.
fn phase(x: C64) -> C64 {
    if x.norm() > 0.0 { x / x.norm() } else { C64::new(1.0, 0.0) }
}

/// The real block's number: it stays inside -1 to 1, and on the edge where the iteration pushes it outwards.
fn real_block(q: f64, b: &[C64], a: &[C64], w: &[C64]) -> f64 {
    let size = norm(a);
    let ratio = if size > 0.0 { norm(b) / size } else { 0.0 };
    let pushed = q.signum() * ratio + inner(a, w).re;
    pushed.clamp(-1.0, 1.0)
}
