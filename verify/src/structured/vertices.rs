//! The lower bound of the structured singular value by a search over the real parameters.
//!
//! With the real parameters held at x q, |q| <= 1, what the complex ones see is
//!
//! ```text
//!     M_c(x q) = M_cc + M_cr x Q inv(I - M_rr x Q) M_rc
//! ```
//!
//! and for one or two complex numbers mu of that is known: the largest spectral radius over their phases. The search raises it, one
//! parameter at a time, and shrinks x until x mu(M_c(x q)) = 1: a perturbation of size x, whatever the power iteration did.

use counterpoise_linalg::{C64, CMat, csolve};

use super::blocks::PerturbationBlock;
use super::factor::Reach;
use super::{Perturbation, PerturbationStructure};
use crate::tolerance::{
    ASCENT_ROUNDS, CROSSING_NEARNESS, CROSSING_RAISES, PHASE_NEARNESS, ROUGH_PHASE, SEARCH_BEGINNINGS,
    SEARCH_SHRINK, SEARCH_SHRINKS, TRIED_LEVELS, TRIED_PHASES,
};

/// Returns a perturbation of least size x near 1 / `upper`, from a start of the real parameters, none of which leaves its reach; none without one or
/// two complex blocks, or where it would be much larger.
pub fn vertex_bound(
    M: &CMat,
    structure: &PerturbationStructure,
    start: &[f64],
    reach: &[Reach],
    upper: f64,
) -> Option<Perturbation> {
    let search = Search::new(M, structure, reach)?;
    let found = SEARCH_BEGINNINGS.iter().filter_map(|times| search.from(start, times / upper, 1.0 / upper));
    let (x, q) = found.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let (_, phases) = search.radius(&q, x, PHASE_NEARNESS)?;
    let real = (0..q.len()).map(|k| C64::new(search.deviation(&q, k, x) / x, 0.0));
    Some(Perturbation { beta: 1.0 / x, delta: real.chain(phases).collect() })
}

struct Search<'a> {
    M: &'a CMat,
    real: Vec<usize>,
    complex: Vec<usize>,
    /// The block of each real row.
    owner: Vec<usize>,
    /// The least and the largest deviation of each parameter.
    reach: &'a [Reach],
}

impl<'a> Search<'a> {
    fn new(M: &'a CMat, structure: &PerturbationStructure, reach: &'a [Reach]) -> Option<Self> {
        let (mut real, mut complex, mut owner) = (Vec::new(), Vec::new(), Vec::new());
        for (block, rows) in structure.place_blocks() {
            if block == PerturbationBlock::Complex {
                complex.extend(rows);
            } else {
                let number = owner.last().map_or(0, |last| last + 1);
                owner.extend(rows.clone().map(|_| number));
                real.extend(rows);
            }
        }
        (1..=2).contains(&complex.len()).then_some(Self { M, real, complex, owner, reach })
    }

    /// The least x that is found from a beginning, and its parameters; x is at least `least`.
    fn from(&self, start: &[f64], begin: f64, least: f64) -> Option<(f64, Vec<f64>)> {
        let mut q = start.to_vec();
        self.ascend(&mut q, begin);
        let mut best = (self.crossing(&q, least)?, q.clone());
        for _ in 0..SEARCH_SHRINKS {
            self.ascend(&mut q, SEARCH_SHRINK * best.0);
            let x = self.crossing(&q, least)?;
            if x > SEARCH_SHRINK * best.0 {
                break;
            }
            best = (x, q.clone());
        }
        Some(best)
    }

    fn deviation(&self, q: &[f64], k: usize, x: f64) -> f64 {
        (x * q[k]).clamp(self.reach[k].least, self.reach[k].most)
    }

    /// M_c(x q); `None` if I - M_rr x Q is singular.
    fn vertex_response(&self, q: &[f64], x: f64) -> Option<CMat> {
        let (r, c) = (&self.real, &self.complex);
        if r.is_empty() {
            return Some(self.M.select(c, c));
        }
        let scaled = |rows: &[usize]| {
            CMat::from_fn(rows.len(), r.len(), |i, j| {
                self.M[(rows[i], r[j])] * self.deviation(q, self.owner[j], x)
            })
        };
        let inner = csolve(&(&CMat::eye(r.len()) - &scaled(r)), &self.M.select(r, c)).ok()?;
        Some(&self.M.select(c, c) + &(&scaled(c) * &inner))
    }

