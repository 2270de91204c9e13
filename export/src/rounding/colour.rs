//! Roundings that repeat themselves: a number that moves by less than its unit from sample to sample is rounded alike.
//!
//! The error of rounding to a grid u is a sawtooth of the number. Where the number moves by d u, and nothing is known of where on
//! the grid it lies, two errors in a row have the correlation
//!
//! ```text
//!     rho(d) = 1 - 6 d (1 - d),   0 <= d <= 1
//! ```
//!
//! Each such error is carried along as a state of its own, c <- rho c + sqrt(1 - rho^2) e with e as large as it, beside those of
//! the controller: what a filter makes of it is what it makes of coloured noise, not of white.

use super::Rounded;
use super::tangent::{Row, Tangent};

/// Mean correlation from sample to sample above which an operation's error is carried along.
const REPEATED: f64 = 0.2;

/// Correlation of the errors of a number before and after it moved by so many units.
pub(crate) fn correlation(moved_units: f64) -> f64 {
    let d = moved_units.abs();
    if d < 0.5 { (1.0 - 6.0 * d * (1.0 - d)).max(0.0) } else { 0.0 }
}

/// Finds the operations whose errors repeat themselves.
#[derive(Debug, Clone, Default)]
pub(crate) struct Search {
    last: Vec<f64>,
    sums: Vec<f64>,
    samples: usize,
}

impl Search {
    /// Looks at a sample.
    pub fn look(&mut self, tangent: &Tangent<'_>, rounded: &[Rounded]) {
        self.last.resize(rounded.len(), f64::NAN);
        self.sums.resize(rounded.len(), 0.0);
        for (number, one) in rounded.iter().enumerate() {
            let value = tangent.value(number);
            if one.grid > 0.0 && one.square > 0.0 && self.samples > 0 {
                self.sums[number] += correlation((value - self.last[number]) / one.grid);
            }
            self.last[number] = value;
        }
        self.samples += 1;
    }

    /// Those that were found.
    pub fn found(&self) -> Colours {
        let least = REPEATED * self.samples as f64;
        let one = |number: usize| Colour { number, last: f64::NAN, square: 0.0, cross: Vec::new() };
        Colours { all: (0..self.sums.len()).filter(|k| self.sums[*k] > least).map(one).collect() }
    }
}

/// An error that repeats itself.
#[derive(Debug, Clone)]
struct Colour {
    /// The operation that makes it.
    number: usize,
    /// What it wrote in the sample before.
    last: f64,
    /// Squared bound.
    square: f64,
    /// Covariance with the errors of the states; empty before the first sample.
    cross: Vec<f64>,
}

/// All of them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Colours {
    all: Vec<Colour>,
}

impl Colours {
    /// Takes the errors of a sample from those that are independent from sample to sample.
    pub fn take(&mut self, tangent: &Tangent<'_>, rounded: &mut [Rounded], states: usize) {
        for colour in &mut self.all {
            let one = &mut rounded[colour.number];
            let value = tangent.value(colour.number);
            let moved = (value - colour.last) / one.grid;
            let kept = if moved.is_finite() { correlation(moved) } else { 0.0 };
            colour.last = value;
            colour.cross.resize(states, 0.0);
            colour.cross.iter_mut().for_each(|x| *x *= kept);
            colour.square = kept * kept * colour.square + (1.0 - kept * kept) * one.square;
            one.square = 0.0;
        }
    }

    /// What they add to the squares of what a row of derivatives gives, by the states and then by the operations.
    pub fn squares(&self, states: usize, row: &[(usize, f64)]) -> f64 {
        let of = |colour: &Colour| {
            let own: f64 = row.iter().filter(|e| e.0 == states + colour.number).map(|e| e.1).sum();
            let beside: f64 = row.iter().filter(|e| e.0 < states).map(|(i, a)| a * colour.cross[*i]).sum();
            own * (2.0 * beside + own * colour.square)
        };
        self.all.iter().map(of).sum()
    }

    /// Goes through a program that makes none of them.
    pub fn pass(&mut self, tangent: &Tangent<'_>) {
        for colour in self.all.iter_mut().filter(|colour| !colour.cross.is_empty()) {
            colour.cross = turned(tangent, &colour.cross);
        }
    }

    /// Goes through a step, and adds to the states' covariance what they give.
    pub fn advance(&mut self, tangent: &Tangent<'_>, covariance: &mut [f64]) {
        for colour in &mut self.all {
            let states = colour.cross.len();
            let mut next = turned(tangent, &colour.cross);
            let column = tangent.column(colour.number);
            for (i, a) in column {
                for (j, y) in next.iter().enumerate().filter(|(_, y)| **y != 0.0) {
                    covariance[i * states + j] += a * y;
                    covariance[j * states + i] += a * y;
                }
                column.iter().for_each(|(j, b)| covariance[i * states + j] += a * b * colour.square);
            }
            column.iter().for_each(|(i, a)| next[*i] += a * colour.square);
            colour.cross = next;
        }
    }
}

/// A v, by the rows of the derivatives of the states.
fn turned(tangent: &Tangent<'_>, v: &[f64]) -> Vec<f64> {
    let row = |row: &Row| row.iter().filter(|e| e.0 < v.len()).map(|(j, a)| a * v[*j]).sum();
    (0..v.len()).map(|i| row(tangent.state(i))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors of rounding a number that drifts, from places on the grid that are spread evenly.
    #[test]
    fn the_correlation_is_that_of_roundings() {
        let error = |x: f64| x.round() - x;
        for d in [0.01, 0.05, 0.1, 0.2] {
            let places = (0..10_000).map(|k| f64::from(k) / 10_000.0 - 0.5);
            let product: f64 = places.map(|x| error(x) * error(x + d)).sum::<f64>() / 10_000.0;
            assert!((12.0 * product - correlation(d)).abs() < 1e-3, "{d}: {}", 12.0 * product);
        }
        assert_eq!((correlation(0.7), correlation(0.3)), (0.0, 0.0));
    }
}
