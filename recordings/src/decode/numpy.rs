//! NumPy files: an array (.npy) or an archive of arrays (.npz), plain or with named fields, as columns.
//!
//! Format: NumPy Enhancement Proposal 1 and `numpy.lib.format`. A vector becomes a column of its name, an N x k matrix the columns
//! `name_1` to `name_k`, a field of a structured array a column of the field's name. The array of an .npy file has no name: it is
//! `column`.

use half::f16;
use ndarray::{Array2, ShapeBuilder};

use super::arrays::{DecodedArrays, NamedArray};
use super::budget::Budget;
use super::zip;
use crate::Error;
use crate::remark::UnreadReason;

/// First bytes of an array.
pub(super) const MAGIC: &[u8] = b"\x93NUMPY";
/// Name of the array of a file that holds one.
const ONLY: &str = "column";
/// Structured arrays with more fields than this are refused.
const MOST_FIELDS: usize = 4096;

/// Returns the array, or the fields, of an .npy file.
pub(super) fn read_array(bytes: &[u8], file: &str) -> Result<DecodedArrays, Error> {
    let mut reader = Reader { file, budget: Budget::new(file, bytes.len()), found: DecodedArrays::default() };
    reader.array(bytes, ONLY)?;
    Ok(reader.found)
}

/// Returns the arrays of an archive.
pub(super) fn read_archive(bytes: &[u8], file: &str) -> Result<DecodedArrays, Error> {
    let mut reader = Reader { file, budget: Budget::new(file, bytes.len()), found: DecodedArrays::default() };
    for entry in
        zip::entries(bytes).ok_or_else(|| unreadable_file(file, "the archive is cut off or damaged"))?
    {
        let Some(name) = entry.name.strip_suffix(".npy") else {
            reader.found.holds(&entry.name, "something other than an array");
            continue;
        };
        reader.budget.take(name, entry.size / 8)?;
        let data = zip::unpack(bytes, &entry)
            .ok_or_else(|| unreadable_file(file, "an array is cut off or damaged"))?;
        reader.array(&data, name)?;
    }
    Ok(reader.found)
}

/// Returns whether an archive holds an array.
pub(super) fn is_archive(bytes: &[u8]) -> bool {
    zip::entries(bytes).is_none_or(|all| all.iter().any(|entry| entry.name.ends_with(".npy")))
}

fn unreadable_file(file: &str, why: &str) -> Error {
    Error::Unreadable { file: file.to_owned(), kind: "NumPy", why: why.to_owned() }
}

/// Reads the arrays of one file.
struct Reader<'a> {
    file: &'a str,
    budget: Budget<'a>,
    found: DecodedArrays,
}

/// The header of an array.
struct Header {
    fields: Vec<Field>,
    columns_first: Order,
    shape: Vec<u64>,
}

/// In which order the values of a matrix are stored.
#[derive(Clone, Copy, PartialEq)]
enum Order {
    /// Row by row.
    Rows,
    /// Column by column.
    Columns,
}

/// A field of every element: its name is empty in a plain array.
struct Field {
    name: String,
    kind: Kind,
    size: usize,
    order: Bytes,
}

/// The order of the bytes of a number.
#[derive(Clone, Copy, PartialEq)]
enum Bytes {
    LowestFirst,
    HighestFirst,
}

/// The contents of a field.
#[derive(Clone, PartialEq)]
enum Kind {
    Float,
    Signed,
    Unsigned,
    /// A time in a unit of this many seconds.
    Time(f64),
    Other(&'static str),
}

impl Reader<'_> {
    fn array(&mut self, bytes: &[u8], name: &str) -> Result<(), Error> {
        let cut = || unreadable_file(self.file, "an array is cut off or damaged");
        let (text, data) = header_and_data(bytes).ok_or_else(cut)?;
        let header = Header::parse(text)
            .ok_or_else(|| unreadable_file(self.file, "the header of an array is not understood"))?;
        let sizes: Vec<usize> = header.shape.iter().filter(|n| **n != 1).map(|n| *n as usize).collect();
        let (rows, columns) = match sizes[..] {
            [] => (1, 1),
            [rows] => (rows, 1),
            [rows, columns] if header.fields.len() == 1 => (rows, columns),
            _ => {
                self.found.note_unread(name, UnreadReason::Shape { shape: header.shape });
                return Ok(());
            }
        };
        let count = rows.checked_mul(columns).ok_or_else(cut)?;
        let size: usize = header.fields.iter().map(|f| f.size).sum();
        let needed = count.checked_mul(size).ok_or_else(cut)?;
        let data = data.get(..needed).ok_or_else(cut)?;
        let mut place = 0;
        for field in &header.fields {
            let full = if field.name.is_empty() { name.to_owned() } else { field.name.clone() };
            if let Kind::Other(holds) = field.kind {
                self.found.holds(&full, holds);
            } else {
                self.budget.take(&full, count as u64)?;
                let values: Vec<f64> = data
                    .chunks_exact(size)
                    .map(|element| field.number(&element[place..place + field.size]))
                    .collect();
                let shaped = match header.columns_first {
                    Order::Columns => Array2::from_shape_vec((rows, columns).f(), field.with_origin(values)),
                    Order::Rows => Array2::from_shape_vec((rows, columns), field.with_origin(values)),
                };
                let values =
                    shaped.map_err(|_| unreadable_file(self.file, "an array is cut off or damaged"))?;
                self.found.arrays.push(NamedArray { name: full, unit: None, values });
            }
            place += field.size;
        }
        Ok(())
    }
}