    /// The largest spectral radius over the phases, with the phases that make the eigenvalue real and positive.
    fn radius(&self, q: &[f64], x: f64, nearness: f64) -> Option<(f64, Vec<C64>)> {
        let S = self.vertex_response(q, x)?;
        if S.nrows() == 1 {
            let value = S[(0, 0)];
            return Some((value.norm(), vec![(value / value.norm()).conj()]));
        }
        let at = |angle: f64| largest(&S, C64::from_polar(1.0, angle));
        let step = std::f64::consts::TAU / TRIED_PHASES as f64;
        let first = (0..TRIED_PHASES).map(|k| (step * k as f64, at(step * k as f64)));
        let (mut angle, mut best) = first.max_by(|a, b| a.1.radius.total_cmp(&b.1.radius))?;
        let mut span = step;
        while span > nearness {
            let mut beside = [angle - span, angle + span].into_iter().map(|angle| (angle, at(angle)));
            match beside.find(|(_, found)| found.radius > best.radius) {
                Some(better) => (angle, best) = better,
                None => span *= 0.5,
            }
        }
        let turn = (best.eigenvalue / best.radius).conj();
        Some((best.radius, vec![turn, turn * C64::from_polar(1.0, angle)]))
    }

    fn value(&self, q: &[f64], x: f64, nearness: f64) -> f64 {
        self.radius(q, x, nearness).map_or(f64::INFINITY, |(radius, _)| radius)
    }

    fn ascend(&self, q: &mut [f64], x: f64) {
        let mut best = self.value(q, x, ROUGH_PHASE);
        let even = |k: usize| 2.0 * k as f64 / (TRIED_LEVELS - 1) as f64 - 1.0;
        let mut step = even(1) + 1.0;
        for round in 0..ASCENT_ROUNDS {
            for k in 0..q.len() {
                let tried: Vec<f64> = match round {
                    0 => (0..TRIED_LEVELS).map(even).collect(),
                    _ => [-step, step].iter().map(|by| (q[k] + by).clamp(-1.0, 1.0)).collect(),
                };
                for level in tried {
                    let old = std::mem::replace(&mut q[k], level);
                    let value = self.value(q, x, ROUGH_PHASE);
                    if value > best && value.is_finite() { best = value } else { q[k] = old }
                }
            }
            if round > 0 {
                step *= 0.5;
            }
        }
    }

    /// The first x from `from` on with x mu = 1.
    fn crossing(&self, q: &[f64], from: f64) -> Option<f64> {
        let enough = |x: f64| x * self.value(q, x, PHASE_NEARNESS) >= 1.0;
        let (mut low, mut high) = (0.97 * from, from);
        let mut raises = 0;
        while !enough(high) {
            (low, high) = (high, high * CROSSING_RAISES.1);
            raises += 1;
            if raises > CROSSING_RAISES.0 {
                return None;
            }
        }
        while high - low > CROSSING_NEARNESS * high {
            let middle = 0.5 * (low + high);
            if enough(middle) { high = middle } else { low = middle }
        }
        Some(high)
    }
}

/// An eigenvalue and its modulus.
#[derive(Clone, Copy)]
struct OutermostEigenvalue {
    eigenvalue: C64,
    radius: f64,
}

/// The eigenvalue of largest modulus of S diag(1, turn).
fn largest(S: &CMat, turn: C64) -> OutermostEigenvalue {
    let (a, b, c, d) = (S[(0, 0)], S[(0, 1)] * turn, S[(1, 0)], S[(1, 1)] * turn);
    let (half, product) = (0.5 * (a + d), a * d - b * c);
    let root = (half * half - product).sqrt();
    let [plus, minus] = [half + root, half - root]
        .map(|eigenvalue| OutermostEigenvalue { eigenvalue, radius: eigenvalue.norm() });
    if plus.radius > minus.radius { plus } else { minus }
}
