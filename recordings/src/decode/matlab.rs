//! MATLAB files of version 5 (also those of -v6 and -v7): real numeric arrays, and those inside structures, as columns.
//!
//! Format: MathWorks, *MAT-File Format*, chapter 1. A vector becomes a column of its name, an N x k matrix the columns
//! `name_1` to `name_k`, a field of a structure `structure.field`. Only the longest common length is kept as a table.

use std::io::Read;

use crate::{Column, Error};

const HEADER: usize = 128;
/// Structures may lie in structures this deep.
const DEEPEST: usize = 8;
/// A compressed array may unfold to this many bytes.
const LARGEST: u64 = 1 << 31;

const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
const STRUCTURE: u8 = 2;
/// Array classes of full numeric arrays: double (6) to uint64 (15).
const NUMERIC: std::ops::RangeInclusive<u8> = 6..=15;

/// A cursor over the elements of a file; every read may find the end.
struct Elements<'a> {
    bytes: &'a [u8],
    big: bool,
}

/// One element: its type and its data.
struct Element<'a> {
    kind: u32,
    data: &'a [u8],
}

/// An array: name, rows, columns, values.
pub(super) struct Array {
    pub(super) name: String,
    pub(super) rows: usize,
    pub(super) values: Vec<f64>,
}

/// The columns of a MATLAB file of version 5.
pub(super) fn read(bytes: &[u8], file: &str) -> Result<Vec<Column>, Error> {
    let broken = |why: &str| Error::Unreadable { file: file.to_owned(), kind: "MATLAB", why: why.to_owned() };
    let big = match bytes.get(126..128) {
        Some(b"IM") => false,
        Some(b"MI") => true,
        _ => return Err(broken("the header has no byte order mark")),
    };
    let mut arrays = Vec::new();
    let mut elements = Elements { bytes: bytes.get(HEADER..).unwrap_or_default(), big };
    while let Some(element) = elements.next() {
        variable(&element, big, &mut arrays).ok_or_else(|| broken("a variable is cut off or damaged"))?;
    }
    if !elements.bytes.is_empty() {
        return Err(broken("the file is cut off"));
    }
    Ok(columns(arrays))
}

fn variable(element: &Element<'_>, big: bool, arrays: &mut Vec<Array>) -> Option<()> {
    match element.kind {
        COMPRESSED => {
            let mut data = Vec::new();
            flate2::read::ZlibDecoder::new(element.data).take(LARGEST).read_to_end(&mut data).ok()?;
            let inner = Elements { bytes: &data, big }.next()?;
            if inner.kind == MATRIX { matrix(inner.data, big, None, 0, arrays) } else { Some(()) }
        }
        MATRIX => matrix(element.data, big, None, 0, arrays),
        _ => Some(()),
    }
}

/// Reads an array; its own name is empty inside a structure, where the field's name stands for it.
fn matrix(data: &[u8], big: bool, field: Option<&str>, depth: usize, arrays: &mut Vec<Array>) -> Option<()> {
    if data.is_empty() || depth > DEEPEST {
        return Some(());
    }
    let mut parts = Elements { bytes: data, big };
    let class = class_of(parts.next()?.data, big)?;
    let dimensions = parts.next()?.numbers(big);
    let own = String::from_utf8_lossy(parts.next()?.data).into_owned();
    let name = field.map_or(own, str::to_owned);
    if class == STRUCTURE {
        return structure(&mut parts, &name, &dimensions, depth, arrays);
    }
    if NUMERIC.contains(&class) {
        let values = parts.next()?.numbers(big);
        let rows = dimensions.first().map_or(0, |r| *r as usize);
        arrays.push(Array { name, rows, values });
    }
    Some(())
}

/// The class is the lowest byte of the flags.
fn class_of(flags: &[u8], big: bool) -> Option<u8> {
    flags.get(if big { 3 } else { 0 }).copied()
}

