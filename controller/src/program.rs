//! A step of the controller as a straight line of operations: the one meaning that all back ends share.

use crate::Number;

/// Where a number lives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Slot {
    /// An argument of the program; never written.
    Input(usize),
    /// A state, kept from step to step.
    State(usize),
    /// A value of this step, written before it is read.
    Local(usize),
}

/// coefficient x slot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term {
    /// Coefficient; never 0.
    pub coefficient: f64,
    /// What it multiplies.
    pub of: Slot,
}

/// One operation. Every product, sum and quotient is rounded by itself; nothing is contracted or reordered.
#[derive(Debug, Clone, PartialEq)]
pub enum Operation {
    /// `into = constant + c1 a1 + c2 a2 + ...`, from left to right; without a constant it starts with c1 a1. Nothing
    /// at all is 0.
    Sum {
        /// Target.
        into: Slot,
        /// First summand.
        constant: Option<f64>,
        /// Other summands.
        terms: Vec<Term>,
    },
    /// `into = a b`.
    Product {
        /// Target.
        into: Slot,
        /// First factor.
        a: Slot,
        /// Second factor.
        b: Slot,
    },
    /// `into = above / below`.
    Quotient {
        /// Target.
        into: Slot,
        /// Dividend.
        above: Slot,
        /// Divisor.
        below: Slot,
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
        low: f64,
        /// Upper limit.
        high: f64,
    },
}

/// Operations that belong together, and what they do, in words.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// One line for the reader of target code.
    pub says: String,
    /// The operations, in order.
    pub operations: Vec<Operation>,
}

/// A straight line of operations.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Program {
    /// Names of the inputs.
    pub inputs: Vec<String>,
    /// Names of the locals.
    pub locals: Vec<String>,
    /// The operations by sections.
    pub sections: Vec<Section>,
    /// The output of the program, if it has one.
    pub output: Option<Slot>,
}

/// A group of states that target code keeps together.
#[derive(Debug, Clone, PartialEq)]
pub struct StateGroup {
    /// Name in target code.
    pub name: String,
    /// Index of the first state.
    pub first: usize,
    /// Number of states; `None` for a scalar.
    pub length: Option<usize>,
    /// Value of each at the start.
    pub initial: Vec<f64>,
    /// Whether a reset puts the states back to the start, or leaves them as set.
    pub on_reset: OnReset,
}

/// What a reset does to a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OnReset {
    /// Back to its start.
    Restart,
    /// Kept: the out-of-balance and what follows from it.
    Keep,
}

/// The programs of a controller and the states they share.
#[derive(Debug, Clone, PartialEq)]
pub struct Programs {
    /// States by groups; together they number the states without gaps.
    pub states: Vec<StateGroup>,
    /// One sample: from the readings to the limited control, V.
    pub step: Program,
    /// From an out-of-balance, kg m, to the gains and the bias that belong to it.
    pub set_out_of_balance: Program,
}

impl Programs {
    /// Returns the number of states.
    pub fn state_count(&self) -> usize {
        self.states.iter().map(|group| group.initial.len()).sum()
    }

    /// Returns the states at the start.
    pub fn initial(&self) -> Vec<f64> {
        self.states.iter().flat_map(|group| group.initial.iter().copied()).collect()
    }

    /// Returns the group and, in an array, the position of a state.
    pub fn locate(&self, state: usize) -> Option<(&StateGroup, usize)> {
        let group = self.states.iter().find(|g| (g.first..g.first + g.initial.len()).contains(&state))?;
        Some((group, state - group.first))
    }
}

impl Operation {
    /// Returns the slot that is written.
    pub fn into_slot(&self) -> Slot {
        match self {
            Operation::Sum { into, .. }
            | Operation::Product { into, .. }
            | Operation::Quotient { into, .. }
            | Operation::Magnitude { into, .. }
            | Operation::Clamp { into, .. } => *into,
        }
    }

    /// Returns the slots that are read, in order.
    pub fn reads(&self) -> Vec<Slot> {
        match self {
            Operation::Sum { terms, .. } => terms.iter().map(|term| term.of).collect(),
            Operation::Product { a, b, .. } => vec![*a, *b],
            Operation::Quotient { above, below, .. } => vec![*above, *below],
            Operation::Magnitude { of, .. } | Operation::Clamp { of, .. } => vec![*of],
        }
    }
}

