//! CSV: one header row naming column and unit, then one row per sample; commas, semicolons or tabs; # starts a comment.

use super::{Column, RecordingError};

/// The columns of a CSV file.
pub(super) fn read(bytes: &[u8], file: &str) -> Result<Vec<Column>, RecordingError> {
    let unreadable =
        |e: csv::Error| RecordingError::Unreadable { file: file.to_owned(), kind: "CSV", why: e.to_string() };
    let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
    let delimiter = delimiter(bytes);
    let mut builder = csv::ReaderBuilder::new();
    builder.comment(Some(b'#')).trim(csv::Trim::All).flexible(true).delimiter(delimiter);
    let mut reader = builder.from_reader(bytes);
    let headings: Vec<String> = reader.headers().map_err(unreadable)?.iter().map(str::to_owned).collect();
    let mut columns: Vec<Column> = headings.iter().map(|h| Column::headed(h, Vec::new())).collect();
    for record in reader.records() {
        row(&record.map_err(unreadable)?, delimiter, &mut columns, file)?;
    }
    Ok(columns)
}

/// The separator that the header uses most.
fn delimiter(bytes: &[u8]) -> u8 {
    let header = bytes.split(|b| *b == b'\n').find(|line| !line.starts_with(b"#")).unwrap_or_default();
    let count = |mark: &u8| header.iter().filter(|b| *b == mark).count();
    [b',', b';', b'\t'].into_iter().rev().max_by_key(count).unwrap_or(b',')
}

fn row(
    record: &csv::StringRecord,
    delimiter: u8,
    columns: &mut [Column],
    file: &str,
) -> Result<(), RecordingError> {
    let line = record.position().map_or(0, csv::Position::line);
    if record.len() != columns.len() {
        return Err(RecordingError::Row {
            file: file.to_owned(),
            line,
            cells: record.len(),
            columns: columns.len(),
        });
    }
    for (cell, column) in record.iter().zip(columns) {
        let value = number(cell, delimiter).ok_or_else(|| RecordingError::Cell {
            file: file.to_owned(),
            line,
            column: column.name.clone(),
            value: cell.to_owned(),
        })?;
        column.values.push(value);
    }
    Ok(())
}

/// A number; NaN where the cell is empty. With semicolons between cells a comma may be the decimal mark.
fn number(cell: &str, delimiter: u8) -> Option<f64> {
    if cell.is_empty() || cell.eq_ignore_ascii_case("na") {
        return Some(f64::NAN);
    }
    if delimiter == b',' { cell.parse().ok() } else { cell.replace(',', ".").parse().ok() }
}
