//! A number with its unit, as a text: read into the unit of a key, and written back in the unit that the user chose.

use super::dimension::Dimension;
use super::parser::{MassOrForce, Unit, UnitError};
use super::scale::{Decimal, Scale, linear, plain_number};

/// Why a text is no quantity of a wanted unit.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum QuantityError {
    /// The text does not begin with a number.
    #[error("must be a number{}, or a text with a number and a unit", in_unit(.wanted))]
    NoNumber {
        /// The unit of the key.
        wanted: String,
    },
    /// The number is written with a decimal comma or with a separator of thousands.
    #[error("must be written with a decimal point and without separators of thousands, as in \"1234.5 mm\"")]
    Comma,
    /// The number is not finite.
    #[error("must be a finite number{}", in_unit(.wanted))]
    NotFinite {
        /// The unit of the key.
        wanted: String,
    },
    /// The unit cannot be read.
    #[error("must be a quantity{}: {why}", unit_hint(.wanted))]
    Unit {
        /// The unit of the key.
        wanted: String,
        /// Why.
        why: UnitError,
    },
    /// A number in quotes without unit, where the key has one.
    #[error("has no unit: write the number without quotes if it is in {wanted}, or add its unit")]
    NoUnit {
        /// The unit of the key.
        wanted: String,
    },
    /// A ratio whose second number is none, or not above 0.
    #[error("must be a number, or a ratio such as 200:1 whose second number is above 0")]
    Ratio,
    /// The quantity measures something else.
    #[error("must be {}; {written} is {}", measured_quantity(.wanted), .found)]
    Dimension {
        /// The unit of the key.
        wanted: String,
        /// The unit that was written.
        written: String,
        /// The quantity that it measures.
        found: String,
        /// The unit that was probably meant.
        meant: Option<String>,
    },
}

impl QuantityError {
    /// Returns what to do about it, if there is something better to say than what is allowed.
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::Unit { why: UnitError::Unknown { name, .. }, .. } if LINES.contains(&name.as_str()) => {
                Some(
                    "write counts: an encoder of N lines or pulses gives 4 N counts if all their edges count"
                        .to_owned(),
                )
            }
            Self::Unit { why: UnitError::Unknown { name, .. }, .. } if hint_at_word(name).is_some() => {
                hint_at_word(name).map(str::to_owned)
            }
            Self::Unit { why: UnitError::Unknown { nearest: Some(name), .. }, .. } => {
                Some(format!("did you mean \"{name}\"?"))
            }
            Self::Dimension { meant, .. } => meant.clone(),
            _ => None,
        }
    }
}

/// Names of the lines of an encoder, of which a turn has a quarter as many as counts, or as many.
const LINES: [&str; 7] = ["line", "lines", "ppr", "PPR", "lpr", "pulse", "pulses"];

/// Returns what to write in the place of a word for a unit that is none here.
fn hint_at_word(name: &str) -> Option<&'static str> {
    match name.to_lowercase().as_str() {
        "mil" | "mils" => {
            Some("a mil has several sizes: one of 6400 to the turn is 0.98175 mrad, one of an inch 0.0254 mm")
        }
        "sqrt" | "rthz" | "rt" => Some(
            "a noise density is the angle random walk of a sensor: write it as `angle_random_walk`, the same number in deg/s, in place of `noise`",
        ),
        "grad" => Some("write deg for degrees, or gon for the 400th part of a turn"),
        _ => None,
    }
}

fn in_unit(wanted: &str) -> String {
    if wanted.is_empty() { String::new() } else { format!(" in {wanted}") }
}

fn unit_hint(wanted: &str) -> String {
    if wanted.is_empty() { " without unit".to_owned() } else { format!(" in a unit like {wanted}") }
}

/// Returns what a wanted unit measures, as in "an angular rate, in a unit like rad/s".
fn measured_quantity(wanted: &str) -> String {
    if wanted.is_empty() {
        return "a number without unit".to_owned();
    }
    let name =
        Unit::parse(wanted, MassOrForce::Mass).map_or_else(|_| String::new(), |unit| unit.dimension.name());
    format!("{name}, in a unit like {wanted}")
}

/// Longest text that is read as a quantity, in bytes.
const LONGEST: usize = 200;

