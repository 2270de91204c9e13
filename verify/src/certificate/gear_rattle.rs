//! Limit cycles in which the gear teeth part.

use counterpoise_lti::Response;

use super::cycle::{Balance, Cycle, Growth, motor_over_hub, rate_of, third_harmonic};
use super::elements::{Elements, Learning, Linear, Sinusoid};
use super::gap::gap_share;
use crate::Error;
use crate::linear::plant::port;
use crate::tolerance::{CYCLE_HALVINGS, FREQUENCY_ROUNDS, GAP_SWINGS, MOST_GAP_SWING, OPEN, STEADY_GROWTH};

/// The growth at a swing of the gear's wind-up.
#[derive(Debug, Clone, Copy)]
struct Swing {
    swing_rad: f64,
    growth: Growth,
    third_harmonic: f64,
}

impl Balance<'_> {
    /// Limit cycles in which the teeth part: sought over the swing of the gear's wind-up, because the same swing of the hub can go with
    /// teeth that stay together and with teeth that part.
    pub(super) fn rattling(&self) -> Result<Vec<Cycle>, Error> {
        let gearbox = &self.subject.case.plant.parameters().gearbox;
        let (gap, pressed) = (gearbox.backlash_rad, self.pressed_rad());
        let least = if pressed > 0.0 { pressed } else { 0.5 * gap };
        let mut cycles = Vec::new();
        let mut before: Option<Swing> = None;
        for k in 1..=GAP_SWINGS {
            let swing_rad = least * MOST_GAP_SWING.powf(k as f64 / GAP_SWINGS as f64);
            let now = self.swinging(swing_rad)?;
            if let Some((grows, fades)) = before.zip(now)
                && grows.growth.growth_per_s > STEADY_GROWTH
                && fades.growth.growth_per_s <= STEADY_GROWTH
            {
                let (mut low, mut high) = (grows, fades);
                for _ in 0..CYCLE_HALVINGS {
                    let Some(middle) = self.swinging((low.swing_rad * high.swing_rad).sqrt())? else { break };
                    if middle.growth.growth_per_s > STEADY_GROWTH { low = middle } else { high = middle }
                }
                cycles.push(Cycle {
                    rate_rad_s: low.growth.rate_rad_s,
                    frequency_hz: low.growth.frequency_hz,
                    third_harmonic: low.third_harmonic,
                });
            }
            before = now;
        }
        Ok(cycles)
    }

    /// The growth at a swing of the wind-up; `None` if nothing oscillates.
    fn swinging(&self, swing_rad: f64) -> Result<Option<Swing>, Error> {
        let gearbox = &self.subject.case.plant.parameters().gearbox;
        let share = gap_share(swing_rad, self.pressed_rad(), gearbox.backlash_rad).max(OPEN);
        let mut motion = Sinusoid {
            rate_rad_s: swing_rad * self.start_rad_s,
            frequency_rad_s: self.start_rad_s,
            motor_over_hub: 2.0 * gearbox.ratio,
        };
        let mut found = None;
        for _ in 0..2 * FREQUENCY_ROUNDS {
            let mut elements = Elements::harmonic(self.subject, &motion)?;
            elements.mesh_share = share;
            let linear = Linear::close(self.subject, &elements, Learning::Still)?;
            let Some(pole) = linear.least_stable_pole() else { return Ok(None) };
            let period_s = linear.plant.sample_period_s;
            let frequency = rate_of(pole, period_s);
            let over = motor_over_hub(&linear, frequency)?.unwrap_or(gearbox.ratio);
            let hub_rad = swing_rad / hub_swing(&linear, (gearbox.ratio, frequency))?;
            motion = Sinusoid {
                rate_rad_s: hub_rad * frequency,
                frequency_rad_s: frequency,
                motor_over_hub: over,
            };
            found = Some((linear, pole));
        }
        let Some((linear, pole)) = found else { return Ok(None) };
        let period_s = linear.plant.sample_period_s;
        let growth = Growth {
            rate_rad_s: motion.rate_rad_s,
            growth_per_s: pole.norm().ln() / period_s,
            frequency_hz: motion.frequency_rad_s / std::f64::consts::TAU,
        };
        Ok(Some(Swing {
            swing_rad,
            growth,
            third_harmonic: third_harmonic(&linear, motion.frequency_rad_s)?,
        }))
    }
}

/// The swing of the wind-up over that of the hub under the control alone.
fn hub_swing(linear: &Linear, (ratio, frequency_rad_s): (f64, f64)) -> Result<f64, Error> {
    let response = Response::of(&linear.plant.continuous)?.at(frequency_rad_s)?;
    let (hub, motor) = (response[(port::HUB, 0)], response[(port::MOTOR, 0)]);
    Ok((motor / hub / ratio - 1.0).norm().max(f64::MIN_POSITIVE))
}
