//! From the operations of a program to integer ones, with the proof that nothing overflows.

use counterpoise_controller::Controller;
use counterpoise_controller::program::{Operation, Program, ProgramTerm, Slot};

use crate::Ranges;
use crate::fixed_point::format::{ALL, Span, bits_for, to_integer, unit};
use crate::fixed_point::{ACCUMULATOR_BITS, FixedError, FixedOperation, FixedProgram, FixedTerm};
use crate::tolerance::ACCUMULATOR_SHARE;

/// One operation's rounding.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct OperationError {
    /// Largest error of what the operation writes, that of rounded coefficients included.
    pub worst: f64,
    /// The part of its rounding that does not average out.
    pub steady: f64,
    /// The square of the bound of the part that does.
    pub squares: f64,
    /// Fraction bits of what is written.
    pub bits: i32,
}

impl OperationError {
    /// Returns the error of rounding to nearest.
    pub fn of_rounding(half: f64) -> Self {
        Self { worst: half, squares: half * half, ..Self::default() }
    }
}

/// Turns a program's operations into integer ones, one after the other.
pub(crate) struct Writer<'a> {
    controller: &'a Controller,
    program: &'a Program,
    states: &'a [i32],
    inputs: Vec<i32>,
    locals: Vec<i32>,
    spans: Vec<Span>,
    operations: Vec<FixedOperation>,
    pub errors: Vec<OperationError>,
}

impl<'a> Writer<'a> {
    pub fn new(
        controller: &'a Controller,
        program: &'a Program,
        states: &'a [i32],
        inputs: Vec<i32>,
    ) -> Self {
        let count = program.locals.len();
        let (locals, spans) = (vec![0; count], vec![ALL; count]);
        Self {
            controller,
            program,
            states,
            inputs,
            locals,
            spans,
            operations: Vec::new(),
            errors: Vec::new(),
        }
    }

    pub fn finish(self) -> FixedProgram {
        FixedProgram { inputs: self.inputs, locals: self.locals, operations: self.operations }
    }

    pub fn program(&self) -> FixedProgram {
        FixedProgram {
            inputs: self.inputs.clone(),
            locals: self.locals.clone(),
            operations: self.operations.clone(),
        }
    }

    /// Returns errors of the operations written.
    pub fn errors(&self) -> &[OperationError] {
        &self.errors
    }

    pub fn all(&mut self, largest: impl Fn(Slot) -> f64) -> Result<(), FixedError> {
        for operation in self.program.operations() {
            self.one(operation, largest(operation.into_slot()))?;
        }
        Ok(())
    }

    /// Returns the fraction bits of a slot.
    pub fn bits(&self, slot: Slot) -> i32 {
        match slot {
            Slot::Input(i) => self.inputs[i],
            Slot::State(i) => self.states[i],
            Slot::Local(i) => self.locals[i],
        }
    }

    fn span(&self, slot: Slot) -> Span {
        if let Slot::Local(i) = slot { self.spans[i] } else { ALL }
    }

    fn name(&self, slot: Slot) -> String {
        Ranges::name(self.controller, self.program, slot)
    }

    /// Returns the largest real magnitude that the integers of a slot can stand for.
    pub fn size(&self, slot: Slot) -> f64 {
        self.span(slot).size() as f64 * unit(self.bits(slot))
    }

    /// Returns the smallest real magnitude that the integers of a divisor can stand for.
    pub fn smallest_magnitude(&self, slot: Slot) -> f64 {
        self.span(slot).distance_from_zero() as f64 * unit(self.bits(slot))
    }

    /// Fraction bits of a target: a state's own; a local's from the runs, or where they leave it at 0 or above what
    /// intervals allow, from the intervals.
    fn target(&self, into: Slot, seen: f64, possible: f64) -> i32 {
        match into {
            Slot::Local(_) => {
                let largest = if seen > 0.0 { seen.min(possible) } else { possible };
                bits_for(largest.max(f64::MIN_POSITIVE))
            }
            _ => self.bits(into),
        }
    }

