//! The frequencies at which a resolved response crosses the real axis or a gain of one, and its limit at rest.

use crate::C64;
use crate::response::Point;
use crate::scan::{Scan, divide_interval};
use crate::tolerance::{
    CERTAIN_GAIN, CERTAIN_SIGN, CROSSING_WIDENINGS, KNOWN_AT_REST, LEVEL_AT_REST, REAL_AT_REST, SIGN_SAMPLES,
    ZOOMS,
};

impl Scan {
    /// Returns where a real function of the response changes sign.
    pub fn crossings(&self, of: impl Fn(C64) -> f64) -> Vec<Point> {
        let mut found = Vec::new();
        for w in self.points.windows(2) {
            if (of(w[0].value) < 0.0) != (of(w[1].value) < 0.0) {
                found.push(self.bisect(w[0], w[1], &of));
            }
        }
        found
    }

    /// Returns where the response crosses the real axis: where its imaginary part changes sign from one run of points to the next, each with a
    /// point at which rounding does not decide the sign. A response that is real, or zero, to rounding crosses nothing.
    pub fn axis_crossings(&self) -> Vec<Point> {
        let is_below = |point: &Point| point.value.im < 0.0;
        let mut runs = Vec::new();
        let mut start = 0;
        for run in self.points.chunk_by(|a, b| is_below(a) == is_below(b)) {
            runs.push((start, run));
            start += run.len();
        }
        if runs.len() < 2 {
            return Vec::new();
        }
        let is_certain = |point: Point| {
            let im = point.value.im.abs();
            // no rounding is smaller than that of the value, which costs nothing to know
            im > CERTAIN_SIGN * 0.5 * f64::EPSILON * point.value.norm()
                && im > CERTAIN_SIGN * self.rounding_at(point)
        };
        runs.retain(|(_, run)| candidates(run).into_iter().any(is_certain));
        let mut found = Vec::new();
        for pair in runs.windows(2) {
            let ((start, left), (next, right)) = (pair[0], pair[1]);
            if is_below(&left[0]) != is_below(&right[0]) {
                let [a, b] =
                    self.bracket(self.points[start + left.len() - 1], self.points[next], &|L: C64| L.im);
                let nearest = if a.value.im.abs() < b.value.im.abs() { a } else { b };
                // Through a pole or a zero on the axis the response jumps to the other side.
                let is_continuous = (a.value - b.value).norm() <= a.value.norm();
                let is_known = nearest.value.norm() > CERTAIN_GAIN * self.rounding_at(nearest);
                found.extend((is_continuous && is_known).then_some(nearest));
            }
        }
        found
    }

    /// Returns the limit of the response at rest, where poles and zeros at zero frequency cancel so that it cannot be evaluated there; `None`
    /// if the response has no finite limit other than zero. The real part is L(0) + O(w^2), extrapolated from the lowest frequency that rounding
    /// leaves known and twice it.
    pub fn limit_at_rest(&self) -> Option<Point> {
        let is_rough = |point: &Point| self.rounding_at(*point) > KNOWN_AT_REST * point.value.re.abs();
        let first = self.points.get(self.points.partition_point(is_rough))?.rate;
        let [a, b] = self.evaluate(&[first, 2.0 * first])[..] else { return None };
        let is_level = (b.value.re - a.value.re).abs() <= LEVEL_AT_REST * a.value.re.abs();
        let is_real = a.value.im.abs() <= REAL_AT_REST * a.value.re.abs();
        let limit = (4.0 * a.value.re - b.value.re) / 3.0;
        (is_level && is_real).then_some(Point { rate: 0.0, value: C64::new(limit, 0.0) })
    }

    /// Returns whether the gain is one at all points, as far as rounding lets it be known.
    pub fn is_all_pass(&self) -> bool {
        let is_one = |point: &Point| {
            (point.value.norm() - 1.0).abs() <= CERTAIN_SIGN * (f64::EPSILON + self.rounding_at(*point))
        };
        !self.points.is_empty() && self.points.iter().all(is_one)
    }

