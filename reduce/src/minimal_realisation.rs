//! Minimal realisation: the states that the input reaches and the output sees, with the gap at which it was cut.

use crate::error::StepContext;
use crate::tolerance::{CERTAIN_GAP, PRECISE_STATES, SAFE_GAP};
use crate::{Error, Warning};
use counterpoise_linalg as linalg;
use counterpoise_linalg::Mat;
use counterpoise_lti::StateSpace;
use counterpoise_lti::scaling::balance;

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

/// Returns the part of a system that is reachable and seen, by orthogonal staircases on the scaled system; if they leave a gap of less than eight
/// decades, a system of at most [`PRECISE_STATES`] states is taken apart again in 32 digits ([`linalg::minimal_part`]).
///
/// A coupling counts where its singular value exceeds `tolerance` times the norm of \[A B\] (or \[A; C\]); 1e-11 suits most
/// systems. Unstable systems too. The gap between the smallest value kept and the largest dropped is returned: a clear
/// order has a gap of many decades, and a gap below [`SAFE_GAP`] is a warning.
///
/// # Errors
/// [`Error::Range`] for a tolerance outside (0, 1), [`Error::Matrix`].
pub fn minimal_realisation(g: &StateSpace, tolerance: f64) -> Result<MinimalRealisation, Error> {
    if !(tolerance > 0.0 && tolerance < 1.0) {
        return Err(Error::Range { what: "tolerance", value: tolerance, allowed: "between 0 and 1" });
    }
    let mut gap = Gap { kept: 1.0, dropped: 0.0 };
    let scaled = balance(g).0;
    let size = |M: &Mat| M.norm_fro().max(f64::MIN_POSITIVE);
    // What is left of a matrix after the first staircase may be rounding alone, so both are judged by the whole system.
    let sizes = (size(&scaled.A), size(&scaled.B), size(&scaled.C));
    let reached = reachable_part(&scaled, sizes.0, sizes.1, tolerance, &mut gap)?;
    let unreachable = g.order() - reached.order();
    let seen = reachable_part(&reached.dual(), sizes.0, sizes.2, tolerance, &mut gap)?.dual();
    let unobservable = reached.order() - seen.order();
    if g.order() <= PRECISE_STATES && gap.kept < CERTAIN_GAP * gap.dropped.max(f64::EPSILON) {
        return in_32_digits(&scaled, tolerance);
    }
    Ok(MinimalRealisation::with_gap(seen, unreachable, unobservable, &gap))
}

/// Returns the part of a scaled system that is reachable and seen, by staircases in 32 digits.
fn in_32_digits(g: &StateSpace, tolerance: f64) -> Result<MinimalRealisation, Error> {
    let part = linalg::minimal_part(&g.A, &g.B, &g.C, tolerance).with_step("staircase")?;
    let gap = Gap { kept: part.smallest_kept, dropped: part.largest_dropped };
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
