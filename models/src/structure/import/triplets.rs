//! Matrices as lines of row, column and value: Abaqus' two texts, and CalculiX' with its list of rows.
//!
//! Formats: Abaqus Keywords Guide, *MATRIX OUTPUT and *MATRIX INPUT; G. Dhondt, *CalculiX CrunchiX User's Manual*, *FREQUENCY with
//! SOLVER=MATRIXSTORAGE. A symmetric matrix is written whole or as one of its triangles; which of them is seen from its entries.

use std::collections::BTreeSet;

use super::dmig::Dmig;
use super::node_map::Dof;
use super::text::{check_size, integer, line_error, parse_real};
use crate::Error;
use counterpoise_linalg::{Sparse, sparse::Entry};

/// Returns whether the entries of an Abaqus text name their nodes and components (FORMAT=MATRIX INPUT); those of FORMAT=COORDINATE do not.
pub fn has_labels(text: &str) -> bool {
    data_lines(text).next().is_some_and(|(_, words)| words.len() == LABELLED)
}

/// Words of an entry that names node and component of its row and of its column.
const LABELLED: usize = 5;

/// Reads an Abaqus matrix whose lines are row node, component, column node, component and value.
///
/// # Errors
/// [`Error::Import`] with the line: a line of another form, an entry that is there twice, a scale factor.
pub fn read_labels(text: &str) -> Result<Dmig, Error> {
    let mut entries = Vec::new();
    let mut places = BTreeSet::new();
    check_keywords(text)?;
    for (at, words) in data_lines(text) {
        let [row, row_component, column, column_component, value] = words[..] else {
            let line = words.join(" ");
            return Err(line_error(
                at,
                format!("\"{line}\" is not row node, component, column node, component and value"),
            ));
        };
        let unknown = |node: &str, component| -> Result<Dof, Error> {
            if node.starts_with('-') {
                return Err(line_error(
                    at,
                    format!(
                        "node {node} is internal to Abaqus (a Lagrange multiplier, an internal node); remove the parts that need it"
                    ),
                ));
            }
            Ok(Dof { grid: integer(at, node)?, component: integer(at, component)? })
        };
        let (row, column) = (unknown(row, row_component)?, unknown(column, column_component)?);
        if !places.insert((row, column)) {
            return Err(repeated_place(at, &words));
        }
        entries.push((row, column, parse_real(at, value)?));
    }
    let symmetric =
        !entries.iter().any(|(row, column, _)| row != column && places.contains(&(*column, *row)));
    Ok(Dmig { name: String::new(), symmetric, entries })
}

/// Reads a square matrix of so many rows whose lines are row, column and value, counted from 1.
///
/// # Errors
/// [`Error::Import`] with the line: a line of another form, an index outside, an entry that is there twice.
pub fn read_triplets(text: &str, rows: usize) -> Result<Sparse, Error> {
    check_size(0, rows, rows)?;
    check_keywords(text)?;
    let mut entries = Vec::new();
    let mut places = BTreeSet::new();
    for (at, words) in data_lines(text) {
        let [row, col, value] = words[..] else {
            return Err(line_error(at, format!("\"{}\" is not row, column and value", words.join(" "))));
        };
        let (row, col): (usize, usize) = (integer(at, row)?, integer(at, col)?);
        if row == 0 || col == 0 || row > rows || col > rows {
            return Err(line_error(
                at,
                format!("({row}, {col}) is outside {rows} x {rows}, the rows that are named"),
            ));
        }
        if !places.insert((row, col)) {
            return Err(repeated_place(at, &words));
        }
        entries.push(Entry { row: row - 1, col: col - 1, value: parse_real(at, value)? });
    }
    let is_whole = places.iter().any(|(row, col)| row != col && places.contains(&(*col, *row)));
    if !is_whole {
        let beside: Vec<Entry> = entries.iter().filter(|e| e.row != e.col).copied().collect();
        entries.extend(beside.iter().map(|e| Entry { row: e.col, col: e.row, value: e.value }));
    }
    Ok(Sparse::from_entries(rows, rows, &entries)?)
}

/// Reads CalculiX' list of rows: each line is the node, a point and the component of the next row.
///
/// # Errors
/// [`Error::Import`] with the line that is of another form, or that repeats a row.
pub fn read_rows(text: &str) -> Result<Vec<Dof>, Error> {
    let mut rows = Vec::new();
    let mut known = BTreeSet::new();
    for (at, words) in data_lines(text) {
        let parts = match words[..] {
            [word] => word.split_once('.'),
            _ => None,
        };
        let Some((node, component)) = parts else {
            return Err(line_error(at, format!("\"{}\" is not NODE.COMPONENT", words.join(" "))));
        };
        let row = Dof { grid: integer(at, node)?, component: integer(at, component)? };
        if !known.insert(row) {
            return Err(repeated_place(at, &words));
        }
        rows.push(row);
    }
    Ok(rows)
}

/// Returns the lines that hold data, with their numbers and their words, between which blanks or commas stand. Lines that begin with an
/// asterisk are keywords or comments.
fn data_lines(text: &str) -> impl Iterator<Item = (usize, Vec<&str>)> {
    let numbered = text.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with('*'));
    numbered.map(|(k, line)| (k + 1, split(line))).filter(|(_, words)| !words.is_empty())
}

fn split(line: &str) -> Vec<&str> {
    line.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty()).collect()
}

/// Refuses a keyword line that changes what the entries mean.
fn check_keywords(text: &str) -> Result<(), Error> {
    let scaled = |line: &str| {
        let line = line.trim_start().to_ascii_uppercase();
        line.starts_with('*') && !line.starts_with("**") && line.contains("SCALE FACTOR")
    };
    match text.lines().position(scaled) {
        Some(k) => Err(line_error(
            k + 1,
            "a scale factor is not read: write the matrix with its true values".to_owned(),
        )),
        None => Ok(()),
    }
}

fn repeated_place(at: usize, words: &[&str]) -> Error {
    line_error(at, format!("\"{}\" names a place that an earlier line names", words.join(" ")))
}