/// Returns the text of the header and what follows it.
fn header_and_data(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let after = bytes.strip_prefix(MAGIC)?;
    let (version, after) = (*after.first()?, after.get(2..)?);
    let (length, after) = if version == 1 {
        (usize::from(u16::from_le_bytes(after.get(..2)?.try_into().ok()?)), after.get(2..)?)
    } else {
        (u32::from_le_bytes(after.get(..4)?.try_into().ok()?) as usize, after.get(4..)?)
    };
    Some((std::str::from_utf8(after.get(..length)?).ok()?, after.get(length..)?))
}

impl Header {
    /// Reads a header such as `{'descr': '<f8', 'fortran_order': False, 'shape': (100, 3), }`.
    fn parse(text: &str) -> Option<Self> {
        let value = |key: &str| {
            let at = text.find(&format!("'{key}'"))? + key.len() + 2;
            Some(text[at..].trim_start().strip_prefix(':')?.trim_start())
        };
        let shape = value("shape")?.strip_prefix('(')?;
        let shape = &shape[..shape.find(')')?];
        let sizes = shape.split(',').map(str::trim).filter(|n| !n.is_empty());
        let shape: Vec<u64> = sizes.map(|n| n.trim_end_matches('L').parse().ok()).collect::<Option<_>>()?;
        let columns_first =
            if value("fortran_order")?.starts_with("True") { Order::Columns } else { Order::Rows };
        let described = value("descr")?;
        let fields = if described.starts_with('[') {
            fields(described)?
        } else {
            vec![Field::of("", quoted_text(described)?)?]
        };
        Some(Self { fields, columns_first, shape })
    }
}

/// Returns the text between the quotes that a text begins with.
fn quoted_text(text: &str) -> Option<&str> {
    let mark = text.chars().next().filter(|c| ['\'', '"'].contains(c))?;
    let inner = &text[1..];
    Some(&inner[..inner.find(mark)?])
}

/// Reads the fields of a structured array, such as `[('time', '<f8'), ('rate', '<f4')]`; fields with fields of their own are not read.
fn fields(described: &str) -> Option<Vec<Field>> {
    let list = &described[1..=described.find(")]")?];
    let mut all = Vec::new();
    for part in list.split('(').skip(1) {
        let inner = part.split(')').next()?.trim();
        let name = quoted_text(inner)?;
        let rest = inner[name.len() + 2..].trim_start().strip_prefix(',')?.trim_start();
        all.push(Field::of(name, quoted_text(rest)?)?);
        if all.len() > MOST_FIELDS
            || !rest[quoted_text(rest)?.len() + 2..].trim().trim_matches(',').is_empty()
        {
            return None;
        }
    }
    (!all.is_empty()).then_some(all)
}

impl Field {
    /// Returns a field by its type, such as `<f8`.
    fn of(name: &str, described: &str) -> Option<Self> {
        let mut letters = described.chars();
        let order = if letters.next()? == '>' { Bytes::HighestFirst } else { Bytes::LowestFirst };
        let kind = letters.next()?;
        let rest = letters.as_str();
        let digits = rest.split('[').next()?;
        let count: usize = digits.parse().ok()?;
        let (kind, size) = match (kind, count) {
            ('f', 2 | 4 | 8) => (Kind::Float, count),
            ('i', 1 | 2 | 4 | 8) => (Kind::Signed, count),
            ('u', 1 | 2 | 4 | 8) | ('b', 1) => (Kind::Unsigned, count),
            ('M' | 'm', 8) => (time_unit(rest).map_or(Kind::Other("times"), Kind::Time), 8),
            ('U', _) => (Kind::Other("texts"), count.checked_mul(4)?),
            ('S', _) => (Kind::Other("texts"), count),
            ('c', _) => (Kind::Other("complex numbers"), count),
            ('f', _) => (Kind::Other("numbers of extended precision"), count),
            ('V', _) => (Kind::Other("bytes"), count),
            _ => return None,
        };
        (size > 0).then(|| Self { name: name.to_owned(), kind, size, order })
    }

