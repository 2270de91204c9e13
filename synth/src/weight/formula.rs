//! A weight as a formula.

use std::fmt;

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
                write!(f, "zero-pole-gain with {} zeros, {} poles, gain {gain}", zeros.len(), poles.len())
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
