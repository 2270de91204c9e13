//! MATLAB files of version 5 (also those of -v6 and -v7): real numeric arrays, and those inside structures, as columns.
//!
//! Format: MathWorks, *MAT-File Format*, chapter 1. A vector becomes a column of its name, an N x k matrix the columns
//! `name_1` to `name_k`, a field of a structure `structure.field`.

use std::io::Read;

use ndarray::{Array2, ShapeBuilder};

use super::arrays::{DecodedArrays, NamedArray};
use super::budget::Budget;
use super::elements::{ByteOrder, COMPRESSED, Element, Elements};
use crate::Error;
use crate::remark::UnreadReason;

/// Bytes before the first element.
const HEADER: usize = 128;
/// Bytes of an element's type and length.
const TAG: u64 = 8;
/// Structures may lie in structures this deep.
const DEEPEST: usize = 8;

/// Type of an element that holds an array.
const MATRIX: u32 = 14;
/// Array class of a structure.
const STRUCTURE: u8 = 2;
/// Array class of text.
const TEXT: u8 = 4;
/// Array classes of full numeric arrays: double (6) to uint64 (15).
const NUMERIC: std::ops::RangeInclusive<u8> = 6..=15;
/// Flag of an array with an imaginary part.
const COMPLEX: u8 = 0x08;

/// Reads the arrays of one file.
struct Reader<'a> {
    file: &'a str,
    order: ByteOrder,
    budget: Budget<'a>,
    found: DecodedArrays,
}

/// The path of an array: its name is empty for one at the top, which has a name of its own.
struct Place<'a> {
    field: Option<&'a str>,
    depth: usize,
}

/// Returns the arrays of a MATLAB file of version 5.
pub(super) fn read(bytes: &[u8], file: &str) -> Result<DecodedArrays, Error> {
    let order = match bytes.get(126..128) {
        Some(b"IM") => ByteOrder::LittleEndian,
        Some(b"MI") => ByteOrder::BigEndian,
        _ => return Err(unreadable_file(file, "the header has no byte order mark")),
    };
    let mut reader =
        Reader { file, order, budget: Budget::new(file, bytes.len()), found: DecodedArrays::default() };
    let mut elements = Elements { bytes: bytes.get(HEADER..).unwrap_or_default(), order };
    while let Some(element) = elements.next() {
        reader.variable(&element)?;
    }
    if !elements.bytes.is_empty() {
        return Err(unreadable_file(file, "the file is cut off"));
    }
    Ok(reader.found)
}

fn unreadable_file(file: &str, why: &str) -> Error {
    Error::Unreadable { file: file.to_owned(), kind: "MATLAB", why: why.to_owned() }
}

