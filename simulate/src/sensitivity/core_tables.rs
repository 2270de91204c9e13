//! The matrices of a step in the physical state, and their derivatives along the directions that change the core.

use super::block::Block;
use super::direction::Family;
use crate::engine::linear_core::{Mode, ModeDynamics};
use crate::engine::tables::{DEEPEST, FIXED_INPUTS, MIDDLE_ROWS, OUTPUTS, PORTS, STAGES, StepTable};
use counterpoise_models::Plant;
use std::collections::BTreeMap;

/// Outputs at the stages.
pub(crate) const STAGE_OUTPUTS: usize = STAGES * OUTPUTS;
/// Ports at the stages.
pub(crate) const UNKNOWNS: usize = STAGES * PORTS;

/// A matrix, row by row.
#[derive(Debug, Clone)]
pub(crate) struct Rows {
    pub columns: usize,
    pub data: Vec<f64>,
}

impl Rows {
    fn new(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
        let data = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))).map(|(i, j)| entry(i, j)).collect();
        Self { columns, data }
    }

    /// Returns one row.
    pub fn row(&self, index: usize) -> &[f64] {
        &self.data[index * self.columns..(index + 1) * self.columns]
    }
}

/// A step of one length in one mode: (outputs at the stages, then the state at the end) from \[state, fixed inputs, ports at the stages\].
#[derive(Debug, Clone)]
pub(crate) struct CoreTable {
    pub all: Rows,
    /// The derivatives of the matrix: entry by entry, one number for each direction that changes the core.
    pub slopes: Vec<f64>,
}

/// The rows of what is seen of the physical state: the outputs, then the tip's rate.
#[derive(Debug, Clone)]
pub(crate) struct SeenRows {
    pub all: Rows,
    /// As [`CoreTable::slopes`].
    pub slopes: Vec<f64>,
}

/// The matrices of the modes and steps that a run has met.
#[derive(Debug, Clone)]
pub(crate) struct CoreTables {
    nominal: Plant,
    period_s: f64,
    /// The directions that change the core, in the order of the derivatives.
    pub directions: Vec<usize>,
    dynamics: BTreeMap<usize, ModeFamily>,
    tables: BTreeMap<usize, CoreTable>,
    pub seen: SeenRows,
}

/// The cores of a mode: of the nominal plant and of the members of each direction that changes it.
#[derive(Debug, Clone)]
struct ModeFamily {
    own: ModeDynamics,
    members: Vec<[ModeDynamics; super::stencil::MEMBERS]>,
}

impl CoreTables {
    pub fn new(nominal: &Plant, families: &[Family], period_s: f64) -> Self {
        let directions: Vec<usize> = (0..families.len()).filter(|&k| families[k].has_other_core).collect();
        let rows = |plant: &Plant| -> Vec<Vec<f64>> {
            let n = plant.core_order();
            let cut = |mut row: Vec<f64>| {
                row.truncate(n);
                row
            };
            vec![
                plant.motor_rate_row(),
                (0..n).map(|j| f64::from(u8::from(j == counterpoise_models::plant::core::state::WINDUP))).collect(),
                plant.hub_angle_row(),
                plant.hub_rate_row(),
                cut(plant.current_row()),
                plant.tip_rate_row(),
            ]
        };
        let own = rows(nominal);
        let all = Rows::new(own.len(), nominal.core_order(), |i, j| own[i][j]);
        let others: Vec<_> = directions.iter().map(|&k| families[k].plants.each_ref().map(rows)).collect();
        let slopes = stored_slopes(&all, &directions, families, |direction, member, i, j| {
            others[direction][member][i][j]
        });
        Self {
            nominal: nominal.clone(),
            period_s,
            directions,
            dynamics: BTreeMap::new(),
            tables: BTreeMap::new(),
            seen: SeenRows { all, slopes },
        }
    }

