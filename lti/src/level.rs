//! The frequencies at which a singular value of a response takes a given level, and the search for peaks between them.

use crate::error::OperationContext;
use crate::peak::{Peak, largest_gains};
use crate::response::Response;
use crate::tolerance::{
    CLIMB_ROUNDS, DOUBTFUL_NORM, DOUBTFUL_SHARE, ENCLOSED_WIDTH, HIGHEST_RISE, LEVEL_SAME_RATE, LOW_SUMMIT,
    NEAR_AXIS, NEAR_AXIS_NORM, PRECISE_SIZE, SAME_POINT, SUMMITS,
};
use crate::{C64, Error, Mat, StateSpace};
use counterpoise_linalg::{self as linalg, Boundary};

/// The Hamiltonian matrix of a level and its eigenvalues.
pub(crate) struct Level {
    matrix: Mat,
    eigenvalues: Vec<C64>,
}

impl Level {
    /// Returns the eigenvalues that belong to a level of a continuous system.
    ///
    /// # Errors
    /// Returns [`Error::Matrix`] if the level is a singular value of the direct path or the eigenvalue iteration fails.
    pub(crate) fn of(g: &StateSpace, level: f64) -> Result<Self, Error> {
        let matrix = hamiltonian(g, level)?;
        let eigenvalues = linalg::eigenvalues(&matrix).with_operation("L-infinity norm")?;
        Ok(Self { matrix, eigenvalues })
    }

    /// Returns frequencies at which a singular value may equal the level, ascending.
    pub(crate) fn frequencies(&self) -> Vec<f64> {
        let near = NEAR_AXIS_NORM * self.matrix.norm_fro();
        let on_axis = |s: &&C64| s.im >= 0.0 && s.re.abs() <= NEAR_AXIS * s.norm() + near;
        let mut rates: Vec<f64> = self.eigenvalues.iter().filter(on_axis).map(|s| s.im).collect();
        rates.sort_by(f64::total_cmp);
        rates
    }

    /// Returns whether no eigenvalue lies on the imaginary axis, whatever rounding the entries of the matrix
    /// did.
    pub(crate) fn is_clear(&self) -> bool {
        linalg::is_clear_of_boundary(&self.matrix, Boundary::ImaginaryAxis).unwrap_or(false)
    }

    /// Returns all eigenvalues, as doubles give them.
    pub(crate) fn eigenvalues(&self) -> &[C64] {
        &self.eigenvalues
    }

    /// Zero and the frequencies of all eigenvalues that rounding may have moved off the axis, ascending; of a small system those of all
    /// eigenvalues, because two crossings of a flat response move far.
    fn doubtful_frequencies(&self) -> Vec<f64> {
        let near = DOUBTFUL_NORM * self.matrix.norm_fro();
        let is_small = self.matrix.nrows() <= 2 * PRECISE_SIZE;
        let is_near = |s: &C64| s.re <= DOUBTFUL_SHARE * s.norm() + near;
        let is_doubtful = |s: &&C64| s.im >= 0.0 && s.re >= 0.0 && (is_small || is_near(s));
        let doubtful = self.eigenvalues.iter().filter(is_doubtful);
        let mut rates: Vec<f64> = doubtful.flat_map(|s| [s.im.abs(), s.norm()]).collect();
        rates.retain(|rate| rate.is_finite());
        rates.push(0.0);
        rates.sort_by(f64::total_cmp);
        rates.dedup_by(|b, a| *b - *a <= LEVEL_SAME_RATE * *b);
        rates
    }
}

/// Zero, the frequencies and the middles between them.
pub(crate) fn with_middles(rates: &[f64]) -> Vec<f64> {
    let mut all = vec![0.0];
    for &rate in rates {
        let last = all.last().copied().unwrap_or(0.0);
        all.extend([0.5 * (last + rate), rate]);
    }
    all
}

