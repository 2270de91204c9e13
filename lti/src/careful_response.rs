//! The response of a small loop where rounding blurs it: with residuals in twice the working precision.

use crate::response::{Point, Response, point_of_rate};
use crate::scaling::balance;
use crate::tolerance::{BLURRED, BLURRED_STRIDE, CERTAIN_SIGN, LEAST_GAIN, PRECISE_SIZE};
use crate::{C64, StateSpace};
use counterpoise_linalg::{self as linalg, StateRealisation};

/// A loop with one input and one output, and the frequencies between which its response is computed with care.
pub(crate) struct CarefulResponse {
    system: StateSpace,
    /// Ascending, apart from each other, rad/s.
    intervals: Vec<[f64; 2]>,
    /// Points a tenth of a decade apart in those intervals: between two at which the gain is large no margin lies.
    known: Vec<Point>,
}

/// How a response between points with large gains is found.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Accuracy {
    /// From those points: enough to see on which side of the critical point it passes.
    Interpolated,
    /// By a computation of its own: for a crossing that is returned.
    Exact,
}

impl CarefulResponse {
    /// Returns the response of a loop about those points of a grid at which rounding decides where the gain is one or the phase is -180 degrees; `None` if
    /// there are none, or if the loop has more than [`PRECISE_SIZE`] states.
    ///
    /// One point of a few is examined, because an estimate of the rounding takes longer than the response.
    pub(crate) fn of(g: &StateSpace, response: &Response, points: &[Point]) -> Option<Self> {
        if g.order() > PRECISE_SIZE {
            return None;
        }
        let mut intervals: Vec<[f64; 2]> = Vec::new();
        for at in (0..points.len()).step_by(BLURRED_STRIDE) {
            if !is_blurred(response, points[at]) {
                continue;
            }
            let low = points[at.saturating_sub(BLURRED_STRIDE)].rate;
            let high = points[(at + BLURRED_STRIDE).min(points.len() - 1)].rate;
            match intervals.last_mut().filter(|last| last[1] >= low) {
                Some(last) => last[1] = high,
                None => intervals.push([low, high]),
            }
        }
        if intervals.is_empty() {
            return None;
        }
        let mut careful = Self { system: balance(g).0, intervals, known: Vec::new() };
        let rates = points.iter().step_by(BLURRED_STRIDE).map(|point| point.rate);
        let known = |rate: f64| careful.computed_at(rate).map(|value| Point { rate, value });
        careful.known = rates.filter(|rate| careful.covers(*rate)).filter_map(known).collect();
        Some(careful)
    }

    /// Returns whether the response at a frequency is computed here.
    pub(crate) fn covers(&self, rate: f64) -> bool {
        self.interval_around(rate).is_some()
    }

    fn interval_around(&self, rate: f64) -> Option<&[f64; 2]> {
        let next = self.intervals.partition_point(|interval| interval[1] < rate);
        self.intervals.get(next).filter(|interval| interval[0] <= rate)
    }

    /// Returns the response at a frequency, rad/s; `None` if it is not computed here, or at a pole. Between two points with gains above 60 dB it is
    /// interpolated, straight in logarithms, unless `accuracy` excludes that.
    pub(crate) fn at(&self, rate: f64, accuracy: Accuracy) -> Option<C64> {
        let interval = self.interval_around(rate)?;
        if let Some(known) = self.known.get(self.next_known(rate)).filter(|point| point.rate == rate) {
            return Some(known.value);
        }
        match self.large_neighbours(rate, interval) {
            Some([a, b]) if accuracy == Accuracy::Interpolated => {
                let share = (rate / a.rate).ln() / (b.rate / a.rate).ln();
                Some(a.value * (b.value / a.value).powf(share))
            }
            _ => self.computed_at(rate),
        }
    }

    /// Returns whether the response at a frequency may be interpolated.
    pub(crate) fn interpolates(&self, rate: f64) -> bool {
        self.interval_around(rate).is_some_and(|interval| self.large_neighbours(rate, interval).is_some())
    }

    fn next_known(&self, rate: f64) -> usize {
        self.known.partition_point(|point| point.rate < rate)
    }

    /// Returns the known points about a frequency of an interval if both have gains above 60 dB.
    fn large_neighbours(&self, rate: f64, &[low, high]: &[f64; 2]) -> Option<[&Point; 2]> {
        let next = self.next_known(rate);
        let above = self.known.get(next).filter(|point| point.rate <= high)?;
        let below = next.checked_sub(1).map(|last| &self.known[last]).filter(|point| point.rate >= low)?;
        let is_large = |point: &Point| point.value.norm() > 1.0 / LEAST_GAIN;
        (is_large(below) && is_large(above)).then_some([below, above])
    }

    fn computed_at(&self, rate: f64) -> Option<C64> {
        let StateSpace { A, B, C, D, timebase } = &self.system;
        let H =
            linalg::refined_transfer(StateRealisation { A, B, C, D }, point_of_rate(rate, *timebase)).ok()?;
        Some(H[(0, 0)])
    }
}

/// Returns whether rounding changes more than the last digits of a response that may matter to a margin: one whose gain may be within 60 dB of one.
fn is_blurred(response: &Response, point: Point) -> bool {
    let (gain, noise) = (point.value.norm(), response.rounding_at(point.rate));
    let may_matter =
        gain + CERTAIN_SIGN * noise > LEAST_GAIN && gain - CERTAIN_SIGN * noise < 1.0 / LEAST_GAIN;
    noise > BLURRED * gain && may_matter
}
