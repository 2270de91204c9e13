//! CSV: one header row with the names and units of the columns, then one row per sample; commas, semicolons or tabs separate
//! cells; # starts a comment.

use crate::{Column, Error, Table};

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
    refuse_numbers(&headings, delimiter, file)?;
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); headings.len()];
    for record in reader.records() {
        row(&record.map_err(unreadable)?, delimiter, &headings, &mut columns, file)?;
    }
    Ok(headings.iter().zip(columns).map(|(heading, values)| Column::headed(heading, values)).collect())
}

/// Refuses a header that holds numbers: the first row of samples was taken for it.
fn refuse_numbers(headings: &[String], delimiter: u8, file: &str) -> Result<(), Error> {
    let is_number = |heading: &String| number(heading, delimiter).is_some_and(f64::is_finite);
    if !headings.is_empty() && headings.iter().all(is_number) {
        return Err(Error::NoHeader { file: file.to_owned(), first: headings.join(",") });
    }
    Ok(())
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

/// A CSV recording read in parts of so many rows, so that its size does not matter. Every part is a table of its own with the same
/// columns; its name says which rows it holds.
#[derive(Debug)]
pub struct CsvParts<R> {
    reader: csv::Reader<R>,
    delimiter: u8,
    headings: Vec<String>,
    name: String,
    rows: usize,
    read: usize,
    record: csv::StringRecord,
}

impl<R: std::io::BufRead> CsvParts<R> {
    /// Reads the header. The separator is found in what the reader has buffered at first.
    ///
    /// # Errors
    /// As [`crate::Table::read`], of the header.
    pub fn new(mut reader: R, name: &str, rows: usize) -> Result<Self, Error> {
        let unreadable = |why: String| Error::Unreadable { file: name.to_owned(), kind: "CSV", why };
        let first = reader.fill_buf().map_err(|error| unreadable(error.to_string()))?;
        let mark = "\u{feff}".as_bytes();
        let marked = first.starts_with(mark);
        let delimiter = delimiter(first.strip_prefix(mark).unwrap_or(first));
        if marked {
            reader.consume(mark.len());
        }
        let mut builder = csv::ReaderBuilder::new();
        builder.comment(Some(b'#')).trim(csv::Trim::All).flexible(true).delimiter(delimiter);
        let mut reader = builder.from_reader(reader);
        let headings: Vec<String> = reader
            .headers()
            .map_err(|error| unreadable(error.to_string()))?
            .iter()
            .map(str::to_owned)
            .collect();
        refuse_numbers(&headings, delimiter, name)?;
        let record = csv::StringRecord::new();
        Ok(Self { reader, delimiter, headings, name: name.to_owned(), rows: rows.max(1), read: 0, record })
    }

    fn part(&mut self) -> Result<Option<Table>, Error> {
        let mut columns: Vec<Vec<f64>> = vec![Vec::with_capacity(self.rows); self.headings.len()];
        let mut count = 0;
        while count < self.rows {
            let more = self.reader.read_record(&mut self.record).map_err(|error| Error::Unreadable {
                file: self.name.clone(),
                kind: "CSV",
                why: error.to_string(),
            })?;
            if !more {
                break;
            }
            row(&self.record, self.delimiter, &self.headings, &mut columns, &self.name)?;
            count += 1;
        }
        if count == 0 {
            return Ok(None);
        }
        let name = format!("{}, rows {} to {}", self.name, self.read + 1, self.read + count);
        self.read += count;
        let columns = self.headings.iter().zip(columns);
        let columns = columns.map(|(heading, values)| Column::headed(heading, values)).collect();
        Table { name, columns, remarks: Vec::new() }.checked().map(Some)
    }
}

impl<R: std::io::BufRead> Iterator for CsvParts<R> {
    type Item = Result<Table, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        self.part().transpose()
    }
}
