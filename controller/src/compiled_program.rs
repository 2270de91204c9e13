//! A program made ready to run: all slots resolved to places of one memory.

use crate::Number;
use crate::program::{Operation, Program, ProgramTerm, Slot};

/// One operation with all slots resolved to places of one memory: states, then inputs, then locals.
#[derive(Debug, Clone)]
enum FlatOperation<N> {
    Sum { into: usize, constant: Option<N>, first: usize, last: usize },
    Product { into: usize, a: usize, b: usize },
    Quotient { into: usize, above: usize, below: usize },
    Magnitude { into: usize, of: usize },
    Clamp { into: usize, of: usize, low: N, high: N },
}

impl<N> FlatOperation<N> {
    fn target_place(&self) -> usize {
        match self {
            FlatOperation::Sum { into, .. }
            | FlatOperation::Product { into, .. }
            | FlatOperation::Quotient { into, .. }
            | FlatOperation::Magnitude { into, .. }
            | FlatOperation::Clamp { into, .. } => *into,
        }
    }
}

/// coefficient x place of memory.
#[derive(Debug, Clone)]
struct FlatTerm<N> {
    coefficient: N,
    place: usize,
}

impl<N: Number> FlatTerm<N> {
    #[inline]
    fn value(&self, memory: &[N]) -> N {
        self.coefficient.times(&memory[self.place])
    }
}

/// A program made ready to run in the numbers N.
#[derive(Debug, Clone)]
pub struct CompiledProgram<N> {
    operations: Vec<FlatOperation<N>>,
    terms: Vec<FlatTerm<N>>,
    states: usize,
    inputs: usize,
    memory: usize,
    output: Option<usize>,
}

impl<N: Number> CompiledProgram<N> {
    /// Returns the program for a memory of `states` states followed by inputs and locals.
    pub fn new(program: &Program, states: usize) -> Self {
        let inputs = program.inputs.len();
        let place = |slot: Slot| match slot {
            Slot::State(i) => i,
            Slot::Input(i) => states + i,
            Slot::Local(i) => states + inputs + i,
        };
        let mut terms = Vec::new();
        let operations = program.operations().map(|op| flatten(op, &place, &mut terms)).collect();
        let memory = states + inputs + program.locals.len();
        Self { operations, terms, states, inputs, memory, output: program.output.map(place) }
    }

    /// Returns places of memory that the program needs.
    pub fn memory(&self) -> usize {
        self.memory
    }

    /// Runs the program on `memory`, whose first places are the states; returns the output, or `None` if the program
    /// has none or the memory is too small.
    pub fn run(&self, memory: &mut [N], inputs: &[N]) -> Option<N> {
        if memory.len() < self.memory {
            return None;
        }
        self.take(memory, inputs);
        for operation in &self.operations {
            self.execute(operation, memory);
        }
        self.output.map(|place| memory[place].clone())
    }

    /// Runs the program as [`CompiledProgram::run`] does, but after each operation `touch` gets its number and what it wrote, to look at or to change.
    pub fn run_touched(
        &self,
        memory: &mut [N],
        inputs: &[N],
        mut touch: impl FnMut(usize, &mut N),
    ) -> Option<N> {
        if memory.len() < self.memory {
            return None;
        }
        self.take(memory, inputs);
        for (number, operation) in self.operations.iter().enumerate() {
            self.execute(operation, memory);
            touch(number, &mut memory[operation.target_place()]);
        }
        self.output.map(|place| memory[place].clone())
    }

    fn take(&self, memory: &mut [N], inputs: &[N]) {
        for (place, input) in memory[self.states..][..self.inputs].iter_mut().zip(inputs) {
            *place = input.clone();
        }
    }

    #[inline]
    fn execute(&self, operation: &FlatOperation<N>, memory: &mut [N]) {
        match operation {
            FlatOperation::Sum { into, constant, first, last } => {
                memory[*into] = sum(constant.as_ref(), &self.terms[*first..*last], memory);
            }
            FlatOperation::Product { into, a, b } => memory[*into] = memory[*a].times(&memory[*b]),
            FlatOperation::Quotient { into, above, below } => {
                memory[*into] = memory[*above].divide_by(&memory[*below])
            }
            FlatOperation::Magnitude { into, of } => memory[*into] = memory[*of].magnitude(),
            FlatOperation::Clamp { into, of, low, high } => memory[*into] = memory[*of].clamp_to(low, high),
        }
    }
}

#[inline]
fn sum<N: Number>(constant: Option<&N>, terms: &[FlatTerm<N>], memory: &[N]) -> N {
    let (start, rest) = match (constant, terms) {
        (Some(constant), all) => (constant.clone(), all),
        (None, [first, rest @ ..]) => (first.value(memory), rest),
        (None, []) => (N::from_f64(0.0), terms),
    };
    rest.iter().fold(start, |sum, term| sum.plus(&term.value(memory)))
}

fn flatten<N: Number>(
    op: &Operation,
    place: &dyn Fn(Slot) -> usize,
    all: &mut Vec<FlatTerm<N>>,
) -> FlatOperation<N> {
    let into = place(op.into_slot());
    match op {
        Operation::Sum { constant, terms, .. } => {
            let first = all.len();
            let flat = |term: &ProgramTerm| FlatTerm {
                coefficient: N::from_f64(term.coefficient),
                place: place(term.of),
            };
            all.extend(terms.iter().map(flat));
            FlatOperation::Sum { into, constant: constant.map(N::from_f64), first, last: all.len() }
        }
        Operation::Product { a, b, .. } => FlatOperation::Product { into, a: place(*a), b: place(*b) },
        Operation::Quotient { above, below, .. } => {
            FlatOperation::Quotient { into, above: place(*above), below: place(*below) }
        }
        Operation::Magnitude { of, .. } => FlatOperation::Magnitude { into, of: place(*of) },
        Operation::Clamp { of, low, high, .. } => {
            FlatOperation::Clamp { into, of: place(*of), low: N::from_f64(*low), high: N::from_f64(*high) }
        }
    }
}
