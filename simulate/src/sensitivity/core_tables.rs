//! The matrices of a step in the physical state, and their derivatives along the directions that change the core.

use super::block::{Block, GroupedMatrix, add_entry_slopes, pad_width};
use super::direction::Family;
use super::port_rows::{STAGE_OUTPUTS, UNKNOWNS};
use crate::engine::linear_core::{Mode, ModeDynamics};
use crate::engine::tables::{DEEPEST, FIXED_INPUTS, MIDDLE_ROWS, StepTable};
use counterpoise_models::Plant;
use std::collections::BTreeMap;

/// A matrix, row by row.
#[derive(Debug, Clone)]
pub(crate) struct Rows {
    pub columns: usize,
    pub data: Vec<f64>,
}

impl Rows {
    fn new(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
        let data =
            (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))).map(|(i, j)| entry(i, j)).collect();
        Self { columns, data }
    }

    /// Returns one row.
    #[inline(always)]
    pub fn row(&self, index: usize) -> &[f64] {
        &self.data[index * self.columns..(index + 1) * self.columns]
    }
}

/// Row of a step's result at which the state at the end begins; before it are the outputs at the stages.
pub(crate) const STATE_ROW: usize = 16;

/// A step of one length in one mode: (outputs at the stages, then the state at the end) from the state, from drive, gap and ports at the start,
/// and from the ports at the stages.
#[derive(Debug, Clone)]
pub(crate) struct CoreTable {
    pub state: GroupedMatrix,
    pub given: GroupedMatrix,
    pub ports: GroupedMatrix,
    /// From the ports at the stages to the outputs there.
    pub stages: Block,
    /// The derivatives of the whole matrix: entry by entry, one number for each direction that changes the core.
    pub slopes: Block,
}

/// Returns the rows of a step's result, padded to whole groups.
pub(crate) fn result_rows(order: usize) -> usize {
    STATE_ROW + order.next_multiple_of(4)
}

/// The rows of what is seen of the physical state: the outputs, then the tip's rate.
#[derive(Debug, Clone)]
pub(crate) struct SeenRows {
    pub all: Rows,
    /// As [`CoreTable::slopes`].
    slopes: Block,
}

/// The matrices of the modes and steps that a run has met.
#[derive(Debug, Clone)]
pub(crate) struct CoreTables {
    nominal: Plant,
    period_s: f64,
    /// Number of directions that change the core: they are the first ones.
    directions: usize,
    dynamics: BTreeMap<usize, ModeFamily>,
    tables: BTreeMap<usize, CoreTable>,
    seen: SeenRows,
}

/// The cores of a mode: of the nominal plant and of the members of each direction that changes it.
#[derive(Debug, Clone)]
struct ModeFamily {
    own: ModeDynamics,
    members: Vec<[ModeDynamics; super::stencil::MEMBERS]>,
}

impl CoreTable {
    fn new(own: &Rows, slopes: Block) -> Self {
        let (n, rows) = (own.columns - FIXED_INPUTS - UNKNOWNS, own.data.len() / own.columns);
        let part = |columns: &[usize]| {
            let mut part = GroupedMatrix::new(rows, columns.len());
            for row in 0..rows {
                for (place, column) in columns.iter().enumerate() {
                    part.set(row, place, own.row(row)[*column]);
                }
            }
            part
        };
        let mut stages = Block::new(STAGE_OUTPUTS, pad_width(UNKNOWNS));
        for row in 0..STAGE_OUTPUTS {
            stages.row_mut(row)[..UNKNOWNS].copy_from_slice(&own.row(row)[n + FIXED_INPUTS..]);
        }
        let all: Vec<usize> = (0..own.columns).collect();
        // drive, gap and the ports at the start: the platform's rates between them depend on nothing
        let given: Vec<usize> = [n, n + 1].into_iter().chain(n + 6..n + FIXED_INPUTS).collect();
        Self {
            state: part(&all[..n]),
            given: part(&given),
            ports: part(&all[n + FIXED_INPUTS..]),
            stages,
            slopes,
        }
    }
}

