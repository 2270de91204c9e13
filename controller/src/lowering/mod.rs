//! From a controller's parts to its straight lines of arithmetic.
//!
//! Order of a step: corrections, projection of heave and surge, limit of the demand's rate, prefilter, derived signals, friction observers, outputs of the paths, their gains, the
//! sum, the limiter, the drive's curve, new states. Coefficients that are exactly 0 are left out here, once for all back ends.

mod curve;
mod estimate;
mod friction_observers;
mod learnt_level;
mod project;
mod regressors;
mod schedule;
mod squares;
mod step;

use std::collections::HashSet;

use crate::program::{
    OnRestart, Operation, Program, ProgramSection, ProgramTerm, Programs, Slot, StateGroup, StateLimits,
};
use crate::{Parts, READING_NAMES};

/// Group of the prefilter's states.
pub const PREFILTER_STATES: &str = "prefilter";
/// The limited control of the sample before.
pub const PREVIOUS_CONTROL: &str = "previous_control_v";
/// Names of states and locals that a path must not take.
pub const OWN_NAMES: [&str; 26] = [
    PREFILTER_STATES,
    PREVIOUS_CONTROL,
    "out_of_balance_kg_m",
    "bias_v",
    "transfer_v",
    "estimate",
    "control_v",
    "limited_v",
    "excess_v",
    "filtered_demand_rad_s",
    "rate_error_rad_s",
    "relative_rate_rad_s",
    "demand_before",
    "demand_followed",
    "demand_kept",
    "demand_at_start",
    "demand_is_new",
    "demand_way",
    "demand_step",
    "demand_cut",
    "demand_following",
    "limited_demand",
    "limited_error",
    learnt_level::LEVEL,
    learnt_level::SLOPE,
    learnt_level::OFFSET,
];

/// Returns whether a group of states holds what is learnt of the friction's level: at rest it stands still, and a loop about rest does not have it.
pub(crate) fn is_of_friction_level(group: &str) -> bool {
    [learnt_level::LEVEL, learnt_level::SLOPE, learnt_level::OFFSET].contains(&group)
}

/// Returns the programs of a controller with the given parts.
pub fn lower_parts(parts: &Parts) -> Programs {
    let mut states = States::default();
    let layout = schedule::layout(parts, &mut states);
    let step = step::program(parts, &layout, &mut states);
    let set_out_of_balance = schedule::program(parts, &layout);
    Programs { states: states.groups, step, set_out_of_balance }
}

/// A new value of a state; it waits in a local until the new values of all states have been computed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Update {
    /// The state.
    pub state: Slot,
    /// The local that holds its new value.
    pub value: Slot,
}

/// The states as they are handed out.
#[derive(Default)]
pub(crate) struct States {
    groups: Vec<StateGroup>,
    count: usize,
}

impl States {
    /// Adds one state.
    pub fn scalar(&mut self, name: &str, initial: f64, on_restart: OnRestart) -> Slot {
        self.add(name, None, vec![initial], on_restart)
    }

    /// Adds an array of states that start at 0.
    pub fn array(&mut self, name: &str, length: usize) -> Vec<Slot> {
        let first = self.count;
        if length > 0 {
            self.add(name, Some(length), vec![0.0; length], OnRestart::Restart);
        }
        (first..first + length).map(Slot::State).collect()
    }

    /// Keeps the states of the last group within limits.
    pub fn keep_within(&mut self, limits: StateLimits) {
        if let Some(group) = self.groups.last_mut() {
            group.limits = Some(limits);
        }
    }

    fn add(&mut self, name: &str, length: Option<usize>, initial: Vec<f64>, on_restart: OnRestart) -> Slot {
        let first = self.count;
        self.count += initial.len();
        self.groups.push(StateGroup {
            name: name.to_owned(),
            first,
            length,
            initial,
            on_restart,
            limits: None,
        });
        Slot::State(first)
    }
}

/// The limits of a clamped value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    pub low: f64,
    pub high: f64,
}

