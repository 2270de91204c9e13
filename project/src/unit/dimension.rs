//! Dimensions: what a unit measures, as exponents of base units.

use std::fmt;

use counterpoise_recordings::unit::table::BASES;

/// Symbols of the base units, in the order of the exponents. Cycle, bit, count and decibel are kept apart from pure numbers, so
/// that `14 bit` is not taken for a ratio.
const SYMBOLS: [&str; BASES] = ["m", "kg", "s", "A", "K", "rad", "cycle", "bit", "count", "dB"];

/// Exponents of metre, kilogram, second, ampere, kelvin, radian, cycle, bit, count and decibel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Dimension(pub [i32; BASES]);

/// Place of the radian among the base units.
pub(super) const RADIAN: usize = 5;
/// Place of the cycle among the base units.
pub(super) const CYCLE: usize = 6;

/// Dimensions that have a name: exponents of metre, kilogram, second, ampere and radian.
const NAMES: [([i32; 5], &str); 33] = [
    ([0, 0, 0, 0, 0], "a number without unit"),
    ([1, 0, 0, 0, 0], "a length"),
    ([2, 0, 0, 0, 0], "an area"),
    ([4, 0, 0, 0, 0], "a second moment of area"),
    ([0, 1, 0, 0, 0], "a mass"),
    ([0, 0, 1, 0, 0], "a time"),
    ([0, 0, 2, 0, 0], "a time squared"),
    ([0, 0, 0, 1, 0], "a current"),
    ([0, 0, 0, 0, 1], "an angle"),
    ([0, 0, -1, 0, 1], "an angular rate"),
    ([0, 0, -2, 0, 1], "an angular acceleration"),
    ([0, 0, -1, 0, 0], "a rate"),
    ([1, 0, -1, 0, 0], "a speed"),
    ([1, 0, -2, 0, 0], "an acceleration"),
    ([1, 1, -2, 0, 0], "a force"),
    ([2, 1, -2, 0, 0], "a torque"),
    ([2, 1, -2, 0, -1], "an angular stiffness"),
    ([2, 1, -1, 0, -1], "an angular damping"),
    ([2, 1, -1, 0, 0], "an angular momentum"),
    ([0, 1, -2, 0, 0], "a stiffness"),
    ([0, 1, -1, 0, 0], "a damping"),
    ([2, 1, 0, 0, 0], "a moment of inertia"),
    ([1, 1, 0, 0, 0], "a first moment of mass"),
    ([1, 1, -1, 0, 0], "a momentum"),
    ([-3, 1, 0, 0, 0], "a density"),
    ([-1, 1, -2, 0, 0], "a pressure"),
    ([2, 1, -3, 0, 0], "a power"),
    ([2, 1, -3, -1, 0], "a voltage"),
    ([2, 1, -3, -2, 0], "a resistance"),
    ([2, 1, -2, -2, 0], "an inductance"),
    ([2, 1, -2, -1, 0], "a torque per current"),
    ([2, 1, -2, -1, -1], "a voltage per angular rate"),
    ([1, 1, -2, -1, 0], "a force per current"),
];

impl Dimension {
    /// Returns the dimension of a product with another dimension raised to a power.
    #[must_use]
    pub fn times(mut self, other: Self, power: i32) -> Self {
        for (mine, theirs) in self.0.iter_mut().zip(other.0) {
            *mine = mine.saturating_add(theirs.saturating_mul(power));
        }
        self
    }

    /// Returns the exponents of radian and cycle, and the dimension without them.
    pub(super) fn without_angles(self) -> (Self, i32, i32) {
        let (radian, cycle) = (self.0[RADIAN], self.0[CYCLE]);
        let mut rest = self;
        (rest.0[RADIAN], rest.0[CYCLE]) = (0, 0);
        (rest, radian, cycle)
    }

    /// Returns what is measured, with its article, as in "a torque"; the base units for what has no name.
    pub fn name(self) -> String {
        let [m, kg, s, a, kelvin, rad, cycle, bit, count, decibel] = self.0;
        if [kelvin, cycle, bit, count, decibel] == [0; 5]
            && let Some((_, name)) = NAMES.iter().find(|(exponents, _)| *exponents == [m, kg, s, a, rad])
        {
            return (*name).to_owned();
        }
        match self.0 {
            [0, 0, -1, 0, 0, 0, 1, 0, 0, 0] => "a frequency".to_owned(),
            [0, 0, 0, 0, 0, 0, 0, 1, 0, 0] => "a number of bits".to_owned(),
            [0, 0, 0, 0, 0, 0, 0, 0, 1, 0] => "a number of counts".to_owned(),
            [0, 0, 0, 0, 0, 0, 0, 0, 0, 1] => "a level in decibels".to_owned(),
            _ => format!("measured in {self}"),
        }
    }
}

impl fmt::Display for Dimension {
    /// Writes the base units with their powers, as in `kg m^2 s^-2`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let power = |(symbol, exponent): (&&str, i32)| match exponent {
            0 => None,
            1 => Some((*symbol).to_owned()),
            _ => Some(format!("{symbol}^{exponent}")),
        };
        let parts: Vec<String> = SYMBOLS.iter().zip(self.0).filter_map(power).collect();
        f.write_str(if parts.is_empty() { "1" } else { "" })?;
        f.write_str(&parts.join(" "))
    }
}
