//! The numbers in which the laws are evaluated: those of one mechanism, or of several side by side.

use crate::tolerance::SPENT;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number, or one for each of several mechanisms ("lanes").
///
/// Every operation rounds as that of `f64` does, lane by lane, so that a law gives the same bits for a mechanism alone and among
/// others. Nothing is contracted to a fused multiplication and addition.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// The lanes in which a condition holds.
    type Mask: Copy;

    /// Returns a constant, in every lane.
    fn constant(self, value: f64) -> Self;
    /// Returns the magnitude.
    fn abs(self) -> Self;
    /// Returns 1 with the sign of the number.
    fn signum(self) -> Self;
    /// Returns the magnitude of the number with the sign of another.
    fn copysign(self, sign: Self) -> Self;
    /// Returns the smaller of two numbers.
    fn min(self, other: Self) -> Self;
    /// Returns the larger of two numbers.
    fn max(self, other: Self) -> Self;
    /// Returns the exponential function.
    fn exp(self) -> Self;
    /// Returns the hyperbolic tangent.
    fn tanh(self) -> Self;
    /// Returns exp(-x^2), and 0 if it no longer changes a sum: libraries are slow where an exponential underflows.
    fn gaussian(self) -> Self;
    /// Returns the power with an exponent.
    fn powf(self, exponent: f64) -> Self;
    /// Returns where the number is 0.
    fn is_zero(self) -> Self::Mask;
    /// Returns where the number is larger than another.
    fn is_above(self, other: Self) -> Self::Mask;
    /// Returns where the number is at least another.
    fn is_at_least(self, other: Self) -> Self::Mask;
    /// Returns whether the number is 0 in every lane.
    fn is_zero_throughout(self) -> bool;
    /// Returns `first` where the mask holds, and `other` elsewhere.
    fn choose(mask: Self::Mask, first: Self, other: Self) -> Self;
}

impl Real for f64 {
    type Mask = bool;

    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self::abs(self)
    }

    #[inline(always)]
    fn signum(self) -> Self {
        Self::signum(self)
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Self::copysign(self, sign)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::min(self, other)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::max(self, other)
    }

    #[inline(always)]
    fn exp(self) -> Self {
        Self::exp(self)
    }

    #[inline(always)]
    fn tanh(self) -> Self {
        Self::tanh(self)
    }

    #[inline(always)]
    fn gaussian(self) -> Self {
        if self > SPENT { 0.0 } else { (-self * self).exp() }
    }

    #[inline(always)]
    fn powf(self, exponent: f64) -> Self {
        Self::powf(self, exponent)
    }

    #[inline(always)]
    fn is_zero(self) -> bool {
        self == 0.0
    }

    #[inline(always)]
    fn is_above(self, other: Self) -> bool {
        self > other
    }

    #[inline(always)]
    fn is_at_least(self, other: Self) -> bool {
        self >= other
    }

    #[inline(always)]
    fn is_zero_throughout(self) -> bool {
        self == 0.0
    }

    #[inline(always)]
    fn choose(mask: Self::Mask, first: Self, other: Self) -> Self {
        if mask { first } else { other }
    }
}