/// Raises the peak to the top of the hill around it, between the neighbours of its frequency in an ascending list.
pub(crate) fn climb_between(best: &mut Peak, response: &Response, rates: &[f64]) -> Result<(), Error> {
    let below = rates.iter().copied().filter(|&rate| rate < best.rate_rad_s).fold(0.0, f64::max);
    let above = rates.iter().copied().filter(|&rate| rate > best.rate_rad_s).fold(f64::INFINITY, f64::min);
    let high = if above.is_finite() { above } else { 2.0 * best.rate_rad_s };
    if best.rate_rad_s.is_finite() && high > below {
        *best = climb(response, below, high, *best, best.value)?;
    }
    Ok(())
}

/// Looks for a higher peak at the frequency of every doubtful eigenvalue, between them, and uphill from the best of them; returns
/// whether the peak rose by more than the tolerance.
///
/// Rounding moves eigenvalues off the axis by more than any tolerance if the system is a difference of two that nearly
/// cancel; their frequencies still tell where the response comes near the level.
pub(crate) fn search_everywhere(
    best: &mut Peak,
    response: &Response,
    level: &Level,
    tolerance: f64,
) -> Result<bool, Error> {
    let mut rates = with_middles(&level.doubtful_frequencies());
    rates.sort_by(f64::total_cmp);
    let values = largest_gains(response, &rates)?;
    let mut found = *best;
    for k in summits(&values, LOW_SUMMIT * best.value) {
        let (low, high) = (rates[k.saturating_sub(1)], rates[(k + 1).min(rates.len() - 1)]);
        // The best peak is the top of its hill already.
        if best.value >= values[k] && (low..=high).contains(&best.rate_rad_s) {
            continue;
        }
        let start = Peak { value: values[k], rate_rad_s: rates[k] };
        let top = climb(response, low, high, start, found.value)?;
        found = if top.value > found.value { top } else { found };
    }
    let risen = found.value > best.value * (1.0 + tolerance);
    if risen {
        *best = found;
    }
    Ok(risen)
}

/// Returns where a list of values has its highest local maxima above a limit.
fn summits(values: &[f64], limit: f64) -> Vec<usize> {
    let last = values.len().saturating_sub(1);
    let is_summit = |&k: &usize| {
        values[k] >= limit
            && values[k] >= values[k.saturating_sub(1)]
            && values[k] >= values[(k + 1).min(last)]
    };
    let mut places: Vec<usize> = (0..values.len()).filter(is_summit).collect();
    places.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
    places.truncate(SUMMITS);
    places
}

/// Returns the top of the hill between two frequencies, from a point on it, or a point of a hill that stays below `wanted`.
fn climb(response: &Response, low: f64, high: f64, top: Peak, wanted: f64) -> Result<Peak, Error> {
    let end =
        |rate_rad_s| if rate_rad_s == top.rate_rad_s { top } else { Peak { value: f64::NAN, rate_rad_s } };
    let mut hill = Hill { low: end(low), top, high: end(high) };
    let mut is_guided = false;
    for _ in 0..CLIMB_ROUNDS {
        let width = hill.width();
        let guided = if is_guided { hill.around_vertex() } else { None };
        let rates = guided.or_else(|| hill.above_rest()).unwrap_or_else(|| hill.uniform_frequencies());
        let values = largest_gains(response, &rates)?.into_iter().zip(rates);
        let mut points: Vec<Peak> = values.map(|(value, rate_rad_s)| Peak { value, rate_rad_s }).collect();
        // The highest comes first: the others are then its neighbours.
        points.sort_by(|a, b| b.value.total_cmp(&a.value));
        points.into_iter().for_each(|point| hill.insert(point));
        if hill.is_flat() || hill.stays_below(wanted) {
            break;
        }
        // A round about a vertex that does not enclose the peak closely is followed by an even one.
        is_guided = hill.width() <= ENCLOSED_WIDTH * width;
    }
    Ok(hill.top)
}

/// A point between two others that are not higher; the value of an end may be unknown (NaN).
struct Hill {
    low: Peak,
    top: Peak,
    high: Peak,
}

impl Hill {
    fn width(&self) -> f64 {
        self.high.rate_rad_s - self.low.rate_rad_s
    }

