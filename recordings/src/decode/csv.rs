//! CSV: one header row with the names and units of the columns, then one row per sample; commas, semicolons or tabs separate
//! cells; # starts a comment. A column of texts, without a single number, is left out.

use super::DecodedFile;
use super::budget::Budget;
use crate::remark::UnreadReason;
use crate::{Error, RecordingColumn, RecordingTable, Remark};

/// The cells of one column.
#[derive(Debug, Default, Clone)]
struct Cells {
    values: Vec<f64>,
    /// Number of those that hold a number.
    numbers: usize,
    /// The first that holds something else.
    text: Option<Text>,
}

/// A cell that is no number.
#[derive(Debug, Clone)]
struct Text {
    line: u64,
    value: String,
}

/// Most columns of a CSV file: a header of separators alone is no recording, and each takes a hundred bytes.
const MOST_COLUMNS: usize = 10_000;
/// Values of a part, at most: a part of many columns has fewer rows.
const VALUES_OF_A_PART: usize = 5_000_000;
/// The memory of a column is accounted for after so many rows.
const ROWS_OF_A_COUNT: usize = 4096;

/// Returns the columns of a CSV file.
pub(super) fn read(bytes: &[u8], file: &str) -> Result<DecodedFile, Error> {
    let unreadable = |e: csv::Error| unreadable_error(file, &e);
    let mut budget = Budget::new(file, bytes.len());
    let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
    let delimiter = delimiter(bytes);
    refuse_many_columns(bytes, delimiter, file)?;
    let mut builder = csv::ReaderBuilder::new();
    builder.comment(Some(b'#')).trim(csv::Trim::All).flexible(true).delimiter(delimiter);
    let mut reader = builder.from_reader(bytes);
    let headings: Vec<String> = reader.headers().map_err(unreadable)?.iter().map(str::to_owned).collect();
    refuse_numbers(&headings, delimiter, file)?;
    let mut columns = vec![Cells::default(); headings.len()];
    for (count, record) in reader.records().enumerate() {
        if count % ROWS_OF_A_COUNT == 0 {
            let column = headings.first().map_or("", String::as_str);
            budget.take(column, (headings.len() * ROWS_OF_A_COUNT) as u64)?;
        }
        row(&record.map_err(unreadable)?, delimiter, &mut columns, file)?;
    }
    TextColumns::of(headings).decode_part(columns, file)
}

/// The columns of a file, which may be read in parts.
#[derive(Debug)]
struct TextColumns {
    headings: Vec<String>,
    /// The contents of the columns so far, without their values.
    held: Vec<Cells>,
    /// The columns that the first part has, and so all others.
    kept: Vec<bool>,
}

impl TextColumns {
    fn of(headings: Vec<String>) -> Self {
        let held = vec![Cells::default(); headings.len()];
        Self { headings, held, kept: Vec::new() }
    }

    /// Returns the columns of numbers of a part, and remarks on those of texts: those that the first part has. A column of texts is left out of
    /// all parts; one that is all missing in the first part, and holds texts later, stays all missing.
    ///
    /// # Errors
    /// [`Error::Cell`] if a column of numbers has a cell that is none, in this part or an earlier one.
    fn decode_part(&mut self, columns: Vec<Cells>, file: &str) -> Result<DecodedFile, Error> {
        let mut found = DecodedFile::default();
        for (k, mut cells) in columns.into_iter().enumerate() {
            cells.follow(&self.held[k]);
            let holds_texts = cells.holds_texts(&self.headings[k], file)?;
            self.held[k] = Cells { values: Vec::new(), numbers: cells.numbers, text: cells.text.clone() };
            if self.kept.len() == k {
                self.kept.push(!holds_texts);
            }
            let column = RecordingColumn::from_heading(&self.headings[k], cells.values);
            if holds_texts {
                found.remarks.push(texts(column.name.clone()));
            }
            if self.kept[k] {
                found.columns.push(column);
            }
        }
        Ok(found)
    }
}

/// Returns the remark on a column of texts.
fn texts(column: String) -> Remark {
    Remark::Unread { column, why: UnreadReason::Type { holds: "texts".to_owned() } }
}

impl Cells {
    /// Returns whether the column holds texts alone.
    ///
    /// # Errors
    /// [`Error::Cell`] if it holds numbers and a text.
    fn holds_texts(&self, heading: &str, file: &str) -> Result<bool, Error> {
        match &self.text {
            None => Ok(false),
            Some(_) if self.numbers == 0 => Ok(true),
            Some(Text { line, value }) => {
                let column = RecordingColumn::from_heading(heading, Vec::new()).name;
                Err(Error::Cell { file: file.to_owned(), line: *line, column, value: value.clone() })
            }
        }
    }

