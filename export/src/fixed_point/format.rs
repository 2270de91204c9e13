//! Formats of integers, and the intervals in which they lie.

use crate::fixed_point::{ACCUMULATOR_BITS, FULL};

/// Fraction bits with which +/- `largest` just fits 32 bits.
pub(crate) fn bits_for(largest: f64) -> i32 {
    ((FULL as f64) / largest).log2().floor().clamp(-64.0, 96.0) as i32
}

/// Returns the real value of one.
pub(crate) fn unit(bits: i32) -> f64 {
    f64::from(-bits).exp2()
}

/// Returns the nearest integer, saturated.
pub(crate) fn to_integer(value: f64, bits: i32) -> i64 {
    (value * f64::from(bits).exp2()).round().clamp(-(FULL as f64), FULL as f64) as i64
}

/// Integers from `low` to `high`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    pub low: i128,
    pub high: i128,
}

pub(crate) const ALL: Span = Span { low: -(FULL as i128), high: FULL as i128 };

impl Span {
    pub fn times(self, other: Self) -> Self {
        let corners =
            [self.low * other.low, self.low * other.high, self.high * other.low, self.high * other.high];
        let (mut low, mut high) = (corners[0], corners[0]);
        for corner in corners {
            low = low.min(corner);
            high = high.max(corner);
        }
        Self { low, high }
    }

    pub fn scale(self, by: i128) -> Self {
        self.times(Self { low: by, high: by })
    }

    pub fn plus(self, other: Self) -> Self {
        Self { low: self.low + other.low, high: self.high + other.high }
    }

    pub fn size(self) -> i128 {
        self.low.abs().max(self.high.abs())
    }

    /// Returns the distance from 0; not positive where 0 lies inside.
    pub fn distance_from_zero(self) -> i128 {
        self.low.max(-self.high)
    }

    pub fn square(self) -> Self {
        let low = self.distance_from_zero().max(0);
        Self { low: low * low, high: self.size() * self.size() }
    }

    pub fn shift_right(self, shift: u32) -> Self {
        let half = if shift > 0 { 1_i128 << (shift - 1) } else { 0 };
        let down = |value: i128| ((value + half) >> shift).clamp(ALL.low, ALL.high);
        Self { low: down(self.low), high: down(self.high) }
    }

    pub fn fits(self) -> bool {
        self.size() < 1_i128 << ACCUMULATOR_BITS
    }
}
