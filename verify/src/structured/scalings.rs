//! The upper bound of the structured singular value, by scalings D and G.
//!
//! ```text
//!     M* D M + j (G M - M* G) < beta^2 D,   D = D* > 0,  G = G*   =>   mu(M) < beta
//! ```
//!
//! D commutes with every perturbation of the structure; G is there for real blocks alone (Fan, Tits and Doyle 1991). For a fixed
//! pair the inequality is a Cholesky factorisation: the bound is proved whatever the search did. The search for the pair is the
//! method of centres (Boyd and El Ghaoui 1993): Newton's method finds the analytic centre of the pairs that prove the present bound,
//! which proves a smaller one.

use counterpoise_linalg::{C64, CMat};

use super::PerturbationStructure;
use super::blocks::PerturbationBlock;
use super::hermitian::HermitianFactor;
use crate::tolerance::{
    BOUND_RATIO, SCALING_BEHIND, SCALING_DECREMENT, SCALING_FIRST, SCALING_FLOOR, SCALING_GAIN, SCALING_NEAR,
    SCALING_NEWTON, SCALING_REGULAR, SCALING_SHORTEST_STEP, SCALING_STEPS,
};

/// An upper bound with what proves it.
#[derive(Debug, Clone, PartialEq)]
pub struct UpperBound {
    /// The bound of mu.
    pub beta: f64,
    /// The scaling D.
    pub D: CMat,
    /// The scaling G.
    pub G: CMat,
}

impl UpperBound {
    /// Returns whether the scalings prove the bound for a matrix: the definition, evaluated.
    pub fn proves(&self, M: &CMat) -> bool {
        HermitianFactor::of(&self.D).is_some()
            && Slack::of(M, &self.D, &self.G).factor(self.beta.powi(2)).is_some()
    }
}

/// The matrix that is positive definite if a pair proves a bound: gamma D - M* D M - j (G M - M* G), for every gamma.
struct Slack<'a> {
    D: &'a CMat,
    /// M* D M.
    passed: CMat,
    /// j (G M - M* G).
    turned: CMat,
}

impl<'a> Slack<'a> {
    fn of(M: &CMat, D: &'a CMat, G: &CMat) -> Self {
        let (Mh, j) = (M.h(), C64::new(0.0, 1.0));
        Self { D, passed: &(&Mh * D) * M, turned: (&(G * M) - &(&Mh * G)).scale(j) }
    }

    /// Returns its Cholesky factor at a gamma; `None` if it is not positive definite there.
    fn factor(&self, gamma: f64) -> Option<HermitianFactor> {
        HermitianFactor::of(&(&(&self.D.scale(C64::new(gamma, 0.0)) - &self.passed) - &self.turned))
    }
}

/// Returns an upper bound of mu(M) over a structure, within about a percent of the best that scalings D and G prove.
///
/// `near` is the bound of a similar matrix, of a neighbouring frequency, from which the search may start.
pub fn upper_bound(M: &CMat, structure: &PerturbationStructure, near: Option<&UpperBound>) -> UpperBound {
    let scale = osborne_scaling(M, structure);
    let n = M.nrows();
    let inside = CMat::from_fn(n, n, |i, j| M[(i, j)] * (scale[i] / scale[j]));
    let mut search = Search::new(&inside, structure, near.map(|bound| unscale_bound(bound, &scale)));
    search.run();
    let back = |X: &CMat| CMat::from_fn(n, n, |i, j| X[(i, j)] * (scale[i] * scale[j]));
    UpperBound { beta: search.gamma.sqrt(), D: back(&search.D), G: back(&search.G) }
}

/// The scalings that prove a bound.
struct Scalings {
    D: CMat,
    G: CMat,
}

/// The scalings of a bound in balanced coordinates, of unit trace.
fn unscale_bound(bound: &UpperBound, scale: &[f64]) -> Scalings {
    let n = scale.len();
    let change = |X: &CMat| CMat::from_fn(n, n, |i, j| X[(i, j)] / (scale[i] * scale[j]));
    let (D, G) = (change(&bound.D), change(&bound.G));
    let size = C64::new(0.9 / D.trace().re, 0.0);
    Scalings { D: D.scale(size), G: G.scale(size) }
}

/// Osborne's scaling, one number a block: rows and columns of S M inv(S) of equal size.
fn osborne_scaling(M: &CMat, structure: &PerturbationStructure) -> Vec<f64> {
    let mut scale = vec![1.0; M.nrows()];
    for _ in 0..8 {
        for (_, rows) in structure.place_blocks() {
            let outside = |k: &usize| !rows.contains(k);
            let size = |i: usize, j: usize| (M[(i, j)] * (scale[i] / scale[j])).norm_sqr();
            let others: Vec<usize> = (0..M.nrows()).filter(outside).collect();
            let out: f64 =
                rows.clone().flat_map(|i| others.iter().map(move |&j| (i, j))).map(|(i, j)| size(i, j)).sum();
            let into: f64 =
                rows.clone().flat_map(|i| others.iter().map(move |&j| (j, i))).map(|(i, j)| size(i, j)).sum();
            if out > 0.0 && into > 0.0 {
                let factor = (into / out).powf(0.25);
                rows.clone().for_each(|k| scale[k] *= factor);
            }
        }
    }
    scale
}

