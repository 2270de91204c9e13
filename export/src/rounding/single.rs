//! Single precision.

use counterpoise_controller::program::{Compiled, Operation, Slot};
use counterpoise_controller::{Controller, Number, READINGS};

use super::{Arithmetic, Deviation, Effect, Gains, Noise, deviation, is_kept, left_wrong};
use crate::Ranges;
use crate::ranges::Run;

/// Half a unit in the last place of single precision, relative.
const UNIT: f64 = 1.0 / (1u64 << 24) as f64;
/// Roundings that a gain or bias has behind it when the out-of-balance has been set.
const KEPT_ROUNDINGS: f64 = 3.0;

/// How far the controller in single precision can be from the reference over a run of `samples` samples in these ranges.
///
/// The errors of an operation bound the rounding of its products and partial sums (Higham 2002, chapter 3). The worst case
/// takes every number at the end of its range and lets every rounding of the run go the same way, which an integrator never
/// forgets: it is safe, and far away. The likely bound takes the runs of `ranges`: what rounded coefficients do is measured
/// there, in arithmetic that rounds nothing else; half a unit in the last place is taken of the number that is rounded, at
/// the time when it is.
pub fn single_precision(controller: &Controller, ranges: &Ranges, samples: usize) -> Deviation {
    deviation(controller, ranges, &Single { controller, ranges }, samples)
}

/// Errors in single precision.
struct Single<'a> {
    controller: &'a Controller,
    ranges: &'a Ranges,
}

impl Arithmetic for Single<'_> {
    fn worst(&self) -> Vec<f64> {
        let operations = self.controller.programs().step.operations();
        let own = operations.map(|operation| UNIT * (self.rounded(operation) + self.stored(operation)));
        let mut worst: Vec<f64> = own.zip(self.kept()).map(|(own, kept)| own + kept).collect();
        worst.extend((0..READINGS).map(|i| UNIT * self.ranges.of(Slot::Input(i))));
        worst
    }

    fn kept(&self) -> Vec<f64> {
        let error = |slot: &Slot| match is_kept(self.controller, *slot) {
            true => KEPT_ROUNDINGS * UNIT * self.ranges.of(*slot),
            false => 0.0,
        };
        left_wrong(self.controller, self.ranges, &error)
    }

    fn coefficients(&self, run: &Run) -> Effect {
        let mut off = Vec::with_capacity(run.readings.len());
        let mut both = (self.controller.runner(), self.controller.runner_in::<Stored>());
        run.play(
            &mut both,
            |(runner, stored), value| {
                runner.set_out_of_balance(value);
                stored.set_out_of_balance(value);
            },
            |(runner, stored), _, readings| {
                off.push(stored.step_array(readings) - runner.step_array(readings))
            },
        );
        Effect::of(&off)
    }

    fn noise(&self, run: &Run, gains: &Gains) -> Noise {
        gains.noise(&squares(self.controller, run, gains.block))
    }
}

impl Single<'_> {
    /// Sum of the magnitudes that an operation rounds.
    fn rounded(&self, operation: &Operation) -> f64 {
        let size = |slot: Slot| self.ranges.of(slot);
        match operation {
            Operation::Sum { constant, terms, .. } => {
                let mut partial = constant.map_or(0.0, f64::abs);
                let mut all = 0.0;
                for (i, term) in terms.iter().enumerate() {
                    let product = term.coefficient.abs() * size(term.of);
                    partial += product;
                    all += if term.coefficient.abs() == 1.0 { 0.0 } else { product };
                    all += if i > 0 || constant.is_some() { partial } else { 0.0 };
                }
                all
            }
            Operation::Product { a, b, .. } => size(*a) * size(*b),
            Operation::Quotient { into, .. } => size(*into),
            Operation::Magnitude { .. } | Operation::Clamp { .. } => 0.0,
        }
    }

    /// Sum of the magnitudes whose stored coefficients or limits are rounded.
    fn stored(&self, operation: &Operation) -> f64 {
        match operation {
            Operation::Sum { constant, terms, .. } => {
                let stored = terms.iter().filter(|term| term.coefficient.abs() != 1.0);
                let each = stored.map(|term| term.coefficient.abs() * self.ranges.of(term.of));
                constant.map_or(0.0, f64::abs) + each.sum::<f64>()
            }
            Operation::Clamp { low, high, .. } => low.abs().max(high.abs()),
            _ => 0.0,
        }
    }
}

