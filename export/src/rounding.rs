//! How far rounding can carry the control away from the reference.

use counterpoise_controller::lti::Mat;
use counterpoise_controller::number::Dual;
use counterpoise_controller::program::{Compiled, Operation, Slot};
use counterpoise_controller::{Controller, Number, READINGS, Runner};

use crate::Ranges;

/// Half a unit in the last place of single precision, relative.
const SINGLE_UNIT: f64 = 1.0 / (1u64 << 24) as f64;
/// Allowance for products of errors, which a first-order bound leaves out.
const SECOND_ORDER: f64 = 1.01;
/// Share of the bound that one more sample must add for the sum to go on.
const NEGLIGIBLE: f64 = 1e-12;

/// What rounding does to the control, predicted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// No sample deviates more than this, V: to first order in the rounding, with the limiter inactive.
    pub worst_v: f64,
    /// RMS deviation when rounding errors are independent and uniform, V, at the end of the run.
    pub rms_v: f64,
    /// Number of samples from the start for which the two hold.
    pub samples: usize,
}

/// One operation's rounding: the largest error, and its variance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct OperationError {
    /// Largest error of what the operation writes.
    pub worst: f64,
    /// Variance of the part that is noise.
    pub variance: f64,
}

/// The step as a linear system of its rounding errors
///
/// ```text
///     x[k+1] = A x[k] + E e[k],    u = C x[k] + F e[k]        e: one error an operation, then one a reading
/// ```
pub(crate) struct ErrorSystem {
    A: Mat,
    E: Mat,
    C: Mat,
    F: Mat,
}

impl ErrorSystem {
    /// Differentiates the step at rest by its states and by an error added to what each operation writes.
    pub fn of(controller: &Controller) -> Self {
        let programs = controller.programs();
        let n = programs.state_count();
        let operations = programs.step.operations().count();
        let variables = n + operations + READINGS;
        let unit = |i: usize, value: f64| {
            let mut slope = vec![0.0; variables];
            slope[i] = 1.0;
            Dual { value, slope }
        };
        let step = Compiled::<Dual>::new(&programs.step, n);
        let mut memory = vec![Dual::from_f64(0.0); step.memory()];
        for (i, (place, value)) in memory.iter_mut().zip(Runner::<f64>::new(controller).states()).enumerate()
        {
            *place = unit(i, value);
        }
        let readings: Vec<Dual> = (0..READINGS).map(|j| unit(n + operations + j, 0.0)).collect();
        let touch = |number: usize, written: &mut Dual| *written = written.plus(&unit(n + number, 0.0));
        let output = step.run_touched(&mut memory, &readings, touch).unwrap_or(Dual::from_f64(0.0));
        let at = |row: &Dual, j: usize| row.slope.get(j).copied().unwrap_or(0.0);
        Self {
            A: Mat::from_fn(n, n, |i, j| at(&memory[i], j)),
            E: Mat::from_fn(n, operations + READINGS, |i, j| at(&memory[i], n + j)),
            C: Mat::from_fn(1, n, |_, j| at(&output, j)),
            F: Mat::from_fn(1, operations + READINGS, |_, j| at(&output, n + j)),
        }
    }

    /// Sum over `samples` samples of |impulse response| times worst error, and of its square times variance; infinite
    /// for a controller so unstable that the sums overflow.
    pub fn deviation(&self, errors: &[OperationError], samples: usize) -> Deviation {
        let mut worst = 0.0;
        let mut variance = 0.0;
        let mut add = |gains: &Mat| {
            let mut added = 0.0;
            for (j, error) in errors.iter().enumerate() {
                let gain = gains[(0, j)];
                added += gain.abs() * error.worst;
                variance += gain * gain * error.variance;
            }
            worst += added;
            added > NEGLIGIBLE * worst
        };
        add(&self.F);
        let mut row = self.C.clone();
        for _ in 1..samples {
            if !add(&(&row * &self.E)) {
                break;
            }
            row = &row * &self.A;
        }
        if !(worst.is_finite() && variance.is_finite()) {
            return Deviation { worst_v: f64::INFINITY, rms_v: f64::INFINITY, samples };
        }
        Deviation { worst_v: worst * SECOND_ORDER, rms_v: variance.sqrt(), samples }
    }
}

/// How far the controller in single precision can be from the reference over a run of `samples` samples in these ranges
///
/// ```text
///     |du[k]| <= sum over operations o and past samples j of |h_o(j)| e_o
/// ```
///
/// h_o is the impulse response from an error in operation o to the control, from the differentiated program; e_o bounds
/// the rounding of its coefficients, products and partial sums (Higham 2002, chapter 3).
pub fn single_precision(controller: &Controller, ranges: &Ranges, samples: usize) -> Deviation {
    let step = &controller.programs().step;
    let mut errors: Vec<OperationError> = step.operations().map(|op| single_error(op, ranges)).collect();
    errors.extend((0..READINGS).map(|i| noise(SINGLE_UNIT * ranges.of(Slot::Input(i)))));
    ErrorSystem::of(controller).deviation(&errors, samples)
}

fn noise(worst: f64) -> OperationError {
    OperationError { worst, variance: worst * worst / 3.0 }
}

fn single_error(operation: &Operation, ranges: &Ranges) -> OperationError {
    let u = SINGLE_UNIT;
    match operation {
        Operation::Sum { constant, terms, .. } => {
            let mut partial = constant.map_or(0.0, f64::abs);
            let mut worst = u * partial;
            for (i, term) in terms.iter().enumerate() {
                let size = term.coefficient.abs() * ranges.of(term.of);
                let exact = term.coefficient.abs() == 1.0;
                partial += size;
                worst += u * size * if exact { 0.0 } else { 2.0 } + 3.0 * u * kept(term.of, size);
                worst += if i > 0 || constant.is_some() { u * partial } else { 0.0 };
            }
            noise(worst)
        }
        Operation::Product { a, b, .. } => noise(4.0 * u * ranges.of(*a) * ranges.of(*b)),
        Operation::Quotient { into, .. } => noise(6.0 * u * ranges.of(*into)),
        Operation::Magnitude { .. } => noise(0.0),
        Operation::Clamp { low, high, .. } => noise(u * low.abs().max(high.abs())),
    }
}

/// States that are computed when the out-of-balance is set carry an error of their own.
fn kept(slot: Slot, size: f64) -> f64 {
    if matches!(slot, Slot::State(_)) { size } else { 0.0 }
}
