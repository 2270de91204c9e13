//! How far rounding can carry the control away from the reference.

use counterpoise_controller::lti::Mat;
use counterpoise_controller::number::Dual;
use counterpoise_controller::program::{Compiled, OnReset, Operation, Slot};
use counterpoise_controller::{Controller, Number, READINGS, Runner};

use crate::Ranges;

/// Half a unit in the last place of single precision, relative.
const SINGLE_UNIT: f64 = 1.0 / (1u64 << 24) as f64;
/// Allowance for products of errors, which a first-order bound leaves out.
const SECOND_ORDER: f64 = 1.01;
/// Multiple of the root of the sum of squares in the likely bound.
pub const CONFIDENCE: f64 = 6.0;
/// 2 exp(-CONFIDENCE^2 / 2): how probable it is that a sample leaves the likely bound.
pub const CHANCE: f64 = 3.05e-8;
/// Share of the bound that one more sample must add for the sum to go on.
const NEGLIGIBLE: f64 = 1e-12;

/// What rounding does to the control, predicted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// No sample deviates more than this, V: to first order in the rounding, with the limiter inactive.
    pub worst_v: f64,
    /// No sample deviates more than this, V, but with a probability of [`CHANCE`] a sample, when the rounding errors of
    /// the operations are independent and of mean 0: the effect of rounded coefficients, plus [`CONFIDENCE`] times the
    /// root of the sum of the squared bounds (Higham and Mary 2019, a Hoeffding bound).
    pub likely_v: f64,
    /// RMS deviation when rounding errors are independent and uniform, V, at the end of the run.
    pub rms_v: f64,
    /// Number of samples from the start for which the two hold.
    pub samples: usize,
}

impl Deviation {
    /// No deviation at all: the reference itself.
    pub fn none(samples: usize) -> Self {
        Self { worst_v: 0.0, likely_v: 0.0, rms_v: 0.0, samples }
    }
}

/// One operation's rounding: the largest error, what of it is no noise, and the noise's variance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct OperationError {
    /// Largest error of what the operation writes.
    pub worst: f64,
    /// The part of it that is the same at every sample: of rounded coefficients.
    pub steady: f64,
    /// Sum of the squares of the bounds of the parts that are noise.
    pub squares: f64,
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
        let (mut worst, mut steady, mut squares, mut variance) = (0.0, 0.0, 0.0, 0.0);
        let mut add = |gains: &Mat| {
            let mut added = 0.0;
            for (j, error) in errors.iter().enumerate() {
                let gain = gains[(0, j)];
                added += gain.abs() * error.worst;
                steady += gain.abs() * error.steady;
                squares += gain * gain * error.squares;
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
        if !(worst.is_finite() && squares.is_finite() && variance.is_finite()) {
            let no_bound = f64::INFINITY;
            return Deviation { worst_v: no_bound, likely_v: no_bound, rms_v: no_bound, samples };
        }
        let likely = (steady + CONFIDENCE * squares.sqrt()).min(worst);
        let rms_v = variance.sqrt();
        Deviation { worst_v: worst * SECOND_ORDER, likely_v: likely * SECOND_ORDER, rms_v, samples }
    }
}

/// How far the controller in single precision can be from the reference over a run of `samples` samples in these ranges
///
/// ```text
///     |du[k]| <= sum over operations o and past samples j of |h_o(j)| e_o
/// ```
///
/// h_o is the impulse response from an error in operation o to the control, from the differentiated program; e_o bounds
/// the rounding of its coefficients, products and partial sums (Higham 2002, chapter 3). That bound lets every rounding
/// of the run go the same way, which an integrator never forgets: it is safe, and far away. The likely bound takes the
/// coefficients' effect from the runs of `ranges` ([`Ranges::of_coefficients_v`]) and the rest as independent.
pub fn single_precision(controller: &Controller, ranges: &Ranges, samples: usize) -> Deviation {
    let step = &controller.programs().step;
    let single = Single { controller, ranges };
    let mut errors: Vec<OperationError> = step.operations().map(|op| single.error(op)).collect();
    errors.extend((0..READINGS).map(|_| OperationError::default()));
    let rounding = ErrorSystem::of(controller).deviation(&errors, samples);
    let mut coefficients: Vec<OperationError> = step.operations().map(|op| single.coefficients(op)).collect();
    coefficients.extend((0..READINGS).map(|i| steady(SINGLE_UNIT * ranges.of(Slot::Input(i)))));
    let stored = ErrorSystem::of(controller).deviation(&coefficients, samples);
    let seen = ranges.of_coefficients_v();
    let worst_v = rounding.worst_v + stored.worst_v;
    Deviation {
        worst_v,
        likely_v: (rounding.likely_v + seen).min(worst_v),
        rms_v: rounding.rms_v.hypot(ranges.of_coefficients_rms_v()),
        samples,
    }
}

