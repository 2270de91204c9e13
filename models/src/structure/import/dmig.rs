//! Nastran's DMIG bulk data: matrices by grid and component, in small, large and free fields.

use super::node_map::Dof;
use super::text::{columns, integer, line_error, parse_real};
use crate::Error;
use counterpoise_linalg::{Sparse, sparse::Entry};

/// A matrix of DMIG entries.
#[derive(Debug, Clone, PartialEq)]
pub struct Dmig {
    /// Name.
    pub name: String,
    /// `true` if each entry stands for its mirror image too (IFO = 6).
    pub symmetric: bool,
    /// Row, column and value of each entry.
    pub entries: Vec<(Dof, Dof, f64)>,
}

impl Dmig {
    /// Returns the unknowns that the entries mention; a symmetric matrix mentions each once at least as row or column.
    pub fn dofs(&self) -> impl Iterator<Item = Dof> + '_ {
        self.entries.iter().flat_map(|(row, col, _)| [*row, *col])
    }

    /// Returns the square matrix over the given unknowns, which rise; entries of others are left out, repeated ones add up.
    ///
    /// # Errors
    /// [`Error::Linalg`] if the matrix is too large.
    pub fn matrix(&self, rows: &[Dof]) -> Result<Sparse, Error> {
        let mut out = Vec::with_capacity(self.entries.len());
        for (row, col, value) in &self.entries {
            let (Ok(row), Ok(col)) = (rows.binary_search(row), rows.binary_search(col)) else { continue };
            out.push(Entry { row, col, value: *value });
            if self.symmetric && row != col {
                out.push(Entry { row: col, col: row, value: *value });
            }
        }
        Ok(Sparse::from_entries(rows.len(), rows.len(), &out)?)
    }
}

/// Reads all DMIG matrices in a bulk data text; other entries, comments (`$`) and blank lines are passed over.
///
/// # Errors
/// [`Error::Import`] with the line: a complex or rectangular matrix, an entry before its header, a field that cannot be
/// read.
pub fn read_dmig(text: &str) -> Result<Vec<Dmig>, Error> {
    let mut out: Vec<Dmig> = Vec::new();
    for card in cards(text) {
        let fields: Vec<&str> = card.fields.iter().map(String::as_str).collect();
        let name = fields.first().copied().unwrap_or("");
        if fields.get(1) == Some(&"0") {
            out.push(header(card.line, name, &fields)?);
            continue;
        }
        let found = out.iter_mut().rfind(|d| d.name == name);
        let matrix =
            found.ok_or_else(|| line_error(card.line, format!("DMIG {name} has no header before")))?;
        column(card.line, &fields, matrix)?;
    }
    Ok(out)
}

fn header(at: usize, name: &str, fields: &[&str]) -> Result<Dmig, Error> {
    let form: u32 = integer(at, fields.get(2).unwrap_or(&""))?;
    let kind: u32 = integer(at, fields.get(3).unwrap_or(&""))?;
    if form != 1 && form != 6 {
        return Err(line_error(
            at,
            format!("DMIG {name} has form {form}: only square (1) and symmetric (6) are read"),
        ));
    }
    if kind != 1 && kind != 2 {
        return Err(line_error(at, format!("DMIG {name} has type {kind}, not a real one")));
    }
    Ok(Dmig { name: name.to_owned(), symmetric: form == 6, entries: Vec::new() })
}

/// NAME, GJ, CJ, blank, then G, C, A, B for each entry of the column.
fn column(at: usize, fields: &[&str], matrix: &mut Dmig) -> Result<(), Error> {
    let dof = |k: usize| -> Result<Dof, Error> {
        let component = fields.get(k + 1).filter(|f| !f.is_empty()).unwrap_or(&"0");
        Ok(Dof { grid: integer(at, fields.get(k).unwrap_or(&""))?, component: integer(at, component)? })
    };
    let col = dof(1)?;
    for k in (4..fields.len()).step_by(4) {
        if fields[k].is_empty() {
            continue;
        }
        let value = parse_real(at, fields.get(k + 2).unwrap_or(&""))?;
        matrix.entries.push((dof(k)?, col, value));
    }
    Ok(())
}

/// One DMIG entry with its continuations joined; fields after the first, trimmed.
struct Card {
    line: usize,
    fields: Vec<String>,
}

fn cards(text: &str) -> Vec<Card> {
    let mut out: Vec<Card> = Vec::new();
    let mut open = false;
    for (i, raw) in text.lines().enumerate() {
        let line = raw.split('$').next().unwrap_or("").trim_end();
        if line.trim().is_empty() {
            continue;
        }
        let (first, fields) = split(line);
        let continues = first.is_empty() || first.starts_with(['+', '*']);
        if first.trim_end_matches('*').eq_ignore_ascii_case("DMIG") {
            out.push(Card { line: i + 1, fields });
        } else if let (true, true, Some(card)) = (continues, open, out.last_mut()) {
            card.fields.extend(fields);
        } else {
            open = false;
            continue;
        }
        open = true;
    }
    out
}

/// Returns the first field and the data fields of a line: by commas, or by 8 columns, or by 16 if the first ends in `*`.
fn split(line: &str) -> (String, Vec<String>) {
    let trimmed = |s: &str| s.trim().to_owned();
    if line.contains(',') {
        let mut parts = line.split(',').map(trimmed);
        let first = parts.next().unwrap_or_default();
        let width = if first.contains('*') { 4 } else { 8 };
        let mut fields: Vec<String> = parts.take(width).collect();
        pad(&mut fields);
        return (first, fields);
    }
    let first = trimmed(columns(line, 0, 8));
    let (width, many) = if first.contains('*') { (16, 4) } else { (8, 8) };
    let mut fields: Vec<String> =
        (0..many).map(|k| trimmed(columns(line, 8 + k * width, 8 + (k + 1) * width))).collect();
    pad(&mut fields);
    (first, fields)
}

/// Whole groups of four fields, without groups that are empty at the end.
fn pad(fields: &mut Vec<String>) {
    while fields.len() > 4 && fields[fields.len() - 1].is_empty() {
        fields.pop();
    }
    while !fields.len().is_multiple_of(4) {
        fields.push(String::new());
    }
}