impl Reader<'_> {
    fn cut_off(&self) -> Error {
        unreadable_file(self.file, "a variable is cut off or damaged")
    }

    fn variable(&mut self, element: &Element<'_>) -> Result<(), Error> {
        let top = Place { field: None, depth: 0 };
        match element.kind {
            COMPRESSED => {
                let data = self.unpack_element(element.data)?;
                let inner =
                    Elements { bytes: &data, order: self.order }.next().ok_or_else(|| self.cut_off())?;
                if inner.kind == MATRIX { self.matrix(inner.data, &top) } else { Ok(()) }
            }
            MATRIX => self.matrix(element.data, &top),
            _ => Ok(()),
        }
    }

    /// Returns a compressed element, whose length is known from its first bytes before the rest is unpacked.
    fn unpack_element(&mut self, packed: &[u8]) -> Result<Vec<u8>, Error> {
        let mut tag = [0; TAG as usize];
        let mut decoder = flate2::read::ZlibDecoder::new(packed);
        decoder.read_exact(&mut tag).map_err(|_| self.cut_off())?;
        let [_, _, _, _, length @ ..] = tag;
        let length = self.order.word(length);
        self.budget.take("a compressed variable", u64::from(length) / 8)?;
        let mut data = tag.to_vec();
        // one byte more, so that the decoder meets the end of the stream and compares its checksum
        let read = decoder.take(u64::from(length) + 1).read_to_end(&mut data);
        read.map_err(|e| unreadable_file(self.file, &format!("a compressed variable is damaged: {e}")))?;
        Ok(data)
    }

    /// Reads an array; inside a structure it has the field's name.
    fn matrix(&mut self, data: &[u8], place: &Place<'_>) -> Result<(), Error> {
        if data.is_empty() {
            return Ok(());
        }
        let mut parts = Elements { bytes: data, order: self.order };
        let mut part = || parts.next();
        let (Some(flags), Some(dimensions), Some(name)) = (part(), part(), part()) else {
            return Err(self.cut_off());
        };
        let [class, flags] = self.class_and_flags(flags.data)?;
        let dimensions: Vec<u64> = dimensions.numbers(self.order).iter().map(|d| *d as u64).collect();
        let own = String::from_utf8_lossy(name.data).into_owned();
        let name = place.field.map_or(own, str::to_owned);
        let count: u64 = dimensions.iter().fold(1, |product, d| product.saturating_mul(*d));
        match class {
            STRUCTURE if count == 1 && place.depth < DEEPEST => {
                self.structure(&mut parts, &name, place.depth)
            }
            _ if NUMERIC.contains(&class) && flags & COMPLEX == 0 => {
                let values = parts.next().ok_or_else(|| self.cut_off())?;
                self.numbers(name, &dimensions, &values)
            }
            TEXT if dimensions.first().is_none_or(|rows| *rows <= 1) => Ok(()),
            _ => {
                self.found.holds(&name, holds(class));
                Ok(())
            }
        }
    }

    /// Returns the class of an array, which is the lowest byte of its flags, and the flags themselves, in the byte above.
    fn class_and_flags(&self, flags: &[u8]) -> Result<[u8; 2], Error> {
        let at = match self.order {
            ByteOrder::BigEndian => [3, 2],
            ByteOrder::LittleEndian => [0, 1],
        };
        match at.map(|k| flags.get(k).copied()) {
            [Some(class), Some(flags)] => Ok([class, flags]),
            _ => Err(self.cut_off()),
        }
    }

    /// Reads the numbers of an array, which are stored column by column.
    fn numbers(&mut self, name: String, dimensions: &[u64], values: &Element<'_>) -> Result<(), Error> {
        self.budget.take(&name, values.count())?;
        let sizes: Vec<usize> = dimensions.iter().map(|d| *d as usize).filter(|d| *d != 1).collect();
        let shape = match sizes[..] {
            [] => (1, 1),
            [rows] => (rows, 1),
            [rows, columns] => (rows, columns),
            _ => {
                self.found.note_unread(&name, UnreadReason::Shape { shape: dimensions.to_vec() });
                return Ok(());
            }
        };
        match Array2::from_shape_vec(shape.f(), values.numbers(self.order)) {
            Ok(values) => self.found.arrays.push(NamedArray { name, unit: None, values }),
            Err(_) => return Err(self.cut_off()),
        }
        Ok(())
    }

    fn structure(&mut self, parts: &mut Elements<'_>, name: &str, depth: usize) -> Result<(), Error> {
        let (Some(length), Some(names)) = (parts.next(), parts.next()) else { return Err(self.cut_off()) };
        let length = length.numbers(self.order).first().map_or(0, |l| *l as usize);
        if length == 0 {
            return Ok(());
        }
        for name_bytes in names.data.chunks(length) {
            let end = name_bytes.iter().position(|b| *b == 0).unwrap_or(name_bytes.len());
            let field = format!("{name}.{}", String::from_utf8_lossy(&name_bytes[..end]));
            let element = parts.next().ok_or_else(|| self.cut_off())?;
            self.matrix(element.data, &Place { field: Some(&field), depth: depth + 1 })?;
        }
        Ok(())
    }
}

/// Returns what an array holds that is not read, in the plural (*MAT-File Format*, table 1-3).
fn holds(class: u8) -> &'static str {
    match class {
        1 => "cells",
        STRUCTURE => "structures",
        3 => "objects",
        TEXT => "texts",
        5 => "a sparse matrix",
        6..=15 => "complex numbers",
        16 => "functions",
        _ => "objects such as a table or a time series",
    }
}
