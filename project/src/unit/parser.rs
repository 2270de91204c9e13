//! Units as they are written: products, quotients and powers of named units.

use std::str::Chars;

use counterpoise_recordings::unit::table::{BASES, UNITS, UnitMeaning, find_named_unit};

use super::dimension::Dimension;
use crate::diagnostic::nearest_name;

/// A unit: `factor` times ten to the power `exponent`, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Factor of the size in SI units.
    pub factor: f64,
    /// Power of ten of the size in SI units.
    pub exponent: i32,
    /// Dimension of the measured quantity.
    pub dimension: Dimension,
}

/// Meaning of the units `kg`, `lb`, `oz` and `g`: mass or force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MassOrForce {
    /// Masses.
    Mass,
    /// The weights of these masses, and the acceleration of gravity.
    Weight,
}

/// Why a unit cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum UnitError {
    /// A name that no unit has.
    #[error("there is no unit \"{name}\"")]
    Unknown {
        /// The name.
        name: String,
        /// The unit of the nearest name.
        nearest: Option<&'static str>,
    },
    /// A factor after a division, which could belong above or below the line.
    #[error(
        "\"{written}\" can be read in two ways: put the factors below the line in parentheses, as in N m/(rad s), or before it"
    )]
    Ambiguous {
        /// The unit.
        written: String,
    },
    /// A power that is no whole number from -9 to 9.
    #[error("the power in \"{written}\" must be a whole number from -9 to 9")]
    Power {
        /// The unit.
        written: String,
    },
    /// A character that no unit has, or a unit that breaks off.
    #[error("\"{written}\" is no product or quotient of units")]
    Malformed {
        /// The unit.
        written: String,
    },
    /// More characters, factors or parentheses than a unit has.
    #[error("the unit is longer than {LONGEST} characters or {MOST_FACTORS} factors")]
    TooLong,
}

/// Most characters of a unit.
const LONGEST: usize = 64;
/// Most factors of a unit.
const MOST_FACTORS: usize = 16;
/// Deepest nesting of parentheses.
const DEEPEST: usize = 4;
/// Largest power of a factor.
const LARGEST_POWER: i32 = 9;

impl Unit {
    /// The unit of a number without unit.
    pub const ONE: Self = Self { factor: 1.0, exponent: 0, dimension: Dimension([0; BASES]) };

    /// Reads a unit such as `rad/s`, `kg cm^2`, `N m s/rad`, `(m/s^2)^2 s`, `oz-in/A`; the empty text is [`Unit::ONE`].
    ///
    /// Factors are separated by spaces, `*`, `·` or hyphens. A `/` divides by the factor that follows it. A power is written `^2`,
    /// `²` or as a digit behind the name.
    ///
    /// # Errors
    /// [`UnitError`].
    pub fn parse(written: &str, reading: MassOrForce) -> Result<Self, UnitError> {
        if written.chars().count() > LONGEST {
            return Err(UnitError::TooLong);
        }
        let mut parser = Parser { written, rest: written.chars(), reading, factors: 0 };
        parser.skip_separators();
        if parser.rest.as_str().is_empty() {
            return Ok(Self::ONE);
        }
        let unit = parser.product(0)?;
        if parser.rest.as_str().is_empty() { Ok(unit) } else { Err(parser.malformed_unit()) }
    }

    /// Returns the product with another unit raised to a power.
    fn times(self, other: Self, power: i32) -> Self {
        Self {
            factor: self.factor * other.factor.powi(power),
            exponent: self.exponent.saturating_add(other.exponent.saturating_mul(power)),
            dimension: self.dimension.times(other.dimension, power),
        }
    }

    fn of(meaning: UnitMeaning, prefix: i32) -> Self {
        let UnitMeaning { factor, exponent, dimension } = meaning;
        Self { factor, exponent: exponent + prefix, dimension: Dimension(dimension) }
    }

    /// Returns the unit of a name, with or without prefix.
    fn find_unit(name: &str, reading: MassOrForce) -> Option<Self> {
        let (unit, prefix) = find_named_unit(name)?;
        let meaning = match (reading, unit.weight) {
            (MassOrForce::Weight, Some(weight)) => weight,
            _ => unit.meaning,
        };
        Some(Self::of(meaning, prefix))
    }
}

/// A walk over the characters of a unit.
struct Parser<'a> {
    written: &'a str,
    rest: Chars<'a>,
    reading: MassOrForce,
    factors: usize,
}

/// Units, with their prefixes, that data sheets write as one word with another behind them.
const JOINED_FIRST: [&str; 8] = ["Nm", "N", "g", "lb", "oz", "lbf", "ozf", "V"];
/// The units behind them, the longer ones first.
const JOINED_SECOND: [&str; 6] = ["cm", "mm", "in", "ft", "m", "s"];

/// The place of a factor: above or below the line.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    Above,
    Below,
}

