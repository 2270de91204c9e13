//! The deviation of the control from the reference by rounding.

mod gains;
mod single_precision;
mod tangent;
mod trajectory;

use counterpoise_controller::Controller;
use counterpoise_controller::program::{OnRestart, Operation, Slot};

use gains::Gains;
pub use single_precision::single_precision;
use trajectory::ErrorTrack;

use crate::Ranges;
use crate::ranges::{Run, larger_bound, settings};
use crate::tolerance::SECOND_ORDER;
pub use crate::tolerance::{LIKELY_BOUND_EXCEEDANCE, LIKELY_BOUND_FACTOR};

/// Deviation of the control that rounding causes, predicted to first order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// If the step is linear but for its limiter: no sample deviates more than this, V, whatever the readings, as long as
    /// every number stays within its range and the limiter is inactive. With a friction observer, an estimator or a drive's
    /// curve the same sum with the derivatives at rest: a measure, not a bound. Never less than [`Deviation::likely_v`].
    pub worst_v: f64,
    /// No sample of the runs that the ranges come from deviates more than this, V, but with a probability of [`LIKELY_BOUND_EXCEEDANCE`] a
    /// sample, when the rounding errors of the operations have mean 0: what rounded coefficients do in these runs, plus
    /// [`LIKELY_BOUND_FACTOR`] times the root of the sum of the squared bounds of every rounding on the way (Higham and Mary 2019,
    /// a Hoeffding bound), each bound from the number that was rounded at that time, and carried on by the derivatives of
    /// every step as it ran: estimators, observers and limits as they were. What is added to a state at rest rounds the same way
    /// again and again: that part is known, and carried on with its sign.
    pub likely_v: f64,
    /// RMS deviation of the run where it is largest, V, when rounding errors are independent and uniform. They are not where a state
    /// fades by less than half its unit a sample: in fixed point it stays where it is. A transfer that an estimator feeds all the
    /// time, with a factor of 0.995, rests anywhere within 100 units; there the RMS deviation is twice what is predicted.
    pub rms_v: f64,
    /// Number of samples from the start for which the first holds.
    pub samples: usize,
}

impl Deviation {
    /// Returns no deviation at all: the reference itself.
    pub fn none(samples: usize) -> Self {
        Self { worst_v: 0.0, likely_v: 0.0, rms_v: 0.0, samples }
    }
}

/// The straight line that an operation belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Line {
    /// A sample.
    Step,
    /// A setting of the out-of-balance.
    Set,
}

/// An operation with what it read and wrote.
pub(crate) struct ExecutedOperation<'a> {
    /// Number in its line.
    pub number: usize,
    pub operation: &'a Operation,
    pub read: &'a [f64],
    pub written: f64,
}

/// The rounding of an operation.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct OperationRounding {
    /// The part that does not average out, with its sign.
    pub known: f64,
    /// The square of the bound of the rest.
    pub square: f64,
}

