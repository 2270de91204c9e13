//! Structures from elsewhere: M, C and K as text, and which row belongs to which node.
//!
//! Readers take text and give matrices; nothing here opens a file. Matrix Market ([`matrix_market()`]) and OP4
//! ([`op4()`]) hold plain matrices, whose rows the node map names; DMIG ([`dmig()`]) names its own.
//! [`Imported::structure`] makes the [`FeModel`] that modal analysis and the plant take.

pub mod dmig;
pub mod matrix_market;
pub mod node_map;
pub mod op4;
mod text;

pub use dmig::{Dmig, dmig};
pub use matrix_market::matrix_market;
pub use node_map::{Dof, NodeMap};
pub use op4::{Op4, op4};

use super::fe::{FeModel, Fitted, NodeRows};
use crate::Error;
use crate::tolerance::ASYMMETRY_OF_IMPORT;
use counterpoise_lti::Mat;

/// Matrices of a structure and the unknown that each row belongs to; SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// Mass matrix, n x n.
    pub M: Mat,
    /// Damping matrix, n x n, if there is one.
    pub C: Option<Mat>,
    /// Stiffness matrix, n x n.
    pub K: Mat,
    /// The unknown of each row.
    pub rows: Vec<Dof>,
}

impl Imported {
    /// Plain matrices in the row order of the node map.
    pub fn in_order_of(map: &NodeMap, M: Mat, C: Option<Mat>, K: Mat) -> Self {
        Self { M, C, K, rows: map.rows.clone() }
    }

    /// DMIG matrices by their names, in the order of the grids and components that K or M mention.
    ///
    /// # Errors
    /// [`Error::Import`] if a name is missing.
    pub fn from_dmig(
        all: &[Dmig],
        mass: &str,
        damping: Option<&str>,
        stiffness: &str,
    ) -> Result<Self, Error> {
        let named = |name: &str| {
            let found = all.iter().find(|d| d.name.eq_ignore_ascii_case(name));
            found.ok_or_else(|| text::refused(0, format!("there is no DMIG matrix {name}")))
        };
        let (m, k) = (named(mass)?, named(stiffness)?);
        let c = damping.map(named).transpose()?;
        let mut rows: Vec<Dof> = [Some(m), Some(k), c].into_iter().flatten().flat_map(Dmig::dofs).collect();
        rows.sort_unstable();
        rows.dedup();
        text::check_size(0, rows.len(), rows.len())?;
        Ok(Self { M: m.matrix(&rows), C: c.map(|c| c.matrix(&rows)), K: k.matrix(&rows), rows })
    }

    /// Returns the structure with its hub at the map's pivot.
    ///
    /// Rows of the deflection component move with heave and pitch, rows of the rotation component with pitch; rows of
    /// other components do not move rigidly (nodes on the axis).
    ///
    /// # Errors
    /// [`Error::Import`] if shapes and rows differ, a matrix is not symmetric, or the map lacks a grid that it needs.
    pub fn structure(&self, map: &NodeMap) -> Result<FeModel, Error> {
        let n = self.rows.len();
        for matrix in [Some(&self.M), self.C.as_ref(), Some(&self.K)].into_iter().flatten() {
            check_symmetric(matrix, n)?;
        }
        let mut heave = vec![0.0; n];
        let mut pitch = vec![0.0; n];
        for (i, dof) in self.rows.iter().enumerate() {
            if dof.component == map.deflection {
                heave[i] = 1.0;
                pitch[i] = map.position(dof.grid)? - map.position(map.pivot)?;
            } else if dof.component == map.rotation {
                pitch[i] = 1.0;
            }
        }
        let symmetric = |A: &Mat| self.nose_up(&A.symmetric_part(), map);
        Ok(FeModel {
            M: symmetric(&self.M),
            K: symmetric(&self.K),
            C: self.C.as_ref().map(symmetric),
            heave,
            pitch,
            hub: Some(self.node(map, map.pivot)?),
            tip: self.node(map, map.tip)?,
            tip_arm_m: map.position(map.tip)? - map.position(map.pivot)?,
        })
    }

    /// Returns the matrices with what is fitted: each point mass hangs on the nearest grid by a rigid arm, and the hub's inertia turns with
    /// the pivot's grid.
    ///
    /// # Errors
    /// [`Error::Import`] if the grid that carries a mass lacks a row that it needs.
    pub fn fitted(&self, map: &NodeMap, fitted: &Fitted) -> Result<Self, Error> {
        let mut out = self.clone();
        for mass in &fitted.masses {
            let grid = map.nearest(mass.position_m)?;
            let arm = mass.position_m - map.position(grid)?;
            let node = self.node(map, grid)?;
            let (w, turn) = (node.deflection, node.rotation);
            let coupling = map.rotation_sign * mass.mass_kg * arm;
            out.M[(w, w)] += mass.mass_kg;
            out.M[(w, turn)] += coupling;
            out.M[(turn, w)] += coupling;
            out.M[(turn, turn)] += mass.mass_kg * arm * arm + mass.inertia_kg_m2;
        }
        if fitted.hub_inertia_kg_m2 != 0.0 {
            let turn = self.node(map, map.pivot)?.rotation;
            out.M[(turn, turn)] += fitted.hub_inertia_kg_m2;
        }
        Ok(out)
    }

    /// Returns the matrix with rotations counted nose-up.
    fn nose_up(&self, A: &Mat, map: &NodeMap) -> Mat {
        let sign = |i: usize| if self.rows[i].component == map.rotation { map.rotation_sign } else { 1.0 };
        Mat::from_fn(A.nrows(), A.ncols(), |i, j| sign(i) * A[(i, j)] * sign(j))
    }

    fn node(&self, map: &NodeMap, grid: u64) -> Result<NodeRows, Error> {
        let row = |component: u8| {
            let found = self.rows.iter().position(|d| d.grid == grid && d.component == component);
            found.ok_or_else(|| text::refused(0, format!("grid {grid} has no row for component {component}")))
        };
        Ok(NodeRows { deflection: row(map.deflection)?, rotation: row(map.rotation)? })
    }
}

fn check_symmetric(matrix: &Mat, n: usize) -> Result<(), Error> {
    if matrix.shape() != (n, n) {
        let (rows, cols) = matrix.shape();
        return Err(text::refused(0, format!("a matrix is {rows} x {cols}, the node map has {n} rows")));
    }
    let skew = (matrix - &matrix.t()).norm_max();
    if skew > ASYMMETRY_OF_IMPORT * matrix.norm_max() {
        return Err(text::refused(0, format!("a matrix is not symmetric: entries differ by {skew:e}")));
    }
    Ok(())
}
