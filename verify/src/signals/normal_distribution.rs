//! The normal distribution.

use crate::tolerance::FARTHEST_DEVIATIONS;

/// Returns the probability that a normal variable of mean 0 lies between two values; with a deviation of 0 whether 0 does.
pub(crate) fn probability_between(low: f64, high: f64, deviation: f64) -> f64 {
    if deviation > 0.0 {
        cumulative(high / deviation) - cumulative(low / deviation)
    } else if low <= 0.0 && high >= 0.0 {
        1.0
    } else {
        0.0
    }
}

/// Returns the probability that a standard normal variable is below `x`. The series has terms of one sign: it loses no digits
/// (M. Abramowitz and I. Stegun, Handbook of Mathematical Functions, 26.2.11, 1964).
fn cumulative(x: f64) -> f64 {
    if x.abs() > FARTHEST_DEVIATIONS {
        return if x > 0.0 { 1.0 } else { 0.0 };
    }
    let (mut term, mut sum, mut odd) = (x, 0.0, 1.0);
    while sum + term != sum {
        sum += term;
        odd += 2.0;
        term *= x * x / odd;
    }
    0.5 + sum * (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of SciPy 1.14, `scipy.stats.norm.cdf`.
    #[test]
    fn the_distribution_is_that_of_tables() {
        for (x, expected) in [
            (-3.0, 0.001_349_898_031_630_094_6),
            (0.0, 0.5),
            (0.5, 0.691_462_461_274_013_1),
            (1.0, 0.841_344_746_068_542_9),
            (4.0, 0.999_968_328_758_166_9),
            (9.0, 1.0),
        ] {
            assert!((cumulative(x) - expected).abs() < 1e-15, "{x}: {}", cumulative(x));
        }
        assert_eq!((probability_between(-1.0, 1.0, 0.0), probability_between(0.5, 1.0, 0.0)), (1.0, 0.0));
    }
}
