//! Figures of a step response, read from samples that may be noisy.

use super::{check_finite, check_length, mean};
use crate::Error;
use crate::tolerance::{EVEN_SPACING, FEWEST_STEP_SAMPLES, RISE_FROM_TO, SETTLING_BAND, STEADY_FRACTION};

/// Figures of the response to a step from rest to `demand`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepFigures {
    /// Excess of the largest value over the demand, percent of the demand; 0 if there is none.
    pub overshoot_percent: f64,
    /// From 10 % to 90 % of the demand; `None` if 90 % is never reached.
    pub rise_time_s: Option<f64>,
    /// From the step to the largest value; `None` if the demand is never exceeded.
    pub peak_time_s: Option<f64>,
    /// From the step to the last sample outside +/- 5 % of the demand; `None` if the record ends outside.
    pub settling_time_s: Option<f64>,
    /// |demand - mean over the last tenth of the record|, percent of the demand.
    pub steady_state_error_percent: f64,
    /// Mean over the last tenth of the record, in the unit of y.
    pub final_value: f64,
}

/// Reads the figures of the response `y` at the times `time_s` (seconds from the step; uniform or not) to a step from 0 to
/// `demand`. Crossings are interpolated; the largest value is refined by a parabola through its neighbours where the samples are
/// uniform there.
///
/// # Errors
/// [`Error::Length`] for fewer than ten samples or series of two lengths, [`Error::NotFinite`], [`Error::Range`] for a demand of 0.
pub fn step_figures(time_s: &[f64], y: &[f64], demand: f64) -> Result<StepFigures, Error> {
    check(time_s, y, demand)?;
    let relative: Vec<f64> = y.iter().map(|value| value / demand).collect();
    let (peak_time_s, peak) = largest(time_s, &relative);
    let steady = ((y.len() as f64 * STEADY_FRACTION).ceil() as usize).max(1);
    let final_value = mean(&y[y.len() - steady..]);
    Ok(StepFigures {
        overshoot_percent: 100.0 * (peak - 1.0).max(0.0),
        rise_time_s: rise_time(time_s, &relative),
        peak_time_s: (peak > 1.0).then_some(peak_time_s),
        settling_time_s: settling_time(time_s, &relative),
        steady_state_error_percent: 100.0 * (1.0 - final_value / demand).abs(),
        final_value,
    })
}

fn check(time_s: &[f64], y: &[f64], demand: f64) -> Result<(), Error> {
    check_length("step response", y.len(), time_s.len())?;
    if y.len() < FEWEST_STEP_SAMPLES {
        return Err(Error::Length { what: "step response", found: y.len(), needed: FEWEST_STEP_SAMPLES });
    }
    check_finite("time of a step response", time_s)?;
    check_finite("step response", y)?;
    if demand == 0.0 || !demand.is_finite() {
        return Err(Error::Range { what: "demand of a step", value: demand, allowed: "finite and not 0" });
    }
    Ok(())
}

/// Time and height of the largest value.
fn largest(time_s: &[f64], y: &[f64]) -> (f64, f64) {
    let at = (0..y.len()).fold(0, |best, k| if y[k] > y[best] { k } else { best });
    if at == 0 || at + 1 == y.len() {
        return (time_s[at], y[at]);
    }
    let (before, here, after) = (y[at - 1], y[at], y[at + 1]);
    let curvature = before - 2.0 * here + after;
    let (left, right) = (time_s[at] - time_s[at - 1], time_s[at + 1] - time_s[at]);
    if curvature >= 0.0 || (left - right).abs() > EVEN_SPACING * left {
        return (time_s[at], here);
    }
    let shift = 0.5 * (before - after) / curvature;
    (time_s[at] + shift * left, here - 0.25 * (before - after) * shift)
}

fn rise_time(time_s: &[f64], y: &[f64]) -> Option<f64> {
    let from = first_crossing(time_s, y, RISE_FROM_TO.0)?;
    let to = first_crossing(time_s, y, RISE_FROM_TO.1)?;
    Some(to - from)
}

