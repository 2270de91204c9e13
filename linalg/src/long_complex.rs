//! Complex numbers of 32 digits.

use std::ops::{Add, Div, Mul, Sub};

use crate::long_matrix::LongReal;
use crate::mat::C64;

/// A complex number of 32 digits.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LongComplex {
    pub(crate) re: LongReal,
    pub(crate) im: LongReal,
}

impl LongComplex {
    /// Returns a number of a double's digits.
    pub(crate) fn of(value: C64) -> Self {
        Self { re: value.re.into(), im: value.im.into() }
    }

    /// Returns the nearest number of a double's digits.
    pub(crate) fn round(self) -> C64 {
        C64::new(self.re.high + self.re.low, self.im.high + self.im.low)
    }

    /// Returns whether it is 0.
    pub(crate) fn is_zero(self) -> bool {
        self.re.high == 0.0 && self.im.high == 0.0
    }

    /// Returns its modulus to a double's digits.
    pub(crate) fn size(self) -> f64 {
        self.re.high.hypot(self.im.high)
    }

    /// Returns its product with a real number.
    pub(crate) fn times(self, factor: f64) -> Self {
        let factor = LongReal::from(factor);
        Self { re: self.re * factor, im: self.im * factor }
    }
}

impl Add for LongComplex {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Sub for LongComplex {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Mul for LongComplex {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }
}

impl Div for LongComplex {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        // The divisor is brought to size one first, so that its square neither overflows nor vanishes.
        let power = (-other.size().log2().round()).clamp(-1000.0, 1000.0).exp2();
        let scaled = |x: LongReal| LongReal { high: x.high * power, low: x.low * power };
        let other = Self { re: scaled(other.re), im: scaled(other.im) };
        let square = other.re * other.re + other.im * other.im;
        let top = self * Self { re: other.re, im: -other.im };
        let out = |x: LongReal| scaled(x / square);
        Self { re: out(top.re), im: out(top.im) }
    }
}
