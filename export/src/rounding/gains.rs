//! What an error of an operation does to later controls: impulse responses, summed over blocks of time.

use counterpoise_controller::number::Dual;
use counterpoise_controller::program::Compiled;
use counterpoise_controller::{Controller, Number, READINGS, Runner};

use super::Noise;

/// Blocks into which the longest run is cut.
const BLOCKS: usize = 48;
/// Below this, relative to the sensitivity's largest entry so far, a sensitivity of the control is taken for 0.
const NEGLIGIBLE: f64 = 1e-200;

/// Sums of |h| and h^2 over blocks of past samples, for an error added to what each operation writes, then to each
/// reading.
pub(crate) struct Gains {
    /// Length of a block in samples.
    pub block: usize,
    magnitudes: Vec<f64>,
    squares: Vec<Vec<f64>>,
}

/// A sparse column: places and values.
type Column = Vec<(usize, f64)>;

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
        let errors = programs.step.operations().count() + READINGS;
        let unit = |i: usize, value: f64| {
            let mut slope = vec![0.0; n + errors];
            slope[i] = 1.0;
            Dual { value, slope }
        };
        let step = Compiled::<Dual>::new(&programs.step, n);
        let mut memory = vec![Dual::from_f64(0.0); step.memory()];
        for (i, (place, value)) in memory.iter_mut().zip(start(controller, set_kg_m)).enumerate() {
            *place = unit(i, value);
        }
        let readings: Vec<Dual> = (0..READINGS).map(|j| unit(n + errors - READINGS + j, 0.0)).collect();
        let touch = |number: usize, written: &mut Dual| *written = written.plus(&unit(n + number, 0.0));
        let output = step.run_touched(&mut memory, &readings, touch).unwrap_or(Dual::from_f64(0.0));
        let at = |row: &Dual, j: usize| row.slope.get(j).copied().unwrap_or(0.0);
        let column = |j: usize| {
            let all = (0..n).map(|i| (i, at(&memory[i], j)));
            all.filter(|(_, value)| *value != 0.0).collect::<Column>()
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
    /// The gains over `samples` samples from the start, at a setting of the out-of-balance.
    pub fn of(controller: &Controller, set_kg_m: Option<f64>, samples: usize) -> Self {
        let system = ErrorSystem::of(controller, set_kg_m);
        let block = samples.div_ceil(BLOCKS).max(1);
        let mut gains = Self { block, magnitudes: vec![0.0; system.F.len()], squares: Vec::new() };
        gains.add(0, &system.F);
        let mut row = system.C.clone();
        for k in 1..samples {
            let response: Vec<f64> = system.E.iter().map(|column| dot(&row, column)).collect();
            gains.add(k, &response);
            row = system.A.iter().map(|column| flushed(dot(&row, column))).collect();
            if row.iter().all(|entry| *entry == 0.0) {
                break;
            }
        }
        gains
    }

    fn add(&mut self, k: usize, response: &[f64]) {
        if k.is_multiple_of(self.block) {
            self.squares.push(vec![0.0; response.len()]);
        }
        for (sum, h) in self.magnitudes.iter_mut().zip(response) {
            *sum += h.abs();
        }
        if let Some(block) = self.squares.last_mut() {
            block.iter_mut().zip(response).for_each(|(sum, h)| *sum += h * h);
        }
    }

    /// Sum of |h| times errors that may have any sign at any time.
    pub fn constant(&self, errors: &[f64]) -> f64 {
        let each = self.magnitudes.iter().zip(errors).filter(|(_, error)| **error != 0.0);
        each.map(|(gain, error)| gain * error).sum()
    }

    /// Sum of h^2 times squared errors that are the same at all times.
    pub fn steady_noise(&self, squares: &[f64]) -> Noise {
        let all = self.squares.iter().map(|block| product(block, squares)).sum();
        Noise { largest_v2: all, mean_v2: all }
    }

    /// Sum of h^2 times squared errors of a run, given by blocks of time: in each block the largest of every operation.
    ///
    /// A sample of block m lies `j` samples, j in block b, behind a sample of block m - b or of the one before.
    pub fn noise(&self, blocks: &[Vec<f64>]) -> Noise {
        let before = |m: usize| m.checked_sub(1).and_then(|i| blocks.get(i));
        let either = |m: usize| match before(m) {
            Some(earlier) => blocks[m].iter().zip(earlier).map(|(a, b)| a.max(*b)).collect(),
            None => blocks[m].clone(),
        };
        let errors: Vec<Vec<f64>> = (0..blocks.len()).map(either).collect();
        let at = |m: usize| -> f64 {
            let pairs = self.squares.iter().zip(errors[..=m].iter().rev());
            pairs.map(|(gains, squares)| product(gains, squares)).sum()
        };
        let all: Vec<f64> = (0..errors.len()).map(at).collect();
        let largest_v2 = all.iter().copied().fold(0.0, f64::max);
        Noise { largest_v2, mean_v2: all.iter().sum::<f64>() / all.len().max(1) as f64 }
    }
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn dot(row: &[f64], column: &Column) -> f64 {
    column.iter().map(|(i, value)| row[*i] * value).sum()
}

/// 0 for what is so small that it would only slow the arithmetic down.
fn flushed(value: f64) -> f64 {
    if value.abs() < NEGLIGIBLE { 0.0 } else { value }
}