/// Reads a quantity such as `0.5 mrad` and returns its value in the wanted unit.
///
/// `kg`, `lb` and `oz` are masses, or the weights of these masses where only that fits; `g` is the gram, or the acceleration of
/// gravity. A ratio may be written `200:1`. A number of bits fits where counts are wanted: `14 bit` are 16384 counts, of a turn or of anything else.
///
/// # Errors
/// [`QuantityError`].
pub fn read_quantity(text: &str, wanted: &str) -> Result<f64, QuantityError> {
    let parts = Parts::of(text, wanted)?;
    if wanted.is_empty()
        && let Some(per) = parts.ratio()
    {
        return require_finite(parts.number.scale_by_power_of_ten(0) / per, wanted);
    }
    if parts.unit.starts_with(':') {
        return Err(match wanted {
            "" => QuantityError::Ratio,
            _ => mismatch(text, wanted, "a ratio", Dimension::default()),
        });
    }
    let scale = scale(&parts, text, wanted)?;
    require_finite(scale.apply(&parts.number), wanted)
}

/// Returns the text with a new value, given in the wanted unit, in the unit that the text has; `None` if the text is no
/// quantity of the wanted unit.
pub fn rewrite_quantity(text: &str, value: f64, wanted: &str) -> Option<String> {
    let parts = Parts::of(text, wanted).ok()?;
    if let (true, Some(per)) = (wanted.is_empty(), parts.ratio()) {
        return Some(format!("{}{}{}", plain_number(value * per), parts.gap, parts.unit));
    }
    let scale = scale(&parts, text, wanted).ok()?;
    let number = scale.undo(value)?;
    Some(format!("{number}{}{}", parts.gap, parts.unit))
}

fn require_finite(value: f64, wanted: &str) -> Result<f64, QuantityError> {
    if value.is_finite() { Ok(value) } else { Err(QuantityError::NotFinite { wanted: wanted.to_owned() }) }
}

/// The number, what separates it from the unit, and the unit, as written.
struct Parts<'t> {
    number: Decimal,
    gap: &'t str,
    unit: &'t str,
}

impl<'t> Parts<'t> {
    fn of(text: &'t str, wanted: &str) -> Result<Self, QuantityError> {
        let none = || QuantityError::NoNumber { wanted: wanted.to_owned() };
        let text = text.trim();
        if text.len() > LONGEST {
            return Err(none());
        }
        let unsigned = text.strip_prefix(['+', '-', '\u{2212}']).unwrap_or(text);
        let lower = unsigned.to_ascii_lowercase();
        if lower.starts_with("nan") || lower.starts_with("inf") {
            return Err(QuantityError::NotFinite { wanted: wanted.to_owned() });
        }
        let sign = if text.starts_with(['-', '\u{2212}']) { "-" } else { "" };
        let end = unsigned.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(unsigned.len());
        let (digits, rest) = unsigned.split_at(end);
        if digits.parse::<f64>().is_err() {
            return Err(none());
        }
        let (exponent, rest) = exponent(rest);
        let unit = rest.trim_start();
        if unit.starts_with(',') || unit.starts_with(|c: char| c.is_ascii_digit() && !unit.starts_with("1/"))
        {
            return Err(QuantityError::Comma);
        }
        let gap = &rest[..rest.len() - unit.len()];
        Ok(Self { number: Decimal { digits: format!("{sign}{digits}"), exponent }, gap, unit })
    }

    /// Returns the second number of a ratio such as `200:1`.
    fn ratio(&self) -> Option<f64> {
        let second = self.unit.strip_prefix(':')?.trim();
        let plain = second.chars().all(|c| c.is_ascii_digit() || c == '.');
        second.parse().ok().filter(|per: &f64| plain && *per > 0.0 && per.is_finite())
    }
}

/// Splits the power of ten off a text such as `e-3 mm`.
fn exponent(rest: &str) -> (i64, &str) {
    let Some(after) = rest.strip_prefix(['e', 'E']) else { return (0, rest) };
    let sign = after.len() - after.strip_prefix(['+', '-']).unwrap_or(after).len();
    let digits = after[sign..].chars().take_while(char::is_ascii_digit).count();
    if digits == 0 {
        return (0, rest);
    }
    let (power, rest) = after.split_at(sign + digits);
    let beyond = if power.starts_with('-') { i64::MIN / 2 } else { i64::MAX / 2 };
    (power.parse().unwrap_or(beyond), rest)
}

