//! A weight as a formula.

use std::fmt;

use counterpoise_linalg::C64;

use crate::weight::Weight;

impl fmt::Display for Weight {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Weight::Constant { gain } => write!(f, "{gain}"),
            Weight::Integral { gain, time_s } => write!(f, "{gain} / ({time_s} s)"),
            Weight::Lag { gain, time_s } => write!(f, "{gain} / ({time_s} s + 1)"),
            Weight::Lead { gain, time_s } => write!(f, "{gain} ({time_s} s + 1)"),
            Weight::Quadratic { gain, second_s2, first_s } => {
                write!(f, "{gain} ({second_s2} s^2 + {first_s} s + 1)")
            }
            Weight::QuadraticFreeAtZero { gain, second_s2, first_s } => {
                write!(f, "{gain} ({second_s2} s^2 + {first_s} s)")
            }
            Weight::ZeroPoleGain { zeros, poles, gain } => {
                let (above, below) = (factors(zeros), factors(poles));
                let below = if below.is_empty() { below } else { format!(" / ({below})") };
                write!(f, "{} {above}{below}", round_digits(*gain))
            }
            Weight::Shelf { low, high, corner_rad_s } => {
                write!(f, "shelf from {low} to {high} at {corner_rad_s} rad/s")
            }
            Weight::Notch { gain, centre_rad_s, factor, .. } => {
                write!(f, "{gain}, times {factor} near {centre_rad_s} rad/s")
            }
            Weight::Product(parts) => {
                let texts: Vec<String> = parts.iter().map(ToString::to_string).collect();
                write!(f, "({})", texts.join(") ("))
            }
            Weight::Table { points, order, .. } => {
                let (count, off) = (points.len(), self.worst_db());
                write!(f, "table of {count} points, by a function of order {order} within {off:.2} dB")
            }
        }
    }
}

/// The product of the factors of roots: "s (s + 3) (s^2 + 0.4 s + 4)".
fn factors(roots: &[C64]) -> String {
    let of = |root: &C64| {
        let sign = |value: f64| if value < 0.0 { '-' } else { '+' };
        let (linear, constant) = (-2.0 * root.re, root.norm_sqr());
        match (root.norm() == 0.0, root.im == 0.0) {
            (true, _) => Some("s".to_owned()),
            (_, true) => Some(format!("(s {} {})", sign(-root.re), round_digits(root.re.abs()))),
            _ if root.im < 0.0 => None,
            _ => {
                let (linear_sign, linear) = (sign(linear), round_digits(linear.abs()));
                Some(format!("(s^2 {linear_sign} {linear} s + {})", round_digits(constant)))
            }
        }
    };
    roots.iter().filter_map(of).collect::<Vec<_>>().join(" ")
}

/// Four digits, as an engineer reads them.
fn round_digits(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
