//! The values that a parameter may take.

use crate::Error;
use std::fmt;

/// The values that a number may take. All of them are finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Range {
    /// Any finite number.
    Any,
    /// Numbers greater than this one.
    Above(f64),
    /// This number and all greater ones.
    AtLeast(f64),
    /// Numbers from the first to the second, both included.
    Between(f64, f64),
    /// Numbers greater than the first, up to the second, which is included.
    AboveTo(f64, f64),
}

impl Range {
    /// Numbers greater than zero.
    pub const POSITIVE: Self = Self::Above(0.0);
    /// Zero and all greater numbers.
    pub const NOT_NEGATIVE: Self = Self::AtLeast(0.0);

    /// Returns whether the range contains a value; it contains neither infinities nor NaN.
    pub fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Any => true,
                Self::Above(low) => value > low,
                Self::AtLeast(low) => value >= low,
                Self::Between(low, high) => (low..=high).contains(&value),
                Self::AboveTo(low, high) => value > low && value <= high,
            }
    }

    /// Returns the value if the range contains it.
    ///
    /// # Errors
    /// [`Error::Parameter`] names `path.name`, the value and the range otherwise.
    pub(crate) fn check(self, path: &str, name: &str, value: f64) -> Result<f64, Error> {
        if self.contains(value) {
            return Ok(value);
        }
        let parameter = if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
        Err(Error::Parameter { parameter, value, allowed: self.to_string().into() })
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Any => write!(f, "must be finite"),
            Self::Above(low) => write!(f, "must be finite and above {low}"),
            Self::AtLeast(low) => write!(f, "must be finite and at least {low}"),
            Self::Between(low, high) => write!(f, "must be between {low} and {high}"),
            Self::AboveTo(low, high) => write!(f, "must be above {low} and at most {high}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_contains_its_closed_ends_only_and_nothing_infinite() {
        let ranges = [Range::Any, Range::Above(1.0), Range::AtLeast(1.0), Range::Between(1.0, 2.0)];
        assert_eq!(ranges.map(|range| range.contains(1.0)), [true, false, true, true]);
        assert_eq!(ranges.map(|range| range.contains(0.0)), [true, false, false, false]);
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(!ranges.iter().any(|range| range.contains(value)));
        }
        assert!(Range::AboveTo(1.0, 2.0).contains(2.0) && !Range::AboveTo(1.0, 2.0).contains(1.0));
    }
}
