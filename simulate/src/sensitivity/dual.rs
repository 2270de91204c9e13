//! Numbers with their derivatives, in which the laws of friction are differentiated.

use counterpoise_models::friction::Real;
use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number and its derivatives over N variables. Where two branches meet, the derivative is that of the branch that gives the value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Dual<const N: usize> {
    pub value: f64,
    pub slope: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// Returns a constant.
    pub fn number(value: f64) -> Self {
        Self { value, slope: [0.0; N] }
    }

    /// Returns the variable of a place.
    pub fn variable(value: f64, place: usize) -> Self {
        Self { value, slope: from_fn(|k| f64::from(u8::from(k == place))) }
    }

    /// Returns the number that a function of given value and slope makes of this one.
    #[inline(always)]
    fn chain(self, value: f64, slope: f64) -> Self {
        Self { value, slope: self.slope.map(|own| if own == 0.0 { 0.0 } else { slope * own }) }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: from_fn(|k| self.slope[k] + other.slope[k]) }
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slope: from_fn(|k| self.slope[k] - other.slope[k]) }
    }
}

// the rule of the product has other signs in it
#[allow(clippy::suspicious_arithmetic_impl)]
impl<const N: usize> Mul for Dual<N> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let slope = from_fn(|k| self.slope[k] * other.value + self.value * other.slope[k]);
        Self { value: self.value * other.value, slope }
    }
}

// the rule of the quotient has other signs in it
#[allow(clippy::suspicious_arithmetic_impl)]
impl<const N: usize> Div for Dual<N> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let (value, per) = (self.value / other.value, other.value.recip());
        Self { value, slope: from_fn(|k| (self.slope[k] - value * other.slope[k]) * per) }
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: -self.value, slope: self.slope.map(|own| -own) }
    }
}

impl<const N: usize> Real for Dual<N> {
    type Mask = bool;

    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        Self::number(value)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.chain(self.value.abs(), self.value.signum())
    }

    #[inline(always)]
    fn signum(self) -> Self {
        Self::number(self.value.signum())
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        let value = self.value.copysign(sign.value);
        self.chain(value, self.value.signum() * value.signum())
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if other.value < self.value { other } else { self }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if other.value > self.value { other } else { self }
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let value = self.value.exp();
        self.chain(value, value)
    }

    #[inline(always)]
    fn tanh(self) -> Self {
        let value = self.value.tanh();
        self.chain(value, 1.0 - value * value)
    }

    #[inline(always)]
    fn gaussian(self) -> Self {
        let value = Real::gaussian(self.value);
        self.chain(value, -2.0 * self.value * value)
    }

    /// Returns the power; at 0, where a power below one has no slope, the slope is taken as 0.
    #[inline(always)]
    fn powf(self, exponent: f64) -> Self {
        let slope = if self.value == 0.0 { 0.0 } else { exponent * self.value.powf(exponent - 1.0) };
        self.chain(self.value.powf(exponent), slope)
    }

    #[inline(always)]
    fn is_zero(self) -> bool {
        self.value == 0.0
    }

    #[inline(always)]
    fn is_above(self, other: Self) -> bool {
        self.value > other.value
    }

    #[inline(always)]
    fn is_at_least(self, other: Self) -> bool {
        self.value >= other.value
    }

    /// Returns whether the number stays 0 whatever the variables do.
    #[inline(always)]
    fn is_zero_throughout(self) -> bool {
        self.value == 0.0 && self.slope == [0.0; N]
    }

    #[inline(always)]
    fn choose(mask: Self::Mask, first: Self, other: Self) -> Self {
        if mask { first } else { other }
    }
}