impl Parser<'_> {
    fn peek(&self) -> Option<char> {
        self.rest.clone().next()
    }

    fn malformed_unit(&self) -> UnitError {
        UnitError::Malformed { written: self.written.to_owned() }
    }

    /// Passes separators between factors.
    fn skip_separators(&mut self) {
        while self.peek().is_some_and(|c| c.is_whitespace() || matches!(c, '*' | '·' | '⋅' | '-' | '.')) {
            self.rest.next();
        }
    }

    /// Reads factors up to the end or a closing parenthesis.
    fn product(&mut self, depth: usize) -> Result<Unit, UnitError> {
        if depth > DEEPEST {
            return Err(UnitError::TooLong);
        }
        let mut unit = self.factor(depth)?;
        let mut side = Side::Above;
        loop {
            self.skip_separators();
            match self.peek() {
                None | Some(')') => return Ok(unit),
                Some('/') => {
                    self.rest.next();
                    self.skip_separators();
                    side = Side::Below;
                    let below = self.factor(depth)?;
                    unit = unit.times(below, -1);
                }
                Some(_) if side == Side::Below => {
                    return Err(UnitError::Ambiguous { written: self.written.to_owned() });
                }
                Some(_) => {
                    let next = self.factor(depth)?;
                    unit = unit.times(next, 1);
                }
            }
        }
    }

    /// Reads a name or a group in parentheses, with its power.
    fn factor(&mut self, depth: usize) -> Result<Unit, UnitError> {
        self.factors += 1;
        if self.factors > MOST_FACTORS {
            return Err(UnitError::TooLong);
        }
        let unit = match self.peek() {
            Some('(') => {
                self.rest.next();
                self.skip_separators();
                let inside = self.product(depth + 1)?;
                if self.rest.next() != Some(')') {
                    return Err(self.malformed_unit());
                }
                inside
            }
            Some('1') => self.one()?,
            _ => self.name()?,
        };
        let power = self.power()?;
        Ok(Unit::ONE.times(unit, power))
    }

    /// Reads `1`, or `1000` with the name that follows it, as in `V/1000 rpm`.
    fn one(&mut self) -> Result<Unit, UnitError> {
        let Some(after) = self.rest.as_str().strip_prefix("1000") else {
            self.rest.next();
            return Ok(Unit::ONE);
        };
        self.rest = after.chars();
        self.skip_separators();
        let named = self.name()?;
        Ok(Unit { exponent: named.exponent.saturating_add(3), ..named })
    }

    fn name(&mut self) -> Result<Unit, UnitError> {
        let text = self.rest.as_str();
        let end = text.find(|c: char| !(c.is_alphabetic() || matches!(c, '%' | '°'))).unwrap_or(text.len());
        // The standard gravity is the only name with a digit.
        let end = if text.starts_with("g0") { 2 } else { end };
        let (name, rest) = text.split_at(end);
        if name.is_empty() {
            return Err(self.malformed_unit());
        }
        if let Some((unit, first)) = self.first_of_joined(name) {
            self.rest = text[first..].chars();
            return Ok(unit);
        }
        self.rest = rest.chars();
        Unit::find_unit(name, self.reading).ok_or_else(|| UnitError::Unknown {
            name: name.to_owned(),
            nearest: nearest_name(name, UNITS.iter().map(|unit| unit.name)),
        })
    }

    /// Returns the first of two units that are written as one word, as in `kgm²` and `gcm²`, with the length of its name.
    fn first_of_joined(&self, name: &str) -> Option<(Unit, usize)> {
        if Unit::find_unit(name, self.reading).is_some() {
            return None;
        }
        JOINED_SECOND.iter().find_map(|second| {
            let first = name.strip_suffix(second)?;
            let is_joined = JOINED_FIRST.iter().any(|known| first.ends_with(known));
            let unit = Unit::find_unit(first, self.reading).filter(|_| is_joined)?;
            Some((unit, first.len()))
        })
    }

    /// Reads `^-2`, `²` or `2`; 1 if there is no power.
    fn power(&mut self) -> Result<i32, UnitError> {
        let bad = UnitError::Power { written: self.written.to_owned() };
        let raised = match self.peek() {
            Some('^') => {
                self.rest.next();
                true
            }
            Some('²') => return self.superscript(2),
            Some('³') => return self.superscript(3),
            Some(c) if c.is_ascii_digit() => false,
            _ => return Ok(1),
        };
        let text = self.rest.as_str();
        let sign = usize::from(raised && text.starts_with('-'));
        let digits = text[sign..].chars().take_while(char::is_ascii_digit).count();
        let power = text[..sign + digits].parse::<i32>().map_err(|_| bad.clone())?;
        self.rest = text[sign + digits..].chars();
        if power.abs() > LARGEST_POWER || self.peek() == Some('.') { Err(bad) } else { Ok(power) }
    }

    fn superscript(&mut self, power: i32) -> Result<i32, UnitError> {
        self.rest.next();
        Ok(power)
    }
}
