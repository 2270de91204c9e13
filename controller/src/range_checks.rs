//! The requirements on a number or a count, and the error if one does not hold.

use crate::Error;

pub(crate) fn count(path: &str, what: &'static str, found: usize, expected: usize) -> Result<(), Error> {
    if found == expected {
        Ok(())
    } else {
        Err(Error::Count { path: path.to_owned(), what, found, expected })
    }
}

pub(crate) fn require_positive(what: &str, value: f64) -> Result<(), Error> {
    require(
        what,
        value,
        NumberRequirement { holds: value > 0.0 && value.is_finite(), words: "positive and finite" },
    )
}

pub(crate) fn at_least_0(what: &str, value: f64) -> Result<(), Error> {
    require(
        what,
        value,
        NumberRequirement { holds: value >= 0.0 && value.is_finite(), words: "0 or positive, and finite" },
    )
}

pub(crate) fn require_finite(what: &str, value: f64) -> Result<(), Error> {
    require(what, value, NumberRequirement { holds: value.is_finite(), words: "finite" })
}

/// A requirement on a number: whether it holds, and its statement in words that follow "must be".
pub(crate) struct NumberRequirement {
    pub holds: bool,
    pub words: &'static str,
}

pub(crate) fn require(what: &str, value: f64, required: NumberRequirement) -> Result<(), Error> {
    if required.holds {
        Ok(())
    } else {
        Err(Error::Range { what: what.to_owned(), value, allowed: required.words })
    }
}