/// Returns the factor from the written unit to the wanted one.
fn scale(parts: &Parts<'_>, text: &str, wanted: &str) -> Result<Scale, QuantityError> {
    let target = Unit::parse(wanted, MassOrForce::Mass).unwrap_or(Unit::ONE);
    let refused = |why| QuantityError::Unit { wanted: wanted.to_owned(), why };
    if parts.unit.is_empty() && target.dimension != Dimension::default() {
        return Err(QuantityError::NoUnit { wanted: wanted.to_owned() });
    }
    let unit = Unit::parse(parts.unit, MassOrForce::Mass).map_err(refused)?;
    if is_per_minute(parts.unit) && target.dimension.without_angles().1 != unit.dimension.without_angles().1 {
        return Err(mismatch(text, wanted, &unit.dimension.name(), unit.dimension));
    }
    if let Some(scale) = linear(&unit, &target) {
        return Ok(scale);
    }
    let weight = Unit::parse(parts.unit, MassOrForce::Weight).map_err(refused)?;
    if let Some(scale) = linear(&weight, &target) {
        return Ok(scale);
    }
    if let Some(scale) = of_a_turn(&unit, &target) {
        return Ok(scale);
    }
    Err(mismatch(text, wanted, &unit.dimension.name(), unit.dimension))
}

/// Returns whether a unit counts something a minute, without saying what.
fn is_per_minute(unit: &str) -> bool {
    unit.contains("min^-1") || unit.contains("1/min")
}

/// Returns the factor to a number of steps, or to a length, of a turn, whether the turn is written or not; bits count steps.
fn of_a_turn(unit: &Unit, target: &Unit) -> Option<Scale> {
    let is_one_of = |one: &Unit, names: [&str; 2]| {
        names.iter().any(|name| {
            Unit::parse(name, MassOrForce::Mass).is_ok_and(|named| named.dimension == one.dimension)
        })
    };
    let (counts, bits) = (["count", "count/rev"], ["bit", "bit/rev"]);
    if is_one_of(target, counts) && is_one_of(unit, bits) {
        return Some(Scale::CountsOfBits);
    }
    if is_one_of(target, counts) && is_one_of(unit, counts) {
        return Some(Scale::Linear { factor: 1.0, power: unit.exponent });
    }
    let is_lead = is_one_of(target, ["m/rev"; 2]) && is_one_of(unit, ["m"; 2]);
    is_lead.then_some(Scale::Linear { factor: unit.factor, power: unit.exponent })
}

fn mismatch(text: &str, wanted: &str, found: &str, dimension: Dimension) -> QuantityError {
    let target = Unit::parse(wanted, MassOrForce::Mass).unwrap_or(Unit::ONE).dimension;
    let frequency = Dimension([0, 0, -1, 0, 0, 0, 1, 0, 0, 0]);
    let time = Dimension([0, 0, 1, 0, 0, 0, 0, 0, 0, 0]);
    let (length, area) =
        (Dimension([1, 0, 0, 0, 0, 0, 0, 0, 0, 0]), Dimension([2, 0, 0, 0, 0, 0, 0, 0, 0, 0]));
    let (speed_constant, back_emf) =
        (Dimension([-2, -1, 2, 1, 0, 1, 0, 0, 0, 0]), Dimension([2, 1, -2, -1, 0, -1, 0, 0, 0, 0]));
    let (per_turn, turns) =
        (Dimension([1, 0, 0, 0, 0, 0, -1, 0, 0, 0]), Dimension([-1, 0, 0, 0, 0, 0, 1, 0, 0, 0]));
    let decibel = Dimension([0, 0, 0, 0, 0, 0, 0, 0, 0, 1]);
    let meant = if is_per_minute(text) {
        Some("write rpm for revolutions a minute, or rad/min for radians".to_owned())
    } else if dimension == speed_constant && target == back_emf {
        Some("that is the speed constant, the inverse: \"380 rpm/V\" are \"2.6316 mV/rpm\"".to_owned())
    } else if dimension == per_turn && target == turns {
        Some("that is the travel per turn, the inverse: \"200 mm/rev\" are \"31.416 rad/m\"".to_owned())
    } else if dimension == frequency && target == time {
        Some("give the period, the inverse of the frequency".to_owned())
    } else if dimension == area && target == length && text.ends_with("m m") {
        Some("did you mean \"mm\"?".to_owned())
    } else if dimension == decibel {
        Some("decibels stand only where the unit is dB: give the ratio itself".to_owned())
    } else {
        None
    };
    QuantityError::Dimension {
        wanted: wanted.to_owned(),
        written: format!("\"{}\"", text.trim()),
        found: found.to_owned(),
        meant,
    }
}
