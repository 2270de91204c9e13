//! The coincidence window of a stabilised gun: how long the axis points within it, and whether a shot that it releases hits.
//!
//! The trigger is pressed at a random instant. The shot is released at the first instant at which the hub's error is within the window, which is
//! at once if it is within already. The projectile leaves the muzzle at the tip a delay later, and hits if the tip's error is then within the
//! target, widened by the dispersion of the rounds. The probability is an average over every instant of the record as that of the trigger.
//! An instant is not counted if its shot would leave after the end of the record.

use crate::Error;
use crate::signals::normal_distribution::probability_between;

/// The window within which a shot is released, and the target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coincidence {
    /// Largest error of the hub at which a shot is released, rad.
    pub window_rad: f64,
    /// Time from the release to the instant at which the projectile leaves the tip, s.
    pub delay_s: f64,
    /// Largest error of the tip that hits, rad: half the target's height over its distance.
    pub target_rad: f64,
    /// RMS dispersion of the rounds about the tip's direction, rad; 0 if the projectile flies where the tip points.
    pub dispersion_rad: f64,
}

impl Default for Coincidence {
    /// A window and a target of half a milliradian, 10 ms from the release to the muzzle, no dispersion.
    fn default() -> Self {
        Self { window_rad: 5e-4, delay_s: 0.01, target_rad: 5e-4, dispersion_rad: 0.0 }
    }
}

impl Coincidence {
    /// Refuses a window, a delay or a target that cannot be.
    ///
    /// # Errors
    /// [`Error::Range`].
    pub fn check(&self) -> Result<(), Error> {
        let positive = [
            ("coincidence window in rad", self.window_rad),
            ("half size of the target in rad", self.target_rad),
        ];
        let not_negative =
            [("delay of the shot in s", self.delay_s), ("dispersion in rad", self.dispersion_rad)];
        for (what, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::Range { what, value, allowed: "positive" });
            }
        }
        for (what, value) in not_negative {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(Error::Range { what, value, allowed: "0 or more" });
            }
        }
        Ok(())
    }
}

/// Shots of a run through a coincidence window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shots {
    /// Share of the time during which the hub's error is within the window.
    pub inside: f64,
    /// Mean time from the trigger to the release, s; infinite if the error never is within the window.
    pub wait_s: f64,
    /// Probability that a shot hits; 0 if none is released.
    pub hit: f64,
}

/// Returns what a window makes of the errors of hub and tip, in rad, in samples of one period. `None` if every shot leaves after the end.
pub fn coincidence_figures(
    hub_rad: &[f64],
    tip_rad: &[f64],
    period_s: f64,
    asked: &Coincidence,
) -> Option<Shots> {
    let is_inside: Vec<bool> = hub_rad.iter().map(|error| error.abs() <= asked.window_rad).collect();
    let inside = is_inside.iter().filter(|one| **one).count();
    if inside == 0 {
        return Some(Shots { inside: 0.0, wait_s: f64::INFINITY, hit: 0.0 });
    }
    let (mut counted, mut waited, mut hits, mut release) = (0_usize, 0_usize, 0.0, None);
    for trigger in (0..hub_rad.len()).rev() {
        if is_inside[trigger] {
            release = at(tip_rad, trigger as f64 + asked.delay_s / period_s).map(|error| (trigger, error));
        }
        let Some((released, error)) = release else { continue };
        counted += 1;
        waited += released - trigger;
        let (low, high) = (-asked.target_rad - error, asked.target_rad - error);
        hits += probability_between(low, high, asked.dispersion_rad);
    }
    let mean = |sum: f64| sum / counted as f64;
    (counted > 0).then(|| Shots {
        inside: inside as f64 / hub_rad.len() as f64,
        wait_s: period_s * mean(waited as f64),
        hit: mean(hits),
    })
}

/// Returns the value at a fractional index on the straight line between two samples; `None` beyond the last.
fn at(samples: &[f64], index: f64) -> Option<f64> {
    let (k, fraction) = (index.floor() as usize, index - index.floor());
    let (a, b) = (*samples.get(k)?, samples.get(k + 1));
    if fraction == 0.0 { Some(a) } else { b.map(|b| a + fraction * (b - a)) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::f64::consts::{FRAC_2_PI, TAU};

    const PERIOD_S: f64 = 1e-4;

    /// Ten seconds of a sine of 1 mrad at 2 Hz.
    fn sine() -> Vec<f64> {
        (0..100_000).map(|k| 1e-3 * (TAU * 2.0 * PERIOD_S * f64::from(k)).sin()).collect()
    }

    fn of(asked: Coincidence) -> Shots {
        coincidence_figures(&sine(), &sine(), PERIOD_S, &asked).unwrap()
    }

    /// A sine of amplitude A is within w during 2/pi asin(w/A) of the time. Outside, it waits half of each stay on the average: stays last
    /// T/2 (1 - share), twice a period, and the mean of the wait is the sum of their half squares over the period.
    #[test]
    fn a_sine_is_inside_and_waits_as_the_closed_form_says() {
        let found = of(Coincidence { window_rad: 6e-4, ..Coincidence::default() });
        let share = FRAC_2_PI * 0.6_f64.asin();
        assert!((found.inside - share).abs() < 1e-3, "{found:?} {share}");
        let stay_s = 0.25 * (1.0 - share);
        let wait_s = 2.0 * 0.5 * stay_s * stay_s / 0.5;
        assert!((found.wait_s / wait_s - 1.0).abs() < 1e-2, "{found:?} {wait_s}");
    }

    /// Without delay every shot of a window as large as the target hits; after a quarter of the period, a shot that was released at an entry
    /// into the window, or within, has the error of a cosine.
    #[test]
    fn what_is_released_inside_hits_unless_it_leaves_late() {
        let window_rad = 5e-4;
        let none = Coincidence { window_rad, target_rad: window_rad, delay_s: 0.0, dispersion_rad: 0.0 };
        assert_eq!(of(none).hit, 1.0);
        // the cosine is at least sqrt(1 - 0.25) of the amplitude while the sine is within a half
        let late = Coincidence { delay_s: 0.125, ..none };
        assert_eq!(of(late).hit, 0.0);
        let large = Coincidence { target_rad: 1.1e-3, ..late };
        assert_eq!(of(large).hit, 1.0);
    }

    /// An axis that points exactly leaves the dispersion: the probability of a normal error within one sigma.
    #[test]
    fn dispersion_is_that_of_a_normal_error() {
        let still = vec![0.0; 1000];
        let asked =
            Coincidence { target_rad: 1e-3, dispersion_rad: 1e-3, delay_s: 0.0, ..Coincidence::default() };
        let found = coincidence_figures(&still, &still, PERIOD_S, &asked).unwrap();
        assert!((found.hit - 0.682_689_492_137_085_9).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn nothing_is_released_by_an_axis_that_never_is_inside() {
        let far = vec![1e-2; 1000];
        let found = coincidence_figures(&far, &far, PERIOD_S, &Coincidence::default()).unwrap();
        assert_eq!(found, Shots { inside: 0.0, wait_s: f64::INFINITY, hit: 0.0 });
        let late = Coincidence { delay_s: 1.0, ..Coincidence::default() };
        assert_eq!(coincidence_figures(&[0.0; 1000], &[0.0; 1000], PERIOD_S, &late), None);
    }
}