/// An entry of a sparse Hermitian matrix.
#[derive(Debug, Clone, Copy)]
struct Entry {
    row: usize,
    col: usize,
    value: C64,
}

impl Entry {
    const fn new(row: usize, col: usize, value: C64) -> Self {
        Self { row, col, value }
    }
}

/// A direction of D or of G.
#[derive(Debug, Clone)]
struct Direction {
    /// `true` if it belongs to G.
    of_G: bool,
    /// Entries, both triangles.
    entries: Vec<Entry>,
}

fn directions(structure: &PerturbationStructure) -> Vec<Direction> {
    let mut all = Vec::new();
    for (block, rows) in structure.place_blocks() {
        let kinds =
            if matches!(block, PerturbationBlock::Real { .. }) { &[false, true][..] } else { &[false][..] };
        for &of_G in kinds {
            for a in rows.clone() {
                all.push(Direction { of_G, entries: vec![Entry::new(a, a, C64::new(1.0, 0.0))] });
                for b in a + 1..rows.end {
                    for unit in [C64::new(1.0, 0.0), C64::new(0.0, 1.0)] {
                        all.push(Direction {
                            of_G,
                            entries: vec![Entry::new(a, b, unit), Entry::new(b, a, unit.conj())],
                        });
                    }
                }
            }
        }
    }
    all
}

/// The search for the scalings of one matrix.
struct Search<'a> {
    M: &'a CMat,
    directions: Vec<Direction>,
    D: CMat,
    G: CMat,
    /// The square of a bound that (D, G) prove.
    gamma: f64,
    floor: f64,
}

impl<'a> Search<'a> {
    fn new(M: &'a CMat, structure: &PerturbationStructure, near: Option<Scalings>) -> Self {
        let n = M.nrows();
        let size = M.norm_fro().powi(2).max(f64::MIN_POSITIVE);
        let plain = (CMat::eye(n).scale(C64::new(0.5, 0.0)), CMat::zeros(n, n));
        let mut search = Self {
            M,
            directions: directions(structure),
            D: plain.0,
            G: plain.1,
            gamma: 1.01 * size,
            floor: SCALING_FLOOR * SCALING_FLOOR * size,
        };
        if let Some(Scalings { D, G }) = near {
            let proved =
                HermitianFactor::of(&D).is_some() && Slack::of(M, &D, &G).factor(1.01 * size).is_some();
            if proved {
                (search.D, search.G) = (D, G);
            }
        }
        search
    }

    /// Leaves the best pair that was found, with the least gamma that it proves.
    fn run(&mut self) {
        let mut best = (self.least(), self.D.clone(), self.G.clone());
        self.gamma = self.gamma.min(SCALING_FIRST * best.0);
        for _ in 0..SCALING_STEPS {
            if self.gamma <= self.floor || !self.centre() {
                break;
            }
            let proved = self.least();
            let near = self.gamma < SCALING_NEAR * proved;
            let gained = proved < (1.0 - SCALING_GAIN) * best.0;
            if proved < best.0 {
                best = (proved, self.D.clone(), self.G.clone());
            }
            if near && !gained {
                break;
            }
            self.gamma = proved + SCALING_BEHIND * (self.gamma - proved);
        }
        (self.gamma, self.D, self.G) = best;
    }

    /// The least gamma that the present pair proves, by bisection, to a part in ten thousand.
    fn least(&self) -> f64 {
        let slack = Slack::of(self.M, &self.D, &self.G);
        let (mut low, mut high) = (self.floor.min(0.5 * self.gamma), self.gamma);
        while high > BOUND_RATIO * low {
            let middle = if high > 4.0 * low { (low * high).sqrt() } else { 0.5 * (low + high) };
            match slack.factor(middle) {
                Some(_) => high = middle,
                None => low = middle,
            }
        }
        high
    }

    /// Moves to the analytic centre of the pairs that prove the present gamma; false if no step was possible.
    fn centre(&mut self) -> bool {
        let mut moved = false;
        for _ in 0..SCALING_NEWTON {
            let Some((step, decrement)) = self.newton() else { return moved };
            if decrement < SCALING_DECREMENT {
                return true;
            }
            if !self.advance(&step, decrement) {
                return moved;
            }
            moved = true;
        }
        moved
    }

