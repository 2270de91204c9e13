//! Units as headers write them: products and quotients of named units with prefixes, to SI.

/// A unit: its size in SI, and its dimensions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// SI value of one unit.
    pub factor: f64,
    /// Exponents of metre, kilogram, second, ampere, radian, kelvin.
    pub dimension: [i32; 6],
}

/// Name, size and dimensions of a unit that takes prefixes.
const PREFIXED: &[(&str, f64, [i32; 6])] = &[
    ("rad", 1.0, [0, 0, 0, 0, 1, 0]),
    ("ohm", 1.0, [2, 1, -3, -2, 0, 0]),
    ("Hz", 1.0, [0, 0, -1, 0, 0, 0]),
    ("Pa", 1.0, [-1, 1, -2, 0, 0, 0]),
    ("m", 1.0, [1, 0, 0, 0, 0, 0]),
    ("s", 1.0, [0, 0, 1, 0, 0, 0]),
    ("A", 1.0, [0, 0, 0, 1, 0, 0]),
    ("V", 1.0, [2, 1, -3, -1, 0, 0]),
    ("N", 1.0, [1, 1, -2, 0, 0, 0]),
    ("W", 1.0, [2, 1, -3, 0, 0, 0]),
    ("H", 1.0, [2, 1, -2, -2, 0, 0]),
    ("K", 1.0, [0, 0, 0, 0, 0, 1]),
    ("g", STANDARD_GRAVITY, [1, 0, -2, 0, 0, 0]),
];

/// Units that take no prefix.
const PLAIN: &[(&str, f64, [i32; 6])] = &[
    ("1", 1.0, [0; 6]),
    ("count", 1.0, [0; 6]),
    ("counts", 1.0, [0; 6]),
    ("%", 0.01, [0; 6]),
    ("deg", std::f64::consts::PI / 180.0, [0, 0, 0, 0, 1, 0]),
    ("°", std::f64::consts::PI / 180.0, [0, 0, 0, 0, 1, 0]),
    ("rev", std::f64::consts::TAU, [0, 0, 0, 0, 1, 0]),
    ("rpm", std::f64::consts::TAU / 60.0, [0, 0, -1, 0, 1, 0]),
    ("arcmin", std::f64::consts::PI / 10_800.0, [0, 0, 0, 0, 1, 0]),
    ("arcsec", std::f64::consts::PI / 648_000.0, [0, 0, 0, 0, 1, 0]),
    ("kg", 1.0, [0, 1, 0, 0, 0, 0]),
    ("min", 60.0, [0, 0, 1, 0, 0, 0]),
    ("h", 3600.0, [0, 0, 1, 0, 0, 0]),
    ("Nm", 1.0, [2, 1, -2, 0, 0, 0]),
];

const PREFIXES: &[(&str, f64)] =
    &[("n", 1e-9), ("u", 1e-6), ("µ", 1e-6), ("μ", 1e-6), ("m", 1e-3), ("c", 1e-2), ("k", 1e3), ("M", 1e6)];

/// Standard acceleration of gravity, m/s^2: in recordings `g` means this, not the gram.
const STANDARD_GRAVITY: f64 = 9.80665;

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

fn find_unit(name: &str) -> Option<Unit> {
    let unit = |factor, dimension: &[i32; 6]| Unit { factor, dimension: *dimension };
    let exact = PLAIN.iter().chain(PREFIXED).find(|(known, ..)| *known == name);
    if let Some((_, factor, dimension)) = exact {
        return Some(unit(*factor, dimension));
    }
    PREFIXES.iter().find_map(|(prefix, scale)| {
        let rest = name.strip_prefix(prefix)?;
        let (_, factor, dimension) = PREFIXED.iter().find(|(known, ..)| *known == rest)?;
        Some(unit(scale * factor, dimension))
    })
}
