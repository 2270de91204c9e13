//! What `counterpoise compare` prints: one design a column, because it has more figures than a terminal has columns.

use super::add_line;
use crate::designs::{design_cells, design_remarks, table_columns};
use crate::results::DesignTableText;

/// Width of the column of names: "residual transmitted torque [mN m]" and a space.
const WIDEST_NAME: usize = 35;

/// Returns the lines of the table, with the time that each design took in s.
pub fn comparison_lines(table: &DesignTableText, times_s: &[f64]) -> Vec<String> {
    let mut lines = vec![format!("{}: tuned structures make least: {}", table.name, table.objective)];
    add_line!(lines);
    for (k, row) in table.rows.iter().enumerate() {
        add_line!(lines, "{}  {}", k + 1, row.name);
        design_remarks(row, table.loops.controlled).iter().for_each(|line| add_line!(lines, "     {line}"));
    }
    add_line!(lines);
    let heads: String = (1..=table.rows.len()).map(|k| format!("{k:>11}")).collect();
    add_line!(lines, "{:WIDEST_NAME$}{heads}", "");
    let columns: Vec<Vec<String>> =
        table.rows.iter().enumerate().map(|(k, row)| design_cells(row, times_s.get(k).copied())).collect();
    for (line, name) in table_columns(table.loops).iter().enumerate() {
        let cells: String = columns.iter().map(|cells| format!("{:>11}", cells[line])).collect();
        add_line!(lines, "{name:WIDEST_NAME$}{cells}");
    }
    lines
}
