//! Free functions of one variable: piecewise linear on knots, sines of time and of the motor's angle.

use crate::localisation::error_hypotheses::SignalQuantity;
use crate::localisation::ports::Port;
use crate::localisation::residual_regression::{ResidualRegression, Series};
use crate::localisation::trend::{Trend, classify_function};
use crate::tolerance::localisation::SAME_KNOT;
use crate::tolerance::localisation::{
    FUNCTION_KNOTS, FUNCTION_SAMPLES, HIGHEST_PERIODIC_HZ, MOTOR_ORDERS, PERIODS_IN_TIME,
    TIME_FREQUENCIES_TRIED, TIME_FREQUENCY_REFINEMENTS,
};

/// The spacing of the knots of a free function along its variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum KnotSpacing {
    /// As many samples between any two.
    Even,
    /// Closer together towards small values, where friction changes most.
    DenseAtRest,
}

/// Places the knots of a free function of a variable; returns `None` if the variable does not move.
pub(crate) fn place_knots(variable: &Series, spacing: KnotSpacing) -> Option<Vec<f64>> {
    let mut sorted: Vec<f64> = variable.iter().flatten().copied().collect();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    let at = |k: usize| {
        let share = k as f64 / (FUNCTION_KNOTS - 1) as f64;
        let share = if spacing == KnotSpacing::DenseAtRest { share * share } else { share };
        sorted[(share * last as f64) as usize]
    };
    let mut knots: Vec<f64> = (0..FUNCTION_KNOTS).map(at).collect();
    let least = SAME_KNOT * (sorted[last] - sorted[0]);
    knots.dedup_by(|a, b| *a - *b <= least);
    (knots.len() > 1 && knots.iter().all(|k| k.is_finite())).then_some(knots)
}

/// Returns the index of the knot below a value, and the weight of the knot above it.
fn knot_interval(knots: &[f64], value: f64) -> (usize, f64) {
    let value = value.clamp(knots[0], knots[knots.len() - 1]);
    let lower = knots.partition_point(|k| *k <= value).clamp(1, knots.len() - 1) - 1;
    (lower, (value - knots[lower]) / (knots[lower + 1] - knots[lower]))
}

/// Returns one series for each knot: the function that is 1 there and falls to 0 at the next, times the carrier.
pub(crate) fn hat_series(variable: &Series, carrier: &Series, knots: &[f64]) -> Vec<Series> {
    let mut out = vec![carrier.iter().map(|c| vec![0.0; c.len()]).collect::<Series>(); knots.len()];
    for (r, (values, carried)) in variable.iter().zip(carrier).enumerate() {
        for (k, (value, c)) in values.iter().zip(carried).enumerate() {
            let (lower, share) = knot_interval(knots, *value);
            out[lower][r][k] = (1.0 - share) * c;
            out[lower + 1][r][k] = share * c;
        }
    }
    out
}

/// Classifies a function on knots along its variable; returns `None` if it has no simple form.
pub(crate) fn classify_knot_function(
    knots: &[f64],
    coefficients: &[f64],
    along: &[f64],
    unit: &'static str,
) -> Option<Trend> {
    if coefficients.len() != knots.len() {
        return None;
    }
    let some: Vec<f64> = along.iter().step_by((along.len() / FUNCTION_SAMPLES).max(1)).copied().collect();
    let value = |v: &f64| {
        let (lower, share) = knot_interval(knots, *v);
        (1.0 - share) * coefficients[lower] + share * coefficients[lower + 1]
    };
    classify_function(&some.iter().map(value).collect::<Vec<_>>(), &some, unit)
}

/// Returns the frequency that explains most of the drive's balance, Hz, its phase free in every recording, and its sines and
/// cosines there.
pub(crate) fn sines(regression: &ResidualRegression, carrier: &Series) -> Option<(f64, Vec<Series>)> {
    let times = regression.all(SignalQuantity::Time);
    let longest = times.iter().filter_map(|t| t.last().copied()).fold(0.0, f64::max);
    if longest <= 0.0 {
        return None;
    }
    let step = 1.0 / (TIME_FREQUENCIES_TRIED * longest);
    let count =
        ((HIGHEST_PERIODIC_HZ * longest - PERIODS_IN_TIME) * TIME_FREQUENCIES_TRIED).max(0.0) as usize;
    let mut best = (PERIODS_IN_TIME / longest, 0.0);
    let consider = |frequency: f64, best: &mut (f64, f64)| {
        let power = regression.power_at(frequency);
        if power > best.1 {
            *best = (frequency, power);
        }
    };
    (0..count).for_each(|k| consider(PERIODS_IN_TIME / longest + k as f64 * step, &mut best));
    let mut width = 0.5 * step;
    for _ in 0..TIME_FREQUENCY_REFINEMENTS {
        let here = best.0;
        consider(here - width, &mut best);
        consider(here + width, &mut best);
        width *= 0.6;
    }
    let turn = std::f64::consts::TAU * best.0;
    let alone = |r: usize| -> Series {
        carrier.iter().enumerate().map(|(k, c)| if k == r { c.clone() } else { vec![0.0; c.len()] }).collect()
    };
    Some((best.0, (0..times.len()).flat_map(|r| waves(turn, &times, &alone(r))).collect()))
}

/// Returns sine and cosine of a variable times a turn, each times the carrier.
pub(crate) fn waves(turn: f64, variable: &Series, carrier: &Series) -> [Series; 2] {
    [f64::sin as fn(f64) -> f64, f64::cos].map(|of| {
        let one = |(values, carried): (&Vec<f64>, &Vec<f64>)| {
            values.iter().zip(carried).map(|(v, c)| c * of(turn * v)).collect()
        };
        variable.iter().zip(carrier).map(one).collect()
    })
}

/// Returns the order at which a sine of the motor's angle at a port gains most, and its two columns.
pub(crate) fn best_motor_order(
    regression: &ResidualRegression,
    port: Port,
    carrier: &Series,
) -> Option<(f64, Vec<Vec<f64>>)> {
    let angle = regression.all(SignalQuantity::MotorAngle);
    let at = |order: &f64| {
        let columns = regression.columns(port, &waves(*order, &angle, carrier));
        Some((regression.gain(&columns)?, *order, columns))
    };
    let best = MOTOR_ORDERS.iter().filter_map(at).max_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, order, columns)| (order, columns))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::localisation::trend::{Extent, TrendForm};

    #[test]
    fn a_function_on_knots_is_the_straight_line_between_them() {
        let variable = vec![(0..100).map(|k| f64::from(k) * 0.1).collect::<Vec<f64>>()];
        let knots = place_knots(&variable, KnotSpacing::Even).unwrap();
        let columns = hat_series(&variable, &vec![vec![1.0; 100]], &knots);
        for k in 0..100 {
            let line: f64 = columns.iter().zip(&knots).map(|(c, knot)| (2.0 - 3.0 * knot) * c[0][k]).sum();
            assert!((line - (2.0 - 3.0 * variable[0][k])).abs() < 1e-9);
        }
        let trend = classify_knot_function(&knots, &knots, &variable[0], "rad");
        let extent = Some(Extent { low: 0.0, high: variable[0][99], unit: "rad" });
        assert_eq!(trend, Some(Trend::Simple { form: TrendForm::Proportional, extent }));
        assert!(place_knots(&vec![vec![1.0; 5]], KnotSpacing::Even).is_none());
    }
}
