//! From one unit to another: factors and powers of ten, radians and cycles.

use std::f64::consts::TAU;

use super::dimension::Dimension;
use super::parser::Unit;

/// A decimal number: its digits with sign and point, and its power of ten.
pub(super) struct Decimal {
    pub digits: String,
    pub exponent: i64,
}

impl Decimal {
    /// Returns the number times a power of ten, correctly rounded.
    pub fn scale_by_power_of_ten(&self, power: i32) -> f64 {
        let exponent = self.exponent.saturating_add(i64::from(power));
        format!("{}e{exponent}", self.digits).parse().unwrap_or(f64::NAN)
    }
}

/// From a written unit to a wanted one: a factor and a power of ten, or counts of a number of bits.
pub(super) enum Scale {
    Linear { factor: f64, power: i32 },
    CountsOfBits,
}

impl Scale {
    pub fn apply(&self, number: &Decimal) -> f64 {
        match self {
            // A factor of 1 keeps the decimal conversion exact.
            Self::Linear { factor: 1.0, power } => number.scale_by_power_of_ten(*power),
            Self::Linear { factor, power } => number.scale_by_power_of_ten(*power) * factor,
            Self::CountsOfBits => number.scale_by_power_of_ten(0).exp2(),
        }
    }

    /// Returns the shortest number that gives the value, or comes nearest to it.
    pub fn undo(&self, value: f64) -> Option<String> {
        let (factor, power) = match self {
            Self::Linear { factor, power } => (*factor, *power),
            Self::CountsOfBits => return (value > 0.0).then(|| plain_number(value.log2())),
        };
        if factor == 1.0 {
            return Some(plain_number(shift_decimal(value, -power)));
        }
        let near = shift_decimal(value / factor, -power);
        let gives = |digits: usize| {
            let written: f64 = format!("{near:.digits$e}").parse().ok()?;
            (shift_decimal(written, power) * factor == value).then(|| plain_number(written))
        };
        (0..17).find_map(gives).or_else(|| near.is_finite().then(|| plain_number(near)))
    }
}

/// Returns a number times a power of ten, by its shortest decimal form.
fn shift_decimal(value: f64, power: i32) -> f64 {
    let written = format!("{value:e}");
    let (digits, exponent) = written.split_once('e').unwrap_or((&written, "0"));
    let exponent = exponent.parse::<i64>().unwrap_or(0).saturating_add(i64::from(power));
    format!("{digits}e{exponent}").parse().unwrap_or(f64::NAN)
}

/// Returns a number as a person writes it: without a trailing `.0`.
pub(super) fn plain_number(value: f64) -> String {
    let written = crate::file::setting::number(value);
    written.strip_suffix(".0").map_or(written.clone(), str::to_owned)
}

/// Returns the factor between two units that measure the same; `None` if they do not.
pub(super) fn linear(unit: &Unit, target: &Unit) -> Option<Scale> {
    let turns = angle_factor(unit.dimension, target.dimension)?;
    let factor = if unit.factor == target.factor { turns } else { unit.factor / target.factor * turns };
    Some(Scale::Linear { factor, power: unit.exponent.saturating_sub(target.exponent) })
}

/// Dimensions without the radian in which it may be left out: rate, angular acceleration, viscous coefficient, back-EMF constant.
const RADIAN_MAY_LACK: [[i32; 4]; 4] = [[0, 0, -1, 0], [0, 0, -2, 0], [2, 1, -1, 0], [2, 1, -2, -1]];

/// Returns the factor that the angles of two dimensions differ by: radians against cycles, and radians left out.
fn angle_factor(unit: Dimension, target: Dimension) -> Option<f64> {
    let ((rest, radians, cycles), (wanted, wanted_radians, wanted_cycles)) =
        (unit.without_angles(), target.without_angles());
    if rest != wanted {
        return None;
    }
    if (radians, cycles) == (wanted_radians, wanted_cycles) {
        return Some(1.0);
    }
    if radians + cycles == wanted_radians + wanted_cycles {
        return Some(TAU.powi(cycles - wanted_cycles));
    }
    // One over a hertz is a second: cycles below the line are not counted.
    if cycles.min(wanted_cycles) < 0 && radians == wanted_radians && cycles.max(0) == wanted_cycles.max(0) {
        return Some(1.0);
    }
    // 1/s is a hertz, too.
    if (radians, cycles, wanted_radians, wanted_cycles) == (0, 0, 0, 1) {
        return Some(1.0);
    }
    let [m, kg, s, a, ..] = wanted.0;
    let may_lack = RADIAN_MAY_LACK.contains(&[m, kg, s, a]);
    (may_lack && radians == 0 && cycles == 0 && wanted_cycles == 0).then_some(1.0)
}
