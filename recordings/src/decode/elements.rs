//! Elements of a MATLAB file of version 5: a type, a length, and data (MathWorks, *MAT-File Format*, chapter 1).

/// Type of an element that holds a compressed element.
pub(super) const COMPRESSED: u32 = 15;

/// The order of the bytes of a number in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ByteOrder {
    /// The lowest byte comes first.
    LittleEndian,
    /// The highest byte comes first.
    BigEndian,
}

impl ByteOrder {
    /// Returns the number that four bytes hold.
    pub(super) fn word(self, bytes: [u8; 4]) -> u32 {
        match self {
            Self::LittleEndian => u32::from_le_bytes(bytes),
            Self::BigEndian => u32::from_be_bytes(bytes),
        }
    }
}

/// A cursor over the elements of a file; every read may find the end.
pub(super) struct Elements<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) order: ByteOrder,
}

/// One element: its type and its data.
pub(super) struct Element<'a> {
    pub(super) kind: u32,
    pub(super) data: &'a [u8],
}

impl<'a> Elements<'a> {
    /// Returns the next element; `None` at the end, or if it is cut off.
    pub(super) fn next(&mut self) -> Option<Element<'a>> {
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

    /// Returns the 32-bit word at a place.
    fn word(&self, at: usize) -> Option<u32> {
        let bytes: [u8; 4] = self.bytes.get(at..at + 4)?.try_into().ok()?;
        Some(self.order.word(bytes))
    }
}

impl Element<'_> {
    /// Returns the number of values.
    pub(super) fn count(&self) -> u64 {
        let size = match self.kind {
            1 | 2 => 1,
            3 | 4 => 2,
            5..=7 => 4,
            _ => 8,
        };
        self.data.len() as u64 / size
    }

    /// Returns the data as numbers, by the element's type (MAT-File Format, table 1-1).
    pub(super) fn numbers(&self, order: ByteOrder) -> Vec<f64> {
        match self.kind {
            1 => self.data.iter().map(|b| f64::from(*b as i8)).collect(),
            2 => self.data.iter().map(|b| f64::from(*b)).collect(),
            3 => self.convert_each(order, |b| f64::from(i16::from_le_bytes(b))),
            4 => self.convert_each(order, |b| f64::from(u16::from_le_bytes(b))),
            5 => self.convert_each(order, |b| f64::from(i32::from_le_bytes(b))),
            6 => self.convert_each(order, |b| f64::from(u32::from_le_bytes(b))),
            7 => self.convert_each(order, |b| f64::from(f32::from_le_bytes(b))),
            9 => self.convert_each(order, f64::from_le_bytes),
            12 => self.convert_each(order, |b| i64::from_le_bytes(b) as f64),
            13 => self.convert_each(order, |b| u64::from_le_bytes(b) as f64),
            _ => Vec::new(),
        }
    }

    fn convert_each<const N: usize>(&self, order: ByteOrder, convert: impl Fn([u8; N]) -> f64) -> Vec<f64> {
        let ordered = |chunk: &[u8]| {
            let mut bytes: [u8; N] = chunk.try_into().unwrap_or([0; N]);
            if order == ByteOrder::BigEndian {
                bytes.reverse();
            }
            bytes
        };
        self.data.chunks_exact(N).map(|chunk| convert(ordered(chunk))).collect()
    }
}
