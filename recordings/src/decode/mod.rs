//! Decoders: the bytes of a file to columns of numbers.

mod csv;
mod hdf5;
mod matlab;
mod parquet;

use crate::{Column, Error};

/// First bytes of a Parquet file.
const PARQUET: &[u8] = b"PAR1";
/// First bytes of a MATLAB file of version 5.
const MATLAB: &[u8] = b"MATLAB 5.0";
/// First bytes of a MATLAB file of version 7.3, which is an HDF5 file behind a header.
const MATLAB_7_3: &[u8] = b"MATLAB 7.3";
/// First bytes of an HDF5 file.
const HDF5: &[u8] = b"\x89HDF";

/// Returns the columns of a file, whose format is recognised by its first bytes: Parquet, MATLAB version 5 or 7.3, HDF5, else
/// CSV.
pub(crate) fn columns(bytes: &[u8], file: &str) -> Result<Vec<Column>, Error> {
    if bytes.starts_with(PARQUET) {
        parquet::read(bytes, file)
    } else if bytes.starts_with(MATLAB) {
        matlab::read(bytes, file)
    } else if bytes.starts_with(MATLAB_7_3) || bytes.starts_with(HDF5) {
        hdf5::read(bytes, file)
    } else {
        csv::read(bytes, file)
    }
}
