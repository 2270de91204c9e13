//! The shapes that carry most from the loads of a large structure to its motion: balanced truncation with low-rank Gramians.
//!
//! Inputs are the inertial loads of heave and pitch and forces at the tip, outputs the displacements that belong to them, with the hub clamped.
//! The Hankel values of the structure rank its motions, whatever their frequency, and a structure with many local modes needs far fewer of them
//! than there are modes below the last one that matters. Method of the Gramians: [`low_rank_gramians`].

use counterpoise_linalg as linalg;
use counterpoise_linalg::{
    Mat, Sparse,
    sparse::{
        GramianAccuracy, ModeRequest, ProgressObserver, QuadraticPencil, StructurePorts, low_rank_gramians,
        lowest_modes,
    },
};

use super::damping::{DampedFrequency, Rayleigh, rayleigh_coefficients};
use super::fe::Truncation;
use super::sparse_structure::{ClampedStiffness, SparseStructure, orthonormal};
use crate::Error;
use crate::tolerance::{
    GRAMIAN_CONTRIBUTION, GRAMIAN_STEPS, LEAST_RATIO, MODE_RESIDUAL, RAYLEIGH_SPAN, SHAPE_NOISE, SPARE_MODES,
};

/// The shapes of a structure that is clamped at its hub, zero there, and what they leave out.
pub(super) struct BalancedShapes {
    pub(super) shapes: Mat,
    pub(super) truncation: Truncation,
}

impl BalancedShapes {
    /// Finds the shapes of `modes` motions and some more; `damping_ratio` holds where the structure has no damping matrix.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a mode is not damped, or those of the factors.
    pub(super) fn of(
        structure: &SparseStructure,
        clamped: &ClampedStiffness,
        modes: usize,
        damping_ratio: f64,
        watch: &mut ProgressObserver,
    ) -> Result<Self, Error> {
        let free = clamped.free_unknowns();
        let (M, K) = (structure.M.select(free), structure.K.select(free));
        let D = match &structure.C {
            Some(C) => C.select(free),
            None => proportional(structure, clamped, damping_ratio, watch)?.select(free),
        };
        let pencil = QuadraticPencil::of(&M, &D, &K)?;
        let F = loads(structure, clamped)?;
        let ports = StructurePorts { F: &F, P: &F.t(), V: &Mat::zeros(F.ncols(), F.nrows()) };
        let accuracy = GramianAccuracy { contribution: GRAMIAN_CONTRIBUTION, steps: GRAMIAN_STEPS };
        let gramians = low_rank_gramians(&pencil, &ports, accuracy, watch).map_err(|error| match error {
            linalg::Error::NotStable { eigenvalue, .. } => Error::Parameter {
                parameter: "the damping of a mode of the clamped structure, 1/s,".to_owned(),
                value: -eigenvalue.re,
                allowed: "must be positive for balanced shapes: complete the damping matrix, or choose shapes = \"modes\"".into(),
            },
            other => other.into(),
        })?;
        let directions = gramians.balanced_directions(&pencil)?;
        let kept = directions.values.len().min(2 * (modes + SPARE_MODES));
        let n = free.len();
        let positions = directions.right.block(0, 0, n, kept);
        let forces = directions.left.block(n, 0, n, kept);
        let dropped: f64 = directions.values[kept..].iter().rev().sum();
        let largest = directions.values.first().copied().unwrap_or(0.0).max(f64::MIN_POSITIVE);
        // The two directions of a value are nearly the same shape; what differs by less than their accuracy is noise.
        let both =
            Mat::from_fn(
                n,
                2 * kept,
                |i, j| if j % 2 == 0 { positions[(i, j / 2)] } else { forces[(i, j / 2)] },
            );
        let shapes = orthonormal(&M, &both, SHAPE_NOISE)?;
        Ok(Self {
            shapes: clamped.extend_rows(&shapes),
            truncation: Truncation {
                kept,
                estimated_error: 2.0 * dropped / largest,
                steps: gramians.shifts.len(),
            },
        })
    }
}

/// The loads on the unknowns that are free with the hub clamped, each made so large that it does the same work on its static shape.
fn loads(structure: &SparseStructure, clamped: &ClampedStiffness) -> Result<Mat, Error> {
    let n = structure.heave.len();
    let mut all = structure.M.times(&structure.rigid_motions());
    if structure.tip != structure.hub {
        for row in [structure.tip.deflection, structure.tip.rotation] {
            let mut unit = Mat::zeros(n, 1);
            unit[(row, 0)] = 1.0;
            all = all.hstack(&unit);
        }
    }
    let moved = clamped.solve(&all);
    let inner = clamped.inner(&all);
    let work = linalg::transpose_times(&all, &moved)?.diagonal();
    let kept: Vec<usize> = (0..work.len()).filter(|&j| work[j] > 0.0).collect();
    Ok(Mat::from_fn(inner.nrows(), kept.len(), |i, j| inner[(i, kept[j])] / work[kept[j]].sqrt()))
}

/// Rayleigh damping with the given ratio at the lowest frequency of the clamped structure and far above it. Only the choice of shapes rests on it.
fn proportional(
    structure: &SparseStructure,
    clamped: &ClampedStiffness,
    ratio: f64,
    watch: &mut ProgressObserver,
) -> Result<Sparse, Error> {
    let none = Mat::zeros(structure.heave.len(), 0);
    let stage = "lowest mode of the clamped structure";
    let wanted = ModeRequest { stage, count: 1, tolerance: MODE_RESIDUAL.sqrt(), rigid: &none };
    let lowest = lowest_modes(&|loads| Ok(clamped.solve(loads)), &structure.M, &wanted, watch)?;
    let frequency_rad_s = lowest.squares.first().copied().unwrap_or(1.0).sqrt();
    let ratio = ratio.max(LEAST_RATIO);
    let Rayleigh { mass_factor, stiffness_factor } = rayleigh_coefficients(
        DampedFrequency { frequency_rad_s, ratio },
        DampedFrequency { frequency_rad_s: RAYLEIGH_SPAN * frequency_rad_s, ratio },
    )?;
    let of_mass = structure.M.map(|_, _, m| mass_factor * m);
    Ok(structure.K.map(|_, _, k| stiffness_factor * k).plus(&of_mass.entries().collect::<Vec<_>>())?)
}
