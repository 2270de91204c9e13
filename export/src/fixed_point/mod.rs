//! The controller in 32-bit fixed point.
//!
//! Every number has its own Q format, chosen from the ranges of closed-loop runs with a margin. A sum is accumulated in
//! 64 bits at one common scale and narrowed once, rounding to nearest and saturating. That no accumulator can overflow is
//! proven by integer intervals over the whole step, for any state and any reading.

mod code;
mod error;
mod format;
mod guard;
mod plan;
mod prediction;
mod runner;
mod writer;

pub use code::fixed_c99;
pub use error::FixedError;
pub(crate) use format::{to_integer, unit};
pub use plan::plan_fixed_point;
pub use runner::FixedRunner;

use counterpoise_controller::program::Slot;
use counterpoise_controller::{Controller, READINGS};

use crate::rounding::Deviation;

/// Largest magnitude of a stored number.
pub const FULL: i64 = (1 << 31) - 1;
/// Accumulators stay below 2 to this power; the rounding half bit then fits as well.
pub const ACCUMULATOR_BITS: u32 = 62;

/// factor x slot, in integers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FixedTerm {
    /// Factor.
    pub factor: i64,
    /// Slot that the coefficient multiplies.
    pub of: Slot,
}

/// An operation on integers. Slots are those of the controller's program.
#[derive(Debug, Clone, PartialEq)]
pub enum FixedOperation {
    /// `into = narrow(constant + c1 a1 + c2 a2 + ..., shift)`.
    Sum {
        /// Target.
        into: Slot,
        /// Summand at the accumulator's scale.
        constant: i64,
        /// Other summands.
        terms: Vec<FixedTerm>,
        /// Bits dropped.
        shift: u32,
    },
    /// `into = narrow(a b, shift)`.
    Product {
        /// Target.
        into: Slot,
        /// First factor.
        a: Slot,
        /// Second factor.
        b: Slot,
        /// Bits dropped.
        shift: u32,
    },
    /// `into = narrow((above 2^left) / below, shift)`; the quotient is cut towards zero.
    Quotient {
        /// Target.
        into: Slot,
        /// Dividend.
        above: Slot,
        /// Divisor, never 0.
        below: Slot,
        /// Bits the dividend is moved up.
        left: u32,
        /// Bits dropped.
        shift: u32,
    },
    /// `into = |of|`.
    Magnitude {
        /// Target.
        into: Slot,
        /// Operand.
        of: Slot,
    },
    /// `into = low if of < low, else high if of > high, else of`.
    Clamp {
        /// Target.
        into: Slot,
        /// Operand.
        of: Slot,
        /// Lower limit.
        low: i64,
        /// Upper limit.
        high: i64,
    },
}

/// A controller in fixed point.
#[derive(Debug, Clone, PartialEq)]
pub struct FixedPointController {
    /// The controller.
    pub controller: Controller,
    /// Fraction bits of the states.
    pub states: Vec<i32>,
    /// The states at the start.
    pub initial: Vec<i64>,
    /// One sample.
    pub step: FixedProgram,
    /// Setting of the out-of-balance.
    pub set_out_of_balance: FixedProgram,
    /// Largest deviation of the control from the reference.
    pub deviation: Deviation,
}

/// A program on integers, with the format of each of its slots.
#[derive(Debug, Clone, PartialEq)]
pub struct FixedProgram {
    /// Fraction bits of the inputs: real = integer x 2^-bits.
    pub inputs: Vec<i32>,
    /// Fraction bits of the locals.
    pub locals: Vec<i32>,
    /// Operations in order, one for each of the controller's program.
    pub operations: Vec<FixedOperation>,
}

impl FixedProgram {
    /// Returns readings as integers in the formats of the inputs; 0 for one that the program does not take.
    pub fn integers(&self, readings: &[f64; READINGS]) -> [i64; READINGS] {
        std::array::from_fn(|i| self.inputs.get(i).map_or(0, |bits| to_integer(readings[i], *bits)))
    }
}

/// Returns floor(value / 2^shift + 1/2), kept within +/- [`FULL`].
pub fn round_and_limit(value: i64, shift: u32) -> i64 {
    let half = if shift > 0 { 1_i64 << (shift - 1) } else { 0 };
    ((value + half) >> shift).clamp(-FULL, FULL)
}
