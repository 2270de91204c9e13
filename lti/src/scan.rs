//! A loop's response on a grid that is as fine as the loop asks for, with its extremes refined on it.

use std::ops::Range;

use crate::asymptotes::Asymptotes;
use crate::careful_response::{Accuracy, CarefulResponse};
use crate::response::{Point, Response};
use crate::roots::{poles, uncorrected_zeros, zeros};
use crate::scaling::balance;
use crate::tolerance::{
    ASYMPTOTE_DEPARTS, AT_ORIGIN, CANDIDATE_GAINS, CAREFUL_ROUNDING, CERTAIN_SIGN, DELAY_TURN,
    DELAYED_POINTS, EVERY_GAIN, NEAR_CRITICAL, NEAR_ORIGIN, NEAR_STEP, SCAN_BEYOND, SCAN_PER_DECADE,
    SCAN_PER_DELAY, SCAN_POINTS, SCAN_RESOLUTION, SCAN_ROUNDS, SCAN_STEP, SCAN_TO_NYQUIST, ZOOMS,
};
use crate::{C64, Error, StateSpace, Timebase};

/// The response of a loop with one input and one output, resolved.
pub(crate) struct Scan {
    response: Response,
    /// Zeros, poles and gain, and the frequencies beyond which the response is computed from them.
    asymptotes: Option<Asymptotes>,
    /// The response where rounding blurs the other one.
    careful: Option<CarefulResponse>,
    /// Seconds by which the response is delayed besides.
    delay_s: f64,
    /// Points far below and far above the grid, if the gain tends to a limit there that is on the other side of one from the gain at that end of
    /// the grid.
    pub limits: Limits,
    /// Gains at which neighbours are close where the phase is near -180 degrees.
    close_gains: Range<f64>,
    /// `true` if the gain grows beyond all bounds towards rest: the roots have more poles than zeros at the origin.
    grows_towards_rest: bool,
    pub points: Vec<Point>,
}

/// The response far beyond the ends of a grid, where it has reached its limit.
#[derive(Default)]
pub(crate) struct Limits {
    pub low: Option<Point>,
    pub high: Option<Point>,
}

impl Scan {
    /// Resolves the loop's response.
    pub fn of(g: &StateSpace) -> Result<Self, Error> {
        let zeros = zeros(g)?;
        let mut scan = Self::on_starting_grid(g, &zeros, EVERY_GAIN)?;
        scan.careful = CarefulResponse::of(g, &scan.response, &scan.points);
        if scan.careful.is_some() {
            let rates: Vec<f64> = scan.points.iter().map(|point| point.rate).collect();
            scan.points = scan.evaluate(&rates);
        }
        scan.complete_grid(g, &zeros)
    }

    /// Resolves the loop's response on a grid that starts from zeros without the correction in 32 digits, and is close along the negative axis
    /// only about a gain of one.
    pub fn of_candidate(g: &StateSpace) -> Result<Self, Error> {
        let zeros = uncorrected_zeros(g)?;
        Self::on_starting_grid(g, &zeros, CANDIDATE_GAINS)?.complete_grid(g, &zeros)
    }

    fn on_starting_grid(g: &StateSpace, zeros: &[C64], close_gains: Range<f64>) -> Result<Self, Error> {
        let response = Response::of(g)?;
        let mut scan = Self {
            response,
            asymptotes: None,
            careful: None,
            delay_s: 0.0,
            limits: Limits::default(),
            close_gains,
            grows_towards_rest: false,
            points: Vec::new(),
        };
        let rates = starting_grid(g, zeros)?;
        scan.points = scan.evaluate(&rates);
        Ok(scan)
    }

    /// Refines the grid and extends it beyond its ends.
    fn complete_grid(mut self, g: &StateSpace, zeros: &[C64]) -> Result<Self, Error> {
        self.refine();
        self.extend(g, zeros)?;
        Ok(self)
    }

