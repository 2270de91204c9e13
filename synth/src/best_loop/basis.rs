//! The functions that a Youla parameter is made of, orthonormal on the grid.

use counterpoise_linalg::{C64, Mat, svd};
use counterpoise_lti::zeros;

use super::Ground;
use crate::Error;
use crate::tolerance::{LARGEST_ZERO, SMALLEST_ZERO, WEAKEST_DIRECTION};

/// Delays of the whole basis: at a millisecond they reach over a sixth of a second.
const DELAYS: usize = 160;
/// Real poles of the whole basis, and between what they lie, over half the sample rate in rad/s.
const POLES: usize = 60;
const POLES_BETWEEN: [f64; 2] = [1.0e-4, 0.05];

/// A function from which the basis is made.
struct RawFunction {
    /// Values on the grid.
    on_grid: Vec<C64>,
    /// Value at zero frequency.
    at_zero: f64,
}

/// The basis.
pub(crate) struct Basis {
    /// Each function on the grid: one column a function.
    pub columns: Vec<Vec<C64>>,
    /// Each function at zero frequency.
    pub at_zero: Vec<f64>,
}

impl Basis {
    /// Returns the whole basis.
    pub fn build_full(ground: &Ground) -> Result<Self, Error> {
        Self::new(ground, DELAYS, POLES)
    }

    /// Returns half of the basis.
    pub fn build_half(ground: &Ground) -> Result<Self, Error> {
        Self::new(ground, DELAYS / 2, POLES / 2)
    }

    /// Returns the number of functions.
    pub fn size(&self) -> usize {
        self.columns.len()
    }

    fn new(ground: &Ground, delays: usize, poles: usize) -> Result<Self, Error> {
        let z: Vec<C64> =
            ground.grid.rates.iter().map(|rate| C64::from_polar(1.0, rate * ground.period_s)).collect();
        let mut raw: Vec<RawFunction> = Vec::new();
        for k in 0..delays {
            raw.push(RawFunction { on_grid: z.iter().map(|z| z.powi(-(k as i32))).collect(), at_zero: 1.0 });
        }
        let half = std::f64::consts::PI / ground.period_s;
        let [low, high] = POLES_BETWEEN;
        for k in 0..poles {
            let rate = half * low * (high / low).powf(k as f64 / (poles - 1) as f64);
            let p = (-rate * ground.period_s).exp();
            let on_grid = z.iter().map(|z| (1.0 - p) / (1.0 - p / z)).collect();
            raw.push(RawFunction { on_grid, at_zero: 1.0 });
        }
        for zero in zeros(&ground.system)? {
            raw.extend(of_zero(zero, &z));
        }
        Self::orthonormal(ground, &raw)
    }

    /// The directions that the functions span, by a singular value decomposition on the grid.
    fn orthonormal(ground: &Ground, raw: &[RawFunction]) -> Result<Self, Error> {
        let count = ground.grid.rates.len();
        let weights = weights(ground);
        let entry = |i: usize, j: usize| {
            let value = raw[j].on_grid[i % count] * weights[i % count];
            if i < count { value.re } else { value.im }
        };
        let decomposed = svd(&Mat::from_fn(2 * count, raw.len(), entry))?;
        let most = decomposed.s.first().copied().unwrap_or(0.0);
        let kept: Vec<usize> =
            (0..decomposed.s.len()).filter(|&k| decomposed.s[k] > WEAKEST_DIRECTION * most).collect();
        let combine = |k: usize, of: &dyn Fn(usize) -> C64| -> C64 {
            let parts = (0..raw.len()).map(|j| of(j) * decomposed.V[(j, k)] / decomposed.s[k]);
            parts.sum()
        };
        let column = |k: usize| (0..count).map(|i| combine(k, &|j| raw[j].on_grid[i])).collect();
        Ok(Self {
            columns: kept.iter().map(|&k| column(k)).collect(),
            at_zero: kept.iter().map(|&k| combine(k, &|j| C64::new(raw[j].at_zero, 0.0)).re).collect(),
        })
    }
}

/// The functions whose poles are a stable zero of the plant and its conjugate: with them Q can be the plant's inverse there.
fn of_zero(zero: C64, z: &[C64]) -> Vec<RawFunction> {
    let radius = zero.norm();
    if !(SMALLEST_ZERO..LARGEST_ZERO).contains(&radius) || zero.im < 0.0 {
        return Vec::new();
    }
    let one = C64::ONE;
    if zero.im == 0.0 {
        let gain = one - zero;
        let on_grid = z.iter().map(|z| gain / (one - zero / z)).collect();
        return vec![RawFunction { on_grid, at_zero: 1.0 }];
    }
    let denominator = |z: C64| (one - zero / z) * (one - zero.conj() / z);
    let scale = denominator(one);
    let first = z.iter().map(|&z| scale / denominator(z)).collect();
    let second = z.iter().map(|&z| scale / z / denominator(z)).collect();
    vec![RawFunction { on_grid: first, at_zero: 1.0 }, RawFunction { on_grid: second, at_zero: 1.0 }]
}

/// The weight of each frequency: half by the linear and half by the logarithmic axis, so that neither end is lost to rounding.
fn weights(ground: &Ground) -> Vec<f64> {
    let rates = &ground.grid.rates;
    let last = rates.len() - 1;
    let width = |k: usize| (rates[(k + 1).min(last)] / rates[k.saturating_sub(1)]).ln();
    let whole = (rates[last] / rates[0]).ln();
    (0..=last).map(|k| (0.5 * ground.grid.share[k] + 0.25 * width(k) / whole).sqrt()).collect()
}
