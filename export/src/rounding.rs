//! How far rounding can carry the control away from the reference.

mod gains;
mod single;

use counterpoise_controller::Controller;
use counterpoise_controller::program::{OnReset, Operation, Slot};

pub(crate) use gains::Gains;
pub use single::single_precision;

use crate::Ranges;
use crate::ranges::{Run, settings};

/// Allowance for products of errors, which a first-order bound leaves out.
const SECOND_ORDER: f64 = 1.01;
/// Multiple of the root of the sum of squares in the likely bound.
pub const CONFIDENCE: f64 = 6.0;
/// 2 exp(-CONFIDENCE^2 / 2): how probable it is that a sample leaves the likely bound.
pub const CHANCE: f64 = 3.05e-8;

/// What rounding does to the control, predicted to first order around rest, with the limiter inactive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// No sample deviates more than this, V, whatever the readings, as long as every number stays within its range.
    pub worst_v: f64,
    /// No sample of the runs that the ranges come from deviates more than this, V, but with a probability of [`CHANCE`] a
    /// sample, when the rounding errors of the operations have mean 0: what rounded coefficients do in these runs, plus
    /// [`CONFIDENCE`] times the root of the sum of the squared bounds of every rounding on the way (Higham and Mary 2019,
    /// a Hoeffding bound), each bound from the number that was rounded at that time.
    pub likely_v: f64,
    /// RMS deviation of the run where it is largest, V, when rounding errors are independent and uniform.
    pub rms_v: f64,
    /// Number of samples from the start for which the first holds.
    pub samples: usize,
}

impl Deviation {
    /// No deviation at all: the reference itself.
    pub fn none(samples: usize) -> Self {
        Self { worst_v: 0.0, likely_v: 0.0, rms_v: 0.0, samples }
    }

    /// The larger of two, figure by figure.
    fn or(self, other: Self) -> Self {
        Self {
            worst_v: self.worst_v.max(other.worst_v),
            likely_v: self.likely_v.max(other.likely_v),
            rms_v: self.rms_v.max(other.rms_v),
            samples: self.samples.max(other.samples),
        }
    }
}

/// What rounded coefficients did to the control of a run.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Effect {
    /// Largest deviation, V.
    pub largest_v: f64,
    /// Mean square, V^2.
    pub mean_square_v2: f64,
}

impl Effect {
    /// Of the deviations of each sample.
    pub fn of(deviations_v: &[f64]) -> Self {
        let squares: f64 = deviations_v.iter().map(|v| v * v).sum();
        Self {
            largest_v: deviations_v.iter().fold(0.0, |most, v| most.max(v.abs())),
            mean_square_v2: squares / deviations_v.len().max(1) as f64,
        }
    }
}

/// The sum over time of the squared bounds of roundings, weighted by what they do to the control, V^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Noise {
    /// At the sample where it is largest.
    pub largest_v2: f64,
    /// Mean over the run.
    pub mean_v2: f64,
}

/// What an arithmetic must tell for its deviation to be predicted.
pub(crate) trait Arithmetic {
    /// Largest error of each operation, then of each reading, whatever the readings.
    fn worst(&self) -> Vec<f64>;
    /// What a setting left wrong in kept states adds to the error of each operation.
    fn kept(&self) -> Vec<f64>;
    /// What rounded coefficients do in a run.
    fn coefficients(&self, run: &Run) -> Effect;
    /// The noise of a run.
    fn noise(&self, run: &Run, gains: &Gains) -> Noise;
}

/// The deviation of an arithmetic: for every setting of the out-of-balance the impulse responses of the step around rest,
///
/// ```text
///     |du[k]| <= sum over operations o and past samples j of |h_o(j)| e_o[k-j]
/// ```
///
/// and the largest figures of all settings.
pub(crate) fn deviation(
    controller: &Controller,
    ranges: &Ranges,
    arithmetic: &impl Arithmetic,
    samples: usize,
) -> Deviation {
    let all = std::iter::once(None).chain(settings(controller).into_iter().map(Some));
    let (worst, kept) = (arithmetic.worst(), arithmetic.kept());
    let of_setting = |set: Option<f64>| {
        let gains = Gains::of(controller, set, samples);
        let runs = ranges.runs().iter().filter(|run| run.set_kg_m == set);
        let kept_v = gains.constant(&kept);
        let figures = runs.map(|run| {
            let (seen, noise) = (arithmetic.coefficients(run), arithmetic.noise(run, &gains));
            let likely_v = seen.largest_v + kept_v + CONFIDENCE * noise.largest_v2.sqrt();
            (likely_v, (seen.mean_square_v2 + noise.mean_v2 / 3.0).sqrt())
        });
        let (likely, rms_v) = figures.fold((0.0, 0.0), |a, b| (f64::max(a.0, b.0), f64::max(a.1, b.1)));
        let worst_v = SECOND_ORDER * gains.constant(&worst);
        Deviation { worst_v, likely_v: (SECOND_ORDER * likely).min(worst_v), rms_v, samples }
    };
    let found = all.map(of_setting).fold(Deviation::none(samples), Deviation::or);
    let figures = [found.worst_v, found.likely_v, found.rms_v];
    if figures.iter().all(|figure| figure.is_finite()) {
        found
    } else {
        let none = f64::INFINITY;
        Deviation { worst_v: none, likely_v: none, rms_v: none, samples }
    }
}

/// Whether a state is one that a setting of the out-of-balance computes and a reset keeps.
pub(crate) fn is_kept(controller: &Controller, slot: Slot) -> bool {
    let Slot::State(i) = slot else { return false };
    controller.programs().locate(i).is_some_and(|(group, _)| group.on_reset == OnReset::Keep)
}

/// Error of each operation that comes from operands which a setting left wrong by `error`.
pub(crate) fn left_wrong(controller: &Controller, ranges: &Ranges, error: &dyn Fn(&Slot) -> f64) -> Vec<f64> {
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
