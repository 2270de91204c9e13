//! Single precision.

use counterpoise_controller::program::{Operation, ProgramTerm, Slot};
use counterpoise_controller::{Controller, Number, Runner};

use super::{
    Arithmetic, Deviation, ExecutedOperation, Line, OperationRounding, deviation, is_kept, setting_errors,
    state_increment, to_grid,
};
use crate::Ranges;
use crate::ranges::{Run, RunState, RunVisitor, play_runs};
use crate::tolerance::SMALL_SUMMAND;

/// Half a unit in the last place of single precision, relative.
const UNIT: f64 = 1.0 / (1u64 << 24) as f64;
/// Roundings that a gain or bias has behind it when the out-of-balance has been set.
const KEPT_ROUNDINGS: f64 = 3.0;

/// Returns how far the controller in single precision can be from the reference over a run of `samples` samples in these
/// ranges.
///
/// The errors of an operation bound the rounding of its products and partial sums (Higham 2002, chapter 3). The worst case
/// takes every number at the end of its range and lets every rounding of the run go the same way, which an integrator never
/// forgets: it is safe, and far away. The likely bound takes the runs of `ranges`: what rounded coefficients do is measured
/// there, in arithmetic that rounds nothing else; half a unit in the last place is taken of the number that is rounded, at
/// the time when it is.
pub fn single_precision(controller: &Controller, ranges: &Ranges, samples: usize) -> Deviation {
    deviation(controller, ranges, &SinglePrecision { controller, ranges }, samples)
}

/// Errors in single precision.
struct SinglePrecision<'a> {
    controller: &'a Controller,
    ranges: &'a Ranges,
}

impl Arithmetic for SinglePrecision<'_> {
    fn worst_errors(&self) -> Vec<f64> {
        let operations = self.controller.programs().step.operations();
        let own = operations
            .map(|operation| UNIT * (self.magnitudes(operation) + self.rounded_magnitudes(operation)));
        let mut worst: Vec<f64> = own.zip(self.setting_errors()).map(|(own, left)| own + left).collect();
        worst.extend(
            (0..self.controller.parts().reading_count()).map(|i| UNIT * self.ranges.of(Slot::Input(i))),
        );
        worst
    }

    fn coefficients(&self, runs: &[Run]) -> Vec<Vec<f64>> {
        play_runs(runs, &StoredCoefficients(self.controller))
            .into_iter()
            .map(|state| state.voltages_v)
            .collect()
    }

    fn stored_reading(&self, value: f64) -> f64 {
        f64::from(value as f32)
    }

    fn rounding_of(&self, _: Line, executed: &ExecutedOperation<'_>) -> OperationRounding {
        let ExecutedOperation { operation, read, written: value, .. } = *executed;
        let square = match operation {
            Operation::Sum { constant, terms, .. } => sum(*constant, terms, read),
            Operation::Product { .. } if read.iter().any(|one| is_power_of_two(*one)) => 0.0,
            Operation::Product { .. } | Operation::Quotient { .. } => half_unit(value).powi(2),
            Operation::Magnitude { .. } | Operation::Clamp { .. } => 0.0,
        };
        let known = match operation {
            Operation::Sum { constant, terms, .. } if square > 0.0 => {
                let is_increment = state_increment(operation, read).is_some();
                let summands = constant.iter().copied().chain(products(terms, read).skip(1));
                if is_increment { summands_on_grid(summands, value) } else { 0.0 }
            }
            _ => 0.0,
        };
        OperationRounding { known, square }
    }
}

/// The controller with coefficients in single precision, and how far its control was from the reference's, V.
struct StoredCoefficients<'a>(&'a Controller);