    fn put(&mut self, operation: FixedOperation, into: Slot, bits: i32, span: Span, error: OperationError) {
        if let Slot::Local(i) = into {
            self.locals[i] = bits;
            self.spans[i] = span;
        }
        self.operations.push(operation);
        self.errors.push(OperationError { bits, ..error });
    }

    fn one(&mut self, operation: &Operation, seen: f64) -> Result<(), FixedError> {
        match operation {
            Operation::Sum { into, constant, terms } => self.sum(*into, constant.unwrap_or(0.0), terms, seen),
            Operation::Product { into, a, b } => self.product(*into, *a, *b, seen),
            Operation::Quotient { into, above, below } => self.quotient(*into, *above, *below, seen),
            Operation::Magnitude { into, of } => {
                let (bits, span) = (self.bits(*of), Span { low: 0, high: self.span(*of).size() });
                let magnitude = FixedOperation::Magnitude { into: *into, of: *of };
                self.put(magnitude, *into, bits, span, OperationError::default());
                Ok(())
            }
            Operation::Clamp { into, of, low, high } => {
                self.clamp(*into, *of, *low, *high);
                Ok(())
            }
        }
    }

    fn clamp(&mut self, into: Slot, of: Slot, low: f64, high: f64) {
        let bits = self.bits(of);
        let (low, high) = (to_integer(low, bits), to_integer(high, bits));
        let within = |value: i128| value.clamp(i128::from(low), i128::from(high));
        let span = Span { low: within(self.span(of).low), high: within(self.span(of).high) };
        let clamp = FixedOperation::Clamp { into, of, low, high };
        self.put(clamp, into, bits, span, OperationError::default());
    }

    fn sum(&mut self, into: Slot, constant: f64, terms: &[ProgramTerm], seen: f64) -> Result<(), FixedError> {
        let sizes: Vec<f64> = terms.iter().map(|term| term.coefficient.abs() * self.size(term.of)).collect();
        let possible = constant.abs() + sizes.iter().sum::<f64>();
        let bits = self.target(into, seen, possible);
        let scale = self.accumulator(constant, terms);
        if scale < bits {
            return Err(FixedError::NoRoom { name: self.name(into), missing_bits: bits - scale });
        }
        let integer = |value: f64, bits: i32| (value * f64::from(bits).exp2()).round() as i64;
        let fixed =
            |t: &ProgramTerm| FixedTerm { factor: integer(t.coefficient, scale - self.bits(t.of)), of: t.of };
        let mut factors: Vec<FixedTerm> = terms.iter().map(fixed).collect();
        let mut start = integer(constant, scale);
        let mut worst = (constant - start as f64 * unit(scale)).abs();
        for (term, fixed) in terms.iter().zip(&factors) {
            let rounded = fixed.factor as f64 * unit(scale - self.bits(term.of));
            worst += (term.coefficient - rounded).abs() * self.size(term.of);
        }
        let spare = spare_bits(start, &factors).min((scale - bits) as u32);
        factors.iter_mut().for_each(|term| term.factor >>= spare.min(63));
        start >>= spare.min(63);
        let shift = (scale - bits) as u32 - spare;
        let (span, size) = self.accumulated_span(start, &factors);
        if size >= 1_i128 << ACCUMULATOR_BITS || shift > ACCUMULATOR_BITS {
            return Err(FixedError::NoRoom { name: self.name(into), missing_bits: 1 });
        }
        let rounding =
            if shift > 0 { OperationError::of_rounding(0.5 * unit(bits)) } else { OperationError::default() };
        let error = OperationError { worst: rounding.worst + worst, ..rounding };
        let sum = FixedOperation::Sum { into, constant: start, terms: factors, shift };
        self.put(sum, into, bits, span.shift_right(shift), error);
        Ok(())
    }

