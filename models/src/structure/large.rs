//! Large structures, condensed to the unknowns of a few nodes, the static shapes and the lowest modes.
//!
//! Method: component-mode synthesis (Craig and Bampton, AIAA J. 6 (1968) 1313), with the exact modes of the free, the pinned and the
//! clamped structure in place of those that are held at every kept node. One Cholesky factorisation of the stiffness with the
//! hub clamped serves all of them: a load that is in equilibrium with the rigid motions needs no reaction at the hub.

use counterpoise_linalg as linalg;
use counterpoise_linalg::{Mat, Sparse, sparse::ProgressObserver};

use super::balanced_shapes::BalancedShapes;
use super::fe::{FeModel, NodeRows};
use super::sparse_structure::{ClampedStiffness, SparseStructure, orthonormal};
use super::supported_modes::SupportedModes;
use crate::Error;
use crate::tolerance::{DEPENDENT_SHAPE, FREE, LARGE_STRUCTURE_NODES};

/// Shapes of a condensed structure besides the static ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Shapes {
    /// The lowest modes of the structure that is pinned, clamped and free at its hub, to about eight digits.
    #[default]
    Modes,
    /// The motions that carry most from the loads to the displacements of hub and tip, by balanced truncation.
    Balanced,
}

/// Options of the condensation of a large structure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Condensation {
    /// Number of modes that are needed.
    pub modes: usize,
    /// Kind of shapes.
    pub shapes: Shapes,
    /// Damping ratio with which motions are ranked if the structure has no damping matrix.
    pub damping_ratio: f64,
}

impl Condensation {
    /// Returns a condensation to so many of the lowest modes.
    pub fn modes(modes: usize) -> Self {
        Self { modes, shapes: Shapes::Modes, damping_ratio: 0.0 }
    }
}

impl SparseStructure {
    /// Returns a small model with the same rigid motions, the same static shapes under weight and under forces at the kept nodes,
    /// and the shapes that are asked for: [`Shapes::Modes`] or [`Shapes::Balanced`].
    ///
    /// Its first unknowns are the deflection and rotation of the hub, then those of nodes along the axis, the tip last; the others
    /// are modal coordinates. What the shapes leave out is kept as static flexibility.
    ///
    /// # Errors
    /// [`Error::NotFree`] if K resists a rigid motion, [`Error::Parameter`] for a negative mass or a mode without damping where shapes are
    /// balanced, [`Error::MovesFreely`] if K leaves other motions free, and [`Error::Linalg`] if the factors do not fit into memory or `watch`
    /// asked to stop.
    pub fn condense(&self, wanted: &Condensation, watch: &mut ProgressObserver) -> Result<FeModel, Error> {
        self.check()?;
        let clamped = ClampedStiffness::of(self, watch)?;
        let mut shapes = clamped.solve(&self.M.times(&self.rigid_motions()));
        let mut truncation = None;
        match wanted.shapes {
            Shapes::Modes => {
                for found in SupportedModes::of(self, &clamped, wanted.modes, watch)? {
                    shapes = shapes.hstack(&found.shapes);
                }
            }
            Shapes::Balanced => {
                let found = BalancedShapes::of(self, &clamped, wanted.modes, wanted.damping_ratio, watch)?;
                shapes = shapes.hstack(&found.shapes);
                truncation = Some(found.truncation);
            }
        }
        let kept = self.kept_nodes(wanted.shapes);
        let basis = Basis::of(self, &clamped, &kept, shapes)?;
        Ok(FeModel { truncation, ..basis.project(self, &kept)? })
    }

    fn check(&self) -> Result<(), Error> {
        if let Some((row, value)) =
            self.M.diagonal().into_iter().enumerate().find(|(_, m)| m.is_nan() || *m < 0.0)
        {
            let parameter = format!("entry ({0}, {0}) of the mass matrix", row + 1);
            return Err(Error::Parameter { parameter, value, allowed: "must not be negative".into() });
        }
        let size = self.K.norm_fro();
        for (motion, vector) in [("heave", &self.heave), ("pitch", &self.pitch)] {
            let vector = Mat::col(vector);
            let relative = self.K.times(&vector).norm_fro() / (size * vector.norm_fro());
            if relative > FREE {
                return Err(Error::NotFree { motion, relative });
            }
        }
        Ok(())
    }