    /// Returns the response of the same loop with a delay in seconds, up to the frequency from which on the gain is below `least_gain`; `None` if the delay
    /// turns it so often up to there that a grid of [`DELAYED_POINTS`] does not resolve it.
    pub fn with_delay(
        mut self,
        g: &StateSpace,
        delay_s: f64,
        least_gain: f64,
    ) -> Result<Option<Self>, Error> {
        self.extend_down(g, least_gain)?;
        let last = self.points.iter().rposition(|point| point.value.norm() >= least_gain);
        self.points.truncate(last.map_or(1, |at| at + 2));
        self.delay_s = delay_s;
        // Close enough that no turn of the delay hides between two points.
        let parts = |w: &[Point]| ((w[1].rate - w[0].rate) * delay_s / DELAY_TURN).ceil().max(1.0);
        if self.points.windows(2).map(parts).sum::<f64>() > DELAYED_POINTS as f64 {
            return Ok(None);
        }
        let mut rates: Vec<f64> = self.points.iter().take(1).map(|point| point.rate).collect();
        for w in self.points.windows(2) {
            let count = parts(w);
            rates
                .extend((1..=count as usize).map(|k| w[0].rate + (w[1].rate - w[0].rate) * k as f64 / count));
        }
        self.points = self.evaluate(&rates);
        self.refine();
        let is_resolved = !self.points.windows(2).any(|w| self.is_unresolved(w[0], w[1]));
        Ok(is_resolved.then_some(self))
    }

    /// Adds points beyond the last one until the gain is below `least_gain`.
    fn extend_down(&mut self, g: &StateSpace, least_gain: f64) -> Result<(), Error> {
        let (Some(first), Some(last)) = (self.points.first().copied(), self.points.last().copied()) else {
            return Ok(());
        };
        let asymptotes = match self.asymptotes.take() {
            Some(known) => known,
            None => Asymptotes::of(g, &zeros(g)?, first.rate, last.rate)?,
        };
        let rates = asymptotes.frequencies_down_to(least_gain, last);
        self.asymptotes = Some(asymptotes);
        let more = self.evaluate(&rates);
        self.points.extend(more);
        Ok(())
    }

    /// Adds points beyond both ends until the gain leaves one for good, and up to half the sampling rate.
    fn extend(&mut self, g: &StateSpace, zeros: &[C64]) -> Result<(), Error> {
        let (Some(first), Some(last)) = (self.points.first().copied(), self.points.last().copied()) else {
            return Ok(());
        };
        let asymptotes = Asymptotes::of(g, zeros, first.rate, last.rate)?;
        self.grows_towards_rest = asymptotes.slope_at_zero() < 0.0;
        let mut rates = asymptotes.frequencies_beyond(first, last, g.timebase);
        let goes_below = rates.first().is_some_and(|&rate| rate < first.rate);
        let blurred = CERTAIN_SIGN * self.response.rounding_at(first.rate);
        let departs =
            (asymptotes.at(first.rate) - first.value).norm() > ASYMPTOTE_DEPARTS * first.value.norm();
        if goes_below && (departs || first.value.norm() <= blurred) {
            // Rounding decides how many poles are at the origin, and with it the slope.
            rates.retain(|&rate| rate > first.rate);
        }
        let is_other_side = |end: Point, point: Point| {
            (end.value.norm() < 1.0) != (point.value.norm() < 1.0) && self.is_certain_limit(end)
        };
        let limits = asymptotes.limits(first, last, g.timebase);
        let low = limits[0].filter(|&limit| !departs && is_other_side(limit, first));
        let high = limits[1].filter(|&limit| is_other_side(limit, last));
        self.limits = Limits { low, high };
        if rates.is_empty() && self.limits.low.is_none() && self.limits.high.is_none() {
            return Ok(());
        }
        self.asymptotes = Some(asymptotes);
        let more = self.evaluate(&rates);
        self.points.extend(more);
        self.points.sort_by(|a, b| a.rate.total_cmp(&b.rate));
        self.refine();
        Ok(())
    }

    /// Returns whether the state space leaves no doubt on which side of one the gain is at a limit that was computed from the roots.
    fn is_certain_limit(&self, limit: Point) -> bool {
        let [value] = self.response.scalar_at_all(&[limit.rate])[..] else { return false };
        let excess = value.norm() - 1.0;
        (excess < 0.0) == (limit.value.norm() < 1.0)
            && excess.abs() > CERTAIN_SIGN * self.response.rounding_at(limit.rate)
    }

    /// Adds points until neighbours agree. A pair of neighbours is looked at once, when it becomes one.
    fn refine(&mut self) {
        let most = if self.delay_s > 0.0 { DELAYED_POINTS } else { SCAN_POINTS };
        let mut open: Vec<bool> = self.points.windows(2).map(|w| self.is_unresolved(w[0], w[1])).collect();
        for _ in 0..SCAN_ROUNDS {
            let pairs = self.points.windows(2).zip(&open);
            let finer: Vec<f64> = pairs.filter(|(_, open)| **open).map(|(w, _)| middle(w)).collect();
            if finer.is_empty() || self.points.len() > most {
                break;
            }
            let more = self.evaluate(&finer);
            open = self.insert(&more, &open);
        }
    }

