//! Limit cycles in which the gear teeth part.

use counterpoise_lti::Response;

use super::balance::{MeshBalance, SettledLoop};
use super::cycle::{
    Cycle, CycleBracket, Growth, HarmonicBalance, frequency_error, motor_over_hub, rate_of, third_harmonic,
};
use super::elements::{ElementLoop, Elements, Learning, Sinusoid};
use super::gap::gap_share;
use crate::Error;
use crate::linear_loop::plant::port;
use crate::tolerance::{CYCLE_HALVINGS, FREQUENCY_ROUNDS, GAP_SWINGS, MOST_GAP_SWING, OPEN, STEADY_GROWTH};

/// The growth at a swing of the gear's wind-up.
struct Swing {
    swing_rad: f64,
    growth: Growth,
    third_harmonic: f64,
    settled: SettledLoop,
}

impl HarmonicBalance<'_> {
    /// Limit cycles in which the teeth part: sought over the swing of the gear's wind-up, because the same swing of the hub can go with
    /// teeth that stay together and with teeth that part.
    pub(super) fn rattling_cycles(&self) -> Result<Vec<CycleBracket>, Error> {
        let gearbox = &self.subject.case.plant.parameters().gearbox;
        let (gap, pressed) = (gearbox.backlash_rad, self.pressed_wind_up_rad());
        let least = if pressed > 0.0 { pressed } else { 0.5 * gap };
        let mut cycles = Vec::new();
        let mut before: Option<Swing> = None;
        for k in 1..=GAP_SWINGS {
            let swing_rad = least * MOST_GAP_SWING.powf(k as f64 / GAP_SWINGS as f64);
            let now = self.swing_growth(swing_rad)?;
            let grew = before.as_ref().is_some_and(|at| at.growth.growth_per_s > STEADY_GROWTH);
            let fades = now.as_ref().is_some_and(|at| at.growth.growth_per_s <= STEADY_GROWTH);
            match (before.take(), now) {
                // the next cycle begins only where a motion grows again
                (Some(low), Some(high)) if grew && fades => cycles.push(self.rattling_cycle(low, high)?),
                (_, now) => before = now,
            }
        }
        Ok(cycles)
    }

    /// The limit cycle between a swing that grows and one that fades.
    fn rattling_cycle(&self, grows: Swing, fades: Swing) -> Result<CycleBracket, Error> {
        let (mut low, mut high) = (grows, fades);
        for _ in 0..CYCLE_HALVINGS {
            let Some(middle) = self.swing_growth((low.swing_rad * high.swing_rad).sqrt())? else { break };
            if middle.growth.growth_per_s > STEADY_GROWTH { low = middle } else { high = middle }
        }
        let (growth, third_harmonic) = (low.growth, low.third_harmonic);
        let sides = [low.settled, high.settled];
        let cycle = Cycle {
            rate_rad_s: growth.rate_rad_s,
            frequency_hz: growth.frequency_hz,
            third_harmonic,
            frequency_error: frequency_error(&sides),
        };
        CycleBracket::new(self.subject, cycle, &sides)
    }

    /// The growth at a swing of the wind-up; `None` if nothing oscillates.
    fn swing_growth(&self, swing_rad: f64) -> Result<Option<Swing>, Error> {
        let gearbox = &self.subject.case.plant.parameters().gearbox;
        let share = gap_share(swing_rad, self.pressed_wind_up_rad(), gearbox.backlash_rad).max(OPEN);
        let mut motion = Sinusoid {
            rate_rad_s: swing_rad * self.start_rad_s,
            frequency_rad_s: self.start_rad_s,
            motor_over_hub: 2.0 * gearbox.ratio,
        };
        let mut found = None;
        for _ in 0..2 * FREQUENCY_ROUNDS {
            let mut elements = Elements::harmonic(self.subject, &motion)?;
            elements.mesh_share = share;
            let linear = ElementLoop::close(self.subject, &elements, Learning::Still)?;
            let Some(pole) = linear.least_stable_pole() else { return Ok(None) };
            let (period_s, used) = (linear.plant.sample_period_s, motion);
            let frequency = rate_of(pole, period_s);
            let over = motor_over_hub(&linear, frequency)?.unwrap_or(gearbox.ratio);
            let hub_rad = swing_rad / hub_swing(&linear, gearbox.ratio, frequency)?;
            motion = Sinusoid {
                rate_rad_s: hub_rad * frequency,
                frequency_rad_s: frequency,
                motor_over_hub: over,
            };
            let (pressed_rad, gap_rad) = (self.pressed_wind_up_rad(), gearbox.backlash_rad);
            let mesh = MeshBalance { wind_up_rad: swing_rad, pressed_rad, gap_rad, share };
            found = Some(SettledLoop { motion: used, elements, linear, pole, mesh });
        }
        let Some(settled) = found else { return Ok(None) };
        let period_s = settled.linear.plant.sample_period_s;
        let growth = Growth {
            rate_rad_s: motion.rate_rad_s,
            growth_per_s: settled.pole.norm().ln() / period_s,
            frequency_hz: motion.frequency_rad_s / std::f64::consts::TAU,
        };
        let third_harmonic = third_harmonic(&settled.linear, motion.frequency_rad_s)?;
        Ok(Some(Swing { swing_rad, growth, third_harmonic, settled }))
    }
}

/// The swing of the wind-up over that of the hub under the control alone.
fn hub_swing(linear: &ElementLoop, ratio: f64, frequency_rad_s: f64) -> Result<f64, Error> {
    let response = Response::of(&linear.plant.continuous)?.at(frequency_rad_s)?;
    let (hub, motor) = (response[(port::HUB, 0)], response[(port::MOTOR, 0)]);
    Ok((motor / hub / ratio - 1.0).norm().max(f64::MIN_POSITIVE))
}
