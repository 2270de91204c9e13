//! The node and direction that each row of an imported matrix belongs to, and the places of the nodes.

use super::text::{integer, line_error, parse_real};
use crate::Error;
use std::collections::BTreeMap;

/// An unknown: a component of a grid point, 1 to 3 translations and 4 to 6 rotations (0 for a scalar point).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Dof {
    /// Grid point.
    pub grid: u64,
    /// Component.
    pub component: u8,
}

/// Places of the nodes, and the meaning of the rows.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeMap {
    /// Component of the upward deflection.
    pub deflection: u8,
    /// Component of the rotation about the pivot's axis.
    pub rotation: u8,
    /// 1 if that rotation is positive nose-up, -1 if nose-down (about y with x forward and z up).
    pub rotation_sign: f64,
    /// Grid at the pivot.
    pub pivot: u64,
    /// Grid at the tip.
    pub tip: u64,
    /// Component of the displacement along the axis, if nodes lie off the axis.
    pub axial: Option<u8>,
    /// 1 if that displacement is positive towards larger positions, -1 if towards smaller ones.
    pub axial_sign: f64,
    /// Position of each grid along the axis, m.
    pub positions_m: BTreeMap<u64, f64>,
    /// Height of each grid above the axis, m; a grid that is missing lies on the axis.
    pub heights_m: BTreeMap<u64, f64>,
    /// The unknown of each row, for matrices that do not name their rows.
    pub rows: Vec<Dof>,
}

impl NodeMap {
    /// Returns the map in a text of lines
    ///
    /// ```text
    /// axes 3 -5        component of the deflection, of the rotation; minus if that is nose-down
    /// axial 1          component along the axis, if nodes lie off the axis; minus if it points to smaller positions
    /// pivot 100        grid at the pivot
    /// tip 120          grid at the tip
    /// node 100 0.0     grid and its position along the axis, m; then its height above the axis, m, if it has one
    /// row 100 3        grid and component of the next row (not for DMIG)
    /// ```
    ///
    /// in any order but that of the rows; `#` begins a comment.
    ///
    /// # Errors
    /// [`Error::Import`] with the line that cannot be read, or what is missing.
    pub fn parse(text: &str) -> Result<Self, Error> {
        let mut out = Draft::default();
        for (i, raw) in text.lines().enumerate() {
            let words: Vec<&str> = raw.split('#').next().unwrap_or("").split_whitespace().collect();
            if !words.is_empty() {
                out.read(i + 1, &words)?;
            }
        }
        out.finish()
    }

    /// Returns the position of a grid, m.
    ///
    /// # Errors
    /// [`Error::Import`] for a grid that the map lacks.
    pub fn position(&self, grid: u64) -> Result<f64, Error> {
        let found = self.positions_m.get(&grid).copied();
        found.ok_or_else(|| line_error(0, format!("the node map has no position for grid {grid}")))
    }

    /// Returns the height of a grid above the axis, m.
    pub fn height(&self, grid: u64) -> f64 {
        self.heights_m.get(&grid).copied().unwrap_or(0.0)
    }

    /// Returns the grid nearest to a place on the axis.
    ///
    /// # Errors
    /// [`Error::Import`] if the map has no grid.
    pub fn nearest_grid(&self, position_m: f64) -> Result<u64, Error> {
        let distance = |x: f64| (x - position_m).abs();
        let found = self.positions_m.iter().min_by(|a, b| distance(*a.1).total_cmp(&distance(*b.1)));
        found.map(|(grid, _)| *grid).ok_or_else(|| line_error(0, "the node map has no grid".to_owned()))
    }
}

#[derive(Default)]
struct Draft {
    axes: Option<(u8, i8)>,
    axial: Option<i8>,
    pivot: Option<u64>,
    tip: Option<u64>,
    positions_m: BTreeMap<u64, f64>,
    heights_m: BTreeMap<u64, f64>,
    rows: Vec<Dof>,
}

impl Draft {
    fn read(&mut self, at: usize, words: &[&str]) -> Result<(), Error> {
        match words {
            ["axes", deflection, rotation] => {
                self.axes = Some((integer(at, deflection)?, integer(at, rotation)?))
            }
            ["axial", component] => self.axial = Some(integer(at, component)?),
            ["pivot", grid] => self.pivot = Some(integer(at, grid)?),
            ["tip", grid] => self.tip = Some(integer(at, grid)?),
            ["node", grid, position] => {
                self.positions_m.insert(integer(at, grid)?, parse_real(at, position)?);
            }
            ["node", grid, position, height] => {
                let grid = integer(at, grid)?;
                self.positions_m.insert(grid, parse_real(at, position)?);
                self.heights_m.insert(grid, parse_real(at, height)?);
            }
            ["row", grid, component] => {
                self.rows.push(Dof { grid: integer(at, grid)?, component: integer(at, component)? });
            }
            _ => return Err(line_error(at, format!("\"{}\" is not a line of a node map", words.join(" ")))),
        }
        Ok(())
    }

    fn finish(self) -> Result<NodeMap, Error> {
        let missing = |what: &str| line_error(0, format!("the node map lacks its \"{what}\" line"));
        let (deflection, rotation) = self.axes.ok_or_else(|| missing("axes"))?;
        if deflection == rotation.unsigned_abs() {
            return Err(line_error(
                0,
                format!("component {deflection} cannot be both deflection and rotation"),
            ));
        }
        if let Some(axial) =
            self.axial.filter(|a| [deflection, rotation.unsigned_abs()].contains(&a.unsigned_abs()))
        {
            return Err(line_error(
                0,
                format!("component {axial} cannot be axial and deflection or rotation"),
            ));
        }
        if self.axial.is_none() && self.heights_m.values().any(|height| *height != 0.0) {
            return Err(missing("axial"));
        }
        Ok(NodeMap {
            axial: self.axial.map(i8::unsigned_abs),
            axial_sign: if self.axial.is_some_and(|axial| axial < 0) { -1.0 } else { 1.0 },
            heights_m: self.heights_m,
            deflection,
            rotation: rotation.unsigned_abs(),
            rotation_sign: if rotation < 0 { -1.0 } else { 1.0 },
            pivot: self.pivot.ok_or_else(|| missing("pivot"))?,
            tip: self.tip.ok_or_else(|| missing("tip"))?,
            positions_m: self.positions_m,
            rows: self.rows,
        })
    }
}