fn first_crossing(time_s: &[f64], y: &[f64], level: f64) -> Option<f64> {
    let k = y.iter().position(|&value| value >= level)?;
    if k == 0 {
        return Some(time_s[0]);
    }
    let fraction = (level - y[k - 1]) / (y[k] - y[k - 1]);
    Some(time_s[k - 1] + fraction * (time_s[k] - time_s[k - 1]))
}

fn settling_time(time_s: &[f64], y: &[f64]) -> Option<f64> {
    let outside = |value: f64| (value - 1.0).abs() > SETTLING_BAND;
    let Some(last) = y.iter().rposition(|&value| outside(value)) else { return Some(time_s[0]) };
    let after = last + 1;
    if after == y.len() {
        return None;
    }
    let edge = if y[last] > 1.0 { 1.0 + SETTLING_BAND } else { 1.0 - SETTLING_BAND };
    let fraction = ((edge - y[last]) / (y[after] - y[last])).clamp(0.0, 1.0);
    Some(time_s[last] + fraction * (time_s[after] - time_s[last]))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::f64::consts::PI;

    fn second_order(zeta: f64, wn: f64, until_s: f64, step_s: f64) -> (Vec<f64>, Vec<f64>) {
        let wd = wn * (1.0 - zeta * zeta).sqrt();
        let time: Vec<f64> = (0..(until_s / step_s) as usize).map(|k| k as f64 * step_s).collect();
        let response =
            |t: f64| 1.0 - (-zeta * wn * t).exp() * ((wd * t).cos() + zeta * wn / wd * (wd * t).sin());
        let y = time.iter().map(|&t| response(t)).collect();
        (time, y)
    }

    #[test]
    fn a_second_order_system_has_its_closed_form() {
        let (zeta, wn) = (0.5, 10.0);
        let (time, y) = second_order(zeta, wn, 3.0, 1e-3);
        let found = step_figures(&time, &y, 1.0).unwrap();
        let root = (1.0f64 - zeta * zeta).sqrt();
        assert!((found.overshoot_percent - 100.0 * (-PI * zeta / root).exp()).abs() < 1e-4);
        assert!((found.peak_time_s.unwrap() - PI / (wn * root)).abs() < 1e-5);
        assert!(found.steady_state_error_percent < 1e-3);
    }

    #[test]
    fn a_first_order_lag_rises_and_settles_as_it_must() {
        let time: Vec<f64> = (0..4000).map(|k| k as f64 * 1e-3).collect();
        let y: Vec<f64> = time.iter().map(|t| -2.0 * (1.0 - (-t / 0.4f64).exp())).collect();
        let found = step_figures(&time, &y, -2.0).unwrap();
        assert_eq!(found.overshoot_percent, 0.0);
        assert_eq!(found.peak_time_s, None);
        assert!((found.rise_time_s.unwrap() - 0.4 * 9f64.ln()).abs() < 1e-5);
        assert!((found.settling_time_s.unwrap() - 0.4 * 20f64.ln()).abs() < 1e-5);
    }

    #[test]
    fn what_never_happens_is_none() {
        let time: Vec<f64> = (0..100).map(|k| k as f64 * 1e-2).collect();
        let y = vec![0.5; 100];
        let found = step_figures(&time, &y, 1.0).unwrap();
        assert_eq!((found.rise_time_s, found.settling_time_s, found.peak_time_s), (None, None, None));
        assert!((found.steady_state_error_percent - 50.0).abs() < 1e-12);
    }

    #[test]
    fn bad_series_are_refused() {
        assert!(matches!(step_figures(&[0.0; 3], &[0.0; 3], 1.0), Err(Error::Length { .. })));
        assert!(matches!(
            step_figures(&[0.0; 20], &[f64::NAN; 20], 1.0),
            Err(Error::NotFinite { index: 0, .. })
        ));
        assert!(matches!(step_figures(&[0.0; 20], &[0.0; 20], 0.0), Err(Error::Range { .. })));
    }
}