/// The facts that an arithmetic must tell for its deviation to be predicted.
pub(crate) trait Arithmetic {
    /// Returns the largest error of each operation of a step, then of each reading, whatever the readings.
    fn worst_errors(&self) -> Vec<f64>;
    /// Returns for each run what rounded coefficients and readings do to the control of each sample, V.
    fn coefficients(&self, runs: &[Run]) -> Vec<Vec<f64>>;
    /// Returns a reading as the step gets it.
    fn stored_reading(&self, value: f64) -> f64;
    /// Returns what an operation of a line rounds as it was executed.
    fn rounding_of(&self, line: Line, executed: &ExecutedOperation<'_>) -> OperationRounding;
}

/// Returns the deviation of an arithmetic. The worst case takes for every setting of the out-of-balance the impulse
/// responses of the step around rest,
///
/// ```text
///     |du[k]| <= sum over operations o and past samples j of |h_o(j)| e_o[k-j]
/// ```
///
/// and the largest of all settings; the likely one follows every run.
pub(crate) fn deviation(
    controller: &Controller,
    ranges: &Ranges,
    arithmetic: &impl Arithmetic,
    samples: usize,
) -> Deviation {
    let all = std::iter::once(None).chain(settings(controller).into_iter().map(Some));
    let errors = arithmetic.worst_errors();
    let at_rest =
        all.map(|set| Gains::of(controller, set, samples).constant(&errors)).fold(0.0, larger_bound);
    let tracks = trajectory::track_errors(controller, ranges.runs(), arithmetic);
    let coefficients = arithmetic.coefficients(ranges.runs()).into_iter();
    let along = coefficients.zip(tracks).map(|(coefficients, track)| run_deviation(coefficients, track));
    let (likely, rms_v) = along.fold((0.0, 0.0), |a, b| (larger_bound(a.0, b.0), larger_bound(a.1, b.1)));
    let (at_rest, likely) = (SECOND_ORDER * at_rest, SECOND_ORDER * likely);
    if !(at_rest.is_finite() && likely.is_finite() && rms_v.is_finite()) {
        let none = f64::INFINITY;
        return Deviation { worst_v: none, likely_v: none, rms_v: none, samples };
    }
    Deviation { worst_v: at_rest.max(likely), likely_v: likely, rms_v, samples }
}

/// Likely and RMS deviation of a run, V, from what rounded coefficients do in it and from what rounding does.
fn run_deviation(coefficients: Vec<f64>, track: ErrorTrack) -> (f64, f64) {
    let known = coefficients.into_iter().zip(track.mean_v).map(|(a, b)| a + b);
    let (mut likely, mut squares) = (0.0, 0.0);
    for (known, square) in known.zip(&track.squares_v2) {
        likely = larger_bound(likely, known.abs() + LIKELY_BOUND_FACTOR * square.sqrt());
        squares += known * known + square / 3.0;
    }
    (likely, (squares / track.squares_v2.len().max(1) as f64).sqrt())
}

/// Returns what an operation adds to a state; `None` if it adds nothing to one. The state lies on the grid of its numbers already, so that
/// what is rounded is the summand, the same way whenever the summand is the same.
pub(crate) fn state_increment(operation: &Operation, read: &[f64]) -> Option<(usize, f64)> {
    let Operation::Sum { constant, terms, .. } = operation else { return None };
    let (first, rest) = terms.split_first()?;
    let Slot::State(state) = first.of else { return None };
    let each = rest.iter().zip(&read[1..]).map(|(term, value)| term.coefficient * value);
    (first.coefficient == 1.0 && !rest.is_empty())
        .then(|| (state, constant.unwrap_or(0.0) + each.sum::<f64>()))
}

/// Returns what rounding to multiples of `grid` adds to a value.
pub(crate) fn to_grid(value: f64, grid: f64) -> f64 {
    (value / grid).round() * grid - value
}

/// Returns whether a state is one that a setting of the out-of-balance computes and a restart keeps.
pub(crate) fn is_kept(controller: &Controller, slot: Slot) -> bool {
    let Slot::State(i) = slot else { return false };
    controller.programs().locate(i).is_some_and(|(group, _)| group.on_restart == OnRestart::Keep)
}

/// Returns the error of each operation that comes from operands which a setting left wrong by `error`.
pub(crate) fn setting_errors(
    controller: &Controller,
    ranges: &Ranges,
    error: &dyn Fn(&Slot) -> f64,
) -> Vec<f64> {
    let size = |slot: &Slot| ranges.of(*slot);
    let of = |operation: &Operation| match operation {
        Operation::Sum { terms, .. } => {
            terms.iter().map(|term| term.coefficient.abs() * error(&term.of)).sum()
        }
        Operation::Product { a, b, .. } => error(a) * size(b) + error(b) * size(a),
        Operation::Quotient { into, above, below } if size(below) > 0.0 => {
            (error(above) + error(below) * size(into)) / size(below)
        }
        _ => 0.0,
    };
    let writes_kept = |operation: &Operation| is_kept(controller, operation.into_slot());
    let program = &controller.programs().step;
    // An estimator writes the kept states in every step: what a setting left wrong does not stay.
    if program.operations().any(writes_kept) {
        return vec![0.0; program.operations().count()];
    }
    program.operations().map(of).collect()
}