fn structure(
    parts: &mut Elements<'_>,
    name: &str,
    dimensions: &[f64],
    depth: usize,
    arrays: &mut Vec<Array>,
) -> Option<()> {
    let big = parts.big;
    let length = parts.next()?.numbers(big).first().map_or(0, |l| *l as usize);
    let names = parts.next()?.data;
    if length == 0 || dimensions.iter().product::<f64>() != 1.0 {
        return Some(());
    }
    for name_bytes in names.chunks(length) {
        let end = name_bytes.iter().position(|b| *b == 0).unwrap_or(name_bytes.len());
        let field = format!("{name}.{}", String::from_utf8_lossy(&name_bytes[..end]));
        let element = parts.next()?;
        matrix(element.data, big, Some(&field), depth + 1, arrays)?;
    }
    Some(())
}

impl<'a> Elements<'a> {
    fn next(&mut self) -> Option<Element<'a>> {
        let tag = self.word(0)?;
        if tag >> 16 != 0 {
            let (length, kind) = ((tag >> 16) as usize, tag & 0xffff);
            let data = self.bytes.get(4..4 + length)?;
            self.bytes = self.bytes.get(8..)?;
            return (length <= 4).then_some(Element { kind, data });
        }
        let length = self.word(4)? as usize;
        let data = self.bytes.get(8..)?.get(..length)?;
        let padded = if tag == COMPRESSED { length } else { length.next_multiple_of(8) };
        self.bytes = self.bytes.get(8 + padded..).unwrap_or_default();
        Some(Element { kind: tag, data })
    }

    fn word(&self, at: usize) -> Option<u32> {
        let bytes: [u8; 4] = self.bytes.get(at..at + 4)?.try_into().ok()?;
        Some(if self.big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }
}

impl Element<'_> {
    /// The data as numbers, by the element's type (MAT-File Format, table 1-1).
    fn numbers(&self, big: bool) -> Vec<f64> {
        match self.kind {
            1 => self.data.iter().map(|b| f64::from(*b as i8)).collect(),
            2 => self.data.iter().map(|b| f64::from(*b)).collect(),
            3 => self.each(big, |b| f64::from(i16::from_le_bytes(b))),
            4 => self.each(big, |b| f64::from(u16::from_le_bytes(b))),
            5 => self.each(big, |b| f64::from(i32::from_le_bytes(b))),
            6 => self.each(big, |b| f64::from(u32::from_le_bytes(b))),
            7 => self.each(big, |b| f64::from(f32::from_le_bytes(b))),
            9 => self.each(big, f64::from_le_bytes),
            12 => self.each(big, |b| i64::from_le_bytes(b) as f64),
            13 => self.each(big, |b| u64::from_le_bytes(b) as f64),
            _ => Vec::new(),
        }
    }

    fn each<const N: usize>(&self, big: bool, convert: impl Fn([u8; N]) -> f64) -> Vec<f64> {
        let ordered = |chunk: &[u8]| {
            let mut bytes: [u8; N] = chunk.try_into().unwrap_or([0; N]);
            if big {
                bytes.reverse();
            }
            bytes
        };
        self.data.chunks_exact(N).map(|chunk| convert(ordered(chunk))).collect()
    }
}

/// The arrays as columns of the most frequent length among them (the longer one where two are as frequent).
pub(super) fn columns(arrays: Vec<Array>) -> Vec<Column> {
    let all: Vec<Column> = arrays.into_iter().flat_map(split).collect();
    let frequency = |length: usize| all.iter().filter(|c| c.values.len() == length).count();
    let length = all
        .iter()
        .map(|c| c.values.len())
        .filter(|l| *l > 1)
        .max_by_key(|l| (frequency(*l), *l))
        .unwrap_or(0);
    all.into_iter().filter(|c| c.values.len() == length && length > 0).collect()
}

fn split(array: Array) -> Vec<Column> {
    let Array { name, rows, values } = array;
    if rows <= 1 || rows >= values.len() {
        return vec![Column::plain(name, values)];
    }
    let column =
        |(index, part): (usize, &[f64])| Column::plain(format!("{name}_{}", index + 1), part.to_vec());
    values.chunks(rows).enumerate().map(column).collect()
}
