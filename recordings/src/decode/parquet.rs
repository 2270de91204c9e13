//! Parquet: every numeric column of a flat table; dates and times of day in seconds.

use bytes::Bytes;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};

use super::DecodedFile;
use super::budget::Budget;
use super::physical::{Holds, Origin, column, content_of};
use crate::remark::UnreadReason;
use crate::{Error, RecordingColumn, Remark};

/// Returns the columns of a Parquet file. The library panics over some damaged pages; that too is an error.
pub(super) fn read(bytes: &[u8], file: &str) -> Result<DecodedFile, Error> {
    let unreadable = |why: String| Error::Unreadable { file: file.to_owned(), kind: "Parquet", why };
    let opened = || {
        let reader = SerializedFileReader::new(Bytes::copy_from_slice(bytes))?;
        check_places(&reader, bytes.len())?;
        Ok::<_, ParquetError>(reader)
    };
    let read = std::panic::catch_unwind(|| {
        let reader = opened().map_err(|e| unreadable(e.to_string()))?;
        columns(&reader, file, Budget::new(file, bytes.len()))
    });
    read.unwrap_or_else(|_| Err(unreadable("a page is damaged".to_owned())))
}

fn columns(
    reader: &SerializedFileReader<Bytes>,
    file: &str,
    mut budget: Budget<'_>,
) -> Result<DecodedFile, Error> {
    let metadata = reader.metadata();
    let schema = metadata.file_metadata().schema_descr_ptr();
    let rows = metadata
        .row_groups()
        .iter()
        .map(|group| group.num_rows().unsigned_abs())
        .fold(0, u64::saturating_add);
    let (mut decoded, mut origin) = (DecodedFile::default(), Origin::default());
    for index in 0..schema.num_columns() {
        let description = schema.column(index);
        let is_list = description.max_rep_level() > 0;
        let what = if is_list { Holds::Other("lists") } else { content_of(&description) };
        // the innermost name of a list is that of its element; that of a record, one of its fields
        let parts = description.path().parts();
        let outermost = parts.first().filter(|_| is_list).cloned();
        let name = &outermost.unwrap_or_else(|| parts.join("."));
        if let Holds::Other(what) = what {
            let why = UnreadReason::Type { holds: what.to_owned() };
            decoded.remarks.push(Remark::Unread { column: name.to_owned(), why });
            continue;
        }
        budget.take(name, rows)?;
        let values = column(reader, index, description.max_def_level(), what, &mut origin);
        let values = values.map_err(|error| damaged_column(file, name, &error))?;
        let named = RecordingColumn::from_heading(name, values);
        let unit = named.unit.or_else(|| what.unit().map(str::to_owned));
        decoded.columns.push(RecordingColumn { unit, ..named });
    }
    Ok(decoded)
}

/// Returns the error of a column that cannot be decoded.
fn damaged_column(file: &str, column: &str, error: &ParquetError) -> Error {
    let (file, why) = (file.to_owned(), error.to_string());
    match why.contains("CRC") {
        true => Error::Checksum { file, column: column.to_owned(), why },
        false => Error::Unreadable { file, kind: "Parquet", why: format!("column \"{column}\": {why}") },
    }
}

/// Refuses a directory that points outside the file, over which the library would stumble.
fn check_places(reader: &SerializedFileReader<Bytes>, length: usize) -> Result<(), ParquetError> {
    let is_inside = |start: i64, size: i64| {
        start >= 0 && size >= 0 && start.checked_add(size).is_some_and(|end| end <= length as i64)
    };
    for group in reader.metadata().row_groups() {
        for chunk in group.columns() {
            let start = chunk.dictionary_page_offset().unwrap_or_else(|| chunk.data_page_offset());
            if group.num_rows() < 0
                || !is_inside(start, chunk.compressed_size())
                || !is_inside(chunk.data_page_offset(), 0)
            {
                return Err(ParquetError::General("a column lies outside the file".to_owned()));
            }
        }
    }
    Ok(())
}
