//! Decoders: the bytes of a file to columns of numbers, and what was left out.

mod arrays;
mod budget;
mod csv;
mod elements;
mod hdf5;
mod matlab;
mod numpy;
mod parquet;
mod physical;
mod zip;

pub use arrays::NamedArray;
pub use csv::CsvParts;

use crate::{Error, RecordingColumn, RecordingTable, Remark};
use arrays::DecodedArrays;

/// First bytes of a Parquet file.
const PARQUET: &[u8] = b"PAR1";
/// First bytes of a MATLAB file of version 5.
const MATLAB: &[u8] = b"MATLAB 5.0";
/// First bytes of a MATLAB file of version 7.3, which is an HDF5 file behind a header.
const MATLAB_7_3: &[u8] = b"MATLAB 7.3";
/// First bytes of an HDF5 file.
const HDF5: &[u8] = b"\x89HDF";
/// First bytes of a text in UTF-16, which spreadsheets call Unicode.
const UTF_16: [&[u8]; 2] = [b"\xff\xfe", b"\xfe\xff"];
/// So many first bytes are searched for a zero, which no text has.
const TEXT: usize = 1024;

/// The columns of a file, and what was left out.
#[derive(Debug, Default)]
pub(crate) struct DecodedFile {
    pub(crate) columns: Vec<RecordingColumn>,
    pub(crate) remarks: Vec<Remark>,
}

impl RecordingTable {
    /// Reads the bytes of a recording. The format is recognised by the first bytes: Parquet, MATLAB version 5 or 7.3, HDF5, NumPy, else CSV
    /// with one header row `name [unit]`.
    ///
    /// # Errors
    /// Returns what is wrong with the file, with row, column and value where they are known.
    pub fn read(bytes: &[u8], name: &str) -> Result<Self, Error> {
        let DecodedFile { columns, remarks } = decode(bytes, name)?;
        Self { name: name.to_owned(), columns, remarks }.into_checked()
    }
}

/// Returns whether a file with these first bytes is read as text.
pub fn is_text(first: &[u8]) -> bool {
    ![PARQUET, MATLAB, MATLAB_7_3, HDF5, numpy::MAGIC, zip::MAGIC].iter().any(|mark| first.starts_with(mark))
}

/// Returns the arrays of a MATLAB (version 5 or 7.3), HDF5 or NumPy file as they are, and what is not read: names with those of the structures
/// that hold them (`structure.field`), and matrices.
///
/// # Errors
/// Returns what is wrong with the file; [`Error::UnknownFormat`] for a file of another format.
pub fn read_arrays(bytes: &[u8], name: &str) -> Result<(Vec<NamedArray>, Vec<Remark>), Error> {
    let unknown = || Err(Error::UnknownFormat { file: name.to_owned() });
    decode_arrays(bytes, name).unwrap_or_else(unknown).map(|found| (found.arrays, found.remarks))
}

/// Returns what a file of arrays holds; `None` for a file of another format.
fn decode_arrays(bytes: &[u8], file: &str) -> Option<Result<DecodedArrays, Error>> {
    if bytes.starts_with(MATLAB) {
        Some(matlab::read(bytes, file))
    } else if bytes.starts_with(MATLAB_7_3) {
        Some(hdf5::read(bytes, file, hdf5::Order::Matlab))
    } else if bytes.starts_with(HDF5) {
        Some(hdf5::read(bytes, file, hdf5::Order::AsWritten))
    } else if bytes.starts_with(numpy::MAGIC) {
        Some(numpy::read_array(bytes, file))
    } else if bytes.starts_with(zip::MAGIC) && numpy::is_archive(bytes) {
        Some(numpy::read_archive(bytes, file))
    } else {
        None
    }
}

/// Returns the columns of a file, whose format is recognised by its first bytes: Parquet, MATLAB version 5 or 7.3, HDF5, NumPy,
/// else CSV.
pub(crate) fn decode(bytes: &[u8], file: &str) -> Result<DecodedFile, Error> {
    if let Some(found) = decode_arrays(bytes, file) {
        Ok(found?.columns())
    } else if bytes.starts_with(PARQUET) {
        parquet::read(bytes, file)
    } else if UTF_16.iter().any(|mark| bytes.starts_with(mark)) {
        let why = "it is text in UTF-16: save it as UTF-8".to_owned();
        Err(Error::Unreadable { file: file.to_owned(), kind: "CSV", why })
    } else if bytes[..bytes.len().min(TEXT)].contains(&0) {
        Err(Error::UnknownFormat { file: file.to_owned() })
    } else {
        csv::read(bytes, file)
    }
}
