//! CSV: one header row with the names and units of the columns, then one row per sample; commas, semicolons or tabs separate
//! cells; # starts a comment.

use crate::{Column, Error};

/// Returns the columns of a CSV file.
pub(super) fn read(bytes: &[u8], file: &str) -> Result<Vec<Column>, Error> {
    let unreadable =
        |e: csv::Error| Error::Unreadable { file: file.to_owned(), kind: "CSV", why: e.to_string() };
    let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
    let delimiter = delimiter(bytes);
    let mut builder = csv::ReaderBuilder::new();
    builder.comment(Some(b'#')).trim(csv::Trim::All).flexible(true).delimiter(delimiter);
    let mut reader = builder.from_reader(bytes);
    let headings: Vec<String> = reader.headers().map_err(unreadable)?.iter().map(str::to_owned).collect();
    if !headings.is_empty()
        && headings.iter().all(|heading| number(heading, delimiter).is_some_and(f64::is_finite))
    {
        return Err(Error::NoHeader { file: file.to_owned(), first: headings.join(",") });
    }
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); headings.len()];
    for record in reader.records() {
        row(&record.map_err(unreadable)?, delimiter, &headings, &mut columns, file)?;
    }
    Ok(headings.iter().zip(columns).map(|(heading, values)| Column::headed(heading, values)).collect())
}

/// Returns the separator that the header uses most.
fn delimiter(bytes: &[u8]) -> u8 {
    let header = bytes.split(|b| *b == b'\n').find(|line| !line.starts_with(b"#")).unwrap_or_default();
    let count = |mark: &u8| header.iter().filter(|b| *b == mark).count();
    [b',', b';', b'\t'].into_iter().rev().max_by_key(count).unwrap_or(b',')
}

fn row(
    record: &csv::StringRecord,
    delimiter: u8,
    headings: &[String],
    columns: &mut [Vec<f64>],
    file: &str,
) -> Result<(), Error> {
    let line = record.position().map_or(0, csv::Position::line);
    if record.len() != columns.len() {
        let (cells, columns) = (record.len(), columns.len());
        return Err(Error::Row { file: file.to_owned(), line, cells, columns });
    }
    for ((cell, heading), column) in record.iter().zip(headings).zip(columns) {
        let value = number(cell, delimiter).ok_or_else(|| Error::Cell {
            file: file.to_owned(),
            line,
            column: Column::headed(heading, Vec::new()).name,
            value: cell.to_owned(),
        })?;
        column.push(value);
    }
    Ok(())
}

/// Returns a number, which is NaN if the cell is empty; `None` if the cell holds something else. With semicolons between cells, a comma
/// may be the decimal mark.
fn number(cell: &str, delimiter: u8) -> Option<f64> {
    if cell.is_empty() || cell.eq_ignore_ascii_case("na") {
        return Some(f64::NAN);
    }
    if delimiter == b',' { cell.parse().ok() } else { cell.replace(',', ".").parse().ok() }
}