impl Program {
    /// All operations in order.
    pub fn operations(&self) -> impl Iterator<Item = &Operation> {
        self.sections.iter().flat_map(|section| section.operations.iter())
    }

    /// Returns the number of multiplications by a coefficient that is neither 1 nor -1, products included.
    pub fn multiplications(&self) -> usize {
        self.operations()
            .map(|operation| match operation {
                Operation::Sum { terms, .. } => terms.iter().filter(|t| t.coefficient.abs() != 1.0).count(),
                Operation::Product { .. } => 1,
                _ => 0,
            })
            .sum()
    }

    /// Returns the number of additions and subtractions.
    pub fn additions(&self) -> usize {
        self.operations()
            .map(|operation| match operation {
                Operation::Sum { terms, constant, .. } => {
                    (terms.len() + usize::from(constant.is_some())).saturating_sub(1)
                }
                _ => 0,
            })
            .sum()
    }
}

/// One operation with all slots resolved to places of one memory: states, then inputs, then locals.
#[derive(Debug, Clone)]
enum Flat<N> {
    Sum { into: usize, constant: Option<N>, first: usize, last: usize },
    Product { into: usize, a: usize, b: usize },
    Quotient { into: usize, above: usize, below: usize },
    Magnitude { into: usize, of: usize },
    Clamp { into: usize, of: usize, low: N, high: N },
}

impl<N> Flat<N> {
    fn target_place(&self) -> usize {
        match self {
            Flat::Sum { into, .. }
            | Flat::Product { into, .. }
            | Flat::Quotient { into, .. }
            | Flat::Magnitude { into, .. }
            | Flat::Clamp { into, .. } => *into,
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
pub struct Compiled<N> {
    operations: Vec<Flat<N>>,
    terms: Vec<FlatTerm<N>>,
    states: usize,
    memory: usize,
    output: Option<usize>,
}

impl<N: Number> Compiled<N> {
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
        Self { operations, terms, states, memory, output: program.output.map(place) }
    }

    /// Places of memory that the program needs.
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

    /// As [`Compiled::run`], but after each operation `touch` gets its number and what it wrote, to look at or to change.
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
        for (place, input) in memory[self.states..].iter_mut().zip(inputs) {
            *place = input.clone();
        }
    }

    #[inline]
    fn execute(&self, operation: &Flat<N>, memory: &mut [N]) {
        match operation {
            Flat::Sum { into, constant, first, last } => {
                memory[*into] = sum(constant.as_ref(), &self.terms[*first..*last], memory);
            }
            Flat::Product { into, a, b } => memory[*into] = memory[*a].times(&memory[*b]),
            Flat::Quotient { into, above, below } => memory[*into] = memory[*above].over(&memory[*below]),
            Flat::Magnitude { into, of } => memory[*into] = memory[*of].magnitude(),
            Flat::Clamp { into, of, low, high } => memory[*into] = memory[*of].clamped(low, high),
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

fn flatten<N: Number>(op: &Operation, place: &dyn Fn(Slot) -> usize, all: &mut Vec<FlatTerm<N>>) -> Flat<N> {
    let into = place(op.into_slot());
    match op {
        Operation::Sum { constant, terms, .. } => {
            let first = all.len();
            let flat =
                |term: &Term| FlatTerm { coefficient: N::from_f64(term.coefficient), place: place(term.of) };
            all.extend(terms.iter().map(flat));
            Flat::Sum { into, constant: constant.map(N::from_f64), first, last: all.len() }
        }
        Operation::Product { a, b, .. } => Flat::Product { into, a: place(*a), b: place(*b) },
        Operation::Quotient { above, below, .. } => {
            Flat::Quotient { into, above: place(*above), below: place(*below) }
        }
        Operation::Magnitude { of, .. } => Flat::Magnitude { into, of: place(*of) },
        Operation::Clamp { of, low, high, .. } => {
            Flat::Clamp { into, of: place(*of), low: N::from_f64(*low), high: N::from_f64(*high) }
        }
    }
}
