//! A weight in words.

use std::f64::consts::TAU;

use crate::rational::Rational;
use crate::weight::Weight;

impl Weight {
    /// What the weight means in words, as a weight on the `signal` ("error", "control"): what it says of the steady and of
    /// the fast signal, up to where it is the one, and where it weighs most or least in between.
    pub fn meaning(&self, signal: &str) -> String {
        let rational = self.rational();
        if rational.zeros.is_empty() && rational.poles.is_empty() {
            return format!("weight on the {signal}: {} at every frequency", plain(rational.gain.abs()));
        }
        let low = match rational.order_at_zero() {
            0 => format!("{} at low frequency", plain(self.magnitude(0.0))),
            n if n < 0 => {
                format!("without bound towards zero frequency, so that no steady {signal} may remain")
            }
            _ => format!("nothing at zero frequency, so that a steady {signal} is free"),
        };
        let high = match rational.relative_degree() {
            0 => format!("{} at high frequency", plain(rational.gain.abs())),
            n if n < 0 => {
                format!("rising with the power {} of frequency, so that fast {signal} is forbidden", -n)
            }
            n => format!("falling with the power {n} of frequency, so that fast {signal} is let be"),
        };
        let between = match (self.corner(&rational), self.extreme(&rational)) {
            (None, _) => format!(
                "1 at {} Hz",
                plain(rational.gain.abs().powf(1.0 / rational.relative_degree() as f64) / TAU)
            ),
            (Some(corner), None) => format!("up to {} Hz", plain(corner / TAU)),
            (Some(_), Some((rate, modulus, which))) => {
                format!("{which} at {} Hz ({})", plain(rate / TAU), plain(modulus))
            }
        };
        format!("weight on the {signal}: {low}, {between}; {high}")
    }

    /// The rates over which a weight with roots off the origin changes, evenly spaced on a logarithmic axis.
    fn rates(rational: &Rational) -> Option<Vec<f64>> {
        let moduli =
            rational.zeros.iter().chain(&rational.poles).map(|root| root.norm()).filter(|r| *r > 0.0);
        let (least, most) = moduli.fold((f64::INFINITY, 0.0_f64), |(a, b), r| (a.min(r), b.max(r)));
        let (from, to) = (least * 1e-3, most * 1e3);
        let rate = |k: usize| from * (to / from).powf(k as f64 / (MEANING_POINTS - 1) as f64);
        (most > 0.0).then(|| (0..MEANING_POINTS).map(rate).collect())
    }

    /// The rate at which the modulus leaves that of low frequency by 3 dB; `None` if every root is at the origin.
    fn corner(&self, rational: &Rational) -> Option<f64> {
        let (rates, order) = (Self::rates(rational)?, rational.order_at_zero());
        let level = |rate: f64| self.magnitude(rate) / rate.powi(order);
        let start = level(*rates.first()?);
        let left = |rate: f64| (level(rate) / start).ln().abs() > 2f64.sqrt().ln();
        let Some(first) = rates.iter().position(|rate| left(*rate)) else { return rates.last().copied() };
        let (mut before, mut after) = (rates[first.saturating_sub(1)], rates[first]);
        for _ in 0..BISECTIONS {
            let middle = (before * after).sqrt();
            (before, after) = if left(middle) { (before, middle) } else { (middle, after) };
        }
        Some(after)
    }

    /// Where a weight that is level at both ends is largest or smallest between them, if by more than 3 dB: rate, modulus and
    /// which.
    fn extreme(&self, rational: &Rational) -> Option<(f64, f64, &'static str)> {
        if rational.order_at_zero() != 0 || rational.relative_degree() != 0 {
            return None;
        }
        let rates = Self::rates(rational)?;
        let ends = [self.magnitude(0.0), rational.gain.abs()];
        let values: Vec<(f64, f64)> = rates.iter().map(|&rate| (rate, self.magnitude(rate))).collect();
        let most = values.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let least = values.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1))?;
        if most.1 > 2f64.sqrt() * ends[0].max(ends[1]) {
            return Some((most.0, most.1, "most"));
        }
        (least.1 * 2f64.sqrt() < ends[0].min(ends[1])).then_some((least.0, least.1, "least"))
    }
}

/// Frequencies at which a weight is looked at for its meaning.
const MEANING_POINTS: usize = 601;
/// Halvings of the stretch in which a corner lies.
const BISECTIONS: usize = 20;

/// Three significant digits, as a person writes them.
fn plain(value: f64) -> String {
    if !(1e-3..1e6).contains(&value) {
        return format!("{value:.2e}");
    }
    let decimals = (2.0 - value.log10().floor()).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}
