//! Orders at which a torque repeats with the motor's angle, read from the balance of the drive.
//!
//! The rest of the balance after everything smooth is regressed on sine and cosine of the angle times each order of a grid, as a
//! Lomb-Scargle periodogram does over time (Lomb 1976; Scargle 1982). A list of usual orders cannot hold those of every motor:
//! slots and poles make 72 or 168 periods a turn too.

use counterpoise_linalg::{Mat, lstsq};
use counterpoise_models::Parameters;

use crate::library::EffectName;
use crate::localisation::torque_balances::{Balance, BalanceColumn, BalanceSignals, integral, trim_ends};
use crate::recording::measured_signals::MeasuredSignals;
use crate::recording::series::dot;
use crate::tolerance::selection::{
    ORDER_PEAK_SHARE, ORDER_PEAKS, ORDER_SPECTRUM_LINES, ORDER_SPECTRUM_SAMPLES, ORDER_STEPS_A_LINE,
};

/// Orders between which a torque is sought that repeats, per motor radian.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct OrderRange {
    pub lowest: f64,
    pub highest: f64,
}

/// A balance of the drive over the motor's angle.
pub(crate) struct BalanceOverAngle {
    /// Angle of the motor, rad.
    angle: Vec<f64>,
    /// The rest of the balance, N m.
    residual: Vec<f64>,
    /// The signal that the repeating factor multiplies.
    carrier: Vec<f64>,
}

impl BalanceOverAngle {
    /// Forms the balance of a recording without what a constant, the frictions, rate, acceleration and angle explain of it; returns
    /// `None` if the recording is too short for that. The drive's torque stays: with the acceleration it is the balance itself.
    pub fn new(base: &Parameters, measured: &MeasuredSignals, effect: EffectName) -> Option<Self> {
        let signals = BalanceSignals::new(base, measured, None);
        let kept = |series: &[f64]| {
            let thinned = trim_ends(series);
            let step = thinned.len().div_ceil(ORDER_SPECTRUM_SAMPLES).max(1);
            thinned.into_iter().step_by(step).collect::<Vec<f64>>()
        };
        let angle = kept(&integral(signals.column(BalanceColumn::Motor), signals.period_s));
        let carrier = match effect {
            EffectName::TorqueRipple => kept(signals.column(BalanceColumn::Drive)),
            _ => vec![1.0; angle.len()],
        };
        let smooth = [
            vec![1.0; angle.len()],
            kept(signals.column(BalanceColumn::Sliding)),
            kept(signals.column(BalanceColumn::Turning)),
            kept(signals.column(BalanceColumn::Motor)),
            kept(signals.column(BalanceColumn::Acceleration)),
            angle.clone(),
            angle.iter().map(|a| a * a).collect(),
        ];
        let residual = less_explained(&kept(&signals.residual(Balance::Drive)), &smooth)?;
        Some(Self { angle, residual, carrier })
    }

    /// Share of the residual that sine and cosine of an order explain, 0 to 1.
    fn share(&self, order: f64) -> f64 {
        let mut sums = [0.0; 5];
        for ((angle, e), c) in self.angle.iter().zip(&self.residual).zip(&self.carrier) {
            let (sine, cosine) = (order * angle).sin_cos();
            let (sine, cosine) = (c * sine, c * cosine);
            for (sum, term) in
                sums.iter_mut().zip([sine * sine, sine * cosine, cosine * cosine, sine * e, cosine * e])
            {
                *sum += term;
            }
        }
        let [ss, sc, cc, se, ce] = sums;
        let determinant = ss * cc - sc * sc;
        let explained = (cc * se * se - 2.0 * sc * se * ce + ss * ce * ce) / determinant;
        let share = explained / dot(&self.residual, &self.residual);
        if share.is_finite() { share } else { 0.0 }
    }

    /// Returns the orders of the highest peaks of the spectrum within a range, the highest first.
    pub fn find_peaks(&self, range: OrderRange) -> Vec<f64> {
        let extent = |pick: fn(f64, f64) -> f64| self.angle.iter().copied().reduce(pick).unwrap_or(0.0);
        let step = std::f64::consts::TAU / (ORDER_STEPS_A_LINE * (extent(f64::max) - extent(f64::min)));
        let lines = (range.highest - range.lowest) / step;
        if !(lines > 0.0 && step > 0.0) {
            return Vec::new();
        }
        let count = (lines as usize).min(ORDER_SPECTRUM_LINES) + 1;
        let order = |k: usize| range.lowest + k as f64 * step;
        let shares: Vec<f64> = (0..count).map(|k| self.share(order(k))).collect();
        let at = |k: Option<usize>| k.and_then(|k| shares.get(k)).copied().unwrap_or(0.0);
        let is_peak = |k: &usize| {
            shares[*k] >= ORDER_PEAK_SHARE
                && shares[*k] >= at(k.checked_sub(1))
                && shares[*k] > at(k.checked_add(1))
        };
        let mut peaks: Vec<usize> = (0..count).filter(is_peak).collect();
        peaks.sort_by(|a, b| shares[*b].total_cmp(&shares[*a]));
        peaks.into_iter().take(ORDER_PEAKS).map(order).collect()
    }
}

/// Returns what is left of a series after the least squares on others.
fn less_explained(series: &[f64], others: &[Vec<f64>]) -> Option<Vec<f64>> {
    let moving: Vec<&Vec<f64>> = others.iter().filter(|column| dot(column, column) > 0.0).collect();
    let scale: Vec<f64> = moving.iter().map(|column| 1.0 / dot(column, column).sqrt()).collect();
    let columns = Mat::from_fn(series.len(), moving.len(), |i, j| scale[j] * moving[j][i]);
    let fit = &columns * &lstsq(&columns, &Mat::col(series)).ok()?;
    let left: Vec<f64> = (0..series.len()).map(|i| series[i] - fit[(i, 0)]).collect();
    (dot(&left, &left) > 0.0).then_some(left)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn over_angle(order: f64, of: impl Fn(f64) -> f64) -> BalanceOverAngle {
        let angle: Vec<f64> = (0..1000).map(|k| 0.15 * (0.01 * f64::from(k)).sin()).collect();
        let residual = angle.iter().map(|a| of(order * a)).collect();
        BalanceOverAngle { carrier: vec![1.0; angle.len()], residual, angle }
    }

    #[test]
    fn a_torque_of_any_order_is_found() {
        let range = OrderRange { lowest: 16.0, highest: 900.0 };
        for order in [33.0, 72.0, 168.0, 555.0] {
            let peaks = over_angle(order, |x| 3.0 * (x + 0.7).sin()).find_peaks(range);
            assert!((peaks[0] / order - 1.0).abs() < 0.1, "{order}: {peaks:?}");
        }
    }

    #[test]
    fn nothing_is_found_in_noise_and_in_an_empty_range() {
        let range = OrderRange { lowest: 16.0, highest: 900.0 };
        let mut noise = over_angle(1.0, |x| x);
        let mut state = 1_u64;
        noise.residual.iter_mut().for_each(|one| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            *one = (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5;
        });
        assert_eq!(noise.find_peaks(range), [0.0; 0]);
        assert!(noise.find_peaks(OrderRange { lowest: 9.0, highest: 8.0 }).is_empty());
    }
}
