//! Nastran's OUTPUT4 in binary: FORTRAN records of 32-bit words, in either order of bytes.
//!
//! Format: MSC Nastran DMAP Programmer's Guide, OUTPUT4. Each matrix begins with NCOL, NROW (negative: bigmat), form and type and eight
//! characters of a name. Each column is a record of ICOL, IROW, NW and NW words: values from row IROW on, or strings if IROW is 0. A column beyond
//! the last ends the matrix.

use super::op4::Op4;
use super::text::{check_size, line_error};
use crate::Error;
use counterpoise_linalg::{Sparse, sparse::Entry};

/// Bytes of the record that begins a matrix.
const HEADER: u32 = 24;
/// Bytes of that record if the words have 64 bits.
const WIDE_HEADER: u32 = 48;
/// Bytes of a word.
const WORD: usize = 4;
/// The bits of a string's header that hold its row; a matrix of more rows is a bigmat.
const STRING_ROW: i64 = 65_536;

/// Returns whether bytes are a binary OUTPUT4 file; they begin with the length of a record.
pub fn is_binary_op4(bytes: &[u8]) -> bool {
    byte_order(bytes).is_some()
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ByteOrder {
    Little,
    Big,
}

fn byte_order(bytes: &[u8]) -> Option<ByteOrder> {
    let first: [u8; WORD] = bytes.get(..WORD)?.try_into().ok()?;
    let is_header = |length: u32| [HEADER, WIDE_HEADER].contains(&length);
    match (is_header(u32::from_le_bytes(first)), is_header(u32::from_be_bytes(first))) {
        (true, _) => Some(ByteOrder::Little),
        (_, true) => Some(ByteOrder::Big),
        _ => None,
    }
}

/// Reads all matrices in a binary OUTPUT4 file.
///
/// # Errors
/// [`Error::Import`] with the byte: a complex matrix, 64-bit words, an index outside, a record that is cut off.
pub fn read_binary_op4(bytes: &[u8]) -> Result<Vec<Op4>, Error> {
    let order = byte_order(bytes).ok_or_else(|| {
        line_error(0, "it does not begin with a record of 24 bytes, as a binary OUTPUT4 file does".to_owned())
    })?;
    let mut records = Records { bytes, at: 0, order };
    let mut out = Vec::new();
    while !records.is_at_end() {
        out.push(read_matrix(&mut records)?);
    }
    Ok(out)
}

/// A cursor over the records of a file.
struct Records<'a> {
    bytes: &'a [u8],
    at: usize,
    order: ByteOrder,
}

/// The data of a record and the byte at which it begins.
struct Record<'a> {
    data: &'a [u8],
    at: usize,
    order: ByteOrder,
}

impl<'a> Records<'a> {
    fn is_at_end(&self) -> bool {
        self.at >= self.bytes.len()
    }

    /// Returns the next record, which stands between two copies of its length.
    fn next(&mut self) -> Result<Record<'a>, Error> {
        let start = self.at;
        let wrong = || mistake(start, "a record is cut off or damaged");
        let bytes = self.bytes;
        let length = word(bytes, start, self.order)
            .and_then(|length| usize::try_from(length).ok())
            .ok_or_else(wrong)?;
        let data = bytes.get(start + WORD..).and_then(|rest| rest.get(..length)).ok_or_else(wrong)?;
        let end = start + WORD + length;
        if word(bytes, end, self.order).and_then(|closing| usize::try_from(closing).ok()) != Some(length) {
            return Err(wrong());
        }
        self.at = end + WORD;
        Ok(Record { data, at: start + WORD, order: self.order })
    }
}

impl Record<'_> {
    /// Returns the word at a place, counted in words.
    fn word(&self, place: usize) -> Result<i64, Error> {
        let found = word(self.data, place * WORD, self.order);
        found.ok_or_else(|| mistake(self.at, "a record is shorter than what it says it holds"))
    }

    /// Returns the value that begins at a place, counted in words.
    fn value(&self, place: usize, size: ValueSize) -> Result<f64, Error> {
        let start = place * WORD;
        let value = match size {
            ValueSize::Single => four_bytes(self.data, start).map(|bytes| match self.order {
                ByteOrder::Little => f64::from(f32::from_le_bytes(bytes)),
                ByteOrder::Big => f64::from(f32::from_be_bytes(bytes)),
            }),
            ValueSize::Double => {
                let bytes: Option<[u8; 8]> = self.data.get(start..start + 8).and_then(|b| b.try_into().ok());
                bytes.map(|bytes| match self.order {
                    ByteOrder::Little => f64::from_le_bytes(bytes),
                    ByteOrder::Big => f64::from_be_bytes(bytes),
                })
            }
        };
        let value =
            value.ok_or_else(|| mistake(self.at, "a record is shorter than what it says it holds"))?;
        if value.is_finite() {
            Ok(value)
        } else {
            Err(mistake(self.at + start, &format!("{value} is not a finite number")))
        }
    }
}