/// For each block of time the largest sum of squared half units in the last place that each operation rounds by.
fn squares(controller: &Controller, run: &Run, block: usize) -> Vec<Vec<f64>> {
    let programs = controller.programs();
    let n = programs.state_count();
    let step = Compiled::<Rounding>::new(&programs.step, n);
    let set = Compiled::<Rounding>::new(&programs.set_out_of_balance, n);
    let mut memory = vec![Rounding::from_f64(0.0); step.memory().max(set.memory())];
    for (place, value) in memory.iter_mut().zip(programs.initial()) {
        *place = Rounding::from_f64(value);
    }
    let errors = programs.step.operations().count() + READINGS;
    let mut blocks: Vec<Vec<f64>> = vec![vec![0.0; errors]; run.readings.len().div_ceil(block)];
    run.play(
        &mut memory,
        |memory, value| {
            set.run_touched(memory, &[Rounding::from_f64(value)], |_, written| written.squares = 0.0);
        },
        |memory, k, readings| {
            let largest = &mut blocks[k / block];
            step.run_touched(memory, &readings.map(Rounding::from_f64), |number, written| {
                largest[number] = largest[number].max(written.squares);
                written.squares = 0.0;
            });
        },
    );
    blocks
}

/// A number in double that knows by how much single precision would have rounded on the way to it.
#[derive(Debug, Clone, Copy)]
struct Rounding {
    value: f64,
    squares: f64,
}

impl Rounding {
    fn rounded(value: f64, squares: f64) -> Self {
        let half = half_unit(value);
        Self { value, squares: squares + half * half }
    }
}

/// Half a unit in the last place of the single-precision numbers around a value.
fn half_unit(value: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
    f64::from_bits(value.to_bits() & EXPONENT) * UNIT
}

/// Whether a product by this number is exact: 0 or a power of two.
fn is_power_of_two(value: f64) -> bool {
    const FRACTION: u64 = 0x000f_ffff_ffff_ffff;
    value.to_bits() & FRACTION == 0
}

impl Number for Rounding {
    fn from_f64(value: f64) -> Self {
        Self { value, squares: 0.0 }
    }
    fn to_f64(&self) -> f64 {
        self.value
    }
    fn plus(&self, other: &Self) -> Self {
        let (value, squares) = (self.value + other.value, self.squares + other.squares);
        match self.value == 0.0 || other.value == 0.0 {
            true => Self { value, squares },
            false => Self::rounded(value, squares),
        }
    }
    fn times(&self, other: &Self) -> Self {
        let value = self.value * other.value;
        match is_power_of_two(self.value) || is_power_of_two(other.value) {
            true => Self::from_f64(value),
            false => Self::rounded(value, 0.0),
        }
    }
    fn over(&self, other: &Self) -> Self {
        Self::rounded(self.value / other.value, 0.0)
    }
    fn magnitude(&self) -> Self {
        Self { value: self.value.abs(), ..*self }
    }
    fn clamped(&self, low: &Self, high: &Self) -> Self {
        Self { value: self.value.max(low.value).min(high.value), ..*self }
    }
}

/// A number in double that was stored in single precision: what [`Number::from_f64`] takes is rounded, arithmetic is not.
#[derive(Debug, Clone, Copy)]
struct Stored(f64);

impl Number for Stored {
    fn from_f64(value: f64) -> Self {
        Self(f64::from(value as f32))
    }
    fn to_f64(&self) -> f64 {
        self.0
    }
    fn plus(&self, other: &Self) -> Self {
        Self(self.0 + other.0)
    }
    fn times(&self, other: &Self) -> Self {
        Self(self.0 * other.0)
    }
    fn over(&self, other: &Self) -> Self {
        Self(self.0 / other.0)
    }
    fn magnitude(&self) -> Self {
        Self(self.0.abs())
    }
    fn clamped(&self, low: &Self, high: &Self) -> Self {
        Self(self.0.max(low.0).min(high.0))
    }
}
