//! Units as headers write them: products and quotients of named units with prefixes, to SI. [`table`] has the units by name.

pub mod table;

use table::{BASES, NamedUnit, UnitMeaning, find_named_unit};

/// A unit: its size in SI, and its dimensions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// SI value of one unit.
    pub factor: f64,
    /// Exponents of metre, kilogram, second, ampere, radian, kelvin.
    pub dimension: [i32; 6],
}

impl Unit {
    /// The unit of a bare number.
    pub const ONE: Self = Self { factor: 1.0, dimension: [0; 6] };

    /// Reads a unit such as `rad/s`, `m/s^2`, `m/s²`, `N m s/rad`, `mV`, `deg/s`, `g`; `None` if it is not known.
    ///
    /// Every factor after a `/` divides until a further `/` or a space, dot or star multiplies in the numerator's sense:
    /// `N m s/rad` is (N m s)/rad.
    pub fn parse(written: &str) -> Option<Self> {
        let mut unit = Self::ONE;
        for (index, part) in written.trim().split('/').enumerate() {
            let sign = if index == 0 { 1 } else { -1 };
            let factors =
                part.trim().trim_matches(['(', ')']).split([' ', '*', '.', '·']).filter(|f| !f.is_empty());
            for factor in factors {
                unit = unit.times(factor_of(factor)?, sign);
            }
        }
        Some(unit)
    }

    /// Returns a value in this unit, in SI.
    pub fn to_si(&self, value: f64) -> f64 {
        value * self.factor
    }

    /// Returns whether the other unit measures the same quantity.
    pub fn is_like(&self, other: &Self) -> bool {
        self.dimension == other.dimension
    }

    fn times(self, other: Self, power: i32) -> Self {
        let mut dimension = self.dimension;
        for (mine, theirs) in dimension.iter_mut().zip(other.dimension) {
            *mine += power * theirs;
        }
        Self { factor: self.factor * other.factor.powi(power), dimension }
    }
}

/// Largest exponent that a unit may be raised to.
const MOST_POWER: i32 = 9;

fn factor_of(written: &str) -> Option<Unit> {
    let (name, power) = match written.split_once('^') {
        Some((name, power)) => (name, power.parse().ok().filter(|p: &i32| p.abs() <= MOST_POWER)?),
        None => superscript(written),
    };
    Some(Unit::ONE.times(find_unit(name)?, power))
}

/// Returns a name that ends in a superscript or a plain digit: `s²`, `s2`.
fn superscript(written: &str) -> (&str, i32) {
    let powers = [("²", 2), ("³", 3), ("2", 2), ("3", 3)];
    powers
        .iter()
        .find_map(|(mark, power)| written.strip_suffix(mark).map(|name| (name, *power)))
        .unwrap_or((written, 1))
}

/// The unit whose name means the acceleration of gravity in recordings, not the gram.
const GRAVITY: &str = "g";

fn find_unit(name: &str) -> Option<Unit> {
    let (NamedUnit { name, meaning, weight, .. }, prefix) = find_named_unit(name)?;
    let UnitMeaning { factor, exponent, dimension } =
        weight.as_ref().filter(|_| *name == GRAVITY).unwrap_or(meaning);
    // Recordings take counts, bits and cycles as numbers. A level in decibels is none.
    let [m, kg, s, a, kelvin, rad, _, _, _, decibel]: [i32; BASES] = *dimension;
    let unit = Unit { factor: factor * 10f64.powi(exponent + prefix), dimension: [m, kg, s, a, rad, kelvin] };
    (decibel == 0).then_some(unit)
}
