//! Limit cycles in which the gear teeth part, and the describing function of the gap.

use counterpoise_lti::Response;

use super::balance::{CycleBalance, MeshBalance, Settled};
use super::cycle::{Balance, Cycle, Growth, Prediction, frequency_error, motor_over_hub, rate_of, third_harmonic};
use super::elements::{Elements, Learning, Linear, Sinusoid};
use crate::Error;
use crate::linear::plant::port;
use crate::tolerance::{CYCLE_HALVINGS, FREQUENCY_ROUNDS, GAP_SWINGS, MOST_GAP_SWING, OPEN, STEADY_GROWTH};

/// The growth at a swing of the gear's wind-up.
struct Swing {
    swing_rad: f64,
    growth: Growth,
    third_harmonic: f64,
    settled: Settled,
}

impl Balance<'_> {
    /// Adds the limit cycles in which the teeth part: sought over the swing of the gear's wind-up, because the same swing of the hub can go with
    /// teeth that stay together and with teeth that part.
    pub(super) fn rattling(&self, found: &mut Prediction) -> Result<(), Error> {
        let gearbox = &self.subject.case.plant.parameters().gearbox;
        let (gap, pressed) = (gearbox.backlash_rad, self.pressed_rad());
        let least = if pressed > 0.0 { pressed } else { 0.5 * gap };
        let mut before: Option<Swing> = None;
        for k in 1..=GAP_SWINGS {
            let swing_rad = least * MOST_GAP_SWING.powf(k as f64 / GAP_SWINGS as f64);
            let now = self.swinging(swing_rad)?;
            let grew = before.as_ref().is_some_and(|at| at.growth.growth_per_s > STEADY_GROWTH);
            let fades = now.as_ref().is_some_and(|at| at.growth.growth_per_s <= STEADY_GROWTH);
            match (before.take(), now) {
                // the next swing starts where the motion fades
                (Some(low), Some(high)) if grew && fades => self.rattling_cycle(found, low, high)?,
                (_, now) => before = now,
            }
        }
        Ok(())
    }

    /// Adds the limit cycle between a swing that grows and one that fades.
    fn rattling_cycle(&self, found: &mut Prediction, grows: Swing, fades: Swing) -> Result<(), Error> {
        let (mut low, mut high) = (grows, fades);
        for _ in 0..CYCLE_HALVINGS {
            let Some(middle) = self.swinging((low.swing_rad * high.swing_rad).sqrt())? else { break };
            if middle.growth.growth_per_s > STEADY_GROWTH { low = middle } else { high = middle }
        }
        for side in [&low, &high] {
            found.balances.push(CycleBalance::new(self.subject, found.cycles.len(), &side.settled)?);
        }
        found.cycles.push(Cycle {
            rate_rad_s: low.growth.rate_rad_s,
            frequency_hz: low.growth.frequency_hz,
            third_harmonic: low.third_harmonic,
            frequency_error: frequency_error(&low.settled, &high.settled),
        });
        Ok(())
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
            let (period_s, used) = (linear.plant.sample_period_s, motion);
            let frequency = rate_of(pole, period_s);
            let over = motor_over_hub(&linear, frequency)?.unwrap_or(gearbox.ratio);
            let hub_rad = swing_rad / hub_swing(&linear, (gearbox.ratio, frequency))?;
            motion = Sinusoid {
                rate_rad_s: hub_rad * frequency,
                frequency_rad_s: frequency,
                motor_over_hub: over,
            };
            let mesh = MeshBalance {
                wind_up_rad: swing_rad,
                pressed_rad: self.pressed_rad(),
                gap_rad: gearbox.backlash_rad,
                share,
            };
            found = Some(Settled { motion: used, elements, linear, pole, mesh });
        }
        let Some(settled) = found else { return Ok(None) };
        let period_s = settled.linear.plant.sample_period_s;
        let growth = Growth {
            rate_rad_s: motion.rate_rad_s,
            growth_per_s: settled.pole.norm().ln() / period_s,
            frequency_hz: motion.frequency_rad_s / std::f64::consts::TAU,
        };
        Ok(Some(Swing {
            swing_rad,
            growth,
            third_harmonic: third_harmonic(&settled.linear, motion.frequency_rad_s)?,
            settled,
        }))
    }
}

/// The swing of the wind-up over that of the hub under the control alone.
fn hub_swing(linear: &Linear, (ratio, frequency_rad_s): (f64, f64)) -> Result<f64, Error> {
    let response = Response::of(&linear.plant.continuous)?.at(frequency_rad_s)?;
    let (hub, motor) = (response[(port::HUB, 0)], response[(port::MOTOR, 0)]);
    Ok((motor / hub / ratio - 1.0).norm().max(f64::MIN_POSITIVE))
}

/// Describing function of a gap over the stiffness beside it, for a wind-up that swings about a flank pressed by `pressed_rad`:
/// first harmonic of the torque over that of the wind-up. 1 while the teeth stay together.
pub fn gap_share(wind_up_rad: f64, pressed_rad: f64, gap_rad: f64) -> f64 {
    if wind_up_rad <= pressed_rad || gap_rad == 0.0 {
        return 1.0;
    }
    // by the midpoint rule over one period: the torque is continuous, and 400 points give four digits
    const POINTS: usize = 400;
    let torque = |swing: f64| {
        let at = pressed_rad + swing;
        if at >= 0.0 { at } else { (at + gap_rad).min(0.0) }
    };
    let sum: f64 = (0..POINTS)
        .map(|k| (std::f64::consts::TAU * (k as f64 + 0.5) / POINTS as f64).cos())
        .map(|cos| torque(wind_up_rad * cos) * cos)
        .sum();
    2.0 * sum / (POINTS as f64 * wind_up_rad)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_has_the_describing_function_of_the_textbook() {
        // D. Atherton: dead zone of half width d, slope 1: N = 1 - (2/pi) (asin r + r sqrt(1 - r^2)), r = d / A; a flank at the edge of
        // the zone is the same as a zone about its middle that is pressed by half its width
        let (gap, swing) = (2e-3, 5e-3);
        let r: f64 = 0.5 * gap / swing;
        let expected = 1.0 - 2.0 / std::f64::consts::PI * (r.asin() + r * (1.0 - r * r).sqrt());
        let middle = gap_share(swing, -0.5 * gap, gap);
        assert!((middle - expected).abs() < 1e-3, "{middle} {expected}");
    }

    #[test]
    fn pressed_teeth_stay_together_until_the_wind_up_exceeds_what_presses_them() {
        assert_eq!(gap_share(1e-4, 2e-4, 1e-3), 1.0);
        assert!(gap_share(4e-4, 2e-4, 1e-3) < 1.0);
    }
}
