//! The trend of an unnamed error: its shape along one regime variable.

use crate::recording::series::{correlation_time, dot, rms};
use crate::tolerance::identification::NORMAL_95;
use crate::tolerance::localisation::INDEPENDENT_PAIR;
use crate::tolerance::localisation::LEAST_SHARE;
use crate::tolerance::localisation::{
    CONSTANT_TREND, PROPORTIONAL_PREFERENCE, TREND_FREQUENCIES_TRIED, TREND_FREQUENCY_REFINEMENTS,
    TREND_PERIODS_AT_LEAST, TREND_PERIODS_AT_MOST, TREND_SHARE,
};

/// A range of a variable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// Unit; empty if there is none.
    pub unit: &'static str,
}

/// A simple form of a function of one variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrendForm {
    /// The same throughout.
    Constant,
    /// In proportion to the variable.
    Proportional,
    /// Odd in the variable.
    Odd,
    /// Even in the variable.
    Even,
}

/// Period with which a trend repeats.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Repetition {
    /// Along a variable.
    Along {
        /// Period, in the unit of the extent.
        period: f64,
        /// Half width of its 95 % interval.
        half_width: f64,
        /// The range that the recordings cover.
        extent: Extent,
    },
    /// In time.
    InTime {
        /// Period, s.
        period_s: f64,
        /// Half width of its 95 % interval, s.
        half_width_s: f64,
    },
    /// With the motor's angle.
    WithMotorTurn {
        /// Periods in a turn.
        order: f64,
    },
}

/// The trend of a function along its regime variable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Trend {
    /// The trend has a simple form.
    Simple {
        /// The form.
        form: TrendForm,
        /// The range that the recordings cover; `None` if its numbers are not those of the machine itself.
        extent: Option<Extent>,
    },
    /// The trend repeats.
    Periodic {
        /// How; `None` if its numbers are not those of the machine itself.
        repetition: Option<Repetition>,
    },
}

impl Trend {
    /// Removes the numbers: those of a dynamically similar machine are not the machine's own.
    pub fn without_numbers(self) -> Self {
        match self {
            Self::Simple { form, .. } => Self::Simple { form, extent: None },
            Self::Periodic { .. } => Self::Periodic { repetition: None },
        }
    }
}

/// Classifies a function along its variable as constant, proportional, odd or even; returns `None` if it is none of these, or if the
/// variable does not move.
pub(crate) fn classify_function(function: &[f64], variable: &[f64], unit: &'static str) -> Option<Trend> {
    let [low, high] = range(variable)?;
    let simple_trend = |form| Trend::Simple { form, extent: Some(Extent { low, high, unit }) };
    let mean = function.iter().sum::<f64>() / function.len().max(1) as f64;
    if rms(&remove_mean(function)) < CONSTANT_TREND * mean.abs() {
        return Some(simple_trend(TrendForm::Constant));
    }
    let [straight, odd, even] = simple(function, variable);
    let forms = [
        (TrendForm::Proportional, straight + PROPORTIONAL_PREFERENCE),
        (TrendForm::Odd, odd),
        (TrendForm::Even, even),
    ];
    let best = forms.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
    best.filter(|(_, share)| *share > TREND_SHARE).map(|(form, _)| simple_trend(form))
}

/// Returns the smallest and largest value of a variable; `None` if it does not move or has too few samples.
fn range(variable: &[f64]) -> Option<[f64; 2]> {
    let (low, high) =
        variable.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    (variable.len() > 15 && high > low).then_some([low, high])
}

/// A sinusoid along a variable.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PeriodicTrend {
    /// Periods per unit of the variable.
    pub frequency: f64,
    /// Half width of the period's 95 % interval.
    pub doubt: f64,
    /// Range that is covered.
    pub range: [f64; 2],
}

impl PeriodicTrend {
    /// Finds the sinusoid that explains most of a residual; returns `None` if the variable does not move.
    pub fn of(residual: &[f64], variable: &[f64]) -> Option<Self> {
        let range = range(variable)?;
        let span = range[1] - range[0];
        let (frequency, share) = repetition(residual, variable, span);
        let share = share.clamp(LEAST_SHARE, 1.0);
        let independent = (residual.len() as f64 / correlation_time(residual)).max(4.0);
        let deviation = (3.0 * (1.0 - share) / (share * independent)).sqrt() / (std::f64::consts::PI * span);
        Some(Self { frequency, doubt: NORMAL_95 * deviation / (frequency * frequency), range })
    }

    /// Returns it as the trend of a function.
    pub fn trend(&self, unit: &'static str) -> Trend {
        let [low, high] = self.range;
        let extent = Extent { low, high, unit };
        let repetition = Repetition::Along { period: 1.0 / self.frequency, half_width: self.doubt, extent };
        Trend::Periodic { repetition: Some(repetition) }
    }
}