    /// Takes over what the cells of an earlier part hold.
    fn follow(&mut self, earlier: &Self) {
        self.numbers += earlier.numbers;
        self.text = earlier.text.clone().or(self.text.take());
    }
}

/// Returns the error of a file that cannot be taken apart, with what to do about text in another encoding.
fn unreadable_error(file: &str, error: &csv::Error) -> Error {
    let hint = match error.kind() {
        csv::ErrorKind::Utf8 { .. } => "; save it as UTF-8",
        _ => "",
    };
    Error::Unreadable { file: file.to_owned(), kind: "CSV", why: format!("{error}{hint}") }
}

/// Refuses a header of very many columns before anything is allocated for them.
fn refuse_many_columns(bytes: &[u8], delimiter: u8, file: &str) -> Result<(), Error> {
    let columns = header(bytes).iter().filter(|b| **b == delimiter).count() + 1;
    if columns <= MOST_COLUMNS {
        return Ok(());
    }
    let why = format!(
        "the first line has {columns} columns, more than the {MOST_COLUMNS} that are read: save the channels alone"
    );
    Err(Error::Unreadable { file: file.to_owned(), kind: "CSV", why })
}

/// Refuses a header that holds numbers, with or without cells that are empty: the first row of samples was taken for it.
fn refuse_numbers(headings: &[String], delimiter: u8, file: &str) -> Result<(), Error> {
    let is_number = |heading: &String| number(heading, delimiter).is_some();
    let is_finite = |heading: &String| number(heading, delimiter).is_some_and(f64::is_finite);
    if headings.iter().all(is_number) && headings.iter().any(is_finite) {
        return Err(Error::NoHeader { file: file.to_owned(), first: headings.join(",") });
    }
    Ok(())
}

/// Returns the first line that is no comment.
fn header(bytes: &[u8]) -> &[u8] {
    let lines = bytes.split(|b| matches!(b, b'\n' | b'\r'));
    lines.filter(|line| !line.is_empty()).find(|line| !line.starts_with(b"#")).unwrap_or_default()
}

/// Returns the separator that the header uses most.
fn delimiter(bytes: &[u8]) -> u8 {
    let header = header(bytes);
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
    columns: TextColumns,
    name: String,
    rows: usize,
    read: usize,
    record: csv::StringRecord,
}

impl<R: std::io::BufRead> CsvParts<R> {
    /// Reads the header. The separator is found in what the reader has buffered at first.
    ///
    /// # Errors
    /// As [`crate::RecordingTable::read`], of the header.
    pub fn new(mut reader: R, name: &str, rows: usize) -> Result<Self, Error> {
        let first = reader.fill_buf().map_err(|error| unreadable_error(name, &error.into()))?;
        let mark = "\u{feff}".as_bytes();
        let marked = first.starts_with(mark);
        let first = first.strip_prefix(mark).unwrap_or(first);
        let delimiter = delimiter(first);
        refuse_many_columns(first, delimiter, name)?;
        if marked {
            reader.consume(mark.len());
        }
        let mut builder = csv::ReaderBuilder::new();
        builder.comment(Some(b'#')).trim(csv::Trim::All).flexible(true).delimiter(delimiter);
        let mut reader = builder.from_reader(reader);
        let headings = reader.headers().map_err(|error| unreadable_error(name, &error))?;
        let headings: Vec<String> = headings.iter().map(str::to_owned).collect();
        refuse_numbers(&headings, delimiter, name)?;
        let rows = rows.min(VALUES_OF_A_PART / headings.len().max(1)).max(1);
        let record = csv::StringRecord::new();
        let (name, columns) = (name.to_owned(), TextColumns::of(headings));
        Ok(Self { reader, delimiter, columns, name, rows, read: 0, record })
    }

    fn part(&mut self) -> Result<Option<RecordingTable>, Error> {
        let mut columns = vec![Cells::default(); self.columns.headings.len()];
        let mut count = 0;
        while count < self.rows {
            let more = self
                .reader
                .read_record(&mut self.record)
                .map_err(|error| unreadable_error(&self.name, &error))?;
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
        let DecodedFile { columns, remarks } = self.columns.decode_part(columns, &self.name)?;
        RecordingTable { name, columns, remarks }.into_checked().map(Some)
    }
}

impl<R: std::io::BufRead> Iterator for CsvParts<R> {
    type Item = Result<RecordingTable, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        self.part().transpose()
    }
}
