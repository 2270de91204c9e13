//! A program beside its derivatives: what an error at any place of it does to the states after it and to what it gives.

use counterpoise_controller::program::{Operation, Program, Slot};

use counterpoise_linalg::sparse::VectorEntry;

use super::ExecutedOperation;

/// Derivatives by the states before the program (0, 1, ...) and then by an error added to each operation: place and value.
pub(crate) type Row = Vec<VectorEntry>;

/// A program with every value named once: the states before it, its inputs, then what each operation writes.
#[derive(Clone)]
pub(crate) struct Tangent<'a> {
    operations: Vec<&'a Operation>,
    reads: Vec<usize>,
    first_reads: Vec<usize>,
    states: usize,
    ends: Vec<usize>,
    output: Option<usize>,
    values: Vec<f64>,
    operands: Vec<f64>,
    partials: Vec<f64>,
    slopes: Vec<Row>,
    changed: Vec<bool>,
    columns: Vec<Row>,
    scratch: Vec<f64>,
}

impl<'a> Tangent<'a> {
    /// Returns the derivatives of a program on so many states.
    pub fn new(program: &'a Program, states: usize) -> Self {
        let operations: Vec<&Operation> = program.operations().collect();
        let first = states + program.inputs.len();
        let mut ends: Vec<usize> = (0..states).collect();
        let mut locals = vec![0; program.locals.len()];
        let (mut reads, mut first_reads) = (Vec::new(), vec![0]);
        for (number, operation) in operations.iter().enumerate() {
            let place = |slot: Slot| place(slot, states, &ends, &locals);
            reads.extend(operation.reads().into_iter().map(place));
            first_reads.push(reads.len());
            match operation.into_slot() {
                Slot::State(i) => ends[i] = first + number,
                Slot::Local(i) => locals[i] = first + number,
                Slot::Input(_) => {}
            }
        }
        let output = program.output.map(|slot| place(slot, states, &ends, &locals));
        let count = first + operations.len();
        // A state is its own derivative; what an operation writes has its own error at least; readings have none.
        let alone = |id: usize| match (id < states, id.checked_sub(first)) {
            (true, _) => vec![VectorEntry::new(id, 1.0)],
            (false, Some(number)) => vec![VectorEntry::new(states + number, 1.0)],
            (false, None) => Row::new(),
        };
        Self {
            partials: vec![f64::NAN; reads.len()],
            operands: vec![0.0; reads.len()],
            columns: vec![Row::new(); operations.len()],
            scratch: vec![0.0; states + operations.len()],
            slopes: (0..count).map(alone).collect(),
            values: vec![0.0; count],
            changed: vec![false; count],
            operations,
            reads,
            first_reads,
            states,
            ends,
            output,
        }
    }

    /// Runs the program once; `states` become those after it. Derivatives that are as they were are not computed again.
    pub fn run(&mut self, states: &mut [f64], inputs: &[f64]) {
        self.values[..self.states].copy_from_slice(states);
        let first = self.values.len() - self.operations.len();
        let taken = first - self.states;
        self.values[self.states..first].copy_from_slice(&inputs[..taken]);
        let mut any = false;
        for number in 0..self.operations.len() {
            let places = self.first_reads[number]..self.first_reads[number + 1];
            let mut renewed = false;
            for k in places.clone() {
                let id = self.reads[k];
                self.operands[k] = self.values[id];
                renewed |= self.changed[id];
            }
            let operands = &self.operands[places.clone()];
            let (value, bent) = evaluate(self.operations[number], operands, &mut self.partials[places]);
            self.values[first + number] = value;
            let differs = (renewed || bent) && self.renew(number, first);
            self.changed[first + number] = differs;
            any |= differs;
        }
        if any {
            self.arrange();
        }
        for (state, end) in states.iter_mut().zip(&self.ends) {
            *state = self.values[*end];
        }
    }

    /// Returns each operation of the last run with what it read and wrote.
    pub fn executed_operations(&self) -> impl Iterator<Item = ExecutedOperation<'_>> + '_ {
        let first = self.values.len() - self.operations.len();
        self.operations.iter().enumerate().map(move |(number, operation)| {
            let read = &self.operands[self.first_reads[number]..self.first_reads[number + 1]];
            ExecutedOperation { number, operation, read, written: self.values[first + number] }
        })
    }

    /// Returns the derivatives of a state after the program.
    pub fn state(&self, i: usize) -> &Row {
        &self.slopes[self.ends[i]]
    }

    /// Returns the derivatives of what the program gives.
    pub fn output(&self) -> &[VectorEntry] {
        self.output.map_or(&[], |id| &self.slopes[id])
    }

    /// Returns what an error of an operation does: states and derivatives.
    pub fn column(&self, number: usize) -> &Row {
        &self.columns[number]
    }

    /// Derivatives of what an operation writes, from those of what it reads; whether they differ from before.
    fn renew(&mut self, number: usize, first: usize) -> bool {
        let mut places: Vec<usize> = Vec::new();
        let own = self.first_reads[number]..self.first_reads[number + 1];
        for (partial, id) in self.partials[own.clone()].iter().zip(&self.reads[own]) {
            for entry in self.slopes[*id].iter().filter(|_| *partial != 0.0) {
                if self.scratch[entry.index] == 0.0 {
                    places.push(entry.index);
                }
                self.scratch[entry.index] += partial * entry.value;
            }
        }
        let mut row = Row::new();
        for place in places {
            let slope = std::mem::take(&mut self.scratch[place]);
            if slope != 0.0 {
                row.push(VectorEntry::new(place, slope));
            }
        }
        row.push(VectorEntry::new(self.states + number, 1.0));
        let differs = row != self.slopes[first + number];
        self.slopes[first + number] = row;
        differs
    }