/// Returns the frequency, per unit of the variable, of the sinusoid that explains most, and the share that it explains.
fn repetition(residual: &[f64], variable: &[f64], span: f64) -> (f64, f64) {
    let count = (TREND_FREQUENCIES_TRIED * (TREND_PERIODS_AT_MOST - TREND_PERIODS_AT_LEAST)) as usize;
    let grid = (0..=count).map(|k| (TREND_PERIODS_AT_LEAST + k as f64 / TREND_FREQUENCIES_TRIED) / span);
    let mut best = (TREND_PERIODS_AT_LEAST / span, f64::NEG_INFINITY);
    let consider = |frequency: f64, best: &mut (f64, f64)| {
        let share = sinusoid(residual, variable, frequency);
        if share > best.1 {
            *best = (frequency, share);
        }
    };
    grid.for_each(|frequency| consider(frequency, &mut best));
    let mut width = 0.5 / TREND_FREQUENCIES_TRIED / span;
    for _ in 0..TREND_FREQUENCY_REFINEMENTS {
        let here = best.0;
        consider(here - width, &mut best);
        consider(here + width, &mut best);
        width *= 0.6;
    }
    best
}

/// Returns the share of the residual's variance that `a sin + b cos` of a frequency explains.
fn sinusoid(residual: &[f64], variable: &[f64], frequency: f64) -> f64 {
    let turn = std::f64::consts::TAU * frequency;
    let (sines, cosines): (Vec<f64>, Vec<f64>) = variable.iter().map(|v| (turn * v).sin_cos()).unzip();
    share(residual, &sines, &cosines)
}

/// Returns the shares that a straight line, an odd function (of first and third power, or of the first and the sign) and an even
/// one explain.
fn simple(residual: &[f64], variable: &[f64]) -> [f64; 3] {
    let largest = variable.iter().fold(f64::MIN_POSITIVE, |a, v| a.max(v.abs()));
    let of = |f: &dyn Fn(f64) -> f64| variable.iter().map(|v| f(v / largest)).collect::<Vec<f64>>();
    let none = vec![0.0; variable.len()];
    let straight = share(residual, &of(&|v| v), &none);
    let odd = [f64::signum as fn(f64) -> f64, |v| v * v * v].map(|f| share(residual, &of(&|v| v), &of(&f)));
    let odd = odd[0].max(odd[1]);
    let even = share(residual, &of(&f64::abs), &of(&|v| v * v));
    [straight, odd, even]
}

/// Returns the share of the variance that two regressors and a constant explain.
fn share(residual: &[f64], a: &[f64], b: &[f64]) -> f64 {
    let [r, a, b] = [residual, a, b].map(remove_mean);
    let (aa, bb, ab) = (dot(&a, &a), dot(&b, &b), dot(&a, &b));
    let (ar, br, total) = (dot(&a, &r), dot(&b, &r), dot(&r, &r).max(f64::MIN_POSITIVE));
    let determinant = aa * bb - ab * ab;
    if determinant > INDEPENDENT_PAIR * aa * bb {
        (ar * (bb * ar - ab * br) + br * (aa * br - ab * ar)) / determinant / total
    } else {
        ar * ar / aa.max(f64::MIN_POSITIVE) / total
    }
}

fn remove_mean(series: &[f64]) -> Vec<f64> {
    let mean = series.iter().sum::<f64>() / series.len().max(1) as f64;
    series.iter().map(|v| v - mean).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::panic)]
    use super::*;

    fn residual_of(f: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let variable: Vec<f64> = (0..3000).map(|k| -1.0 + k as f64 / 1500.0).collect();
        let rough = |k: usize| 0.1 * (k as f64 * 1.7).sin();
        let residual = variable.iter().enumerate().map(|(k, v)| f(*v) + rough(k)).collect();
        (residual, variable)
    }

    #[test]
    fn a_repetition_is_given_with_its_period() {
        let (residual, variable) = residual_of(|v| (std::f64::consts::TAU * v / 0.31 + 0.4).sin());
        let trend = PeriodicTrend::of(&residual, &variable).map(|found| found.trend("s"));
        let Some(Trend::Periodic { repetition: Some(Repetition::Along { period, extent, .. }) }) = trend
        else {
            panic!("{trend:?}");
        };
        assert!((period - 0.31).abs() < 0.05 && extent.low == -1.0 && extent.unit == "s", "{trend:?}");
    }

    #[test]
    fn proportional_odd_and_even_are_told_apart() {
        for (f, expected) in [
            ((|v| 2.0 * v) as fn(f64) -> f64, TrendForm::Proportional),
            (|v: f64| v.signum() + 0.2 * v, TrendForm::Odd),
            (|v: f64| v * v, TrendForm::Even),
            (|v: f64| v * v * v, TrendForm::Odd),
            (|v: f64| 9.0 + v, TrendForm::Constant),
        ] {
            let (residual, variable) = residual_of(f);
            let trend = classify_function(&residual, &variable, "");
            assert!(matches!(trend, Some(Trend::Simple { form, .. }) if form == expected), "{trend:?}");
        }
    }
}