fn four_bytes(bytes: &[u8], start: usize) -> Option<[u8; WORD]> {
    bytes.get(start..start.checked_add(WORD)?)?.try_into().ok()
}

fn word(bytes: &[u8], start: usize, order: ByteOrder) -> Option<i64> {
    let bytes = four_bytes(bytes, start)?;
    Some(i64::from(match order {
        ByteOrder::Little => i32::from_le_bytes(bytes),
        ByteOrder::Big => i32::from_be_bytes(bytes),
    }))
}

fn mistake(byte: usize, what: &str) -> Error {
    line_error(0, format!("byte {byte}: {what}"))
}

/// The size of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ValueSize {
    Single,
    Double,
}

impl ValueSize {
    fn words(self) -> usize {
        match self {
            Self::Single => 1,
            Self::Double => 2,
        }
    }
}

struct Header {
    name: String,
    rows: usize,
    cols: usize,
    size: ValueSize,
    /// The header of a string has two words.
    bigmat: bool,
}

impl Header {
    fn read(record: &Record<'_>) -> Result<Self, Error> {
        if record.data.len() != HEADER as usize {
            let length = record.data.len();
            let why = format!(
                "a matrix begins with a record of {length} bytes, and 24 are read: write the file with 32-bit words"
            );
            return Err(mistake(record.at, &why));
        }
        let (cols, rows, kind) = (record.word(0)?, record.word(1)?, record.word(3)?);
        let size = match kind {
            1 => ValueSize::Single,
            2 => ValueSize::Double,
            _ => return Err(mistake(record.at, &format!("type {kind} is not a real matrix"))),
        };
        if cols < 1 || rows == 0 {
            return Err(mistake(record.at, &format!("a matrix of {rows} x {cols} has no entries")));
        }
        let bigmat = !(0..STRING_ROW).contains(&rows);
        let (rows, cols) = (rows.unsigned_abs() as usize, cols as usize);
        check_size(0, rows, cols)?;
        let name = String::from_utf8_lossy(&record.data[16..]).trim_matches(['\0', ' ']).to_owned();
        Ok(Self { name, rows, cols, size, bigmat })
    }
}

fn read_matrix(records: &mut Records<'_>) -> Result<Op4, Error> {
    let header = Header::read(&records.next()?)?;
    let mut entries = Vec::new();
    loop {
        if records.is_at_end() {
            return Err(line_error(0, format!("matrix {} does not end: the file is cut off", header.name)));
        }
        let record = records.next()?;
        let col = record.word(0)?;
        if col > header.cols as i64 {
            let matrix = Sparse::from_entries(header.rows, header.cols, &entries)?;
            return Ok(Op4 { name: header.name, matrix });
        }
        read_column(&record, &header, &mut entries)?;
    }
}

/// Reads the values of a column: those from its first row on, or strings of them.
fn read_column(record: &Record<'_>, header: &Header, entries: &mut Vec<Entry>) -> Result<(), Error> {
    let (col, first, words) = (record.word(0)?, record.word(1)?, record.word(2)?);
    let end =
        3 + usize::try_from(words).map_err(|_| mistake(record.at, &format!("a column has {words} words")))?;
    if end * WORD > record.data.len() {
        return Err(mistake(record.at, "a record is shorter than what it says it holds"));
    }
    if first != 0 {
        let string = ValueString { place: 3, words: end - 3, row: first, col };
        return string.read(record, header, entries);
    }
    let mut place = 3;
    while place < end {
        let packed = record.word(place)?;
        let (length, row, head) = match header.bigmat {
            true => (packed - 1, record.word(place + 1)?, 2),
            false => (packed / STRING_ROW - 1, packed % STRING_ROW, 1),
        };
        let length =
            usize::try_from(length).ok().filter(|length| *length > 0 && place + head + length <= end);
        let length = length
            .ok_or_else(|| mistake(record.at + place * WORD, "a string of a column has a wrong length"))?;
        ValueString { place: place + head, words: length, row, col }.read(record, header, entries)?;
        place += head + length;
    }
    Ok(())
}

/// Values of adjacent rows of a column.
struct ValueString {
    /// Place in the record, in words.
    place: usize,
    /// Length in words.
    words: usize,
    /// First row, counted from 1.
    row: i64,
    /// Column, counted from 1.
    col: i64,
}

impl ValueString {
    fn read(&self, record: &Record<'_>, header: &Header, entries: &mut Vec<Entry>) -> Result<(), Error> {
        let count = self.words / header.size.words();
        let last = self.row + count as i64 - 1;
        if self.col < 1 || self.row < 1 || last > header.rows as i64 {
            let (rows, cols) = (header.rows, header.cols);
            return Err(mistake(
                record.at,
                &format!("rows {} to {last} of column {} are outside {rows} x {cols}", self.row, self.col),
            ));
        }
        for k in 0..count {
            let value = record.value(self.place + k * header.size.words(), header.size)?;
            if value != 0.0 {
                entries.push(Entry { row: self.row as usize - 1 + k, col: self.col as usize - 1, value });
            }
        }
        Ok(())
    }
}
