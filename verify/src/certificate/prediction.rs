//! The prediction of the harmonic balance: growth over the amplitude, and the stable limit cycles.

use super::balance::CycleBalance;
use super::cycle::{Cycle, CycleBracket, Growth, HarmonicBalance};
use super::floor::Subject;
use super::regime::Teeth;
use crate::Error;
use crate::tolerance::{AMPLITUDES_PER_DECADE, LEAST_AMPLITUDE_FLOORS, MOST_AMPLITUDE_RAD_S, STEADY_GROWTH};

/// Limit cycles that the harmonic balance predicts.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Prediction {
    /// Growth over the amplitude, by rising amplitude.
    pub growth: Vec<Growth>,
    /// Stable limit cycles, by rising amplitude.
    pub cycles: Vec<Cycle>,
    /// The loops below and above each of them: at the last amplitude that grows and at the first that fades.
    pub balances: Vec<Vec<CycleBalance>>,
}

impl Prediction {
    fn add(&mut self, found: CycleBracket) {
        self.cycles.push(found.cycle);
        self.balances.push(found.balances);
    }
}

/// Predicts the limit cycles of a case.
pub(super) fn predict(subject: &Subject<'_>) -> Result<Prediction, Error> {
    let balance = HarmonicBalance::new(subject)?;
    // the floor of a loop of position, torque or current may be any number beside a rate
    let floor = subject.rate_of(subject.noise_floor_rad_s(), balance.start_rad_s / std::f64::consts::TAU);
    let least = (LEAST_AMPLITUDE_FLOORS * floor).min(0.1 * MOST_AMPLITUDE_RAD_S);
    let decades = (MOST_AMPLITUDE_RAD_S / least).log10();
    let count = (decades * AMPLITUDES_PER_DECADE).ceil() as usize + 1;
    let mut found = Prediction::default();
    let mut at = balance.start_rad_s;
    for k in 0..count {
        let rate = least * (MOST_AMPLITUDE_RAD_S / least).powf(k as f64 / (count - 1) as f64);
        let Some(growth) = balance.growth(rate, at)? else { continue };
        at = std::f64::consts::TAU * growth.frequency_hz;
        let before = found.growth.last().copied();
        found.growth.push(growth);
        if let Some(before) = before.filter(|b| b.growth_per_s > STEADY_GROWTH)
            && growth.growth_per_s <= STEADY_GROWTH
        {
            found.add(balance.cycle(before, growth)?);
        }
    }
    if balance.teeth != Teeth::WithoutGap {
        balance.rattling_cycles()?.into_iter().for_each(|cycle| found.add(cycle));
    }
    Ok(found)
}
