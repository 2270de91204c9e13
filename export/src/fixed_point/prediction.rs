//! The deviation of fixed point from the reference: errors of its operations, and a run in its coefficients without rounding.

use counterpoise_controller::READINGS;
use counterpoise_controller::program::{Operation, Program, Slot};

use crate::Ranges;
use crate::fixed_point::format::{to_integer, unit};
use crate::fixed_point::writer::{OperationError, Writer};
use crate::fixed_point::{FixedOperation, FixedPointController, FixedProgram};
use crate::ranges::{Run, RunState, RunVisitor, play_runs};
use crate::rounding::{
    Arithmetic, Deviation, ExecutedOperation, Line, OperationRounding, deviation, is_kept, setting_errors,
    state_increment, to_grid,
};

/// Returns how far the control can be from the reference.
pub(crate) fn predict(
    fixed: &FixedPointController,
    ranges: &Ranges,
    errors: Vec<OperationError>,
    set: &Writer<'_>,
    samples: usize,
) -> Deviation {
    let controller = &fixed.controller;
    let left = left_by_setting(fixed, set);
    let error = |slot: &Slot| match slot {
        Slot::State(i) if is_kept(controller, *slot) => left[*i],
        _ => 0.0,
    };
    let kept = setting_errors(controller, ranges, &error);
    let readings = fixed.step.inputs.iter().map(|bits| OperationError::of_rounding(0.5 * unit(*bits)));
    let errors = errors.into_iter().chain(readings).collect();
    let quantised = FixedPointErrors { fixed, errors, set: set.errors(), kept };
    deviation(controller, ranges, &quantised, samples)
}

/// Returns the largest error of each state after a setting, or at the start.
fn left_by_setting(fixed: &FixedPointController, set: &Writer<'_>) -> Vec<f64> {
    let program = &fixed.controller.programs().set_out_of_balance;
    let mut states: Vec<f64> = fixed.states.iter().map(|bits| 0.5 * unit(*bits)).collect();
    let mut locals = vec![0.0; program.locals.len()];
    for (operation, own) in program.operations().zip(set.errors()) {
        let error = |slot: &Slot| match *slot {
            Slot::State(i) => states[i],
            Slot::Local(i) => locals[i],
            Slot::Input(_) => 0.5 * unit(set.bits(*slot)),
        };
        let total = own.worst + inherited_error(operation, set, &error);
        match operation.into_slot() {
            Slot::State(i) => states[i] = states[i].max(total),
            Slot::Local(i) => locals[i] = total,
            Slot::Input(_) => {}
        }
    }
    states
}

/// Returns what an operation passes on of its operands' errors.
fn inherited_error(operation: &Operation, set: &Writer<'_>, error: &dyn Fn(&Slot) -> f64) -> f64 {
    match operation {
        Operation::Sum { terms, .. } => terms.iter().map(|t| t.coefficient.abs() * error(&t.of)).sum(),
        Operation::Product { a, b, .. } => error(a) * set.size(*b) + error(b) * set.size(*a),
        Operation::Quotient { into, above, below } => {
            (error(above) + error(below) * set.size(*into)) / set.smallest_magnitude(*below)
        }
        Operation::Magnitude { of, .. } => error(of),
        Operation::Clamp { of, .. } => error(of) + 0.5 * unit(set.bits(*of)),
    }
}

/// Errors in fixed point.
struct FixedPointErrors<'a> {
    fixed: &'a FixedPointController,
    errors: Vec<OperationError>,
    set: &'a [OperationError],
    kept: Vec<f64>,
}

impl Arithmetic for FixedPointErrors<'_> {
    fn worst_errors(&self) -> Vec<f64> {
        let kept = self.kept.iter().copied().chain(std::iter::repeat(0.0));
        self.errors.iter().zip(kept).map(|(error, kept)| error.worst + kept).collect()
    }

    fn coefficients(&self, runs: &[Run]) -> Vec<Vec<f64>> {
        play_runs(runs, &Coefficients(self.fixed)).into_iter().map(|state| state.voltages_v).collect()
    }

    /// Returns the reading: its rounding is among what rounded coefficients do.
    fn stored_reading(&self, value: f64) -> f64 {
        value
    }

    /// Returns what is a whole number of units is not rounded. Quotients are cut towards 0: the half unit that this loses has
    /// the sign of the quotient.
    fn rounding_of(&self, line: Line, executed: &ExecutedOperation<'_>) -> OperationRounding {
        let ExecutedOperation { number, operation, read, written: value } = *executed;
        let error = match line {
            Line::Step => self.errors[number],
            Line::Set => self.set[number],
        };
        if (value / unit(error.bits)).fract() == 0.0 {
            return OperationRounding::default();
        }
        let known = match state_increment(operation, read) {
            Some((state, rest)) if error.squares > 0.0 && self.fixed.states[state] <= error.bits => {
                to_grid(rest, unit(error.bits))
            }
            _ => -value.signum() * error.steady,
        };
        OperationRounding { known, square: error.squares }
    }
}