    /// -log det F - log det D - log det (I - D) + |G|^2 / 2 times its weight; none outside the domain.
    fn barrier(&self, D: &CMat, G: &CMat) -> Option<f64> {
        let rest = &CMat::eye(D.nrows()) - D;
        let of_slack = Slack::of(self.M, D, G).factor(self.gamma)?.log_det();
        let sum = of_slack + HermitianFactor::of(D)?.log_det() + HermitianFactor::of(&rest)?.log_det();
        Some(0.5 * SCALING_REGULAR * G.norm_fro().powi(2) - sum)
    }

    fn advance(&mut self, step: &[f64], decrement: f64) -> bool {
        let Some(here) = self.barrier(&self.D, &self.G) else { return false };
        let mut length = 1.0;
        while length > SCALING_SHORTEST_STEP {
            let (D, G) = self.move_scalings(step, length);
            if self.barrier(&D, &G).is_some_and(|there| there < here - 0.1 * length * decrement) {
                (self.D, self.G) = (D, G);
                return true;
            }
            length *= 0.5;
        }
        false
    }

    fn move_scalings(&self, step: &[f64], length: f64) -> (CMat, CMat) {
        let (mut D, mut G) = (self.D.clone(), self.G.clone());
        for (direction, amount) in self.directions.iter().zip(step) {
            let X = if direction.of_G { &mut G } else { &mut D };
            for entry in &direction.entries {
                X[(entry.row, entry.col)] += entry.value * (length * amount);
            }
        }
        (D, G)
    }

    /// Newton's step and its decrement.
    ///
    /// F = V* Pi V with V = [I; M] and Pi linear in (D, G): every trace of the gradient and of the Hessian is a sum over the few
    /// entries of a direction in P = V inv(F) V*.
    fn newton(&self) -> Option<(Vec<f64>, f64)> {
        let n = self.M.nrows();
        let V = CMat::eye(n).vstack(self.M);
        let inverse = Slack::of(self.M, &self.D, &self.G).factor(self.gamma)?.inverse();
        let P = &(&V * &inverse) * &V.h();
        let PD = HermitianFactor::of(&self.D)?.inverse();
        let PR = HermitianFactor::of(&(&CMat::eye(n) - &self.D))?.inverse();
        let wide: Vec<Vec<Entry>> = self.directions.iter().map(|d| multiplier(d, n, self.gamma)).collect();
        let count = wide.len();
        let mut gradient = vec![C64::new(0.0, 0.0); count];
        let mut H = CMat::zeros(count, count);
        for (i, one) in self.directions.iter().enumerate() {
            let mut slope = -trace(&P, &wide[i]);
            if one.of_G {
                slope += SCALING_REGULAR
                    * one.entries.iter().map(|e| (e.value.conj() * self.G[(e.row, e.col)]).re).sum::<f64>();
                H[(i, i)] += SCALING_REGULAR * one.entries.len() as f64;
            } else {
                slope += trace(&PR, &one.entries) - trace(&PD, &one.entries);
            }
            gradient[i] = C64::new(slope, 0.0);
            for (j, other) in self.directions.iter().enumerate().take(i + 1) {
                let mut curve = product(&P, &wide[i], &wide[j]);
                if !one.of_G && !other.of_G {
                    curve += product(&PD, &one.entries, &other.entries)
                        + product(&PR, &one.entries, &other.entries);
                }
                H[(i, j)] += curve;
            }
        }
        let mut step = gradient.clone();
        HermitianFactor::of(&H)?.solve_in_place(&mut step);
        let decrement = gradient.iter().zip(&step).map(|(g, s)| g.re * s.re).sum();
        Some((step.iter().map(|s| -s.re).collect(), decrement))
    }
}

/// The entries of a direction in Pi = [gamma D, -jG; jG, -D].
fn multiplier(direction: &Direction, n: usize, gamma: f64) -> Vec<Entry> {
    let j = C64::new(0.0, 1.0);
    let places = |&Entry { row: a, col: b, value }: &Entry| {
        if direction.of_G {
            [Entry::new(a, n + b, -j * value), Entry::new(n + a, b, j * value)]
        } else {
            [Entry::new(a, b, value * gamma), Entry::new(n + a, n + b, -value)]
        }
    };
    direction.entries.iter().flat_map(places).collect()
}

/// trace(P X).
fn trace(P: &CMat, X: &[Entry]) -> f64 {
    X.iter().map(|x| (P[(x.col, x.row)] * x.value).re).sum()
}

/// trace(P X P Y).
fn product(P: &CMat, X: &[Entry], Y: &[Entry]) -> f64 {
    let pair = |x: &Entry| -> f64 {
        Y.iter().map(|y| (P[(y.col, x.row)] * x.value * P[(x.col, y.row)] * y.value).re).sum()
    };
    X.iter().map(pair).sum()
}
