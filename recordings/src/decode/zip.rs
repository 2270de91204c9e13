//! Entries of a ZIP archive, stored or deflated (PKWARE, *APPNOTE.TXT*, 4.3 and 4.5): as NumPy writes them.

use std::io::Read;

/// First bytes of an archive.
pub(super) const MAGIC: &[u8] = b"PK\x03\x04";
/// First bytes of the record at the end of an archive, of an entry of its directory, and of an entry itself.
const END: &[u8] = b"PK\x05\x06";
const DIRECTORY: &[u8] = b"PK\x01\x02";
/// Bytes of these records without what has a length of its own.
const END_BYTES: usize = 22;
const DIRECTORY_BYTES: usize = 46;
const ENTRY_BYTES: usize = 30;
/// A size that stands in the extra field, because 32 bits do not hold it.
const ELSEWHERE: u64 = 0xffff_ffff;

/// An entry of an archive.
pub(super) struct Entry {
    pub name: String,
    method: u16,
    packed: u64,
    /// Size when unpacked, bytes.
    pub size: u64,
    at: u64,
}

/// Returns the entries of an archive, in its order; `None` if its directory is cut off or damaged.
pub(super) fn entries(bytes: &[u8]) -> Option<Vec<Entry>> {
    let last = bytes.len().checked_sub(END_BYTES)?;
    let earliest = last.saturating_sub(usize::from(u16::MAX));
    let end = (earliest..=last).rev().find(|at| bytes[*at..].starts_with(END))?;
    let count = word(bytes, end + 10, 2)?;
    let mut at = usize::try_from(word(bytes, end + 16, 4)?).ok()?;
    let mut all = Vec::new();
    for _ in 0..count {
        let record = bytes.get(at..)?;
        if !record.starts_with(DIRECTORY) {
            return None;
        }
        let length = |place: usize| word(record, place, 2).map(|n| n as usize);
        let (name, extra, comment) = (length(28)?, length(30)?, length(32)?);
        let text = record.get(DIRECTORY_BYTES..DIRECTORY_BYTES + name)?;
        let mut sizes = [word(record, 24, 4)?, word(record, 20, 4)?, word(record, 42, 4)?];
        widen(record.get(DIRECTORY_BYTES + name..DIRECTORY_BYTES + name + extra)?, &mut sizes);
        let [size, packed, offset] = sizes;
        let method = word(record, 10, 2)? as u16;
        all.push(Entry {
            name: String::from_utf8_lossy(text).into_owned(),
            method,
            packed,
            size,
            at: offset,
        });
        at += DIRECTORY_BYTES + name + extra + comment;
    }
    Some(all)
}

/// Returns what an entry holds; `None` if it is cut off, damaged, or packed in another way than by deflation.
pub(super) fn unpack(bytes: &[u8], entry: &Entry) -> Option<Vec<u8>> {
    let record = bytes.get(usize::try_from(entry.at).ok()?..)?;
    if !record.starts_with(MAGIC) {
        return None;
    }
    let start = ENTRY_BYTES + word(record, 26, 2)? as usize + word(record, 28, 2)? as usize;
    let end = start.checked_add(usize::try_from(entry.packed).ok()?)?;
    let packed = record.get(start..end)?;
    match entry.method {
        0 => Some(packed.to_vec()),
        8 => {
            let mut data = Vec::new();
            flate2::read::DeflateDecoder::new(packed).take(entry.size + 1).read_to_end(&mut data).ok()?;
            (data.len() as u64 == entry.size).then_some(data)
        }
        _ => None,
    }
}

/// Puts the wide values of an extra field in the place of those that did not fit.
fn widen(extra: &[u8], sizes: &mut [u64; 3]) {
    let mut at = 0;
    while let (Some(id), Some(length)) = (word(extra, at, 2), word(extra, at + 2, 2)) {
        if id == 1 {
            let mut place = at + 4;
            for size in sizes.iter_mut().filter(|size| **size == ELSEWHERE) {
                let Some(wide) = word(extra, place, 8) else { return };
                *size = wide;
                place += 8;
            }
            return;
        }
        at += 4 + length as usize;
    }
}

/// Returns the number of some bytes, the lowest first.
fn word(bytes: &[u8], at: usize, count: usize) -> Option<u64> {
    let own = bytes.get(at..at.checked_add(count)?)?;
    Some(own.iter().rev().fold(0, |number, byte| (number << 8) | u64::from(*byte)))
}
