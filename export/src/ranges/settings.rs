//! The values to which the out-of-balance can be set, and the largest gains and bias that follow.

use counterpoise_controller::program::{OnRestart, Operation, Slot};
use counterpoise_controller::{Controller, Scaling};

/// Returns the settings at which a gain has a corner: the ends of the range and the points of schedules, without
/// repetition.
pub(crate) fn settings(controller: &Controller) -> Vec<f64> {
    let parts = controller.parts();
    let (low, high) = parts.out_of_balance_range_kg_m;
    let point = |scaling: Scaling| match scaling {
        Scaling::Scheduled { at_kg_m, .. } => Some(at_kg_m.clamp(low, high)),
        _ => None,
    };
    let mut all = vec![low, high];
    all.extend(parts.paths.iter().filter_map(|path| point(path.scaling)));
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Returns bounds of the states that setting an out-of-balance within its range writes for good: interval arithmetic
/// over the program that sets it, with the other states within `largest`.
pub(super) fn setting_bounds(controller: &Controller, largest: &[f64]) -> Vec<(usize, f64)> {
    let programs = controller.programs();
    let program = &programs.set_out_of_balance;
    let (low, high) = controller.parts().out_of_balance_range_kg_m;
    let mut states: Vec<Span> = largest.iter().map(|value| Span(-value, *value)).collect();
    let mut locals = vec![Span(0.0, 0.0); program.locals.len()];
    for operation in program.operations() {
        let read = |slot: Slot| match slot {
            Slot::Input(_) => Span(low, high),
            Slot::State(i) => states[i],
            Slot::Local(i) => locals[i],
        };
        let written = span(operation, read);
        match operation.into_slot() {
            Slot::State(i) => states[i] = written,
            Slot::Local(i) => locals[i] = written,
            Slot::Input(_) => {}
        }
    }
    let kept = programs.states.iter().filter(|group| group.on_restart == OnRestart::Keep);
    let places = kept.flat_map(|group| group.first..group.first + group.initial.len());
    places.map(|i| (i, states[i].0.abs().max(states[i].1.abs()))).filter(|(_, b)| b.is_finite()).collect()
}

/// From the lowest to the highest value.
#[derive(Debug, Clone, Copy)]
struct Span(f64, f64);

impl Span {
    fn hull(corners: [f64; 4]) -> Self {
        let low = corners.into_iter().fold(f64::INFINITY, f64::min);
        Self(low, corners.into_iter().fold(f64::NEG_INFINITY, f64::max))
    }

    fn times(self, other: Self) -> Self {
        Self::hull([self.0 * other.0, self.0 * other.1, self.1 * other.0, self.1 * other.1])
    }

    fn divide(self, other: Self) -> Self {
        if other.0 <= 0.0 && other.1 >= 0.0 {
            return Self(f64::NEG_INFINITY, f64::INFINITY);
        }
        self.times(Self(1.0 / other.1, 1.0 / other.0))
    }
}

fn span(operation: &Operation, read: impl Fn(Slot) -> Span) -> Span {
    match operation {
        Operation::Sum { constant, terms, .. } => {
            let start = constant.unwrap_or(0.0);
            terms.iter().fold(Span(start, start), |sum, term| {
                let each = read(term.of).times(Span(term.coefficient, term.coefficient));
                Span(sum.0 + each.0, sum.1 + each.1)
            })
        }
        Operation::Product { a, b, .. } => read(*a).times(read(*b)),
        Operation::Quotient { above, below, .. } => read(*above).divide(read(*below)),
        Operation::Magnitude { of, .. } => {
            let of = read(*of);
            Span(0.0, of.0.abs().max(of.1.abs()))
        }
        Operation::Clamp { of, low, high, .. } => {
            let of = read(*of);
            Span(of.0.clamp(*low, *high), of.1.clamp(*low, *high))
        }
    }
}
