//! Minimal realisation: the states that the input reaches and the output sees, with the gap at which it was cut.

use crate::error::StepContext;
use crate::state_units::ScaledSystem;
use crate::tolerance::{CERTAIN_GAP, PRECISE_STATES, SAFE_GAP};
use crate::{Error, Warning};
use counterpoise_linalg as linalg;
use counterpoise_linalg::Mat;
use counterpoise_lti::StateSpace;
use counterpoise_lti::components::driven_states;

/// A minimal realisation and the numbers it rests on.
#[derive(Debug, Clone, PartialEq)]
pub struct MinimalRealisation {
    /// The realisation.
    pub system: StateSpace,
    /// States that no input reaches.
    pub unreachable: usize,
    /// States, reachable ones, that no output sees.
    pub unobservable: usize,
    /// The smallest singular value counted as a coupling, relative to the norm of the scaled system.
    pub smallest_kept: f64,
    /// The largest singular value counted as zero, likewise.
    pub largest_dropped: f64,
    /// Warnings for the user.
    pub warnings: Vec<Warning>,
}

/// Returns the part of a system that is reachable and seen; unstable systems too.
///
/// Nothing that decides depends on the units of states, inputs and outputs. First the states go that no way of couplings leads to from an input, or from
/// which none leads to an output. The others are scaled: the rows and columns of \[A B; C 0\] get norms of like size. There, a group of states goes
/// whose couplings to all others are so weak that less than `tolerance` of what the strongest states pass from input to output passes through it. The rest
/// is decided by orthogonal staircases, where a coupling counts whose singular value exceeds `tolerance` times the norm of \[A B\] (or \[A; C\]);
/// 1e-11 suits most systems. If they leave a gap of less than eight decades, a system of at most [`PRECISE_STATES`] states is taken apart again in 32
/// digits ([`linalg::minimal_part`]). The gap between the smallest value kept and the largest dropped is returned: a clear order has a gap of many
/// decades, and a gap below [`SAFE_GAP`] is a warning.
///
/// # Errors
/// [`Error::Range`] for a tolerance outside (0, 1), [`Error::Matrix`].
pub fn minimal_realisation(g: &StateSpace, tolerance: f64) -> Result<MinimalRealisation, Error> {
    if !(tolerance > 0.0 && tolerance < 1.0) {
        return Err(Error::Range { what: "tolerance", value: tolerance, allowed: "between 0 and 1" });
    }
    let mut gap = Gap { kept: 1.0, dropped: 0.0 };
    let reached = driven_states(g);
    let connected: Vec<usize> =
        driven_states(&g.dual()).into_iter().filter(|i| reached.contains(i)).collect();
    if connected.is_empty() {
        let (unreachable, nothing) = (g.order() - reached.len(), states_of(g, &[])?);
        return Ok(MinimalRealisation::with_gap(nothing, unreachable, reached.len(), &gap));
    }
    let scaled = ScaledSystem::of(&states_of(g, &connected)?)?;
    let weak = weak_states(&scaled, tolerance, &mut gap);
    let kept: Vec<usize> = (0..connected.len()).filter(|i| !weak.contains(i)).collect();
    let system = states_of(&scaled.system, &kept)?;
    let mut found = if system.order() == 0 {
        MinimalRealisation::with_gap(system, 0, 0, &gap)
    } else {
        connected_part(&system, tolerance, gap)?
    };
    // What is left of a group of weak states is uncontrollable or unobservable, which is one and the same in these units; in those of the caller the weaker one.
    let unreached = weak.iter().filter(|&&i| scaled.states[i] < 1.0).count();
    found.unreachable += g.order() - reached.len() + unreached;
    found.unobservable += reached.len() - connected.len() + weak.len() - unreached;
    found.system = scaled.restore_signals(found.system);
    let StateSpace { A, B, C, .. } = &found.system;
    if [A, B, C].into_iter().all(Mat::is_finite) {
        return Ok(found);
    }
    Err(linalg::Error::OutOfRange { what: "a system in units of its own" }).with_step("minimal realisation")
}

/// Returns the part of a scaled system that is reachable and seen, by orthogonal staircases or in 32 digits.
fn connected_part(scaled: &StateSpace, tolerance: f64, mut gap: Gap) -> Result<MinimalRealisation, Error> {
    let size = |M: &Mat| M.norm_fro().max(f64::MIN_POSITIVE);
    // What is left of a matrix after the first staircase may be rounding alone, so both are judged by the whole system.
    let sizes = (size(&scaled.A), size(&scaled.B), size(&scaled.C));
    let mut stairs = Gap { kept: 1.0, dropped: 0.0 };
    let reached = reachable_part(scaled, sizes.0, sizes.1, tolerance, &mut stairs)?;
    let unreachable = scaled.order() - reached.order();
    let seen = reachable_part(&reached.dual(), sizes.0, sizes.2, tolerance, &mut stairs)?.dual();
    let unobservable = reached.order() - seen.order();
    if scaled.order() <= PRECISE_STATES && stairs.kept < CERTAIN_GAP * stairs.dropped.max(f64::EPSILON) {
        return in_32_digits(scaled, tolerance, gap);
    }
    gap.include(stairs.kept, stairs.dropped);
    Ok(MinimalRealisation::with_gap(seen, unreachable, unobservable, &gap))
}

/// Returns the system of some of the states, without the others.
fn states_of(g: &StateSpace, states: &[usize]) -> Result<StateSpace, Error> {
    let (inputs, outputs): (Vec<usize>, Vec<usize>) = ((0..g.inputs()).collect(), (0..g.outputs()).collect());
    let (B, C) = (g.B.select(states, &inputs), g.C.select(&outputs, states));
    Ok(StateSpace::new(g.A.select(states, states), B, C, g.D.clone(), g.timebase)?)
}

