//! The lowest modes of a large structure that is pinned, clamped and free at its hub, none of them missed.
//!
//! A Lanczos iteration finds the modes, the signs of the pivots of the shifted stiffness count them: one factorisation in which the hub is
//! eliminated last counts those of all three supports.

use counterpoise_linalg as linalg;
use counterpoise_linalg::{
    Mat,
    sparse::{
        Cut, LowestModes, ModeCounter, ModeRequest, ProgressObserver, StageProgress, highest_cut,
        lowest_modes,
    },
};

use super::modes::Support;
use super::sparse_structure::{ClampedStiffness, SparseStructure, orthonormal};
use crate::Error;
use crate::tolerance::{CUT_SHARES, DEPENDENT_SHAPE, MODE_RESIDUAL, MODE_SEARCHES, RIGID_MODE, SPARE_MODES};

/// The supports whose modes are counted together: those of which equally many modes are sought.
const COUNTED_TOGETHER: [&[usize]; 2] = [&[0], &[1, 2]];

/// One search for modes.
struct Search {
    support: Support,
    stage: &'static str,
    /// Rigid motions that the support leaves, orthonormal in the inner product of M.
    rigid: Mat,
    count: usize,
}

/// The search for the modes of all three supports.
pub(super) struct SupportedModes<'a> {
    structure: &'a SparseStructure,
    clamped: &'a ClampedStiffness,
    searches: [Search; 3],
    counter: ModeCounter<'a>,
}

impl<'a> SupportedModes<'a> {
    /// Returns the lowest flexible modes of the pinned structure, `modes` and some more, and some of the clamped and of the free one.
    ///
    /// # Errors
    /// [`Error::MovesFreely`], or those of the iteration and of the factors.
    pub(super) fn of(
        structure: &'a SparseStructure,
        clamped: &'a ClampedStiffness,
        modes: usize,
        watch: &mut ProgressObserver,
    ) -> Result<[LowestModes; 3], Error> {
        let hub = structure.hub;
        let search = |support: Support, stage: &'static str, motions: &Mat, count: usize| {
            let rigid = orthonormal(&structure.M, motions, DEPENDENT_SHAPE)?;
            Ok::<_, Error>(Search { support, stage, rigid, count })
        };
        let none = Mat::zeros(structure.heave.len(), 0);
        let pitch = Mat::col(&structure.pitch);
        let pinned = "modes of the structure pinned at its hub";
        let held = "modes of the structure clamped at its hub";
        let free = "modes of the free structure";
        let run = Self {
            structure,
            clamped,
            searches: [
                search(Support::Pinned, pinned, &pitch, modes + SPARE_MODES)?,
                search(Support::Clamped, held, &none, SPARE_MODES)?,
                search(Support::Free, free, &structure.rigid_motions(), SPARE_MODES)?,
            ],
            counter: ModeCounter::of(&structure.K, &structure.M, &[hub.rotation, hub.deflection])?,
        };
        let [a, b, c] = &run.searches;
        let mut found = [run.first_modes(a, watch)?, run.first_modes(b, watch)?, run.first_modes(c, watch)?];
        for together in COUNTED_TOGETHER {
            run.complete_modes(&mut found, together, watch)?;
        }
        Ok(found)
    }

    /// The modes that the iteration finds.
    fn first_modes(&self, search: &Search, watch: &mut ProgressObserver) -> Result<LowestModes, Error> {
        let found = self.iterate(search, &search.rigid, search.count, watch)?;
        match found.squares.iter().any(|&square| self.is_rigid(&found.shapes, square)) {
            true => Err(Error::MovesFreely { support: search.stage }),
            false => Ok(found),
        }
    }

    fn iterate(
        &self,
        search: &Search,
        known: &Mat,
        count: usize,
        watch: &mut ProgressObserver,
    ) -> Result<LowestModes, Error> {
        let wanted = ModeRequest { stage: search.stage, count, tolerance: MODE_RESIDUAL, rigid: known };
        let solve = |loads: &Mat| Ok(self.clamped.solve(loads));
        Ok(lowest_modes(&solve, &self.structure.M, &wanted, watch)?)
    }

    /// Adds the modes that the iteration missed, as it may if one is repeated: a count of the modes below a limit tells. What is missing is
    /// sought beside what was found.
    fn complete_modes(
        &self,
        found: &mut [LowestModes; 3],
        together: &[usize],
        watch: &mut ProgressObserver,
    ) -> Result<(), Error> {
        for _ in 0..MODE_SEARCHES {
            let sets: Vec<&LowestModes> = together.iter().map(|&k| &found[k]).collect();
            let Some(cut) = highest_cut(&sets) else { return Ok(()) };
            let mut is_complete = true;
            let counts = self.count(cut, watch)?;
            for &k in together {
                let search = &self.searches[k];
                let missing = counts.of(search.support).saturating_sub(found[k].count_below(counts.limit));
                if missing > 0 {
                    is_complete = false;
                    let known = search.rigid.hstack(&found[k].shapes);
                    let others = self.iterate(search, &known, missing, watch)?;
                    found[k] = found[k].merge(&others, search.count);
                }
            }
            if is_complete {
                return Ok(());
            }
        }
        Err(linalg::Error::NoConvergence { what: "the search for missed modes", limit: MODE_SEARCHES }.into())
    }

    /// The number of flexible modes below a limit within a gap.
    fn count(&self, cut: Cut, watch: &mut ProgressObserver) -> Result<Counts, Error> {
        let step = StageProgress { stage: "counting the modes", done: 0, of: 100 };
        if watch(step).is_break() {
            return Err(linalg::Error::Cancelled { what: step.stage }.into());
        }
        let mut answer = Err(linalg::Error::Singular { what: "the shifted stiffness", rcond: 0.0 });
        for share in CUT_SHARES {
            let limit = cut.low + share * (cut.high - cut.low);
            answer = self.counter.count_below(limit, watch).map(|counts| Counts { limit, counts });
            if !matches!(answer, Err(linalg::Error::Singular { .. })) {
                break;
            }
        }
        Ok(answer?)
    }

    /// Returns whether the first shape stores no more energy than rounding of K does.
    fn is_rigid(&self, shapes: &Mat, square: f64) -> bool {
        let shape = shapes.block(0, 0, shapes.nrows(), shapes.ncols().min(1));
        let moduli = shape.map(f64::abs);
        let rounding = (moduli.t() * self.structure.K.map(|_, _, k| k.abs()).times(&moduli)).norm_max();
        square < RIGID_MODE * f64::EPSILON * rounding
    }
}

/// Modes below a limit: with the hub clamped, with its rotation free, and with both free.
struct Counts {
    limit: f64,
    counts: Vec<usize>,
}

impl Counts {
    /// The number of flexible modes in a support.
    fn of(&self, support: Support) -> usize {
        let rigid = match support {
            Support::Clamped => 0,
            Support::Pinned => 1,
            Support::Free => 2,
        };
        self.counts.get(rigid).map_or(0, |count| count.saturating_sub(rigid))
    }
}
