//! Numbers of several mechanisms side by side in one register.

use counterpoise_models::friction::Real;
use pulp::{Simd, bytemuck};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub};

/// Mechanisms side by side: what a register of AVX2 holds.
pub(crate) const LANES: usize = 4;

/// A number of each mechanism, in memory.
pub(crate) type Lanes = [f64; LANES];

/// A number of each mechanism, in a register. An operation rounds in every lane as that of `f64` does.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lane<S: Simd> {
    simd: S,
    value: S::f64s,
}

/// The lanes in which a condition holds.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LaneMask<S: Simd> {
    simd: S,
    mask: S::m64s,
}

impl<S: Simd> Lane<S> {
    /// Returns the numbers in a register.
    #[inline(always)]
    pub fn new(simd: S, values: Lanes) -> Self {
        Self { simd, value: bytemuck::cast(values) }
    }

    /// Returns the same number in every lane.
    #[inline(always)]
    pub fn splat(simd: S, value: f64) -> Self {
        Self { simd, value: simd.splat_f64s(value) }
    }

    /// Returns the numbers as they are in memory.
    #[inline(always)]
    pub fn values(self) -> Lanes {
        bytemuck::cast(self.value)
    }

    /// Returns other numbers in a register.
    #[inline(always)]
    pub fn with_values(self, values: Lanes) -> Self {
        Self::new(self.simd, values)
    }

    /// Returns what a function makes of each number, one after the other.
    #[inline(always)]
    pub fn map_each(self, function: impl Fn(f64) -> f64) -> Self {
        Self::new(self.simd, self.values().map(function))
    }

    /// Returns where the number is below another.
    #[inline(always)]
    pub fn is_below(self, other: Self) -> LaneMask<S> {
        other.is_above(self)
    }

    /// Returns where the number is at most another.
    #[inline(always)]
    pub fn is_at_most(self, other: Self) -> LaneMask<S> {
        other.is_at_least(self)
    }
}

/// Returns numbers in registers. Loops, not closures, handle registers here and in what follows: a closure is compiled without them unless
/// it is inlined.
#[inline(always)]
pub(crate) fn load_registers<S: Simd, const N: usize>(simd: S, values: &[Lanes; N]) -> [Lane<S>; N] {
    let mut registers = [Lane::splat(simd, 0.0); N];
    for k in 0..N {
        registers[k] = Lane::new(simd, values[k]);
    }
    registers
}

/// Returns numbers as they are in memory.
#[inline(always)]
pub(crate) fn store_registers<S: Simd, const N: usize>(registers: &[Lane<S>; N]) -> [Lanes; N] {
    let mut values = [[0.0; LANES]; N];
    for k in 0..N {
        values[k] = registers[k].values();
    }
    values
}

impl<S: Simd> LaneMask<S> {
    /// Returns whether the condition holds in no lane.
    #[inline(always)]
    pub fn is_nowhere(self) -> bool {
        self.simd.first_true_m64s(self.mask) >= LANES
    }

    /// Returns where the condition does not hold.
    #[inline(always)]
    pub fn invert(self) -> Self {
        Self {
            mask: self.simd.xor_m64s(self.mask, self.simd.equal_u64s(self.one_bits(), self.one_bits())),
            ..self
        }
    }

    #[inline(always)]
    fn one_bits(self) -> S::u64s {
        self.simd.splat_u64s(1)
    }

    /// Returns the first number where the condition holds, and the other one elsewhere.
    #[inline(always)]
    pub fn select(self, first: Lane<S>, other: Lane<S>) -> Lane<S> {
        Lane { simd: self.simd, value: self.simd.select_f64s(self.mask, first.value, other.value) }
    }

    /// Writes a number where the condition holds.
    #[inline(always)]
    pub fn keep(self, place: &mut Lanes, value: Lane<S>) {
        *place = self.select(value, Lane::new(self.simd, *place)).values();
    }

    /// Returns lane by lane whether the condition holds.
    #[inline(always)]
    pub fn lanes(self) -> [bool; LANES] {
        let one = Lane::splat(self.simd, 1.0);
        self.select(one, Lane::splat(self.simd, 0.0)).values().map(|flag| flag != 0.0)
    }
}

impl<S: Simd> BitAnd for LaneMask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self { mask: self.simd.and_m64s(self.mask, other.mask), ..self }
    }
}

impl<S: Simd> BitOr for LaneMask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self { mask: self.simd.or_m64s(self.mask, other.mask), ..self }
    }
}

impl<S: Simd> Add for Lane<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { value: self.simd.add_f64s(self.value, other.value), ..self }
    }
}

impl<S: Simd> Sub for Lane<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { value: self.simd.sub_f64s(self.value, other.value), ..self }
    }
}

impl<S: Simd> Mul for Lane<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { value: self.simd.mul_f64s(self.value, other.value), ..self }
    }
}

impl<S: Simd> Div for Lane<S> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self { value: self.simd.div_f64s(self.value, other.value), ..self }
    }
}

impl<S: Simd> Neg for Lane<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: self.simd.neg_f64s(self.value), ..self }
    }
}

impl<S: Simd> Real for Lane<S> {
    type Mask = LaneMask<S>;

    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        Self::splat(self.simd, value)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self { value: self.simd.abs_f64s(self.value), ..self }
    }

    #[inline(always)]
    fn signum(self) -> Self {
        self.constant(1.0).copysign(self)
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        let simd = self.simd;
        let bit = simd.and_f64s(simd.splat_f64s(-0.0), sign.value);
        Self { value: simd.or_f64s(self.abs().value, bit), ..self }
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.is_below(other).select(self, other)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.is_above(other).select(self, other)
    }

    #[inline(always)]
    fn exp(self) -> Self {
        self.map_each(f64::exp)
    }

    #[inline(always)]
    fn tanh(self) -> Self {
        self.map_each(f64::tanh)
    }

    #[inline(always)]
    fn gaussian(self) -> Self {
        self.map_each(Real::gaussian)
    }

    #[inline(always)]
    fn powf(self, exponent: f64) -> Self {
        self.map_each(|value| value.powf(exponent))
    }

    #[inline(always)]
    fn is_zero(self) -> LaneMask<S> {
        let zero = self.simd.splat_f64s(0.0);
        LaneMask { simd: self.simd, mask: self.simd.equal_f64s(self.value, zero) }
    }

    #[inline(always)]
    fn is_above(self, other: Self) -> LaneMask<S> {
        LaneMask { simd: self.simd, mask: self.simd.less_than_f64s(other.value, self.value) }
    }

    #[inline(always)]
    fn is_at_least(self, other: Self) -> LaneMask<S> {
        LaneMask { simd: self.simd, mask: self.simd.less_than_or_equal_f64s(other.value, self.value) }
    }

    #[inline(always)]
    fn is_zero_throughout(self) -> bool {
        self.is_zero().invert().is_nowhere()
    }

    #[inline(always)]
    fn choose(mask: LaneMask<S>, first: Self, other: Self) -> Self {
        mask.select(first, other)
    }
}