impl Limits {
    /// From 0 to 1: a share, or a switch that fades.
    pub const UNIT: Self = Self { low: 0.0, high: 1.0 };

    /// Returns the limits from `-most` to `most`.
    pub fn symmetric(most: f64) -> Self {
        Self { low: -most, high: most }
    }
}

/// Writes a program line by line.
pub(crate) struct Writer {
    program: Program,
}

impl Writer {
    /// Returns an empty program with named inputs.
    pub fn new(inputs: &[&str]) -> Self {
        let inputs = inputs.iter().map(|name| (*name).to_owned()).collect();
        Self { program: Program { inputs, ..Program::default() } }
    }

    /// Opens a section.
    pub fn section(&mut self, says: impl Into<String>) {
        self.program.sections.push(ProgramSection { says: says.into(), operations: Vec::new() });
    }

    /// Adds a local.
    pub fn local(&mut self, name: impl Into<String>) -> Slot {
        self.program.locals.push(name.into());
        Slot::Local(self.program.locals.len() - 1)
    }

    /// Appends an operation.
    pub fn push(&mut self, operation: Operation) {
        if let Some(section) = self.program.sections.last_mut() {
            section.operations.push(operation);
        }
    }

    /// Writes `into = constant + sum of coefficient x slot`, coefficients of 0 left out.
    pub fn sum_into(&mut self, into: Slot, constant: Option<f64>, terms: &[ProgramTerm]) {
        let terms = terms.iter().filter(|term| term.coefficient != 0.0).copied().collect();
        self.push(Operation::Sum { into, constant: constant.filter(|c| *c != 0.0), terms });
    }

    /// Adds a local that is a sum.
    pub fn sum(&mut self, name: impl Into<String>, terms: &[ProgramTerm]) -> Slot {
        let into = self.local(name);
        self.sum_into(into, None, terms);
        into
    }

    /// Adds a local a b.
    pub fn product(&mut self, name: impl Into<String>, a: Slot, b: Slot) -> Slot {
        let into = self.local(name);
        self.push(Operation::Product { into, a, b });
        into
    }

    /// Adds a local above / below.
    pub fn quotient(&mut self, name: impl Into<String>, above: Slot, below: Slot) -> Slot {
        let into = self.local(name);
        self.push(Operation::Quotient { into, above, below });
        into
    }

    /// Adds a local kept within limits.
    pub fn clamp(&mut self, name: impl Into<String>, of: Slot, limits: Limits) -> Slot {
        let into = self.local(name);
        self.push(Operation::Clamp { into, of, low: limits.low, high: limits.high });
        into
    }

    /// Adds a local |of|.
    pub fn magnitude(&mut self, name: impl Into<String>, of: Slot) -> Slot {
        let into = self.local(name);
        self.push(Operation::Magnitude { into, of });
        into
    }

    /// Writes `into = from`.
    pub fn copy(&mut self, into: Slot, from: Slot) {
        self.sum_into(into, None, &[1.0 * from]);
    }

    /// Returns the program with its output, without the locals that nothing reads.
    pub fn finish(mut self, output: Option<Slot>) -> Program {
        let mut read: HashSet<Slot> = output.into_iter().collect();
        for section in self.program.sections.iter_mut().rev() {
            let mut kept: Vec<Operation> = Vec::new();
            for operation in section.operations.drain(..).rev() {
                let into = operation.into_slot();
                if matches!(into, Slot::State(_)) || read.contains(&into) {
                    read.extend(operation.reads());
                    kept.push(operation);
                }
            }
            section.operations = kept.into_iter().rev().collect();
        }
        self.program.sections.retain(|section| !section.operations.is_empty());
        self.program.output = output;
        self.program
    }
}

/// Returns the names of the step's inputs.
pub(crate) fn reading_names(parts: &Parts) -> Vec<&'static str> {
    READING_NAMES[..parts.reading_count()].to_vec()
}
