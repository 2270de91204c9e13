//! A number of the thesis beside the one that was measured: how near they must be, and why.

use counterpoise_plot::number::short_number;

/// Condition on a measured value that a row of the claims states.
#[derive(Debug, Clone, PartialEq)]
pub struct Criterion {
    /// The quantity with its unit.
    pub what: String,
    /// Statement of the thesis about it, with its number if the thesis prints one.
    pub thesis: String,
    /// Measured value.
    pub measured: f64,
    /// The least and the largest value that agree with the thesis.
    pub accepted: (f64, f64),
    /// Why the range is as wide as it is.
    pub reason: String,
    /// The least and the largest value that the stated explanation predicts; `None` if a value outside `accepted` has none.
    pub explained: Option<(f64, f64)>,
}

/// Comparison of a measured value with the thesis' value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Agreement {
    /// Within the accepted range.
    Agrees,
    /// Outside it, and within the range that the explanation predicts.
    Explained,
    /// Outside both, or not a number.
    Disagrees,
}

impl Criterion {
    /// Returns a criterion that accepts the range from `low` to `high`.
    pub fn with_range(what: &str, thesis: &str, measured: f64, [low, high]: [f64; 2], reason: &str) -> Self {
        Self {
            what: what.to_owned(),
            thesis: thesis.to_owned(),
            measured,
            accepted: (low, high),
            reason: reason.to_owned(),
            explained: None,
        }
    }

    /// Returns a criterion that accepts everything up to a value.
    pub fn at_most(what: &str, thesis: &str, measured: f64, most: f64, reason: &str) -> Self {
        Self::with_range(what, thesis, measured, [f64::NEG_INFINITY, most], reason)
    }

    /// Returns a criterion that accepts everything from a value on.
    pub fn at_least(what: &str, thesis: &str, measured: f64, least: f64, reason: &str) -> Self {
        Self::with_range(what, thesis, measured, [least, f64::INFINITY], reason)
    }

    /// Returns the same criterion with the range that an explanation predicts.
    pub fn with_explained_range(self, low: f64, high: f64) -> Self {
        Self { explained: Some((low, high)), ..self }
    }

    /// Returns how the measured value stands to what the thesis says.
    pub fn agreement(&self) -> Agreement {
        let inside = |(low, high): (f64, f64)| (low..=high).contains(&self.measured);
        match (inside(self.accepted), self.explained.is_some_and(inside)) {
            (true, _) => Agreement::Agrees,
            (false, true) => Agreement::Explained,
            (false, false) => Agreement::Disagrees,
        }
    }

    /// Returns the accepted range as a reader expects it, for example `at most 1` or `0.9 to 1.1`.
    pub fn range(&self) -> String {
        match self.accepted {
            (low, high) if low.is_infinite() => format!("at most {}", short_number(high)),
            (low, high) if high.is_infinite() => format!("at least {}", short_number(low)),
            (low, high) => format!("{} to {}", short_number(low), short_number(high)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_agrees_is_explained_or_disagrees() {
        let of = |measured| {
            Criterion::with_range("ratio", "5", measured, [2.5, 10.0], "a factor of two")
                .with_explained_range(10.0, 20.0)
        };
        assert_eq!(of(5.0).agreement(), Agreement::Agrees);
        assert_eq!(of(15.0).agreement(), Agreement::Explained);
        assert_eq!(of(25.0).agreement(), Agreement::Disagrees);
        assert_eq!(of(f64::NAN).agreement(), Agreement::Disagrees);
        assert_eq!(of(1.0).range(), "2.5 to 10");
        assert_eq!(Criterion::at_most("a", "b", 1.0, 2.0, "").range(), "at most 2");
    }
}
