//! The factor of a parameter as a function of a normalised deviation.

use crate::robustness::Distribution;
use crate::tolerance::INSIDE_REACH;

/// The factor by which a parameter differs, over a deviation delta
///
/// ```text
///     f(delta) = centre (1 + a delta) / (1 + b delta),     f(-1) = lowest, f(0) = centre, f(1) = highest
/// ```
///
/// The centre is 1 if 1 lies inside the range, its middle otherwise. A range that is even about 1 gives b = 0; one that is even
/// in the logarithm gives b = -a.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Factor {
    /// The factor at no deviation.
    pub centre: f64,
    /// Slope of the numerator.
    pub a: f64,
    /// Slope of the denominator.
    pub b: f64,
}

/// The deviations that a parameter may take, over its stated range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// The least, below 0; it may be infinite.
    pub least: f64,
    /// The largest, above 0; it may be infinite.
    pub most: f64,
}

impl Factor {
    /// Returns the factor over the range of a distribution.
    pub fn of(distribution: Distribution) -> Self {
        let (low, high) = match distribution {
            Distribution::Uniform { low, high } | Distribution::LogUniform { low, high } => (low, high),
            Distribution::Normal { .. } => (distribution.quantile(0.0), distribution.quantile(1.0)),
        };
        let centre = if low < 1.0 && 1.0 < high { 1.0 } else { 0.5 * (low + high) };
        let (l, h) = (low / centre, high / centre);
        if h <= l {
            return Self { centre, a: 0.0, b: 0.0 };
        }
        let b = (2.0 - h - l) / (h - l);
        Self { centre, a: h * (1.0 + b) - 1.0, b }
    }

    /// Returns the factor at a deviation, which is taken as the nearest within [`Self::reach`].
    pub fn at(self, delta: f64) -> f64 {
        let Reach { least, most } = self.reach();
        let delta = delta.clamp(least, most);
        self.centre * (1.0 + self.a * delta) / (1.0 + self.b * delta)
    }

    /// Returns the deviations at which the factor is positive and finite: no parameter is 0 or less, however far its range is widened.
    pub fn reach(self) -> Reach {
        let least = if self.a > 0.0 { -1.0 / self.a } else { f64::NEG_INFINITY };
        let most = if self.b < 0.0 { -1.0 / self.b } else { f64::INFINITY };
        Reach { least: INSIDE_REACH * least, most: INSIDE_REACH * most }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_and_the_middle_are_those_of_the_range() {
        for (low, high) in [(0.8, 1.25), (0.5, 2.0), (0.1, 3.0), (0.9, 1.1)] {
            let factor = Factor::of(Distribution::Uniform { low, high });
            let found = [factor.at(-1.0), factor.at(0.0), factor.at(1.0)];
            assert!((found[0] - low).abs() + (found[1] - 1.0).abs() + (found[2] - high).abs() < 1e-14);
        }
        let from_nothing = Factor::of(Distribution::Uniform { low: 0.0, high: 3.0 });
        assert!(
            from_nothing.at(-1.0) > 0.0 && from_nothing.at(-9.0) < 2e-3 && from_nothing.at(9.0).is_finite()
        );
        let outside = Factor::of(Distribution::Uniform { low: 2.0, high: 4.0 });
        assert!((outside.at(-1.0) - 2.0).abs() + (outside.at(0.0) - 3.0).abs() < 1e-14);
    }
}
