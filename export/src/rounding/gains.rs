//! The effect of an operation's error on later controls at rest: impulse responses, summed over time.

use crate::tolerance::NEGLIGIBLE_SENSITIVITY;
use counterpoise_controller::compiled_program::CompiledProgram;
use counterpoise_controller::number::Dual;
use counterpoise_controller::{Controller, Number, Runner};
use counterpoise_linalg::sparse::VectorEntry;

/// A limit that no control reaches.
const UNLIMITED_V: f64 = 1e30;

/// Sums of |h| over past samples, for an error added to what each operation writes, then to each reading.
pub(crate) struct Gains {
    magnitudes: Vec<f64>,
}

/// A sparse column: places and values.
type Column = Vec<VectorEntry>;

/// The step as a linear system of its errors
///
/// ```text
///     x[k+1] = A x[k] + E e[k],    u = C x[k] + F e[k]        e: one error an operation, then one a reading
/// ```
struct ErrorSystem {
    A: Vec<Column>,
    E: Vec<Column>,
    C: Vec<f64>,
    F: Vec<f64>,
}

impl ErrorSystem {
    /// Differentiates the step at rest, with the out-of-balance that is set, by its states and its errors.
    fn of(controller: &Controller, set_kg_m: Option<f64>) -> Self {
        let programs = controller.programs();
        let n = programs.state_count();
        let inputs = programs.step.inputs.len();
        let errors = programs.step.operations().count() + inputs;
        let unit = |i: usize, value: f64| {
            let mut slope = vec![0.0; n + errors];
            slope[i] = 1.0;
            Dual { value, slope }
        };
        let step = CompiledProgram::<Dual>::new(&programs.step, n);
        let mut memory = vec![Dual::from_f64(0.0); step.memory()];
        for (i, (place, value)) in memory.iter_mut().zip(start(controller, set_kg_m)).enumerate() {
            *place = unit(i, value);
        }
        let readings: Vec<Dual> = (0..inputs).map(|j| unit(n + errors - inputs + j, 0.0)).collect();
        let touch = |number: usize, written: &mut Dual| *written = written.plus(&unit(n + number, 0.0));
        let output = step.run_touched(&mut memory, &readings, touch).unwrap_or(Dual::from_f64(0.0));
        let at = |row: &Dual, j: usize| row.slope.get(j).copied().unwrap_or(0.0);
        let column = |j: usize| {
            let all = (0..n).map(|i| VectorEntry::new(i, at(&memory[i], j)));
            all.filter(|entry| entry.value != 0.0).collect::<Column>()
        };
        Self {
            A: (0..n).map(column).collect(),
            E: (n..n + errors).map(column).collect(),
            C: (0..n).map(|j| at(&output, j)).collect(),
            F: (n..n + errors).map(|j| at(&output, j)).collect(),
        }
    }
}

fn start(controller: &Controller, set_kg_m: Option<f64>) -> Vec<f64> {
    let mut runner = Runner::<f64>::new(controller);
    if let Some(value) = set_kg_m {
        runner.set_out_of_balance(value);
    }
    runner.states()
}

impl Gains {
    /// Returns the gains over `samples` samples from the start, at a setting of the out-of-balance.
    pub fn of(controller: &Controller, set_kg_m: Option<f64>, samples: usize) -> Self {
        // The bias alone may reach the limiter, behind which nothing would be seen.
        let unlimited = controller.with(|parts| parts.limit_v = UNLIMITED_V);
        let system = ErrorSystem::of(unlimited.as_ref().unwrap_or(controller), set_kg_m);
        let mut gains = Self { magnitudes: vec![0.0; system.F.len()] };
        gains.add(&system.F);
        let mut row = system.C.clone();
        for _ in 1..samples {
            let response: Vec<f64> = system.E.iter().map(|column| dot(&row, column)).collect();
            gains.add(&response);
            row = system.A.iter().map(|column| flush_negligible(dot(&row, column))).collect();
            if row.iter().all(|entry| *entry == 0.0) {
                break;
            }
        }
        gains
    }

    fn add(&mut self, response: &[f64]) {
        for (sum, h) in self.magnitudes.iter_mut().zip(response) {
            *sum += h.abs();
        }
    }

    /// Returns the sum of |h| times errors that may have any sign at any time.
    pub fn constant(&self, errors: &[f64]) -> f64 {
        let each = self.magnitudes.iter().zip(errors).filter(|(_, error)| **error != 0.0);
        each.map(|(gain, error)| gain * error).sum()
    }
}

fn dot(row: &[f64], column: &Column) -> f64 {
    column.iter().map(|entry| row[entry.index] * entry.value).sum()
}

/// 0 for what is so small that it would only slow the arithmetic down.
fn flush_negligible(value: f64) -> f64 {
    if value.abs() < NEGLIGIBLE_SENSITIVITY { 0.0 } else { value }
}