    /// Returns whether something may hide between two neighbours.
    fn is_unresolved(&self, a: Point, b: Point) -> bool {
        if b.rate - a.rate <= SCAN_RESOLUTION * b.rate {
            return false;
        }
        // Away from the left half plane and from a gain of one neither logarithm nor angle can be small.
        let is_near = |value: C64, size: f64| {
            (size > 0.5 && size < 2.0 && size.ln().abs() < NEAR_CRITICAL)
                || (value.re < 0.0
                    && value.im.abs() < -value.re
                    && self.close_gains.contains(&size)
                    && (-value).arg().abs() < NEAR_CRITICAL)
        };
        let (size_a, size_b) = (a.value.norm(), b.value.norm());
        let step = if is_near(a.value, size_a) || is_near(b.value, size_b) { NEAR_STEP } else { SCAN_STEP };
        let to_critical = (a.value + 1.0).norm().min((b.value + 1.0).norm());
        let change = (b.value - a.value).norm();
        change > step * size_a.min(size_b) || change > SCAN_STEP * to_critical
    }

    /// Inserts points, in rising order, into the open gaps between neighbours; returns which gaps are open then.
    fn insert(&mut self, more: &[Point], open: &[bool]) -> Vec<bool> {
        let old = std::mem::take(&mut self.points);
        let mut more = more.iter().peekable();
        let mut still_open = Vec::with_capacity(old.len() + more.len());
        for (k, &point) in old.iter().enumerate() {
            self.points.push(point);
            let Some(&next) = old.get(k + 1) else { break };
            match more.next_if(|inner| open[k] && inner.rate < next.rate) {
                Some(&inner) => {
                    self.points.push(inner);
                    still_open.extend([self.is_unresolved(point, inner), self.is_unresolved(inner, next)]);
                }
                None => still_open.push(open[k]),
            }
        }
        still_open
    }

    /// Returns the response at the given frequencies, without those that are poles. Where rounding blurs it and the gain is large it is interpolated.
    pub fn evaluate(&self, rates: &[f64]) -> Vec<Point> {
        self.evaluate_to(Accuracy::Interpolated, rates)
    }

    /// Returns the response at the given frequencies, nowhere interpolated, without those that are poles.
    pub fn evaluate_exactly(&self, rates: &[f64]) -> Vec<Point> {
        self.evaluate_to(Accuracy::Exact, rates)
    }

    /// Returns whether [`Scan::evaluate`] interpolates at a frequency.
    pub fn interpolates(&self, rate: f64) -> bool {
        self.careful.as_ref().is_some_and(|careful| careful.interpolates(rate))
    }

    fn evaluate_to(&self, accuracy: Accuracy, rates: &[f64]) -> Vec<Point> {
        let values = self.response.scalar_at_all(rates);
        let careful = |rate: f64| self.careful.as_ref().and_then(|careful| careful.at(rate, accuracy));
        let exact = |rate: f64, value: C64| match &self.asymptotes {
            Some(asymptotes) if asymptotes.is_beyond(rate) => asymptotes.at(rate),
            _ => careful(rate).unwrap_or(value),
        };
        let turned = |rate: f64, value: C64| match self.delay_s {
            0.0 => value,
            delay_s => value * C64::from_polar(1.0, -rate * delay_s),
        };
        let points = rates
            .iter()
            .zip(values)
            .map(|(&rate, value)| Point { rate, value: turned(rate, exact(rate, value)) });
        points.filter(|point| point.value.re.is_finite() && point.value.im.is_finite()).collect()
    }

    /// Returns whether the gain is infinite at rest: it grows towards it, and no point of the scan has a finite response there.
    pub fn is_infinite_at_rest(&self) -> bool {
        self.grows_towards_rest && self.points.first().is_none_or(|first| first.rate > 0.0)
    }

    /// Returns how much rounding may change the response at a frequency.
    pub fn rounding_at(&self, point: Point) -> f64 {
        match &self.asymptotes {
            // the state space gives the response at rest
            Some(asymptotes) if point.rate > 0.0 && asymptotes.is_beyond(point.rate) => {
                asymptotes.rounding() * point.value.norm()
            }
            _ if self.careful.as_ref().is_some_and(|careful| careful.covers(point.rate)) => {
                CAREFUL_ROUNDING * point.value.norm()
            }
            _ => self.response.rounding_at(point.rate),
        }
    }

