//! Where the tuning starts, and how far parameters without a range may go.

use std::f64::consts::PI;

use super::blocks::Blocks;
use super::family::Family;
use super::grid::LoopGrid;
use super::problem::{LoopPlant, Problem};
use crate::fixed_structure::ParameterName;
use crate::tolerance::LEAST_RESPONSE;

/// Crossovers of the starts, over half the sample rate: from a two-thousandth of it to a sixth, beyond which the hold leaves no phase.
const CROSSOVERS: [f64; 2] = [5e-4, 0.16];
/// Largest random factor on a parameter of a start that is not the gain, as a natural logarithm.
const SPREAD: f64 = 0.8;

/// The range of a parameter that the file leaves open: as wide as makes a difference to a loop at this sample rate.
pub(crate) fn usual_range(name: ParameterName, grid: &LoopGrid, plant: &LoopPlant) -> [f64; 2] {
    let top = grid.rates[grid.rates.len() - 1];
    let (slowest, fastest) = (3e-5 * top, 0.8 * top);
    match name {
        ParameterName::Gain => {
            let sizes = grid.rates.iter().zip(&plant.response).filter(|(rate, _)| **rate > 1e-3 * top);
            let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
            for (_, response) in sizes {
                least = least.min(response.norm());
                most = most.max(response.norm());
            }
            [1e-3 / most, 10.0 / least.max(LEAST_RESPONSE * most)]
        }
        ParameterName::Frequency
        | ParameterName::Corner
        | ParameterName::ZeroFrequency
        | ParameterName::PoleFrequency => [slowest, fastest],
        ParameterName::DerivativeTime | ParameterName::FilterTime => [1.0 / fastest, 1.0 / slowest],
        ParameterName::Ratio => [1.0, 50.0],
        ParameterName::Damping | ParameterName::PoleDamping => [0.05, 3.0],
        ParameterName::ZeroDamping => [0.005, 3.0],
        ParameterName::Depth => [0.01, 1.0],
    }
}

/// The starts of a structure: the values that the file states, then crossovers over a wide range with the other parameters placed about them,
/// every second one with random factors. The same for the same seed.
pub(crate) fn placed_starts(
    family: &Blocks<'_>,
    problem: &Problem<'_>,
    count: usize,
    seed: u64,
) -> Vec<Vec<f64>> {
    let half = PI / problem.task.sampling.period_s;
    let resonances = resonances(problem);
    let mut random = Random(seed);
    let mut all = Vec::new();
    if family.open.iter().all(|open| open.stated.is_some()) {
        all.push(family.open.iter().map(|open| open.stated.unwrap_or(1.0).ln()).collect());
    }
    for k in 0..count.max(1) {
        let share = if count > 1 { k as f64 / (count - 1) as f64 } else { 0.4 };
        let crossover = half * CROSSOVERS[0] * (CROSSOVERS[1] / CROSSOVERS[0]).powf(share);
        let spread = if k % 2 == 1 { SPREAD } else { 0.0 };
        let mut at = placed(family, crossover, &resonances, &mut |n| spread * random.symmetric(n));
        balance_gain(family, problem, crossover, &mut at);
        all.push(at);
    }
    all
}

/// A point near an answer, from which a descent may find a better one.
pub(crate) fn near(at: &[f64], seed: u64) -> Vec<f64> {
    let mut random = Random(seed);
    at.iter().enumerate().map(|(n, value)| value + SPREAD * random.symmetric(n)).collect()
}

/// A start at a crossover.
fn placed(
    family: &Blocks<'_>,
    crossover: f64,
    resonances: &[f64],
    jitter: &mut dyn FnMut(usize) -> f64,
) -> Vec<f64> {
    let mut centred = 0;
    let mut block = usize::MAX;
    let mut at: Vec<f64> = Vec::new();
    for (n, (open, range)) in family.open.iter().zip(family.ranges()).enumerate() {
        let kind = family.structure.blocks[open.block].kind;
        use crate::fixed_structure::BlockKind::{Biquad, Lag, LowPass, Notch, SecondOrderLowPass};
        if matches!(kind, Notch | Biquad) && open.block != block {
            (block, centred) = (open.block, centred + 1);
        }
        let centre = resonances.get(centred.max(1) - 1).copied().unwrap_or(3.0 * crossover);
        let value = match (open.name, kind) {
            (ParameterName::Gain, _) => 1.0,
            (ParameterName::Corner, _) => 0.25 * crossover,
            (ParameterName::DerivativeTime, _) => 0.5 / crossover,
            (ParameterName::FilterTime, _) => 0.1 / crossover,
            (ParameterName::Frequency, Lag) => 0.2 * crossover,
            (ParameterName::Frequency, LowPass | SecondOrderLowPass) => 6.0 * crossover,
            (ParameterName::Frequency, Notch) => centre,
            (ParameterName::Frequency, _) => 0.6 * crossover,
            (ParameterName::ZeroFrequency | ParameterName::PoleFrequency, _) => centre,
            (ParameterName::Ratio, _) => 2.0,
            (ParameterName::Depth | ParameterName::ZeroDamping, _) => 0.4,
            (ParameterName::Damping | ParameterName::PoleDamping, _) => 0.7,
        };
        let moved = if open.name == ParameterName::Gain { 0.0 } else { jitter(n) };
        at.push((value.ln() + moved).clamp(range[0], range[1]));
    }
    at
}

/// Sets the first gain so that the nominal loop's gain is 1 at the crossover.
fn balance_gain(family: &Blocks<'_>, problem: &Problem<'_>, crossover: f64, at: &mut [f64]) {
    let Some(gain) = family.open.iter().position(|open| open.name == ParameterName::Gain) else { return };
    let last = problem.grid.rates.len() - 1;
    let k = problem.grid.rates.partition_point(|rate| *rate < crossover).min(last);
    let size = family.at(&family.values(at), problem.grid.s[k]).norm();
    let size = size * problem.plants[0].response[k].norm();
    if size > 0.0 {
        let [low, high] = family.ranges()[gain];
        at[gain] = (at[gain] - size.ln()).clamp(low, high);
    }
}

/// The frequencies at which the nominal plant's response has a peak, the highest peak over its surroundings first.
fn resonances(problem: &Problem<'_>) -> Vec<f64> {
    let (rates, response) = (&problem.grid.rates, &problem.plants[0].response);
    // |P| w is level where inertia alone acts.
    let size = |k: usize| response[k].norm() * rates[k];
    let mut peaks: Vec<(f64, f64)> = (1..rates.len() - 1)
        .filter(|&k| size(k) > size(k - 1) && size(k) > size(k + 1))
        .map(|k| (size(k), rates[k]))
        .collect();
    peaks.sort_by(|a, b| b.0.total_cmp(&a.0));
    peaks.into_iter().map(|peak| peak.1).collect()
}

/// A small portable generator (SplitMix64, Steele, Lea and Flood 2014).
pub(crate) struct Random(pub u64);

impl Random {
    /// A number from -1 to 1.
    pub fn symmetric(&mut self, salt: usize) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15).wrapping_add(salt as u64);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}