impl CoreTables {
    pub fn new(nominal: &Plant, families: &[Family], period_s: f64) -> Self {
        let directions = families.iter().take_while(|family| family.has_other_core).count();
        let rows = |plant: &Plant| -> Vec<Vec<f64>> {
            let n = plant.core_order();
            let cut = |mut row: Vec<f64>| {
                row.truncate(n);
                row
            };
            vec![
                plant.motor_rate_row(),
                (0..n)
                    .map(|j| f64::from(u8::from(j == counterpoise_models::plant::core::state::WINDUP)))
                    .collect(),
                plant.hub_angle_row(),
                plant.hub_rate_row(),
                cut(plant.current_row()),
                plant.tip_rate_row(),
            ]
        };
        let own = rows(nominal);
        let all = Rows::new(own.len(), nominal.core_order(), |i, j| own[i][j]);
        let varied = &families[..directions];
        let others: Vec<_> = varied.iter().map(|family| family.plants.each_ref().map(rows)).collect();
        let slopes = stored_slopes(&all, varied, |direction, member, i, j| others[direction][member][i][j]);
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
            let of = |plant: &Plant| ModeDynamics::with_physical_coordinates(plant, mode, *period_s);
            let family = dynamics.entry(mode.index()).or_insert_with(|| ModeFamily {
                own: of(nominal),
                members: families[..*directions]
                    .iter()
                    .map(|family| family.plants.each_ref().map(of))
                    .collect(),
            });
            let own = rows_of(&mut family.own, level);
            let members: Vec<[Rows; super::stencil::MEMBERS]> = family
                .members
                .iter_mut()
                .map(|members| members.each_mut().map(|member| rows_of(member, level)))
                .collect();
            let slopes = stored_slopes(&own, &families[..*directions], |direction, member, i, j| {
                members[direction][member].row(i)[j]
            });
            CoreTable::new(&own, slopes)
        });
    }

    /// Returns the matrices of a step that [`Self::prepare`] has made.
    pub fn table(&self, mode: &Mode, level: usize) -> Option<&CoreTable> {
        self.tables.get(&(mode.index() * (DEEPEST + 1) + level))
    }

    /// Adds the derivatives of a step's matrix times its inputs, in the columns of the directions that change the core.
    #[inline(always)]
    pub fn add_slopes(&self, table: &CoreTable, inputs: &[f64], out: &mut Block) {
        if self.directions > 0 {
            add_entry_slopes(&table.slopes, inputs, out);
        }
    }

    /// Adds the derivatives of the first rows of what is seen of a physical state.
    #[inline(always)]
    pub fn add_seen(&self, rows: usize, x: &[f64], core: &Block, out: &mut Block) {
        let seen = &self.seen;
        let width = core.row(0).len();
        for row in 0..rows {
            core.combine(seen.all.row(row), &mut out.row_mut(row)[..width]);
            if self.directions > 0 {
                let varied = &mut out.row_mut(row)[..pad_width(self.directions)];
                seen.slopes.combine_from(row * seen.all.columns, x, varied);
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
    families: &[Family],
    entry: impl Fn(usize, usize, usize, usize) -> f64,
) -> Block {
    let mut slopes = Block::new(own.data.len(), pad_width(families.len()));
    for (at, value) in own.data.iter().enumerate() {
        let (i, j) = (at / own.columns, at % own.columns);
        for (k, family) in families.iter().enumerate() {
            let of = std::array::from_fn(|member| entry(k, member, i, j));
            slopes.row_mut(at)[k] = family.stencil.derivative(*value, of);
        }
    }
    slopes
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
    let entry = |i: usize, j: usize| match i {
        i if i < STAGE_OUTPUTS => entry(table, i, j),
        i if (STATE_ROW..STATE_ROW + n).contains(&i) => entry(table, i - STATE_ROW + STAGE_OUTPUTS, j),
        _ => 0.0,
    };
    Rows::new(result_rows(n), columns, entry)
}
