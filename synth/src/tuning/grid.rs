//! The frequencies at which a loop is evaluated while it is tuned.

use std::f64::consts::PI;

use counterpoise_linalg::C64;
use counterpoise_lti::{StateSpace, poles, zeros};

use super::Disturbance;
use crate::Error;
use crate::tolerance::{LIGHTLY_DAMPED, NARROWEST_ROOT, SAME_FREQUENCY};

/// Frequencies with what each stands for.
#[derive(Debug, Clone)]
pub(crate) struct LoopGrid {
    /// Frequencies, rad/s, rising.
    pub rates: Vec<f64>,
    /// Frequencies at which a continuous controller has the response of the sampled one.
    pub s: Vec<C64>,
    /// Share of the power of a white noise.
    pub share: Vec<f64>,
    /// Power of the disturbance, (rad/s)^2.
    pub power: Vec<f64>,
}

/// A plant under a zero-order hold.
pub(crate) struct LoopPlant {
    /// From the held control to the reading.
    pub system: StateSpace,
    /// Response on the grid.
    pub response: Vec<C64>,
}

/// The sampling of a continuous controller.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Clock {
    /// Sample period, s.
    pub period_s: f64,
    /// k of s = k (z - 1)/(z + 1).
    pub factor: f64,
}

/// The density of a grid.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Density {
    /// Frequencies per decade.
    pub per_decade: f64,
    /// Frequencies on the linear axis up to half the sample rate; 0 for none.
    pub linear: usize,
}

impl Density {
    /// For loops of few blocks: 70 per decade resolve a peak of |S| of a loop without light damping to 1e-3.
    pub const OF_BLOCKS: Self = Self { per_decade: 70.0, linear: 0 };
}

/// Lowest frequency over half the sample rate.
const LOWEST: f64 = 1e-5;
/// Highest frequency over half the sample rate: at 1 the bilinear map is infinite.
const HIGHEST: f64 = 0.998;
/// Further frequencies on either side of a lightly damped root, in units of its half-width, dense near it.
const AROUND: [f64; 8] = [0.0, 0.3, 0.7, 1.2, 2.0, 3.5, 6.0, 10.0];
impl LoopGrid {
    /// Returns the grid for plants under one sampling: a logarithmic scale, the neighbourhood of every lightly damped root, and the
    /// lines of the disturbance.
    pub fn new(
        plants: &[StateSpace],
        disturbance: &Disturbance,
        clock: Clock,
        density: Density,
    ) -> Result<Self, Error> {
        let Clock { period_s, factor } = clock;
        let half = PI / period_s;
        disturbance.check(HIGHEST * half)?;
        let count = (density.per_decade * (HIGHEST / LOWEST).log10()).ceil() as usize;
        let at = |k: usize| half * LOWEST * (HIGHEST / LOWEST).powf(k as f64 / count as f64);
        let mut points: Vec<(f64, f64)> = (0..=count).map(|k| (at(k), 0.0)).collect();
        let step = half / (density.linear + 1) as f64;
        points.extend((1..=density.linear).map(|k| (step * k as f64, 0.0)));
        for plant in plants {
            for root in poles(plant)?.into_iter().chain(zeros(plant)?) {
                points.extend(neighbourhood(root, period_s).into_iter().map(|rate| (rate, 0.0)));
            }
        }
        points.retain(|(rate, _)| (half * LOWEST..=half * HIGHEST).contains(rate));
        points.extend(disturbance.lines.iter().map(|line| (line[0], line[1])));
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut merged: Vec<(f64, f64)> = Vec::new();
        for (rate, power) in points {
            match merged.last_mut() {
                Some(last) if rate - last.0 <= SAME_FREQUENCY * rate => last.1 += power,
                _ => merged.push((rate, power)),
            }
        }
        let rates: Vec<f64> = merged.iter().map(|point| point.0).collect();
        let s = rates.iter().map(|rate| C64::new(0.0, factor * (0.5 * rate * period_s).tan())).collect();
        Ok(Self {
            s,
            share: shares(&rates, half),
            power: merged.iter().map(|point| point.1).collect(),
            rates,
        })
    }
}

/// Frequencies about a lightly damped root of a sampled system; none about others.
fn neighbourhood(root: C64, period_s: f64) -> Vec<f64> {
    if root.norm() == 0.0 || root.im <= 0.0 {
        return Vec::new();
    }
    let s = root.ln() / period_s;
    let damping = s.re.abs() / s.norm();
    if damping > LIGHTLY_DAMPED {
        return Vec::new();
    }
    let half_width = damping.max(NARROWEST_ROOT);
    AROUND.iter().flat_map(|k| [1.0 + k * half_width, 1.0 - k * half_width]).map(|x| x * s.im).collect()
}

/// The share of the axis from 0 to half the sample rate that each frequency stands for (trapezoidal rule).
fn shares(rates: &[f64], half: f64) -> Vec<f64> {
    let middle = |k: usize| 0.5 * (rates[k] + rates[k + 1]);
    let last = rates.len().saturating_sub(1);
    let below = |k: usize| if k == 0 { 0.0 } else { middle(k - 1) };
    let above = |k: usize| if k == last { half } else { middle(k) };
    (0..rates.len()).map(|k| (above(k) - below(k)) / half).collect()
}