    /// Columns from rows.
    fn arrange(&mut self) {
        self.columns.iter_mut().for_each(Row::clear);
        for (i, end) in self.ends.iter().enumerate() {
            for entry in &self.slopes[*end] {
                if let Some(number) = entry.index.checked_sub(self.states) {
                    self.columns[number].push(VectorEntry::new(i, entry.value));
                }
            }
        }
    }
}

fn place(slot: Slot, states: usize, ends: &[usize], locals: &[usize]) -> usize {
    match slot {
        Slot::State(i) => ends[i],
        Slot::Input(i) => states + i,
        Slot::Local(i) => locals[i],
    }
}

/// Returns the value; the derivatives by the operands go to `partials`, and whether they are others than before. At a
/// corner, the derivative of the stretch that the corner belongs to.
fn evaluate(operation: &Operation, operands: &[f64], partials: &mut [f64]) -> (f64, bool) {
    let mut bent = false;
    let mut slope = |k: usize, new: f64| {
        bent |= partials[k] != new;
        partials[k] = new;
    };
    let value = match (operation, operands) {
        (Operation::Sum { constant, terms, .. }, all) => {
            let mut sum = constant.unwrap_or(0.0);
            for (k, (term, value)) in terms.iter().zip(all).enumerate() {
                sum += term.coefficient * value;
                slope(k, term.coefficient);
            }
            sum
        }
        (Operation::Product { .. }, [a, b]) => {
            slope(0, *b);
            slope(1, *a);
            a * b
        }
        (Operation::Quotient { .. }, [above, below]) => {
            let quotient = above / below;
            slope(0, 1.0 / below);
            slope(1, -quotient / below);
            quotient
        }
        (Operation::Magnitude { .. }, [of]) => {
            slope(0, if *of == 0.0 { 0.0 } else { of.signum() });
            of.abs()
        }
        (Operation::Clamp { low, high, .. }, [of]) => {
            slope(0, f64::from(u8::from((*low..=*high).contains(of))));
            of.max(*low).min(*high)
        }
        _ => 0.0,
    };
    (value, bent)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use counterpoise_controller::{
        Controller, Estimator, Learning, Parts, Path, PathSignal, READINGS, Scaling,
    };
    use counterpoise_linalg::Mat;
    use counterpoise_lti::{StateSpace, Timebase};

    /// Returns a path on an estimator: products, quotients, limits and states that are written before they are
    /// read again.
    fn adaptive_controller() -> Controller {
        let mut parts = Parts::new(1e-3, 10.0);
        let system = StateSpace::new(
            Mat::from_rows(&[&[0.9, 0.1], &[-0.1, 0.9]]),
            Mat::from_rows(&[&[0.3], &[0.1]]),
            Mat::from_rows(&[&[1.0, 0.5]]),
            Mat::from_rows(&[&[0.2]]),
            Timebase::Discrete { period_s: 1e-3 },
        );
        parts.paths.push(Path {
            name: "heave".into(),
            inputs: vec![PathSignal::PlatformAcceleration],
            system: system.unwrap(),
            anti_windup: vec![0.0; 2],
            scaling: Scaling::WithOutOfBalance,
        });
        parts.design_out_of_balance_kg_m = 100.0;
        parts.bias_v_per_kg_m = 0.02;
        parts.transfer_time_s = 0.1;
        parts.estimator = Some(Estimator {
            learning: Learning::Squares {
                forget: 0.99,
                dead_band_m_s2: 0.1,
                deviation: [0.1, 0.2, 0.3, 0.4],
                filter_s: 0.02,
                inertia_v_s2_rad: [0.1, 0.2],
            },
            gravity_m_s2: 9.8,
            rate: PathSignal::HubRate,
            half_rate_rad_s: 0.01,
            volts_per_kg_m_s2: 0.002,
            rate_limit_kg_m_s: f64::INFINITY,
            hold_band_kg_m: 0.0,
            follow_samples: 0,
            hold_samples: 0,
        });
        Controller::new(parts).unwrap()
    }

    fn readings(k: usize) -> [f64; READINGS] {
        let angle = k as f64 * 0.1;
        [0.0, 0.1 * angle.sin(), 0.0, 1.5 * (0.7 * angle).sin(), 0.0, 0.01 * angle.cos(), 0.0]
    }

    /// Central differences of a whole step, after a stretch of motion.
    #[test]
    fn derivatives_are_those_of_the_step() {
        let controller = adaptive_controller();
        let programs = controller.programs();
        let n = programs.state_count();
        let mut tangent = Tangent::new(&programs.step, n);
        let mut states = programs.initial();
        let mut runner = controller.runner();
        for k in 0..200 {
            tangent.run(&mut states, &readings(k));
            runner.step_array(&readings(k));
        }
        assert_eq!(states, runner.states());
        let before = states.clone();
        tangent.run(&mut states, &readings(200));
        for j in 0..n {
            let moved = |by: f64| {
                let mut other = Tangent::new(&programs.step, n);
                let mut start = before.clone();
                start[j] += by;
                other.run(&mut start, &readings(200));
                start
            };
            let by = 1e-6 * before[j].abs().max(1e-3);
            let (above, below) = (moved(by), moved(-by));
            for i in 0..n {
                let expected = (above[i] - below[i]) / (2.0 * by);
                let found: f64 = tangent.state(i).iter().filter(|e| e.index == j).map(|e| e.value).sum();
                let size = expected.abs().max(1e-3 * before[i].abs().max(1e-6) / before[j].abs().max(1e-6));
                assert!((found - expected).abs() < 1e-5 * size.max(1e-4), "{i} by {j}: {found} {expected}");
            }
        }
    }
}