    /// Seven frequencies at even distances.
    fn uniform_frequencies(&self) -> Vec<f64> {
        (1..8).map(|k| self.low.rate_rad_s + self.width() * f64::from(k) / 8.0).collect()
    }

    /// Seven frequencies that crowd at zero if the top is there, since the gain is an even function of frequency and nearly always has its summit
    /// there, too; `None` if the top is elsewhere.
    fn above_rest(&self) -> Option<Vec<f64>> {
        let powers = [-27, -20, -14, -9, -5, -2, -1];
        (self.top.rate_rad_s == 0.0)
            .then(|| powers.map(|k: i32| self.high.rate_rad_s * f64::from(k).exp2()).to_vec())
    }

    /// Seven frequencies that crowd about the vertex of the parabola through the three points; `None` if it has none between the ends.
    ///
    /// The parabola is that of the inverse square of the gain, which has this form at a resonance.
    fn around_vertex(&self) -> Option<Vec<f64>> {
        let of = |peak: Peak| (peak.value * peak.value).recip();
        let (a, b, c) = (self.low.rate_rad_s, self.top.rate_rad_s, self.high.rate_rad_s);
        let (left, right) =
            ((b - a) * (of(self.high) - of(self.top)), (c - b) * (of(self.low) - of(self.top)));
        let vertex = b - 0.5 * ((b - a) * left - (c - b) * right) / (left + right);
        let room = (vertex - a).min(c - vertex);
        let offsets = [-0.25, -2f64.powi(-6), -2f64.powi(-12), 0.0, 2f64.powi(-12), 2f64.powi(-6), 0.25];
        (room > 0.0).then(|| offsets.map(|share| vertex + share * room).to_vec())
    }

    /// Narrows the hill by a point, unless it is so close to the top that rounding decides which of the two is higher.
    fn insert(&mut self, point: Peak) {
        let rate = point.rate_rad_s;
        let is_top = (rate - self.top.rate_rad_s).abs() <= SAME_POINT * self.width();
        if rate <= self.low.rate_rad_s || rate >= self.high.rate_rad_s || is_top {
            return;
        }
        let is_right = rate > self.top.rate_rad_s;
        match (point.value > self.top.value, is_right) {
            (true, true) => (self.low, self.top) = (self.top, point),
            (true, false) => (self.high, self.top) = (self.top, point),
            (false, true) => self.high = point,
            (false, false) => self.low = point,
        }
    }

    /// Returns whether the hill is far from reaching a value ([`HIGHEST_RISE`]).
    fn stays_below(&self, wanted: f64) -> bool {
        let rise = self.top.value - self.low.value.min(self.high.value);
        let is_known = !self.low.value.is_nan() && !self.high.value.is_nan();
        is_known && self.top.value + HIGHEST_RISE * rise < wanted
    }

    /// Returns whether the values differ by rounding only.
    fn is_flat(&self) -> bool {
        self.low.value.min(self.high.value) >= self.top.value * (1.0 - 4.0 * f64::EPSILON)
            && !self.low.value.is_nan()
            && !self.high.value.is_nan()
    }
}

/// [F, B inv(R) B'; -C' inv(S) C, -F'] with R = 1 - D'D, S = 1 - DD', F = A + B inv(R) D' C, for the system divided by
/// the level.
fn hamiltonian(g: &StateSpace, level: f64) -> Result<Mat, Error> {
    let root = level.sqrt();
    let (B, C, D) = (g.B.scale(1.0 / root), g.C.scale(1.0 / root), g.D.scale(1.0 / level));
    let R = &Mat::eye(D.ncols()) - &(&D.t() * &D);
    let S = &Mat::eye(D.nrows()) - &(&D * &D.t());
    let RB = linalg::solve(&R, &B.t()).with_operation("L-infinity norm")?;
    let SC = linalg::solve(&S, &C).with_operation("L-infinity norm")?;
    let F = &g.A + &(&RB.t() * &(&D.t() * &C));
    Ok(Mat::from_blocks(&[&[&F, &(&B * &RB)], &[&-(&C.t() * &SC), &-F.t()]]))
}