    /// Makes the matrices of a step in a mode, if they are not there yet.
    pub fn prepare(&mut self, mode: &Mode, level: usize, families: &[Family]) {
        let Self { nominal, period_s, directions, dynamics, tables, .. } = self;
        tables.entry(mode.index() * (DEEPEST + 1) + level).or_insert_with(|| {
            let of = |plant: &Plant| ModeDynamics::in_physical_coordinates(plant, mode, *period_s);
            let family = dynamics.entry(mode.index()).or_insert_with(|| ModeFamily {
                own: of(nominal),
                members: directions.iter().map(|&k| families[k].plants.each_ref().map(of)).collect(),
            });
            let own = rows_of(&mut family.own, level);
            let members: Vec<[Rows; super::stencil::MEMBERS]> = family
                .members
                .iter_mut()
                .map(|members| members.each_mut().map(|member| rows_of(member, level)))
                .collect();
            let slopes = stored_slopes(&own, directions, families, |direction, member, i, j| {
                members[direction][member].row(i)[j]
            });
            CoreTable { all: own, slopes }
        });
    }

    /// Returns the matrices of a step that [`Self::prepare`] has made.
    pub fn table(&self, mode: &Mode, level: usize) -> Option<&CoreTable> {
        self.tables.get(&(mode.index() * (DEEPEST + 1) + level))
    }

    /// Adds a row's derivatives times the inputs of a step, in the columns of the directions that change the core.
    #[inline(always)]
    pub fn add_row_slopes(&self, table: &CoreTable, row: usize, inputs: &[f64], out: &mut [f64]) {
        self.add_slopes(&table.slopes[row * table.all.columns * self.directions.len()..], inputs, out);
    }

    /// Adds the derivatives of the first rows of what is seen of a physical state.
    #[inline(always)]
    pub fn add_seen(&self, rows: usize, x: &[f64], core: &Block, out: &mut Block) {
        let Self { seen, directions, .. } = self;
        for row in 0..rows {
            for (j, entry) in seen.all.row(row).iter().enumerate() {
                out.add(row, *entry, core.row(j));
            }
            self.add_slopes(&seen.slopes[row * seen.all.columns * directions.len()..], x, out.row_mut(row));
        }
    }

    #[inline(always)]
    fn add_slopes(&self, slopes: &[f64], inputs: &[f64], out: &mut [f64]) {
        if self.directions.is_empty() {
            return;
        }
        for (input, slopes) in inputs.iter().zip(slopes.chunks_exact(self.directions.len())) {
            for (k, slope) in self.directions.iter().zip(slopes) {
                out[*k] += input * slope;
            }
        }
    }

    /// Returns the core of a mode whose matrices are made.
    pub fn dynamics(&self, mode: &Mode) -> Option<&ModeDynamics> {
        self.dynamics.get(&mode.index()).map(|family| &family.own)
    }
}

/// Returns the derivatives of a stored matrix, entry by entry, one number a direction.
fn stored_slopes(
    own: &Rows,
    directions: &[usize],
    families: &[Family],
    entry: impl Fn(usize, usize, usize, usize) -> f64,
) -> Vec<f64> {
    let places = (0..own.data.len()).map(|at| (at / own.columns, at % own.columns));
    places
        .flat_map(|(i, j)| {
            let entry = &entry;
            directions.iter().enumerate().map(move |(place, &k)| {
                let of = std::array::from_fn(|member| entry(place, member, i, j));
                families[k].stencil.derivative(own.row(i)[j], of)
            })
        })
        .collect()
}

/// Returns the matrix of a step from its table.
fn rows_of(dynamics: &mut ModeDynamics, level: usize) -> Rows {
    dynamics.prepare(level);
    let n = dynamics.order();
    let columns = n + FIXED_INPUTS + UNKNOWNS;
    let Some(table) = dynamics.table(level) else { return Rows { columns, data: Vec::new() } };
    let entry = |table: &StepTable, i: usize, j: usize| match (i.checked_sub(STAGE_OUTPUTS), j) {
        (None, j) if j < n + FIXED_INPUTS => table.fixed.entry(i, j),
        (None, j) => table.stages.entry(i, j - n - FIXED_INPUTS),
        (Some(row), j) if j < n => table.flow.entry(row, j),
        (Some(row), j) if j < n + FIXED_INPUTS => table.drive.entry(row, j - n),
        (Some(row), j) => table.end.entry(MIDDLE_ROWS + row, j - n - FIXED_INPUTS),
    };
    Rows::new(STAGE_OUTPUTS + n, columns, |i, j| entry(table, i, j))
}
