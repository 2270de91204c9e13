//! The units by name: the one table of recordings and of the project file.

use std::f64::consts::PI;

/// Number of base units: metre, kilogram, second, ampere, kelvin, radian, cycle, bit, count and decibel.
pub const BASES: usize = 10;

/// A unit with a name of its own: `factor` times ten to the power `exponent`, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NamedUnit {
    /// The name, as it is written.
    pub name: &'static str,
    /// Meaning.
    pub meaning: UnitMeaning,
    /// The rule for prefixes such as `m` and `k`.
    pub prefixes: PrefixRule,
    /// Other meaning of the name: `kg`, `lb` and `oz` are also used for the weight of that mass, and `g` for the acceleration of
    /// gravity.
    pub weight: Option<UnitMeaning>,
}

/// Size and dimension of a unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnitMeaning {
    /// Factor of the size in SI units.
    pub factor: f64,
    /// Power of ten of the size in SI units.
    pub exponent: i32,
    /// Exponents of the base units in the measured quantity.
    pub dimension: [i32; BASES],
}

/// Rule for the prefixes of a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PrefixRule {
    /// The unit takes prefixes.
    Taken,
    /// The unit takes no prefixes.
    None,
}

/// Prefixes with their powers of ten.
pub const PREFIXES: [(&str, i32); 12] = [
    ("p", -12),
    ("n", -9),
    ("u", -6),
    ("µ", -6),
    ("μ", -6),
    ("m", -3),
    ("c", -2),
    ("d", -1),
    ("k", 3),
    ("M", 6),
    ("G", 9),
    ("T", 12),
];

const fn base(m: i32, kg: i32, s: i32, a: i32) -> [i32; BASES] {
    [m, kg, s, a, 0, 0, 0, 0, 0, 0]
}

const fn unit(name: &'static str, factor: f64, exponent: i32, dimension: [i32; BASES]) -> NamedUnit {
    let meaning = UnitMeaning { factor, exponent, dimension };
    NamedUnit { name, meaning, prefixes: PrefixRule::None, weight: None }
}

/// Returns a coherent SI unit, which takes prefixes.
const fn si(name: &'static str, dimension: [i32; BASES]) -> NamedUnit {
    NamedUnit { prefixes: PrefixRule::Taken, ..unit(name, 1.0, 0, dimension) }
}

/// Returns a power of ten of a coherent SI unit, which takes prefixes.
const fn decimal_multiple(name: &'static str, exponent: i32, dimension: [i32; BASES]) -> NamedUnit {
    NamedUnit { prefixes: PrefixRule::Taken, ..unit(name, 1.0, exponent, dimension) }
}

/// Returns a unit of mass, whose name also stands for the weight of that mass under standard gravity.
const fn mass(name: &'static str, factor: f64, exponent: i32) -> NamedUnit {
    let weight = UnitMeaning { factor: factor * STANDARD_GRAVITY, exponent, dimension: FORCE };
    NamedUnit { weight: Some(weight), ..unit(name, factor, exponent, base(0, 1, 0, 0)) }
}

const FORCE: [i32; BASES] = base(1, 1, -2, 0);
const ANGLE: [i32; BASES] = [0, 0, 0, 0, 0, 1, 0, 0, 0, 0];
const CYCLES: [i32; BASES] = [0, 0, -1, 0, 0, 0, 1, 0, 0, 0];
const BIT: [i32; BASES] = [0, 0, 0, 0, 0, 0, 0, 1, 0, 0];
const COUNT: [i32; BASES] = [0, 0, 0, 0, 0, 0, 0, 0, 1, 0];
const DECIBEL: [i32; BASES] = [0, 0, 0, 0, 0, 0, 0, 0, 0, 1];

/// Standard acceleration of gravity, m/s^2 (ISO 80000-4).
const STANDARD_GRAVITY: f64 = 9.80665;
/// Avoirdupois pound, kg (exact by definition), as a whole number with a power of ten.
const POUND: (f64, i32) = (45_359_237.0, -8);
/// Avoirdupois ounce, kg: a sixteenth of a pound.
const OUNCE: (f64, i32) = (28_349_523_125.0, -12);

