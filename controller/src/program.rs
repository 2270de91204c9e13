//! A step of the controller as a straight line of operations: the one meaning that all back ends share.

/// Place of a number in a program.
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
pub struct ProgramTerm {
    /// Coefficient; never 0.
    pub coefficient: f64,
    /// Slot that the coefficient multiplies.
    pub of: Slot,
}

/// `coefficient * slot` is the term of a sum.
impl std::ops::Mul<Slot> for f64 {
    type Output = ProgramTerm;

    fn mul(self, of: Slot) -> ProgramTerm {
        ProgramTerm { coefficient: self, of }
    }
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
        terms: Vec<ProgramTerm>,
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
pub struct ProgramSection {
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
    pub sections: Vec<ProgramSection>,
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
    /// The treatment of the states on a restart: put back to the start, or left as set.
    pub on_restart: OnRestart,
    /// Within what the states are kept after each step; `None` if the program itself keeps them bounded.
    pub limits: Option<StateLimits>,
}

/// Range of a state, from its lowest to its highest value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StateLimits {
    /// Lowest.
    pub low: f64,
    /// Highest.
    pub high: f64,
}

/// Effect of a restart on a state. A controller restarts by itself if its states leave every plausible size; a reset, which the application
/// asks for, puts every state back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OnRestart {
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
    /// Returns all operations in order.
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
