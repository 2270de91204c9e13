//! Quartics over a sample through five places: the nodes of a step that takes the whole sample, and its middle.

use crate::engine::attempt::Attempt;
use crate::engine::events::Part;
use crate::engine::moments::NODES;
use crate::engine::tables::StepTable;

/// Number of places.
pub(super) const PLACES: usize = 5;

/// The places, as fractions of the sample.
pub(super) const AT: [f64; PLACES] = [NODES[0], NODES[1], 0.5, NODES[2], NODES[3]];

/// The cardinal polynomials of the places. What they give is a sum over the values, so each matrix is stored value by value.
#[derive(Debug, Clone)]
pub(super) struct Quartics {
    /// Coefficients, lowest power first.
    coefficients: [[f64; PLACES]; PLACES],
    /// Derivatives at the places, per sample.
    slopes: [[f64; PLACES]; PLACES],
    /// Values at the places of the next sample, by those at the last three of this one.
    ahead: [[f64; PLACES]; 3],
}

impl Quartics {
    pub fn new() -> Self {
        let coefficients: [[f64; PLACES]; PLACES] = std::array::from_fn(cardinal);
        let slopes =
            coefficients.map(|c| AT.map(|s| c[1] + s * (2.0 * c[2] + s * (3.0 * c[3] + s * 4.0 * c[4]))));
        let last = [AT[2], AT[3], AT[4]];
        let ahead = std::array::from_fn(|k| {
            AT.map(|s| {
                let others = (0..3).filter(|&j| j != k);
                others.map(|j| (1.0 + s - last[j]) / (last[k] - last[j])).product()
            })
        });
        Self { coefficients, slopes, ahead }
    }

    /// Returns the quartic through values at the places, in powers of the fraction of the sample.
    #[inline]
    pub fn interpolate(&self, values: &[f64; PLACES]) -> [f64; PLACES] {
        combine_rows(&self.coefficients, values)
    }

    /// Returns the derivative at the places, per sample.
    #[inline]
    pub fn slopes(&self, values: &[f64; PLACES]) -> [f64; PLACES] {
        combine_rows(&self.slopes, values)
    }

    /// Returns the mean over the sample.
    #[inline]
    pub fn mean(&self, values: &[f64; PLACES]) -> f64 {
        let c = self.interpolate(values);
        c[0] + c[1] / 2.0 + c[2] / 3.0 + c[3] / 4.0 + c[4] / 5.0
    }

    /// Returns the values at the places of the next sample, by the parabola through the last three.
    #[inline]
    pub fn extrapolate(&self, values: &[f64; PLACES]) -> [f64; PLACES] {
        combine_rows(&self.ahead, &[values[2], values[3], values[4]])
    }
}

/// Returns the sum of rows, each times its factor.
#[inline]
fn combine_rows<const COUNT: usize>(rows: &[[f64; PLACES]; COUNT], factors: &[f64; COUNT]) -> [f64; PLACES] {
    let mut sum = [0.0; PLACES];
    for (row, factor) in rows.iter().zip(factors) {
        for (sum, entry) in sum.iter_mut().zip(row) {
            *sum += factor * entry;
        }
    }
    sum
}

/// Returns the coefficients of the polynomial that is 1 at a place and 0 at the others.
fn cardinal(place: usize) -> [f64; PLACES] {
    let mut polynomial = [1.0, 0.0, 0.0, 0.0, 0.0];
    for (degree, root) in (0..PLACES).filter(|&j| j != place).map(|j| AT[j]).enumerate() {
        let scale = 1.0 / (AT[place] - root);
        for k in (0..=degree).rev() {
            polynomial[k + 1] += scale * polynomial[k];
            polynomial[k] *= -root * scale;
        }
    }
    polynomial
}

/// Returns the values of the cardinal polynomials at a fraction.
fn weights(at: f64) -> [f64; PLACES] {
    std::array::from_fn(|k| (0..PLACES).filter(|&j| j != k).map(|j| (at - AT[j]) / (AT[k] - AT[j])).product())
}

/// Angle and rate of a hub at the places of a sample.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Trace {
    pub angle_rad: [f64; PLACES],
    pub rate_rad_s: [f64; PLACES],
    /// Places that are known.
    pub known: usize,
    /// `true` if one step took the sample.
    pub is_whole: bool,
}

impl Trace {
    /// Takes what a step saw of the hub.
    pub fn add(&mut self, attempt: &Attempt, table: &StepTable, part: Part) {
        let (nodes, middle) = (attempt.settled_outputs(table), attempt.middle_outputs());
        let seen = [nodes[0], nodes[1], middle, nodes[2], nodes[3]];
        if part.share == 1.0 {
            self.angle_rad = seen.map(|outputs| outputs[2]);
            self.rate_rad_s = seen.map(|outputs| outputs[3]);
            (self.known, self.is_whole) = (PLACES, true);
            return;
        }
        if part.start == 0.0 {
            (self.known, self.is_whole) = (0, false);
        }
        while self.known < PLACES && AT[self.known] <= part.start + part.share {
            let weights = weights((AT[self.known] - part.start) / part.share);
            let value = |row: usize| weights.iter().zip(&seen).map(|(w, outputs)| w * outputs[row]).sum();
            (self.angle_rad[self.known], self.rate_rad_s[self.known]) = (value(2), value(3));
            self.known += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::quartic;

    #[test]
    fn a_quartic_is_found_with_its_slopes_and_a_parabola_goes_on() {
        let (quartics, c) = (Quartics::new(), [1.0, -2.0, 0.5, 3.0, -1.5]);
        let values = AT.map(|s| quartic(&c, s));
        for (a, b) in quartics.interpolate(&values).iter().zip(c) {
            assert!((a - b).abs() < 1e-13);
        }
        for (slope, s) in quartics.slopes(&values).iter().zip(AT) {
            assert!((slope - (c[1] + s * (2.0 * c[2] + s * (3.0 * c[3] + s * 4.0 * c[4])))).abs() < 1e-12);
        }
        let parabola = |s: f64| 0.3 - s + 2.0 * s * s;
        for (found, s) in quartics.extrapolate(&AT.map(parabola)).iter().zip(AT) {
            assert!((found - parabola(1.0 + s)).abs() < 1e-13);
        }
        let weights = weights(0.37);
        let value: f64 = weights.iter().zip(values).map(|(w, v)| w * v).sum();
        assert!((value - quartic(&c, 0.37)).abs() < 1e-14);
    }
}