    /// Returns the largest value of a function of the response.
    pub fn maximum(&self, of: impl Fn(C64) -> f64) -> Option<Point> {
        let values: Vec<f64> = self.points.iter().map(|point| of(point.value)).collect();
        let top = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut best: Option<Point> = None;
        for (k, &value) in values.iter().enumerate().filter(|(_, value)| **value >= top * (1.0 - SCAN_STEP)) {
            let (left, right) = (k.saturating_sub(1), (k + 1).min(values.len() - 1));
            if value >= values[left] && value >= values[right] {
                let peak = self.zoom(self.points[left].rate, self.points[right].rate, self.points[k], &of);
                if best.is_none_or(|b| of(peak.value) > of(b.value)) {
                    best = Some(peak);
                }
            }
        }
        best
    }

    fn zoom(&self, mut low: f64, mut high: f64, mut best: Point, of: &impl Fn(C64) -> f64) -> Point {
        for _ in 0..ZOOMS {
            let rates = divide_interval(low, high);
            if high - low <= SCAN_RESOLUTION * high {
                break;
            }
            for point in self.evaluate(&rates) {
                best = if of(point.value) >= of(best.value) { point } else { best };
            }
            let below = rates.iter().copied().filter(|&rate| rate < best.rate);
            let above = rates.iter().copied().filter(|&rate| rate > best.rate);
            (low, high) = (below.fold(low, f64::max), above.fold(high, f64::min));
        }
        best
    }
}

/// Seven frequencies inside an interval.
pub(crate) fn divide_interval(low: f64, high: f64) -> Vec<f64> {
    (1..8).map(|k| low + (high - low) * f64::from(k) / 8.0).collect()
}

fn middle(w: &[Point]) -> f64 {
    if w[1].rate > 2.0 * w[0].rate { (w[0].rate * w[1].rate).sqrt() } else { 0.5 * (w[0].rate + w[1].rate) }
}

/// Returns a logarithmic grid over all roots, and close points about each lightly damped one.
fn starting_grid(g: &StateSpace, zeros: &[C64]) -> Result<Vec<f64>, Error> {
    let mut roots: Vec<C64> = poles(g)?;
    roots.extend(zeros);
    let mut highest = f64::INFINITY;
    let mut delays = 0;
    if let Timebase::Discrete { period_s } = g.timebase {
        // Infinite zeros and roots near the origin turn the response as delays do.
        let near_origin = roots.iter().filter(|root| root.norm() < NEAR_ORIGIN).count();
        delays = near_origin.max(g.order().saturating_sub(zeros.len()));
        roots.iter_mut().for_each(|root| *root = root.ln() / period_s);
        highest = std::f64::consts::PI / period_s;
    }
    let sizes = roots.iter().map(|root| root.norm()).filter(|size| size.is_normal());
    let high = sizes.clone().fold(0.0_f64, f64::max);
    // so small a root is one at the origin, moved by rounding
    let low = sizes.filter(|size| *size > AT_ORIGIN * high).fold(f64::INFINITY, f64::min);
    let (low, high) = if high > 0.0 { (low, high) } else { (1.0_f64.min(highest), 1.0) };
    // Where rounding leaves only the traces of roots at the origin, the couplings of the states tell the scale.
    let coupling = if highest.is_finite() { 0.0 } else { balance(g).0.A.norm_max() };
    let (low, high) = (low.min(highest) / SCAN_BEYOND, (high * SCAN_BEYOND).max(coupling).min(highest));
    let count = ((high / low).log10() * SCAN_PER_DECADE as f64).ceil() as usize + 1;
    let mut rates: Vec<f64> = (0..=count).map(|k| low * (high / low).powf(k as f64 / count as f64)).collect();
    for root in roots.iter().filter(|root| root.im > 0.0) {
        rates.extend(points_about(*root));
    }
    if highest.is_finite() {
        rates.extend((1..=SCAN_TO_NYQUIST).map(|k| highest * (1.0 - 0.5_f64.powi(k))));
        let count = SCAN_PER_DELAY * delays;
        rates.extend((1..count).map(|k| highest * k as f64 / count as f64));
    }
    rates.retain(|&rate| rate > 0.0 && rate < highest && rate.is_finite());
    rates.sort_by(f64::total_cmp);
    rates.dedup_by(|b, a| *b - *a <= SCAN_RESOLUTION * *b);
    Ok(rates)
}

/// Returns points about a resonance, as close as its half width.
fn points_about(root: C64) -> Vec<f64> {
    let width = root.re.abs().max(SCAN_RESOLUTION * root.im);
    let mut rates = vec![root.im, root.norm()];
    let mut offset = 0.25 * width;
    while offset < root.im {
        rates.extend([root.im - offset, root.im + offset]);
        offset *= 2.0;
    }
    rates
}