    /// Returns the finest scale, in fraction bits, at which all coefficients are 32-bit integers and the sum cannot
    /// overflow.
    fn accumulator(&self, constant: f64, terms: &[ProgramTerm]) -> i32 {
        let fitting = terms.iter().map(|t| bits_for(t.coefficient.abs()) + self.bits(t.of));
        let constant_bits = bits_for(constant.abs().max(f64::MIN_POSITIVE)) + 30;
        let mut scale = fitting.min().unwrap_or(constant_bits).min(constant_bits);
        let total = |scale: i32| {
            let each = terms.iter().map(|t| {
                let factor = (t.coefficient.abs() * f64::from(scale - self.bits(t.of)).exp2()).round() + 1.0;
                factor * self.span(t.of).size() as f64
            });
            each.sum::<f64>() + constant.abs() * f64::from(scale).exp2()
        };
        while total(scale) >= ACCUMULATOR_SHARE * f64::from(ACCUMULATOR_BITS).exp2() {
            scale -= 1;
        }
        scale
    }

    /// Returns what the sum can be, and a bound of all its partial sums.
    fn accumulated_span(&self, start: i64, factors: &[FixedTerm]) -> (Span, i128) {
        let start = Span { low: start.into(), high: start.into() };
        let each = factors.iter().map(|term| self.span(term.of).scale(term.factor.into()));
        each.fold((start, start.size()), |(sum, size), term| (sum.plus(term), size + term.size()))
    }

    fn product(&mut self, into: Slot, a: Slot, b: Slot, seen: f64) -> Result<(), FixedError> {
        let span = if a == b { self.span(a).square() } else { self.span(a).times(self.span(b)) };
        let both = self.bits(a) + self.bits(b);
        let bits = self.target(into, seen, self.size(a) * self.size(b)).min(both);
        if !span.fits() || self.cannot_take(into, bits) {
            return Err(FixedError::NoRoom { name: self.name(into), missing_bits: 1 });
        }
        let shift = (both - bits) as u32;
        let product = FixedOperation::Product { into, a, b, shift };
        self.put(product, into, bits, span.shift_right(shift), OperationError::of_rounding(0.5 * unit(bits)));
        Ok(())
    }

    /// Returns whether a state's own format differs from `bits`.
    fn cannot_take(&self, into: Slot, bits: i32) -> bool {
        !matches!(into, Slot::Local(_)) && self.bits(into) != bits
    }

    fn quotient(&mut self, into: Slot, above: Slot, below: Slot, seen: f64) -> Result<(), FixedError> {
        let nearest = self.span(below).distance_from_zero();
        if nearest <= 0 {
            return Err(self.divisor(into, below));
        }
        let possible = self.size(above) / (nearest as f64 * unit(self.bits(below)));
        let own = self.bits(above) - self.bits(below);
        let most = (ACCUMULATOR_BITS - 31) as i32 - 1;
        let bits = self.target(into, seen, possible).min(own + most);
        if self.cannot_take(into, bits) {
            return Err(FixedError::NoRoom { name: self.name(into), missing_bits: 1 });
        }
        let left = (bits - own).max(0) as u32;
        let shift = (own + left as i32 - bits) as u32;
        let size = (self.span(above).size() << left) / nearest;
        let span = Span { low: -size, high: size }.shift_right(shift);
        let quotient = FixedOperation::Quotient { into, above, below, left, shift };
        self.put(quotient, into, bits, span, cut(bits, shift));
        Ok(())
    }

    fn divisor(&self, into: Slot, below: Slot) -> FixedError {
        let (span, unit) = (self.span(below), unit(self.bits(below)));
        let (low, high) = (span.low as f64 * unit, span.high as f64 * unit);
        FixedError::Divisor { name: self.name(into), divisor: self.name(below), low, high }
    }
}

/// Returns the error of a quotient: it loses up to one unit before it is narrowed, always towards 0, and half a unit after.
fn cut(bits: i32, shift: u32) -> OperationError {
    let (before, after) = (unit(bits + shift as i32), if shift > 0 { 0.5 * unit(bits) } else { 0.0 });
    let squares = 0.25 * before * before + after * after;
    OperationError { worst: before + after, steady: 0.5 * before, squares, bits }
}

/// Trailing zeros that all the integers share: any number of them where all are 0.
fn spare_bits(start: i64, factors: &[FixedTerm]) -> u32 {
    let all = factors.iter().map(|term| term.factor).chain([start]).filter(|value| *value != 0);
    all.map(i64::trailing_zeros).min().unwrap_or(u32::MAX)
}
