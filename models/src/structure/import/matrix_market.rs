//! Matrix Market text (R. Boisvert, R. Pozo, K. Remington, NIST IR 5935, 1996): coordinate and array, real.

use super::text::{check_size, integer, line_error, parse_real};
use crate::Error;
use counterpoise_linalg::{Sparse, sparse::Entry};

/// Returns the matrix in a Matrix Market text: `real` or `integer`, `general`, `symmetric` or `skew-symmetric`; entries that are
/// given twice add up.
///
/// # Errors
/// [`Error::Import`] with the line: a header that is not supported, an index outside, a number missing or too many.
pub fn matrix_market(text: &str) -> Result<Sparse, Error> {
    let mut lines = text.lines().enumerate().map(|(i, line)| (i + 1, line));
    let (_, banner) = lines.next().ok_or_else(|| line_error(1, "the text is empty".to_owned()))?;
    let header = Header::parse(banner)?;
    let mut body = lines.filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('%'));
    let (at, size) = body.next().ok_or_else(|| line_error(1, "the size is missing".to_owned()))?;
    let size: Vec<usize> = size.split_whitespace().map(|t| integer(at, t)).collect::<Result<_, _>>()?;
    match (header.layout, size.as_slice()) {
        (Layout::Coordinate, &[rows, columns, entries]) => {
            coordinate(body, &header, Shape { rows, columns }, entries, at)
        }
        (Layout::Array, &[rows, columns]) => array(body, &header, Shape { rows, columns }, at),
        _ => Err(line_error(at, "the size has the wrong number of entries".to_owned())),
    }
}

/// The form in which a text lists the entries.
#[derive(Debug, Clone, Copy)]
enum Layout {
    /// Row, column and value of each.
    Coordinate,
    /// All values, column by column.
    Array,
}

/// The size of a matrix.
#[derive(Debug, Clone, Copy)]
struct Shape {
    rows: usize,
    columns: usize,
}

struct Header {
    layout: Layout,
    /// The factor of the entry across the diagonal: 0 for a general matrix.
    mirror: f64,
}

impl Header {
    fn parse(banner: &str) -> Result<Self, Error> {
        let words: Vec<String> = banner.split_whitespace().map(str::to_ascii_lowercase).collect();
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let unsupported = || line_error(1, format!("\"{banner}\" is not a real Matrix Market matrix"));
        let ["%%matrixmarket", "matrix", format, "real" | "integer" | "double", symmetry] = words.as_slice()
        else {
            return Err(unsupported());
        };
        let mirror = match *symmetry {
            "general" => 0.0,
            "symmetric" => 1.0,
            "skew-symmetric" => -1.0,
            _ => return Err(unsupported()),
        };
        match *format {
            "coordinate" => Ok(Self { layout: Layout::Coordinate, mirror }),
            "array" => Ok(Self { layout: Layout::Array, mirror }),
            _ => Err(unsupported()),
        }
    }

    fn add(&self, out: &mut Vec<Entry>, entry: Entry) {
        let Entry { row, col, value } = entry;
        out.push(entry);
        if row != col && self.mirror != 0.0 {
            out.push(Entry { row: col, col: row, value: self.mirror * value });
        }
    }
}

fn coordinate<'a>(
    lines: impl Iterator<Item = (usize, &'a str)>,
    header: &Header,
    shape: Shape,
    entries: usize,
    size_line: usize,
) -> Result<Sparse, Error> {
    check_shape(header, shape, size_line)?;
    let Shape { rows, columns } = shape;
    let mut out = Vec::new();
    let mut found = 0;
    for (at, line) in lines {
        let mut words = line.split_whitespace();
        let (Some(i), Some(j), Some(value), None) = (words.next(), words.next(), words.next(), words.next())
        else {
            return Err(line_error(at, format!("\"{line}\" is not row, column and value")));
        };
        let (i, j): (usize, usize) = (integer(at, i)?, integer(at, j)?);
        if i == 0 || j == 0 || i > rows || j > columns {
            return Err(line_error(at, format!("({i}, {j}) is outside {rows} x {columns}")));
        }
        header.add(&mut out, Entry { row: i - 1, col: j - 1, value: parse_real(at, value)? });
        found += 1;
    }
    if found == entries {
        Ok(Sparse::from_entries(rows, columns, &out)?)
    } else {
        Err(line_error(size_line, format!("{found} entries of {entries} are there")))
    }
}

fn array<'a>(
    lines: impl Iterator<Item = (usize, &'a str)>,
    header: &Header,
    shape: Shape,
    size_line: usize,
) -> Result<Sparse, Error> {
    check_shape(header, shape, size_line)?;
    let Shape { rows, columns } = shape;
    let first = |j: usize| {
        if header.mirror == 0.0 {
            0
        } else if header.mirror > 0.0 {
            j
        } else {
            j + 1
        }
    };
    let mut places = (0..columns).flat_map(|j| (first(j)..rows).map(move |i| (i, j)));
    let mut out = Vec::new();
    for (at, line) in lines {
        let (row, col) =
            places.next().ok_or_else(|| line_error(at, "there are too many entries".to_owned()))?;
        let value = parse_real(at, line)?;
        if value != 0.0 {
            header.add(&mut out, Entry { row, col, value });
        }
    }
    match places.next() {
        None => Ok(Sparse::from_entries(rows, columns, &out)?),
        Some((i, j)) => Err(line_error(size_line, format!("the entries end before ({}, {})", i + 1, j + 1))),
    }
}

fn check_shape(header: &Header, Shape { rows, columns }: Shape, at: usize) -> Result<(), Error> {
    check_size(at, rows, columns)?;
    if header.mirror != 0.0 && rows != columns {
        return Err(line_error(at, format!("a symmetric matrix cannot be {rows} x {columns}")));
    }
    Ok(())
}
