//! A loop's response far from all its roots, where a state-space evaluation loses what cancels: from zeros, poles and gain.

use crate::response::Point;
use crate::tolerance::{ASYMPTOTE_AT_END, ASYMPTOTE_LIMIT, ASYMPTOTE_MARGIN, SCAN_PER_DECADE};
use crate::zpk::Zpk;
use crate::{C64, Error, StateSpace, Timebase};

/// Zeros, poles and gain of a loop with one input and one output.
pub(crate) struct Asymptotes {
    roots: Zpk,
    low: f64,
    high: f64,
}

impl Asymptotes {
    /// Returns the asymptotes of a loop whose zeros are known, and its response from `low` to `high`, rad/s.
    ///
    /// # Errors
    /// Returns [`Error::Matrix`] if poles cannot be computed.
    pub(crate) fn of(g: &StateSpace, zeros: &[C64], low: f64, high: f64) -> Result<Self, Error> {
        Ok(Self { roots: Zpk::with_zeros(g, zeros.to_vec())?, low, high })
    }

    /// Returns whether the response at a frequency is computed here: below the grid, and above it in continuous time. Near
    /// half the sampling rate nothing cancels.
    pub(crate) fn is_beyond(&self, rate: f64) -> bool {
        rate < self.low || rate > self.high && self.roots.timebase == Timebase::Continuous
    }

    /// Returns the response at a frequency in rad/s.
    pub(crate) fn at(&self, rate: f64) -> C64 {
        match self.roots.timebase {
            Timebase::Continuous => self.roots.at(C64::new(0.0, rate)),
            Timebase::Discrete { period_s } => {
                // exp(j w T) - 1 without cancellation, and the roots as distances from one.
                let half = 0.5 * rate * period_s;
                let step = C64::new(0.0, 2.0 * half.sin()) * C64::from_polar(1.0, half);
                let from_one = |roots: &[C64]| roots.iter().map(|root| root - 1.0).collect();
                let (zeros, poles) = (from_one(&self.roots.zeros), from_one(&self.roots.poles));
                Zpk { zeros, poles, ..self.roots.clone() }.at(step)
            }
        }
    }

    /// Returns the rounding error of the response that is computed here, relative to it: four operations for each root.
    pub(crate) fn rounding(&self) -> f64 {
        2.0 * f64::EPSILON * (1 + self.roots.zeros.len() + self.roots.poles.len()) as f64
    }

    /// Returns frequencies beyond the first and the last point at which the gain may still cross one.
    pub(crate) fn frequencies_beyond(&self, first: Point, last: Point, timebase: Timebase) -> Vec<f64> {
        let mut rates = Vec::new();
        if let Some(crossing) =
            crossing(first, self.slope_at_zero()).filter(|&rate| rate < first.rate / ASYMPTOTE_AT_END)
        {
            rates.extend(grid_between(crossing / ASYMPTOTE_MARGIN, first.rate));
        }
        match timebase {
            Timebase::Continuous => {
                let slope = self.roots.zeros.len() as f64 - self.roots.poles.len() as f64;
                if let Some(crossing) =
                    crossing(last, slope).filter(|&rate| rate > ASYMPTOTE_AT_END * last.rate)
                {
                    rates.extend(grid_between(last.rate, crossing * ASYMPTOTE_MARGIN));
                }
            }
            Timebase::Discrete { period_s } => {
                rates.extend(grid_between(last.rate, std::f64::consts::PI / period_s));
            }
        }
        rates
    }

    /// Returns points so far below and above a grid that the response differs from its limits by rounding only, where it has finite
    /// limits other than zero. Sampled time has no upper one.
    pub(crate) fn limits(&self, first: Point, last: Point, timebase: Timebase) -> [Option<Point>; 2] {
        let at = |rate: f64| Point { rate, value: self.at(rate) };
        let low = (self.slope_at_zero() == 0.0).then(|| at(first.rate / ASYMPTOTE_LIMIT));
        let is_flat = self.roots.zeros.len() == self.roots.poles.len() && timebase == Timebase::Continuous;
        [low, is_flat.then(|| at(last.rate * ASYMPTOTE_LIMIT))]
    }

    /// Returns frequencies beyond the last point up to where the gain has fallen to a level; none if it does not fall, or is
    /// below it.
    pub(crate) fn frequencies_down_to(&self, level: f64, last: Point) -> Vec<f64> {
        let slope = self.roots.zeros.len() as f64 - self.roots.poles.len() as f64;
        let relative = Point { value: last.value / level, ..last };
        match crossing(relative, slope).filter(|&rate| slope < 0.0 && rate > last.rate) {
            Some(end) => grid_between(last.rate, end * ASYMPTOTE_MARGIN),
            None => Vec::new(),
        }
    }

    /// Returns the power of the frequency that the gain follows below the grid.
    pub(crate) fn slope_at_zero(&self) -> f64 {
        let count = |roots: &[C64]| roots.iter().filter(|root| self.is_at_origin(**root)).count() as f64;
        count(&self.roots.zeros) - count(&self.roots.poles)
    }

    fn is_at_origin(&self, root: C64) -> bool {
        match self.roots.timebase {
            Timebase::Continuous => root.norm() < self.low,
            Timebase::Discrete { period_s } => (root - 1.0).norm() < period_s * self.low,
        }
    }
}

/// Returns where a gain that follows a power of the frequency from a point on is one; `None` if it never is.
fn crossing(point: Point, slope: f64) -> Option<f64> {
    let gain = point.value.norm();
    if slope == 0.0 || gain == 0.0 {
        return None;
    }
    Some(point.rate * gain.powf(-1.0 / slope)).filter(|rate| rate.is_normal())
}

/// Returns a logarithmic grid between two frequencies, without its ends.
fn grid_between(low: f64, high: f64) -> Vec<f64> {
    let count = ((high / low).log10() * SCAN_PER_DECADE as f64).ceil().clamp(1.0, 20_000.0) as usize;
    (1..count).map(|k| low * (high / low).powf(k as f64 / count as f64)).collect()
}
