//! Nastran's OUTPUT4 as text: dense, sparse and "bigmat" columns of real matrices.

use super::text::{check_size, columns, integer, line_error, parse_real};
use crate::Error;
use counterpoise_linalg::{Sparse, sparse::Entry};

/// A matrix of an OP4 text.
#[derive(Debug, Clone, PartialEq)]
pub struct Op4 {
    /// Name.
    pub name: String,
    /// Entries.
    pub matrix: Sparse,
}

/// Reads all matrices in an OP4 text.
///
/// Each begins with NCOL, NROW (negative: bigmat), form and type in fields of 8 columns, its name in 8 and the FORTRAN
/// format of its values; each column with three whole numbers, each string of a sparse column with one or two; a column
/// beyond the last ends the matrix.
///
/// # Errors
/// [`Error::Import`] with the line: a complex matrix, an index outside, a number that cannot be read.
pub fn read_op4(text: &str) -> Result<Vec<Op4>, Error> {
    let mut lines =
        text.lines().enumerate().map(|(i, line)| (i + 1, line)).filter(|(_, l)| !l.trim().is_empty());
    let mut out = Vec::new();
    while let Some((at, line)) = lines.next() {
        out.push(one(&mut lines, Header::parse(at, line)?)?);
    }
    Ok(out)
}

struct Header {
    name: String,
    rows: usize,
    cols: usize,
    /// Characters of one value.
    width: usize,
}

impl Header {
    fn parse(at: usize, line: &str) -> Result<Self, Error> {
        let field = |k: usize| integer::<i64>(at, columns(line, 8 * k, 8 * k + 8));
        let (cols, rows, kind) = (field(0)?, field(1)?, field(3)?);
        if kind != 1 && kind != 2 {
            return Err(line_error(at, format!("type {kind} is not a real matrix")));
        }
        if cols < 1 || rows == 0 {
            return Err(line_error(at, format!("a matrix of {rows} x {cols} has no entries")));
        }
        let name = columns(line, 32, 40).trim().to_owned();
        let width = value_width(columns(line, 40, line.len()));
        let width = width.ok_or_else(|| line_error(at, "the format of the values is missing".to_owned()))?;
        let (rows, cols) = (rows.unsigned_abs() as usize, cols as usize);
        check_size(at, rows, cols)?;
        Ok(Self { name, rows, cols, width })
    }
}

/// 23 of `1P,3E23.16`.
fn value_width(format: &str) -> Option<usize> {
    let after = &format[format.rfind(['E', 'D', 'e', 'd'])? + 1..];
    after.split('.').next()?.trim().parse().ok().filter(|&w| w > 0)
}

/// The bits of a sparse string's header that hold its row.
const STRING_ROW: usize = 65_536;

fn one<'a>(lines: &mut impl Iterator<Item = (usize, &'a str)>, header: Header) -> Result<Op4, Error> {
    let mut matrix: Vec<Entry> = Vec::new();
    let (mut row, mut col) = (1_usize, 0_usize);
    for (at, line) in lines {
        if line.contains('.') {
            if col > header.cols {
                let matrix = Sparse::from_entries(header.rows, header.cols, &matrix)?;
                return Ok(Op4 { name: header.name, matrix });
            }
            row = values(at, line, &header, &mut matrix, row, col)?;
            continue;
        }
        let numbers: Vec<usize> =
            line.split_whitespace().map(|t| integer(at, t)).collect::<Result<_, _>>()?;
        match *numbers.as_slice() {
            [column, first, _] => (row, col) = (first, column),
            [_, first] => row = first,
            [packed] => row = packed % STRING_ROW,
            _ => return Err(line_error(at, format!("\"{line}\" begins neither a column nor a string"))),
        }
    }
    Err(line_error(0, format!("matrix {} does not end", header.name)))
}

/// Writes a line's values into the column from the row on; returns the row after them.
fn values(
    at: usize,
    line: &str,
    header: &Header,
    matrix: &mut Vec<Entry>,
    mut row: usize,
    col: usize,
) -> Result<usize, Error> {
    let line = line.trim_end();
    let many = line.len().div_ceil(header.width);
    for k in 0..many {
        if row == 0 || col == 0 || row > header.rows {
            return Err(line_error(
                at,
                format!("({row}, {col}) is outside {} x {}", header.rows, header.cols),
            ));
        }
        let value = parse_real(at, columns(line, k * header.width, (k + 1) * header.width))?;
        if value != 0.0 {
            matrix.push(Entry { row: row - 1, col: col - 1, value });
        }
        row += 1;
    }
    Ok(row)
}
