//! CSV: one header row with the names and units of the columns, then one row per sample; commas, semicolons or tabs separate
//! cells; # starts a comment. A column of texts, without a single number, is left out.

use super::Decoded;
use crate::remark::Unread;
use crate::{Column, Error, Remark, Table};

/// The cells of one column.
#[derive(Default, Clone)]
struct Cells {
    values: Vec<f64>,
    /// How many of them hold a number.
    numbers: usize,
    /// The first that holds something else.
    text: Option<Text>,
}

/// A cell that is no number.
#[derive(Clone)]
struct Text {
    line: u64,
    value: String,
}

/// Returns the columns of a CSV file.
pub(super) fn read(bytes: &[u8], file: &str) -> Result<Decoded, Error> {
    let unreadable =
        |e: csv::Error| Error::Unreadable { file: file.to_owned(), kind: "CSV", why: e.to_string() };
    let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
    let delimiter = delimiter(bytes);
    let mut builder = csv::ReaderBuilder::new();
    builder.comment(Some(b'#')).trim(csv::Trim::All).flexible(true).delimiter(delimiter);
    let mut reader = builder.from_reader(bytes);
    let headings: Vec<String> = reader.headers().map_err(unreadable)?.iter().map(str::to_owned).collect();
    refuse_numbers(&headings, delimiter, file)?;
    let mut columns = vec![Cells::default(); headings.len()];
    for record in reader.records() {
        row(&record.map_err(unreadable)?, delimiter, &mut columns, file)?;
    }
    decoded(&headings, columns, file)
}

/// Returns the columns of numbers, and remarks on those of texts.
///
/// # Errors
/// [`Error::Cell`] if a column of numbers has a cell that is none.
fn decoded(headings: &[String], columns: Vec<Cells>, file: &str) -> Result<Decoded, Error> {
    let mut found = Decoded::default();
    for (heading, cells) in headings.iter().zip(columns) {
        let column = Column::headed(heading, cells.values);
        match cells.text {
            None => found.columns.push(column),
            Some(_) if cells.numbers == 0 => {
                let why = Unread::Type { holds: "texts".to_owned() };
                found.remarks.push(Remark::Unread { column: column.name, why });
            }
            Some(Text { line, value }) => {
                return Err(Error::Cell { file: file.to_owned(), line, column: column.name, value });
            }
        }
    }
    Ok(found)
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

fn row(record: &csv::StringRecord, delimiter: u8, columns: &mut [Cells], file: &str) -> Result<(), Error> {
    let line = record.position().map_or(0, csv::Position::line);
    if record.len() != columns.len() {
        let (cells, columns) = (record.len(), columns.len());
        return Err(Error::Row { file: file.to_owned(), line, cells, columns });
    }
    for (cell, column) in record.iter().zip(columns) {
        match number(cell, delimiter) {
            Some(value) => {
                column.numbers += usize::from(!is_missing(cell));
                column.values.push(value);
            }
            None => {
                column.text.get_or_insert_with(|| Text { line, value: cell.to_owned() });
                column.values.push(f64::NAN);
            }
        }
    }
    Ok(())
}

/// Returns whether a cell says that its value is missing.
fn is_missing(cell: &str) -> bool {
    cell.is_empty() || cell.eq_ignore_ascii_case("na") || cell.eq_ignore_ascii_case("nan")
}

/// Returns a number, which is NaN if the cell is empty; `None` if the cell holds something else. With semicolons between cells, a comma
/// may be the decimal mark.
fn number(cell: &str, delimiter: u8) -> Option<f64> {
    if is_missing(cell) {
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
        let mut columns = vec![Cells::default(); self.headings.len()];
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
            row(&self.record, self.delimiter, &mut columns, &self.name)?;
            count += 1;
        }
        if count == 0 {
            return Ok(None);
        }
        let name = format!("{}, rows {} to {}", self.name, self.read + 1, self.read + count);
        self.read += count;
        let Decoded { columns, remarks } = decoded(&self.headings, columns, &self.name)?;
        Table { name, columns, remarks }.checked().map(Some)
    }
}

impl<R: std::io::BufRead> Iterator for CsvParts<R> {
    type Item = Result<Table, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        self.part().transpose()
    }
}
