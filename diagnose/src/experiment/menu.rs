//! The demands of the menu: each a rate over time, at several sizes within the limits.

use std::f64::consts::TAU;

use crate::tolerance::experiment::{LEVELS, MULTISINE_LINES, MULTISINE_RANGE_HZ, STAIRS, SWEEP_PERIODS};

/// Limits of an experiment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Angle from the start to either side, rad.
    pub angle_rad: f64,
    /// Rate in either direction, rad/s.
    pub rate_rad_s: f64,
    /// Current in either direction, A.
    pub current_a: f64,
    /// Duration, s.
    pub duration_s: f64,
}

/// The shape of a demand over time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DemandShape {
    /// Triangle waves of the rate with a number of periods: what depends on rate and on direction.
    Triangle {
        /// Periods in the experiment.
        periods: usize,
    },
    /// A ladder of constant rates in both directions: friction over the rate, what repeats with the angle.
    Staircase,
    /// A slow sine whose size grows from nothing: presliding, breakaway, gaps.
    GrowingSine,
    /// Sines at many frequencies: inertia, stiffness, delays, bandwidths.
    Multisine,
    /// Steps of the rate in both directions with rests between.
    Steps,
}

/// A demand of the menu.
#[derive(Debug, Clone, PartialEq)]
pub struct Demand {
    /// Shape.
    pub shape: DemandShape,
    /// Size, as a share of the largest that the limits allow.
    pub level: f64,
    /// Rate at each sample, rad/s.
    pub rate_rad_s: Vec<f64>,
    /// Integral of the rate from the start, rad.
    pub angle_rad: Vec<f64>,
}

/// All shapes of the menu.
pub const SHAPES: [DemandShape; 7] = [
    DemandShape::Triangle { periods: 2 },
    DemandShape::Triangle { periods: 6 },
    DemandShape::Triangle { periods: 16 },
    DemandShape::Staircase,
    DemandShape::GrowingSine,
    DemandShape::Multisine,
    DemandShape::Steps,
];

/// Returns the menu within limits, at a sample period.
pub fn list_demands(limits: &Limits, period_s: f64) -> Vec<Demand> {
    let count = (limits.duration_s / period_s).round().max(2.0) as usize;
    let of = |shape: DemandShape| {
        let unit: Vec<f64> =
            (0..count).map(|k| shape.at(k as f64 / count as f64, limits.duration_s)).collect();
        LEVELS.map(|level| scale_to_limits(shape, level, &unit, limits, period_s))
    };
    SHAPES.into_iter().flat_map(of).collect()
}

/// Returns a demand of a shape at a share of the largest size that keeps rate and angle within their limits.
fn scale_to_limits(shape: DemandShape, level: f64, unit: &[f64], limits: &Limits, period_s: f64) -> Demand {
    let peak = |series: &[f64]| series.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let travelled = integral(unit, period_s);
    let by_rate = limits.rate_rad_s / peak(unit).max(f64::MIN_POSITIVE);
    let by_angle = limits.angle_rad / peak(&travelled).max(f64::MIN_POSITIVE);
    let size = level * by_rate.min(by_angle);
    let scaled = |series: &[f64]| series.iter().map(|value| size * value).collect::<Vec<f64>>();
    Demand { shape, level, rate_rad_s: scaled(unit), angle_rad: scaled(&travelled) }
}

/// Returns the integral of a rate that is held from sample to sample.
fn integral(rate: &[f64], period_s: f64) -> Vec<f64> {
    let mut angle = 0.0;
    let mut step = |rate: &f64| {
        let here = angle;
        angle += period_s * rate;
        here
    };
    rate.iter().map(&mut step).collect()
}

impl DemandShape {
    /// Returns the value, of about 1 at most, at a share of the duration.
    fn at(self, share: f64, duration_s: f64) -> f64 {
        match self {
            Self::Triangle { periods } => {
                // from the quarter period on, so that the angle swings about the start
                let phase = (periods as f64 * share + 0.25).rem_euclid(1.0);
                1.0 - 4.0 * (phase - 0.5).abs()
            }
            Self::Staircase => {
                let place = share * 2.0 * STAIRS.len() as f64;
                let stair = STAIRS[((place / 2.0) as usize).min(STAIRS.len() - 1)];
                if (place as usize).is_multiple_of(2) { stair } else { -stair }
            }
            Self::GrowingSine => share * (TAU * SWEEP_PERIODS * share).cos(),
            Self::Multisine => {
                let [low, high] = MULTISINE_RANGE_HZ;
                let line = |k: usize| {
                    let place = k as f64 / (MULTISINE_LINES - 1) as f64;
                    let periods = (low * (high / low).powf(place) * duration_s).round().max(1.0);
                    // Schroeder 1970: phases that keep the peak low
                    (TAU * periods * share - std::f64::consts::PI * (k * k) as f64 / MULTISINE_LINES as f64)
                        .cos()
                };
                (0..MULTISINE_LINES).map(line).sum::<f64>() / (MULTISINE_LINES as f64).sqrt()
            }
            Self::Steps => match (8.0 * share) as usize % 4 {
                0 => 1.0,
                2 => -1.0,
                _ => 0.0,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_demand_stays_within_its_limits_and_uses_one_of_them() {
        let limits = Limits { angle_rad: 0.05, rate_rad_s: 0.2, current_a: f64::INFINITY, duration_s: 8.0 };
        let all = list_demands(&limits, 1e-3);
        assert_eq!(all.len(), SHAPES.len() * LEVELS.len());
        for demand in all {
            let peak = |series: &[f64]| series.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
            let (rate, angle) = (peak(&demand.rate_rad_s) / 0.2, peak(&demand.angle_rad) / 0.05);
            assert!((rate.max(angle) - demand.level).abs() < 1e-9, "{:?} {rate} {angle}", demand.shape);
        }
    }
}