/// Every unit. Definitions are those of the SI brochure (9th edition) and of NIST Special Publication 811.
pub const UNITS: &[NamedUnit] = &[
    unit("1", 1.0, 0, base(0, 0, 0, 0)),
    unit("%", 1.0, -2, base(0, 0, 0, 0)),
    unit("percent", 1.0, -2, base(0, 0, 0, 0)),
    unit("ppm", 1.0, -6, base(0, 0, 0, 0)),
    unit("sample", 1.0, 0, base(0, 0, 0, 0)),
    unit("samples", 1.0, 0, base(0, 0, 0, 0)),
    si("m", base(1, 0, 0, 0)),
    unit("in", 254.0, -4, base(1, 0, 0, 0)),
    unit("inch", 254.0, -4, base(1, 0, 0, 0)),
    unit("inches", 254.0, -4, base(1, 0, 0, 0)),
    unit("micron", 1.0, -6, base(1, 0, 0, 0)),
    unit("microns", 1.0, -6, base(1, 0, 0, 0)),
    unit("ft", 3048.0, -4, base(1, 0, 0, 0)),
    unit("foot", 3048.0, -4, base(1, 0, 0, 0)),
    unit("feet", 3048.0, -4, base(1, 0, 0, 0)),
    unit("cc", 1.0, -6, base(3, 0, 0, 0)),
    decimal_multiple("l", -3, base(3, 0, 0, 0)),
    decimal_multiple("L", -3, base(3, 0, 0, 0)),
    unit("litre", 1.0, -3, base(3, 0, 0, 0)),
    unit("liter", 1.0, -3, base(3, 0, 0, 0)),
    NamedUnit {
        prefixes: PrefixRule::Taken,
        weight: Some(UnitMeaning { factor: STANDARD_GRAVITY, exponent: 0, dimension: base(1, 0, -2, 0) }),
        ..unit("g", 1.0, -3, base(0, 1, 0, 0))
    },
    mass("kg", 1.0, 0),
    mass("lb", POUND.0, POUND.1),
    mass("lbs", POUND.0, POUND.1),
    mass("oz", OUNCE.0, OUNCE.1),
    unit("lbm", POUND.0, POUND.1, base(0, 1, 0, 0)),
    unit("slug", 14.593_902_937_206_364, 0, base(0, 1, 0, 0)),
    unit("t", 1.0, 3, base(0, 1, 0, 0)),
    si("s", base(0, 0, 1, 0)),
    si("sec", base(0, 0, 1, 0)),
    unit("second", 1.0, 0, base(0, 0, 1, 0)),
    unit("seconds", 1.0, 0, base(0, 0, 1, 0)),
    unit("min", 60.0, 0, base(0, 0, 1, 0)),
    unit("h", 3600.0, 0, base(0, 0, 1, 0)),
    si("rad", ANGLE),
    unit("deg", PI / 180.0, 0, ANGLE),
    unit("degree", PI / 180.0, 0, ANGLE),
    unit("degrees", PI / 180.0, 0, ANGLE),
    unit("°", PI / 180.0, 0, ANGLE),
    unit("arcmin", PI / 10_800.0, 0, ANGLE),
    unit("arcminute", PI / 10_800.0, 0, ANGLE),
    unit("arcminutes", PI / 10_800.0, 0, ANGLE),
    unit("arcsec", PI / 648_000.0, 0, ANGLE),
    unit("arcsecond", PI / 648_000.0, 0, ANGLE),
    unit("arcseconds", PI / 648_000.0, 0, ANGLE),
    unit("gon", PI / 200.0, 0, ANGLE),
    unit("rev", 2.0 * PI, 0, ANGLE),
    unit("revs", 2.0 * PI, 0, ANGLE),
    unit("r", 2.0 * PI, 0, ANGLE),
    unit("turn", 2.0 * PI, 0, ANGLE),
    unit("turns", 2.0 * PI, 0, ANGLE),
    NamedUnit { prefixes: PrefixRule::Taken, ..unit("rpm", PI / 30.0, 0, [0, 0, -1, 0, 0, 1, 0, 0, 0, 0]) },
    NamedUnit { prefixes: PrefixRule::Taken, ..unit("RPM", PI / 30.0, 0, [0, 0, -1, 0, 0, 1, 0, 0, 0, 0]) },
    unit("rps", 2.0 * PI, 0, [0, 0, -1, 0, 0, 1, 0, 0, 0, 0]),
    unit("dps", PI / 180.0, 0, [0, 0, -1, 0, 0, 1, 0, 0, 0, 0]),
    si("Hz", CYCLES),
    unit("hertz", 1.0, 0, CYCLES),
    si("N", FORCE),
    unit("lbf", 4.448_221_615_260_5, 0, FORCE),
    unit("ozf", 0.278_013_850_953_781_2, 0, FORCE),
    unit("kgf", STANDARD_GRAVITY, 0, FORCE),
    unit("gf", STANDARD_GRAVITY, -3, FORCE),
    unit("dyn", 1.0, -5, FORCE),
    unit("dyne", 1.0, -5, FORCE),
    unit("dynes", 1.0, -5, FORCE),
    si("Nm", base(2, 1, -2, 0)),
    si("Pa", base(-1, 1, -2, 0)),
    si("bar", [-1, 1, -2, 0, 0, 0, 0, 0, 0, 0]).times_ten(5),
    unit("psi", 6_894.757_293_168_361, 0, base(-1, 1, -2, 0)),
    si("J", base(2, 1, -2, 0)),
    si("W", base(2, 1, -3, 0)),
    unit("hp", 745.699_871_582_270_2, 0, base(2, 1, -3, 0)),
    si("A", base(0, 0, 0, 1)),
    unit("amp", 1.0, 0, base(0, 0, 0, 1)),
    unit("amps", 1.0, 0, base(0, 0, 0, 1)),
    si("V", base(2, 1, -3, -1)),
    unit("volt", 1.0, 0, base(2, 1, -3, -1)),
    unit("volts", 1.0, 0, base(2, 1, -3, -1)),
    si("ohm", base(2, 1, -3, -2)),
    si("ohms", base(2, 1, -3, -2)),
    si("Ohm", base(2, 1, -3, -2)),
    si("Ohms", base(2, 1, -3, -2)),
    si("Ω", base(2, 1, -3, -2)),
    // The sign of the ohm, which looks the same as the Greek letter.
    si("\u{2126}", base(2, 1, -3, -2)),
    si("H", base(2, 1, -2, -2)),
    si("F", base(-2, -1, 4, 2)),
    si("C", base(0, 0, 1, 1)),
    si("Wb", base(2, 1, -2, -1)),
    si("T", base(0, 1, -2, -1)),
    si("K", [0, 0, 0, 0, 1, 0, 0, 0, 0, 0]),
    unit("g0", STANDARD_GRAVITY, 0, base(1, 0, -2, 0)),
    unit("bit", 1.0, 0, BIT),
    unit("bits", 1.0, 0, BIT),
    unit("count", 1.0, 0, COUNT),
    unit("counts", 1.0, 0, COUNT),
    unit("step", 1.0, 0, COUNT),
    unit("steps", 1.0, 0, COUNT),
    unit("cpr", 0.5 / PI, 0, [0, 0, 0, 0, 0, -1, 0, 0, 1, 0]),
    unit("CPR", 0.5 / PI, 0, [0, 0, 0, 0, 0, -1, 0, 0, 1, 0]),
    unit("dB", 1.0, 0, DECIBEL),
];

impl NamedUnit {
    const fn times_ten(mut self, power: i32) -> Self {
        self.meaning.exponent += power;
        self
    }
}

/// Words that a prefix and a unit make by chance: a Grad is a degree in German.
const OTHER_WORDS: [&str; 1] = ["Grad"];

/// Returns the unit of a name with or without prefix, and the power of ten of the prefix; `None` if no unit has the name.
pub fn find_named_unit(name: &str) -> Option<(&'static NamedUnit, i32)> {
    if OTHER_WORDS.contains(&name) {
        return None;
    }
    let exact = UNITS.iter().find(|unit| unit.name == name).map(|unit| (unit, 0));
    let prefixed = || {
        PREFIXES.iter().find_map(|(prefix, power)| {
            let rest = name.strip_prefix(prefix)?;
            let takes = |unit: &&NamedUnit| unit.prefixes == PrefixRule::Taken && unit.name == rest;
            UNITS.iter().find(takes).map(|unit| (unit, *power))
        })
    };
    exact.or_else(prefixed)
}