impl RunVisitor<RunState<Runner<StoredNumber>>> for StoredCoefficients<'_> {
    fn start(&self) -> RunState<Runner<StoredNumber>> {
        RunState::of(self.0.runner_in::<StoredNumber>())
    }

    fn set(&self, state: &mut RunState<Runner<StoredNumber>>, out_of_balance_kg_m: f64) {
        state.acting.set_out_of_balance(out_of_balance_kg_m);
    }

    fn sample(&self, state: &mut RunState<Runner<StoredNumber>>, run: &Run, k: usize) {
        state.voltages_v.push(state.acting.step_array(&run.readings[k]) - run.reference_v[k]);
    }
}

impl SinglePrecision<'_> {
    /// Returns the error of each operation that comes from what a setting left wrong.
    fn setting_errors(&self) -> Vec<f64> {
        let error = |slot: &Slot| match is_kept(self.controller, *slot) {
            true => KEPT_ROUNDINGS * UNIT * self.ranges.of(*slot),
            false => 0.0,
        };
        setting_errors(self.controller, self.ranges, &error)
    }

    /// Returns the sum of the magnitudes that an operation rounds.
    fn magnitudes(&self, operation: &Operation) -> f64 {
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

    /// Returns the sum of the magnitudes whose stored coefficients or limits are rounded.
    fn rounded_magnitudes(&self, operation: &Operation) -> f64 {
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

/// Returns the products of a sum.
fn products<'a>(terms: &'a [ProgramTerm], read: &'a [f64]) -> impl Iterator<Item = f64> + Clone + 'a {
    terms.iter().zip(read).map(|(term, value)| term.coefficient * value)
}

/// Returns what rounding adds to the summands of a state that grows to a value: each is added by itself and rounded to the state's grid, so that a
/// constant one is rounded the same way in every sample whatever the others are. 0 if one of them is not small.
fn summands_on_grid(summands: impl Iterator<Item = f64> + Clone, value: f64) -> f64 {
    match summands.clone().all(|summand| SMALL_SUMMAND * summand.abs() < value.abs()) {
        true => summands.map(|summand| to_grid(summand, 2.0 * half_unit(value))).sum(),
        false => 0.0,
    }
}

/// Squared bounds of the roundings of products and partial sums. What is whole in single precision is not rounded.
fn sum(constant: Option<f64>, terms: &[ProgramTerm], read: &[f64]) -> f64 {
    let (mut partial, mut squares) = (constant.unwrap_or(0.0), 0.0);
    for (term, value) in terms.iter().zip(read) {
        let product = term.coefficient * value;
        if !is_power_of_two(term.coefficient) && !is_power_of_two(*value) {
            squares += half_unit(product).powi(2);
        }
        let next = partial + product;
        let exact = partial == 0.0 || product == 0.0 || [partial, product, next].into_iter().all(is_held);
        squares += if exact { 0.0 } else { half_unit(next).powi(2) };
        partial = next;
    }
    squares
}

/// Returns whether single precision holds a number as it is.
fn is_held(value: f64) -> bool {
    f64::from(value as f32) == value
}

/// Returns half a unit in the last place of the single-precision numbers around a value.
fn half_unit(value: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
    f64::from_bits(value.to_bits() & EXPONENT) * UNIT
}

/// Returns whether a product by this number is exact: 0 or a power of two.
fn is_power_of_two(value: f64) -> bool {
    const FRACTION: u64 = 0x000f_ffff_ffff_ffff;
    value.to_bits() & FRACTION == 0
}

/// A number in double that was stored in single precision: what [`Number::from_f64`] takes is rounded, arithmetic is not.
#[derive(Debug, Clone, Copy)]
struct StoredNumber(f64);

impl Number for StoredNumber {
    const FLUSHED_BELOW: f64 = 0.0;

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
    fn divide_by(&self, other: &Self) -> Self {
        Self(self.0 / other.0)
    }
    fn magnitude(&self) -> Self {
        Self(self.0.abs())
    }
    fn clamp_to(&self, low: &Self, high: &Self) -> Self {
        Self(self.0.max(low.0).min(high.0))
    }
}