/// The controller with rounded coefficients, and how far its control was from the reference's, V.
struct Coefficients<'a>(&'a FixedPointController);

impl<'a> RunVisitor<RunState<UnroundedController<'a>>> for Coefficients<'a> {
    fn start(&self) -> RunState<UnroundedController<'a>> {
        RunState::of(UnroundedController::new(self.0))
    }

    fn set(&self, state: &mut RunState<UnroundedController<'a>>, out_of_balance_kg_m: f64) {
        state.acting.set_out_of_balance(out_of_balance_kg_m);
    }

    fn sample(&self, state: &mut RunState<UnroundedController<'a>>, run: &Run, k: usize) {
        state.voltages_v.push(state.acting.step(&run.readings[k]) - run.reference_v[k]);
    }
}

/// A fixed-point controller whose coefficients, start and readings are rounded and nothing else: numbers are real multiples
/// of their units.
#[derive(Clone)]
struct UnroundedController<'a> {
    fixed: &'a FixedPointController,
    states: Vec<f64>,
    locals: Vec<f64>,
}

impl<'a> UnroundedController<'a> {
    fn new(fixed: &'a FixedPointController) -> Self {
        let states = fixed.initial.iter().map(|value| *value as f64).collect();
        let count = fixed.step.locals.len().max(fixed.set_out_of_balance.locals.len());
        Self { fixed, states, locals: vec![0.0; count] }
    }

    fn step(&mut self, readings: &[f64; READINGS]) -> f64 {
        let inputs = self.fixed.step.integers(readings).map(|integer| integer as f64);
        self.run(&self.fixed.step, &inputs);
        let program: &Program = &self.fixed.controller.programs().step;
        let control = program.output.map_or(0.0, |slot| self.read(slot, &inputs));
        control * unit(self.fixed.control_bits())
    }

    fn set_out_of_balance(&mut self, out_of_balance_kg_m: f64) {
        let program = &self.fixed.set_out_of_balance;
        self.run(program, &[to_integer(out_of_balance_kg_m, program.inputs[0]) as f64]);
    }

    fn run(&mut self, program: &FixedProgram, inputs: &[f64]) {
        for operation in &program.operations {
            let (into, value) = self.evaluate(operation, inputs);
            match into {
                Slot::State(i) => self.states[i] = value,
                Slot::Local(i) => self.locals[i] = value,
                Slot::Input(_) => {}
            }
        }
    }

    fn read(&self, slot: Slot, inputs: &[f64]) -> f64 {
        match slot {
            Slot::State(i) => self.states[i],
            Slot::Local(i) => self.locals[i],
            Slot::Input(i) => inputs[i],
        }
    }

    fn evaluate(&self, operation: &FixedOperation, inputs: &[f64]) -> (Slot, f64) {
        let read = |slot: &Slot| self.read(*slot, inputs);
        let moved = |value: f64, shift: u32| value * (-f64::from(shift)).exp2();
        match operation {
            FixedOperation::Sum { into, constant, terms, shift } => {
                let sum = terms
                    .iter()
                    .fold(*constant as f64, |sum, term| sum + term.factor as f64 * read(&term.of));
                (*into, moved(sum, *shift))
            }
            FixedOperation::Product { into, a, b, shift } => (*into, moved(read(a) * read(b), *shift)),
            FixedOperation::Quotient { into, above, below, left, shift } => {
                (*into, moved(f64::from(*left).exp2() * read(above) / read(below), *shift))
            }
            FixedOperation::Magnitude { into, of } => (*into, read(of).abs()),
            FixedOperation::Clamp { into, of, low, high } => {
                (*into, read(of).clamp(*low as f64, *high as f64))
            }
        }
    }
}
