//! The starts of the tuning.

use std::f64::consts::PI;

use super::blocks::Blocks;
use super::grid::{LoopGrid, LoopPlant};
use super::random_generator::RandomGenerator;
use crate::fixed_structure::ParameterName;

/// Crossovers of the starts, over half the sample rate: from a two-thousandth of it to a sixth, beyond which the hold leaves no phase.
const CROSSOVERS: [f64; 2] = [5e-4, 0.16];
/// Largest random factor on a parameter of a start that is not the gain, as a natural logarithm.
const SPREAD: f64 = 0.8;

/// The starts of a structure: the values that the file states, then crossovers over a wide range with the other parameters placed about them,
/// every second one with random factors. The same for the same seed.
pub(crate) fn placed_starts(
    family: &Blocks<'_>,
    nominal: &LoopPlant,
    grid: &LoopGrid,
    count: usize,
    seed: u64,
) -> Vec<Vec<f64>> {
    let half = PI / family.sampling.period_s;
    let resonances = resonances(nominal, grid);
    let mut random = RandomGenerator(seed);
    let mut all = Vec::new();
    if family.open.iter().all(|open| open.stated.is_some()) {
        all.push(family.open.iter().map(|open| open.stated.unwrap_or(1.0).ln()).collect());
    }
    for k in 0..count.max(1) {
        let share = if count > 1 { k as f64 / (count - 1) as f64 } else { 0.4 };
        let crossover = half * CROSSOVERS[0] * (CROSSOVERS[1] / CROSSOVERS[0]).powf(share);
        let spread = if k % 2 == 1 { SPREAD } else { 0.0 };
        let mut at = place_start(family, crossover, &resonances, &mut |n| spread * random.next_symmetric(n));
        balance_gain(family, nominal, grid, crossover, &mut at);
        all.push(at);
    }
    all
}

/// A point near an answer, from which a descent may find a better one.
pub(crate) fn perturb_point(at: &[f64], seed: u64) -> Vec<f64> {
    let mut random = RandomGenerator(seed);
    at.iter().enumerate().map(|(n, value)| value + SPREAD * random.next_symmetric(n)).collect()
}

/// A start at a crossover.
fn place_start(
    family: &Blocks<'_>,
    crossover: f64,
    resonances: &[f64],
    jitter: &mut dyn FnMut(usize) -> f64,
) -> Vec<f64> {
    let mut centred = 0;
    let mut block = usize::MAX;
    let mut at: Vec<f64> = Vec::new();
    for (n, (open, range)) in family.open.iter().zip(&family.ranges).enumerate() {
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
fn balance_gain(family: &Blocks<'_>, nominal: &LoopPlant, grid: &LoopGrid, crossover: f64, at: &mut [f64]) {
    let Some(gain) = family.open.iter().position(|open| open.name == ParameterName::Gain) else { return };
    let last = grid.rates.len() - 1;
    let k = grid.rates.partition_point(|rate| *rate < crossover).min(last);
    let size = family.at(&family.values(at), grid.s[k]).norm();
    let size = size * nominal.response[k].norm();
    if size > 0.0 {
        let [low, high] = family.ranges[gain];
        at[gain] = (at[gain] - size.ln()).clamp(low, high);
    }
}

/// The frequencies at which the nominal plant's response has a peak, the highest peak over its surroundings first.
fn resonances(nominal: &LoopPlant, grid: &LoopGrid) -> Vec<f64> {
    let (rates, response) = (&grid.rates, &nominal.response);
    // |P| w is level where inertia alone acts.
    let size = |k: usize| response[k].norm() * rates[k];
    let mut peaks: Vec<(f64, f64)> = (1..rates.len() - 1)
        .filter(|&k| size(k) > size(k - 1) && size(k) > size(k + 1))
        .map(|k| (size(k), rates[k]))
        .collect();
    peaks.sort_by(|a, b| b.0.total_cmp(&a.0));
    peaks.into_iter().map(|peak| peak.1).collect()
}