/// An error that is the same at every sample.
fn steady(worst: f64) -> OperationError {
    OperationError { worst, steady: worst, ..OperationError::default() }
}

/// Errors of operations in single precision.
struct Single<'a> {
    controller: &'a Controller,
    ranges: &'a Ranges,
}

impl Single<'_> {
    /// What the roundings of an operation itself do.
    fn error(&self, operation: &Operation) -> OperationError {
        let mut sum = Roundings::default();
        let of = |slot: Slot| (self.ranges.of(slot), self.ranges.rms(slot));
        match operation {
            Operation::Sum { constant, terms, .. } => {
                let size = constant.map_or(0.0, f64::abs);
                let (mut partial, mut square) = (size, size * size);
                for (i, term) in terms.iter().enumerate() {
                    let factor = term.coefficient.abs();
                    let (largest, rms) = of(term.of);
                    partial += factor * largest;
                    square += (factor * rms).powi(2);
                    if factor != 1.0 {
                        sum.add(factor * largest, factor * rms);
                    }
                    if i > 0 || constant.is_some() {
                        sum.add(partial, square.sqrt());
                    }
                }
            }
            Operation::Product { into, a, b } => {
                sum.add(self.ranges.of(*a) * self.ranges.of(*b), self.ranges.rms(*into));
            }
            Operation::Quotient { into, .. } => sum.add(self.ranges.of(*into), self.ranges.rms(*into)),
            Operation::Magnitude { .. } | Operation::Clamp { .. } => {}
        }
        sum.error()
    }

    /// What the rounding of stored numbers does: coefficients, limits, and states that are computed when the
    /// out-of-balance is set.
    fn coefficients(&self, operation: &Operation) -> OperationError {
        let size = |slot: &Slot| self.ranges.of(*slot);
        let kept = |slot: &Slot| if self.is_kept(*slot) { 3.0 } else { 0.0 };
        steady(
            SINGLE_UNIT
                * match operation {
                    Operation::Sum { constant, terms, .. } => {
                        let each = terms.iter().map(|term| {
                            let stored = f64::from(u8::from(term.coefficient.abs() != 1.0));
                            (stored + kept(&term.of)) * term.coefficient.abs() * size(&term.of)
                        });
                        constant.map_or(0.0, f64::abs) + each.sum::<f64>()
                    }
                    Operation::Product { a, b, .. } => (kept(a) + kept(b)) * size(a) * size(b),
                    Operation::Quotient { into, above, below } => (kept(above) + kept(below)) * size(into),
                    Operation::Magnitude { .. } => 0.0,
                    Operation::Clamp { low, high, .. } => low.abs().max(high.abs()),
                },
        )
    }

    /// States that a reset keeps are those that setting the out-of-balance computes.
    fn is_kept(&self, slot: Slot) -> bool {
        let Slot::State(i) = slot else { return false };
        self.controller.programs().locate(i).is_some_and(|(group, _)| group.on_reset == OnReset::Keep)
    }
}

/// The roundings of one operation, added up.
#[derive(Default)]
struct Roundings {
    worst: f64,
    squares: f64,
    variance: f64,
}

impl Roundings {
    /// One rounding of a result that is at most `largest`, usually `rms`.
    fn add(&mut self, largest: f64, rms: f64) {
        self.worst += SINGLE_UNIT * largest;
        self.squares += (SINGLE_UNIT * largest).powi(2);
        self.variance += (SINGLE_UNIT * rms).powi(2) / 3.0;
    }

    fn error(self) -> OperationError {
        OperationError { worst: self.worst, steady: 0.0, squares: self.squares, variance: self.variance }
    }
}
