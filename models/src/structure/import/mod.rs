//! Structures from elsewhere: M, C and K as text or bytes, and which row belongs to which node.
//!
//! Readers take the content of a file and give matrices; nothing here opens one. Matrix Market ([`matrix_market()`]), OP4
//! ([`read_op4()`], [`read_binary_op4()`]) and lines of row, column and value ([`read_triplets()`]) hold plain matrices, whose rows the node map or a
//! list of rows ([`read_rows()`]) names; DMIG ([`read_dmig()`]) and Abaqus' matrix input ([`read_labels()`]) name their own.
//! [`Imported::structure`] makes the [`FeModel`] that modal analysis and the plant take.

pub mod dmig;
pub mod matrix_market;
pub mod node_map;
pub mod op4;
pub mod op4_binary;
mod text;
pub mod triplets;

pub use dmig::{Dmig, read_dmig};
pub use matrix_market::matrix_market;
pub use node_map::{Dof, NodeMap};
pub use op4::{Op4, read_op4};
pub use op4_binary::{is_binary_op4, read_binary_op4};
pub use triplets::{has_labels, read_labels, read_rows, read_triplets};

use super::fe::{AttachedMasses, FeModel, NodeRows};
use super::large::{Condensation, Shapes};
use super::sparse_structure::SparseStructure;
use crate::Error;
use crate::tolerance::{ASYMMETRY_OF_IMPORT, LARGE_STRUCTURE};
use counterpoise_linalg::{
    Sparse,
    sparse::{Entry, ProgressObserver},
};
use std::collections::BTreeMap;

/// Matrices of a structure and the unknown that each row belongs to; SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// Mass matrix, n x n.
    pub M: Sparse,
    /// Damping matrix, n x n, if there is one.
    pub C: Option<Sparse>,
    /// Stiffness matrix, n x n.
    pub K: Sparse,
    /// The unknown of each row.
    pub rows: Vec<Dof>,
}

impl Imported {
    /// Takes plain matrices in the row order of the node map.
    pub fn from_row_order(map: &NodeMap, M: Sparse, C: Option<Sparse>, K: Sparse) -> Self {
        Self { M, C, K, rows: map.rows.clone() }
    }