    /// Returns where the gain crosses one, on the grid and between it and the limits beyond its ends.
    pub fn unit_crossings(&self) -> Vec<Point> {
        let excess = |L: C64| L.norm() - 1.0;
        let mut found = Vec::new();
        if let (Some(limit), Some(&first)) = (self.limits.low, self.points.first()) {
            found.push(self.bisect(limit, first, &excess));
        }
        found.extend(self.crossings(excess));
        if let (Some(limit), Some(&last)) = (self.limits.high, self.points.last()) {
            found.push(self.bisect(last, limit, &excess));
        }
        found
    }

    /// Returns the point between a and b where the sign changes.
    fn bisect(&self, a: Point, b: Point, of: &impl Fn(C64) -> f64) -> Point {
        let [a, b] = self.bracket(a, b, of);
        if of(a.value).abs() < of(b.value).abs() { a } else { b }
    }

    /// Returns the neighbours between which the sign changes, between a and b: seven points inside the interval at a time.
    fn bracket(&self, a: Point, b: Point, of: &impl Fn(C64) -> f64) -> [Point; 2] {
        let [mut a, mut b] = self.exact_ends(a, b, of);
        let below = of(a.value) < 0.0;
        for _ in 0..ZOOMS {
            if b.rate - a.rate <= f64::EPSILON * b.rate {
                break;
            }
            let inside = self.evaluate_exactly(&divide_interval(a.rate, b.rate));
            let change = inside.iter().position(|point| (of(point.value) < 0.0) != below);
            let last = change.map_or(inside.last(), |at| if at == 0 { None } else { inside.get(at - 1) });
            b = change.and_then(|at| inside.get(at)).copied().unwrap_or(b);
            a = last.copied().unwrap_or(a);
        }
        [a, b]
    }

    /// Returns two points between which the sign changes of a response that is not interpolated, about an interval in which it changes of one that may be:
    /// each widening doubles the interval. The ends themselves if the sign changes nowhere near.
    fn exact_ends(&self, a: Point, b: Point, of: &impl Fn(C64) -> f64) -> [Point; 2] {
        if !self.interpolates(a.rate) && !self.interpolates(b.rate) {
            return [a, b];
        }
        let (mut low, mut high) = (a.rate, b.rate);
        for _ in 0..CROSSING_WIDENINGS {
            if let [a, b] = self.evaluate_exactly(&[low, high])[..]
                && (of(a.value) < 0.0) != (of(b.value) < 0.0)
            {
                return [a, b];
            }
            let ratio = (high / low).sqrt();
            (low, high) = (low / ratio, high * ratio);
        }
        [a, b]
    }
}

/// Returns points of a run at which the sign of the imaginary part may be the most certain: where it is largest beside the value, and alone,
/// and at evenly spread logarithms of the frequency, because points crowd where rounding makes the response rough.
fn candidates(run: &[Point]) -> Vec<Point> {
    let share = |point: &Point| point.value.im.abs() / point.value.norm().max(f64::MIN_POSITIVE);
    let largest = run.iter().max_by(|a, b| a.value.im.abs().total_cmp(&b.value.im.abs()));
    let steepest = run.iter().max_by(|a, b| share(a).total_cmp(&share(b)));
    let (low, high) = (run.first().map_or(0.0, |p| p.rate), run.last().map_or(0.0, |p| p.rate));
    let spread = (0..=SIGN_SAMPLES).filter_map(|k| {
        let rate = low * (high / low).powf(k as f64 / SIGN_SAMPLES as f64);
        run.get(run.partition_point(|point| point.rate < rate))
    });
    let mut found: Vec<Point> = steepest.into_iter().chain(largest).chain(spread).copied().collect();
    found.dedup_by(|b, a| b.rate == a.rate);
    found
}