    /// The nodes whose unknowns stay: hub, some along the axis, tip; with balanced shapes hub and tip alone, because forces at nodes beside the axis of
    /// a structure in space would bring in modes that no load moves.
    fn kept_nodes(&self, shapes: Shapes) -> Vec<NodeRows> {
        let between: Vec<NodeRows> =
            self.nodes.iter().copied().filter(|node| *node != self.hub && *node != self.tip).collect();
        let count = match shapes {
            Shapes::Modes => between.len().min(LARGE_STRUCTURE_NODES),
            Shapes::Balanced => 0,
        };
        let mut kept = vec![self.hub];
        kept.extend((0..count).map(|k| between[(2 * k + 1) * between.len() / (2 * count)]));
        if self.tip != self.hub {
            kept.push(self.tip);
        }
        kept
    }
}

/// The shapes of the small model's unknowns.
struct Basis {
    columns: Mat,
    /// Unknowns that are those of kept nodes.
    physical: usize,
}

impl Basis {
    /// A shape for each kept unknown, which is 1 there and 0 at the other kept ones, under forces at the kept nodes alone; then what
    /// the given shapes add to them.
    fn of(
        structure: &SparseStructure,
        clamped: &ClampedStiffness,
        kept: &[NodeRows],
        shapes: Mat,
    ) -> Result<Self, Error> {
        let n = structure.heave.len();
        let outer: Vec<usize> = kept[1..].iter().flat_map(|node| [node.deflection, node.rotation]).collect();
        let mut forces = Mat::zeros(n, outer.len());
        outer.iter().enumerate().for_each(|(j, &row)| forces[(row, j)] = 1.0);
        let at = |X: &Mat| Mat::from_fn(outer.len(), X.ncols(), |i, j| X[(outer[i], j)]);
        let moved = clamped.solve(&forces);
        let flexibility = at(&moved).symmetric_part();
        let stiff = linalg::solve(&flexibility, &Mat::eye(outer.len()))?;
        let held = &moved * &stiff;
        let rigid = structure.rigid_motions();
        let hub = &rigid - &(&held * &at(&rigid));
        let physical = hub.hstack(&held);
        let hub_rows = [structure.hub.deflection, structure.hub.rotation];
        let at_hub = |X: &Mat| Mat::from_fn(2, X.ncols(), |i, j| X[(hub_rows[i], j)]);
        let inside = &shapes - &(&physical * &at_hub(&shapes).vstack(&at(&shapes)));
        let modal = orthonormal(&structure.M, &inside, DEPENDENT_SHAPE)?;
        Ok(Self { physical: physical.ncols(), columns: physical.hstack(&modal) })
    }

    fn project(&self, structure: &SparseStructure, kept: &[NodeRows]) -> Result<FeModel, Error> {
        let V = &self.columns;
        let both = |A: &Sparse| linalg::transpose_times(V, &A.times(V)).map(|A| A.symmetric_part());
        let rows: Vec<usize> = kept.iter().flat_map(|node| [node.deflection, node.rotation]).collect();
        let motion = |vector: &[f64]| {
            let mut out: Vec<f64> = rows.iter().map(|&row| vector[row]).collect();
            out.resize(V.ncols(), 0.0);
            out
        };
        let node = |k: usize| NodeRows { deflection: 2 * k, rotation: 2 * k + 1 };
        debug_assert_eq!(self.physical, rows.len());
        Ok(FeModel {
            M: both(&structure.M)?,
            K: both(&structure.K)?,
            C: structure.C.as_ref().map(both).transpose()?,
            heave: motion(&structure.heave),
            pitch: motion(&structure.pitch),
            hub: Some(node(0)),
            tip: node(kept.len() - 1),
            tip_arm_m: structure.tip_arm_m,
            truncation: None,
        })
    }
}
