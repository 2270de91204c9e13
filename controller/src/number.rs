//! The arithmetic that a program runs in.

use crate::tolerance::{FLUSHED_DOUBLE, FLUSHED_SINGLE};

/// Numbers in which a program can run.
pub trait Number: Clone + std::fmt::Debug {
    /// Magnitude below which a kept number becomes 0: far below anything that matters, and far enough above the smallest
    /// normal number that a product with a coefficient is still a normal one. 0 for numbers that are never flushed.
    const FLUSHED_BELOW: f64;
    /// Returns the nearest number.
    fn from_f64(value: f64) -> Self;
    /// Returns its value in double.
    fn to_f64(&self) -> f64;
    /// Returns the sum, rounded.
    fn plus(&self, other: &Self) -> Self;
    /// Returns the product, rounded.
    fn times(&self, other: &Self) -> Self;
    /// Quotient, rounded.
    fn divide_by(&self, other: &Self) -> Self;
    /// Returns the magnitude, exact.
    fn magnitude(&self) -> Self;
    /// Returns the number if it lies between the limits, `high` if it is above, and `low` otherwise: also if it is not a
    /// number.
    fn clamp_to(&self, low: &Self, high: &Self) -> Self;
    /// Returns the number, or a 0 of its sign if its magnitude is below [`Number::FLUSHED_BELOW`].
    fn flush(&self) -> Self {
        if self.magnitude().to_f64() < Self::FLUSHED_BELOW {
            self.times(&Self::from_f64(0.0))
        } else {
            self.clone()
        }
    }
}

macro_rules! machine_number {
    ($t:ty, $tiny:expr) => {
        impl Number for $t {
            const FLUSHED_BELOW: f64 = $tiny;
            #[inline]
            fn from_f64(value: f64) -> Self {
                value as $t
            }
            #[inline]
            fn to_f64(&self) -> f64 {
                f64::from(*self)
            }
            #[inline]
            fn plus(&self, other: &Self) -> Self {
                self + other
            }
            #[inline]
            fn times(&self, other: &Self) -> Self {
                self * other
            }
            #[inline]
            fn divide_by(&self, other: &Self) -> Self {
                self / other
            }
            #[inline]
            fn magnitude(&self) -> Self {
                if *self < 0.0 { -*self } else { *self }
            }
            #[inline]
            fn clamp_to(&self, low: &Self, high: &Self) -> Self {
                if self >= low { if self <= high { *self } else { *high } } else { *low }
            }
        }
    };
}
machine_number!(f32, FLUSHED_SINGLE);
machine_number!(f64, FLUSHED_DOUBLE);

/// A value with its derivatives: forward differentiation of a program.
#[derive(Debug, Clone, PartialEq)]
pub struct Dual {
    /// Value.
    pub value: f64,
    /// Derivatives by the chosen variables; empty means all zero.
    pub slope: Vec<f64>,
}

impl Dual {
    fn blend(&self, p: f64, other: &Self, q: f64, value: f64) -> Self {
        let n = self.slope.len().max(other.slope.len());
        let at = |s: &[f64], i: usize| s.get(i).copied().unwrap_or(0.0);
        let slope = (0..n).map(|i| p * at(&self.slope, i) + q * at(&other.slope, i)).collect();
        Self { value, slope }
    }
}

impl Number for Dual {
    const FLUSHED_BELOW: f64 = 0.0;

    fn from_f64(value: f64) -> Self {
        Self { value, slope: Vec::new() }
    }

    fn to_f64(&self) -> f64 {
        self.value
    }

    fn plus(&self, other: &Self) -> Self {
        self.blend(1.0, other, 1.0, self.value + other.value)
    }

    fn times(&self, other: &Self) -> Self {
        self.blend(other.value, other, self.value, self.value * other.value)
    }

    fn divide_by(&self, other: &Self) -> Self {
        let value = self.value / other.value;
        self.blend(1.0 / other.value, other, -value / other.value, value)
    }

    /// Returns |x|; at 0, where it has no derivative, the derivative is taken as 0.
    fn magnitude(&self) -> Self {
        let sign = if self.value == 0.0 { 0.0 } else { self.value.signum() };
        let slope = self.slope.iter().map(|s| sign * s).collect();
        Self { value: self.value.abs(), slope }
    }

    fn clamp_to(&self, low: &Self, high: &Self) -> Self {
        if self.value >= low.value {
            if self.value <= high.value { self.clone() } else { high.clone() }
        } else {
            low.clone()
        }
    }
}