    /// Returns the number that bytes hold.
    fn number(&self, bytes: &[u8]) -> f64 {
        let mut low = [0; 8];
        for (k, byte) in bytes.iter().take(8).enumerate() {
            let at = if self.order == Bytes::HighestFirst { self.size - 1 - k } else { k };
            low[at] = *byte;
        }
        let whole = u64::from_le_bytes(low);
        let unused = 64 - 8 * self.size.min(8) as u32;
        match (&self.kind, self.size) {
            (Kind::Float, 2) => f16::from_bits(whole as u16).to_f64(),
            (Kind::Float, 4) => f64::from(f32::from_bits(whole as u32)),
            (Kind::Float, _) => f64::from_bits(whole),
            (Kind::Unsigned, _) => whole as f64,
            // "not a time" is the smallest number
            (Kind::Time(_), _) if whole as i64 == i64::MIN => f64::NAN,
            (Kind::Time(unit), _) => whole as i64 as f64 * unit,
            _ => (((whole << unused) as i64) >> unused) as f64,
        }
    }

    /// Returns times counted from the first one, so that their digits suffice; other values as they are.
    fn with_origin(&self, mut values: Vec<f64>) -> Vec<f64> {
        if matches!(self.kind, Kind::Time(_)) {
            let first = values.iter().copied().find(|v| v.is_finite()).unwrap_or(0.0);
            values.iter_mut().for_each(|v| *v -= first);
        }
        values
    }
}

/// Returns the unit of a type of times such as `8[ns]`, s; `None` if it is not a fixed time.
fn time_unit(described: &str) -> Option<f64> {
    let inner = described.split_once('[')?.1.strip_suffix(']')?;
    let digits = inner.find(|c: char| !c.is_ascii_digit())?;
    let count: f64 = if digits == 0 { 1.0 } else { inner[..digits].parse().ok()? };
    let unit = match &inner[digits..] {
        "ns" => 1e-9,
        "us" => 1e-6,
        "ms" => 1e-3,
        "s" => 1.0,
        _ => return None,
    };
    Some(count * unit)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn npy(header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = [MAGIC, &[1, 0], &(header.len() as u16).to_le_bytes(), header.as_bytes()].concat();
        bytes.extend_from_slice(data);
        bytes
    }

    fn of<const N: usize>(values: [f64; N]) -> Vec<u8> {
        values.iter().flat_map(|v| v.to_le_bytes()).collect()
    }

    #[test]
    fn matrices_are_read_in_both_orders() {
        for (order, data) in [("False", of([1., 2., 3., 4., 5., 6.])), ("True", of([1., 3., 5., 2., 4., 6.]))]
        {
            let header = format!("{{'descr': '<f8', 'fortran_order': {order}, 'shape': (3, 2), }}\n");
            let read = read_array(&npy(&header, &data), "a.npy").unwrap().columns();
            let columns: Vec<(String, Vec<f64>)> =
                read.columns.iter().map(|c| (c.name.clone(), c.values.to_vec())).collect();
            let expected = [("column_1", vec![1., 3., 5.]), ("column_2", vec![2., 4., 6.])];
            assert_eq!(columns, expected.map(|(name, values)| (name.to_owned(), values)));
        }
    }

    #[test]
    fn fields_have_their_names_and_a_text_is_left_out() {
        let header = "{'descr': [('time', '<M8[ms]'), ('note', '<U1'), ('rate', '>i2')], 'fortran_order': False, 'shape': (2,), }";
        let row = |t: i64, rate: i16| [&t.to_le_bytes()[..], b"x\0\0\0", &rate.to_be_bytes()].concat();
        let read =
            read_array(&npy(header, &[row(5000, -3), row(5001, 7)].concat()), "a.npy").unwrap().columns();
        let values: Vec<Vec<f64>> = read.columns.iter().map(|c| c.values.to_vec()).collect();
        assert_eq!(read.columns.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(), ["time", "rate"]);
        assert!((values[0][1] - 1e-3).abs() < 1e-9 && values[1] == [-3.0, 7.0], "{values:?}");
        assert_eq!(read.remarks.len(), 1);
    }

    #[test]
    fn damaged_arrays_are_refused() {
        let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), }";
        assert!(read_array(&npy(header, &of([1.0, 2.0])), "a.npy").is_err());
        assert!(
            read_array(&npy("{'descr': '<q9', 'fortran_order': False, 'shape': (1,), }", b""), "a.npy")
                .is_err()
        );
        assert!(read_array(b"\x93NUMPY\x01\x00\xff\xff", "a.npy").is_err());
    }
}