    /// Takes DMIG matrices by their names, in the order of the grids and components that K or M mention.
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
            found.ok_or_else(|| text::line_error(0, format!("there is no DMIG matrix {name}")))
        };
        let (m, k) = (named(mass)?, named(stiffness)?);
        let c = damping.map(named).transpose()?;
        let mut rows: Vec<Dof> = [Some(m), Some(k), c].into_iter().flatten().flat_map(Dmig::dofs).collect();
        rows.sort_unstable();
        rows.dedup();
        text::check_size(0, rows.len(), rows.len())?;
        let C = c.map(|c| c.matrix(&rows)).transpose()?;
        Ok(Self { M: m.matrix(&rows)?, C, K: k.matrix(&rows)?, rows })
    }

    /// Returns whether [`Imported::condense`] condenses the structure.
    pub fn is_large(&self) -> bool {
        self.rows.len() > LARGE_STRUCTURE
    }

    /// Returns the structure with its hub at the map's pivot, as [`Imported::to_sparse_structure`] does, with dense matrices: those of the
    /// files, or of the condensed structure if there are more than [`LARGE_STRUCTURE`] unknowns or shapes are to be balanced.
    ///
    /// # Errors
    /// As for [`Imported::to_sparse_structure`] and [`SparseStructure::condense`].
    pub fn condense(
        &self,
        map: &NodeMap,
        wanted: &Condensation,
        watch: &mut ProgressObserver,
    ) -> Result<FeModel, Error> {
        let whole = self.to_sparse_structure(map)?;
        match self.is_large() || wanted.shapes == Shapes::Balanced {
            true => whole.condense(wanted, watch),
            false => Ok(whole.dense()),
        }
    }

    /// Returns the structure as [`Imported::to_sparse_structure`] does, with the dense matrices of the files.
    ///
    /// # Errors
    /// As for [`Imported::to_sparse_structure`].
    pub fn structure(&self, map: &NodeMap) -> Result<FeModel, Error> {
        Ok(self.to_sparse_structure(map)?.dense())
    }

    /// Returns the structure with its hub at the map's pivot.
    ///
    /// Rows of the deflection component move with heave and pitch, rows of the rotation component with pitch, and rows of the axial
    /// component, if the map names one, with pitch by their height; rows of other components do not move rigidly. Rows of the
    /// pivot's grid other than its deflection and rotation are held, as the bearing holds them.
    ///
    /// # Errors
    /// [`Error::Import`] if shapes and rows differ, a matrix is not symmetric, or the map lacks a grid that it needs.
    pub fn to_sparse_structure(&self, map: &NodeMap) -> Result<SparseStructure, Error> {
        let n = self.rows.len();
        for matrix in [Some(&self.M), self.C.as_ref(), Some(&self.K)].into_iter().flatten() {
            check_symmetric(matrix, n)?;
        }
        let moves = |dof: &Dof| [map.deflection, map.rotation].contains(&dof.component);
        let is_held = |dof: &Dof| dof.grid == map.pivot && !moves(dof);
        if self.rows.iter().any(is_held) {
            let kept: Vec<usize> = (0..n).filter(|&i| !is_held(&self.rows[i])).collect();
            return self.select(&kept).to_sparse_structure(map);
        }
        let mut heave = vec![0.0; n];
        let mut pitch = vec![0.0; n];
        for (i, dof) in self.rows.iter().enumerate() {
            if dof.component == map.deflection {
                heave[i] = 1.0;
                pitch[i] = map.position(dof.grid)? - map.position(map.pivot)?;
            } else if dof.component == map.rotation {
                pitch[i] = 1.0;
            } else if map.axial == Some(dof.component) {
                pitch[i] = map.axial_sign * (map.height(map.pivot) - map.height(dof.grid));
            }
        }
        let symmetric = |A: &Sparse| A.symmetric_part().map(|A| self.nose_up(&A, map));
        Ok(SparseStructure {
            M: symmetric(&self.M)?,
            K: symmetric(&self.K)?,
            C: self.C.as_ref().map(symmetric).transpose()?,
            heave,
            pitch,
            hub: self.node(map, map.pivot)?,
            tip: self.node(map, map.tip)?,
            tip_arm_m: map.position(map.tip)? - map.position(map.pivot)?,
            nodes: self.nodes(map),
        })
    }

    /// The matrices of some of the rows.
    fn select(&self, kept: &[usize]) -> Self {
        Self {
            M: self.M.select(kept),
            C: self.C.as_ref().map(|C| C.select(kept)),
            K: self.K.select(kept),
            rows: kept.iter().map(|&i| self.rows[i]).collect(),
        }
    }

    /// The nodes on the axis that have a deflection and a rotation, by their position, one for each position.
    fn nodes(&self, map: &NodeMap) -> Vec<NodeRows> {
        let mut rows: BTreeMap<u64, [Option<usize>; 2]> = BTreeMap::new();
        for (i, dof) in self.rows.iter().enumerate() {
            let places = [map.deflection, map.rotation];
            if let Some(k) = places.iter().position(|component| *component == dof.component) {
                rows.entry(dof.grid).or_default()[k] = Some(i);
            }
        }
        let both = |(grid, found): (&u64, &[Option<usize>; 2])| {
            let rows = NodeRows { deflection: found[0]?, rotation: found[1]? };
            if map.height(*grid) != map.height(map.pivot) {
                return None;
            }
            Some((*map.positions_m.get(grid)?, rows))
        };
        let mut nodes: Vec<(f64, NodeRows)> = rows.iter().filter_map(both).collect();
        nodes.sort_by(|a, b| a.0.total_cmp(&b.0));
        nodes.dedup_by(|b, a| b.0 == a.0);
        nodes.into_iter().map(|(_, rows)| rows).collect()
    }

    /// Returns the matrices with what is fitted: each point mass hangs on the nearest grid by a rigid arm, and the hub's inertia turns with
    /// the pivot's grid.
    ///
    /// # Errors
    /// [`Error::Import`] if the grid that carries a mass lacks a row that it needs.
    pub fn with_fitted_masses(&self, map: &NodeMap, fitted: &AttachedMasses) -> Result<Self, Error> {
        let mut out = self.clone();
        for mass in &fitted.masses {
            let grid = self.carrier(map, mass.position_m)?;
            let arm = mass.position_m - map.position(grid)?;
            let node = self.node(map, grid)?;
            let (w, turn) = (node.deflection, node.rotation);
            let coupling = map.rotation_sign * mass.mass_kg * arm;
            let entry = |row, col, value| Entry { row, col, value };
            out.M = out.M.plus(&[
                entry(w, w, mass.mass_kg),
                entry(w, turn, coupling),
                entry(turn, w, coupling),
                entry(turn, turn, mass.mass_kg * arm * arm + mass.inertia_kg_m2),
            ])?;
        }
        if fitted.hub_inertia_kg_m2 != 0.0 {
            let turn = self.node(map, map.pivot)?.rotation;
            out.M = out.M.plus(&[Entry { row: turn, col: turn, value: fitted.hub_inertia_kg_m2 }])?;
        }
        Ok(out)
    }

    /// The grid nearest to a place on the axis that can carry a mass there: on the axis, with a deflection and a rotation.
    fn carrier(&self, map: &NodeMap, position_m: f64) -> Result<u64, Error> {
        let on_axis: BTreeMap<u64, f64> = self
            .rows
            .iter()
            .filter(|dof| dof.component == map.rotation && map.height(dof.grid) == map.height(map.pivot))
            .filter_map(|dof| Some((dof.grid, *map.positions_m.get(&dof.grid)?)))
            .collect();
        let distance = |x: f64| (x - position_m).abs();
        let found = on_axis.iter().min_by(|a, b| distance(*a.1).total_cmp(&distance(*b.1)));
        found.map_or_else(|| map.nearest_grid(position_m), |(grid, _)| Ok(*grid))
    }

    /// Returns the matrix with rotations counted nose-up.
    fn nose_up(&self, A: &Sparse, map: &NodeMap) -> Sparse {
        let sign = |i: usize| if self.rows[i].component == map.rotation { map.rotation_sign } else { 1.0 };
        A.map(|i, j, value| sign(i) * value * sign(j))
    }

    fn node(&self, map: &NodeMap, grid: u64) -> Result<NodeRows, Error> {
        let row = |component: u8| {
            let found = self.rows.iter().position(|d| d.grid == grid && d.component == component);
            found.ok_or_else(|| {
                text::line_error(0, format!("grid {grid} has no row for component {component}"))
            })
        };
        Ok(NodeRows { deflection: row(map.deflection)?, rotation: row(map.rotation)? })
    }
}

fn check_symmetric(matrix: &Sparse, n: usize) -> Result<(), Error> {
    if matrix.shape() != (n, n) {
        let (rows, cols) = matrix.shape();
        return Err(text::line_error(0, format!("a matrix is {rows} x {cols}, the node map has {n} rows")));
    }
    let skew = matrix.asymmetry();
    if skew > ASYMMETRY_OF_IMPORT * matrix.norm_max() {
        return Err(text::line_error(0, format!("a matrix is not symmetric: entries differ by {skew:e}")));
    }
    Ok(())
}