/// Returns the states of a scaled system to which no way of strong couplings leads from inputs and outputs.
///
/// A coupling is compared with the rates of both its ends, an input or an output having that of the fastest state, so that its square is the share of the
/// strongest state's response that passes through it. In these units as much leads into a group of states as out of it. Every state has a widest way;
/// the narrowest coupling on it counts.
fn weak_states(scaled: &ScaledSystem, tolerance: f64, gap: &mut Gap) -> Vec<usize> {
    let StateSpace { A, B, C, .. } = &scaled.system;
    let (n, rates, fastest) = (A.nrows(), scaled.rates(), scaled.fastest_rate());
    let share = |entry: f64, rate: f64| if rate > 0.0 { entry * entry / rate } else { f64::INFINITY };
    let largest = |entries: &mut dyn Iterator<Item = f64>| entries.fold(0.0, |m: f64, e| m.max(e.abs()));
    let signal = |i: usize| {
        let entry = largest(&mut (0..B.ncols()).map(|k| B[(i, k)]).chain(C.column(i).iter().copied()));
        if entry == 0.0 { 0.0 } else { share(entry, rates[i] * fastest) }
    };
    let coupling = |i: usize, j: usize| {
        let entry = A[(i, j)].abs().max(A[(j, i)].abs());
        if entry == 0.0 { 0.0 } else { share(entry, rates[i] * rates[j]) }
    };
    let mut width: Vec<f64> = (0..n).map(signal).collect();
    let mut open: Vec<usize> = (0..n).collect();
    let mut weak = Vec::new();
    while let Some(at) = (0..open.len()).max_by(|&a, &b| width[open[a]].total_cmp(&width[open[b]])) {
        let j = open.swap_remove(at);
        if width[j] <= tolerance {
            gap.dropped = gap.dropped.max(width[j]);
            weak.push(j);
        } else {
            gap.kept = gap.kept.min(width[j]);
        }
        for &i in &open {
            width[i] = width[i].max(width[j].min(coupling(i, j)));
        }
    }
    weak
}

/// Returns the part of a scaled system that is reachable and seen, by staircases in 32 digits.
fn in_32_digits(g: &StateSpace, tolerance: f64, mut gap: Gap) -> Result<MinimalRealisation, Error> {
    let part = linalg::minimal_part(&g.A, &g.B, &g.C, tolerance).with_step("staircase")?;
    gap.include(part.smallest_kept, part.largest_dropped);
    let (unreachable, unobservable) = (g.order() - part.reached, part.reached - part.A.nrows());
    let system = StateSpace::new(part.A, part.B, part.C, g.D.clone(), g.timebase)?;
    Ok(MinimalRealisation::with_gap(system, unreachable, unobservable, &gap))
}

impl MinimalRealisation {
    /// Returns a realisation with a warning if the gap leaves its order in doubt.
    fn with_gap(system: StateSpace, unreachable: usize, unobservable: usize, gap: &Gap) -> Self {
        let doubtful = gap.dropped > 0.0 && gap.kept < SAFE_GAP * gap.dropped;
        let warning = Warning::SmallGap { kept: gap.kept, dropped: gap.dropped };
        Self {
            system,
            unreachable,
            unobservable,
            smallest_kept: gap.kept,
            largest_dropped: gap.dropped,
            warnings: if doubtful { vec![warning] } else { Vec::new() },
        }
    }
}

struct Gap {
    kept: f64,
    dropped: f64,
}

impl Gap {
    /// Takes the values of another decision in.
    fn include(&mut self, kept: f64, dropped: f64) {
        self.kept = self.kept.min(kept);
        self.dropped = self.dropped.max(dropped);
    }

    /// Counts the singular values above the tolerance.
    fn count(&mut self, values: &[f64], tolerance: f64) -> usize {
        let (kept, dropped): (Vec<f64>, Vec<f64>) = values.iter().partition(|&&value| value > tolerance);
        self.kept = kept.iter().copied().fold(self.kept, f64::min);
        self.dropped = dropped.iter().copied().fold(self.dropped, f64::max);
        kept.len()
    }
}

/// Returns the reachable part: each stair holds the states that the one before it drives. The sizes are the norms of A and B.
fn reachable_part(
    g: &StateSpace,
    A_size: f64,
    B_size: f64,
    tolerance: f64,
    gap: &mut Gap,
) -> Result<StateSpace, Error> {
    let (n, p) = (g.order(), g.outputs());
    let (mut A, mut B, mut C) = (g.A.clone(), g.B.clone(), g.C.clone());
    let (mut done, mut driving) = (0, B.scale(1.0 / B_size));
    loop {
        let rows = n - done;
        if rows == 0 || driving.ncols() == 0 {
            break;
        }
        let padded = driving.hstack(&Mat::zeros(rows, rows.saturating_sub(driving.ncols())));
        let parts = linalg::svd(&padded).with_step("staircase")?;
        let rank = gap.count(&parts.s[..rows.min(driving.ncols())], tolerance);
        if rank == 0 {
            break;
        }
        let mut U = Mat::eye(n);
        U.set_block(done, done, &parts.U);
        A = &U.t() * &(&A * &U);
        B = &U.t() * &B;
        C = &C * &U;
        driving = A.block(done + rank, done, rows - rank, rank).scale(1.0 / A_size);
        done += rank;
    }
    let (A, B) = (A.block(0, 0, done, done), B.block(0, 0, done, g.inputs()));
    Ok(StateSpace::new(A, B, C.block(0, 0, p, done), g.D.clone(), g.timebase)?)
}
