//! Parquet: every numeric column of a flat table.

use bytes::Bytes;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};

use crate::{Column, Error};

/// The numeric columns of a Parquet file. The library panics over some damaged pages; that too is told as an error.
pub(super) fn read(bytes: &[u8], file: &str) -> Result<Vec<Column>, Error> {
    let unreadable = |why: String| Error::Unreadable { file: file.to_owned(), kind: "Parquet", why };
    match std::panic::catch_unwind(|| columns(bytes)) {
        Ok(outcome) => outcome.map_err(|e| unreadable(e.to_string())),
        Err(_) => Err(unreadable("a page is damaged".to_owned())),
    }
}

fn columns(bytes: &[u8]) -> Result<Vec<Column>, ParquetError> {
    let reader = SerializedFileReader::new(Bytes::copy_from_slice(bytes))?;
    sound(&reader, bytes.len())?;
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let mut columns = Vec::new();
    for index in 0..schema.num_columns() {
        let description = schema.column(index);
        if description.max_rep_level() > 0 {
            continue;
        }
        if let Some(values) = column(&reader, index, description.max_def_level())? {
            columns.push(Column::headed(description.name(), values));
        }
    }
    Ok(columns)
}

/// Refuses a directory that points outside the file, over which the library would stumble.
fn sound(reader: &SerializedFileReader<Bytes>, length: usize) -> Result<(), ParquetError> {
    let inside = |start: i64, size: i64| {
        start >= 0 && size >= 0 && start.checked_add(size).is_some_and(|end| end <= length as i64)
    };
    for group in reader.metadata().row_groups() {
        for chunk in group.columns() {
            let start = chunk.dictionary_page_offset().unwrap_or_else(|| chunk.data_page_offset());
            if group.num_rows() < 0
                || !inside(start, chunk.compressed_size())
                || !inside(chunk.data_page_offset(), 0)
            {
                return Err(ParquetError::General("a column lies outside the file".to_owned()));
            }
        }
    }
    Ok(())
}

/// The values of a column over all row groups; none if it does not hold numbers.
fn column(
    reader: &SerializedFileReader<Bytes>,
    index: usize,
    present: i16,
) -> Result<Option<Vec<f64>>, ParquetError> {
    let mut all = Vec::new();
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group)?;
        let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        let values = match group.get_column_reader(index)? {
            ColumnReader::DoubleColumnReader(r) => numbers(r, rows, present, |v| v)?,
            ColumnReader::FloatColumnReader(r) => numbers(r, rows, present, f64::from)?,
            ColumnReader::Int32ColumnReader(r) => numbers(r, rows, present, f64::from)?,
            ColumnReader::Int64ColumnReader(r) => numbers(r, rows, present, |v| v as f64)?,
            ColumnReader::BoolColumnReader(r) => numbers(r, rows, present, f64::from)?,
            _ => return Ok(None),
        };
        all.extend(values);
    }
    Ok(Some(all))
}

/// The values of a column in one row group, NaN where there is none.
fn numbers<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    rows: usize,
    present: i16,
    convert: impl Fn(T::T) -> f64,
) -> Result<Vec<f64>, ParquetError> {
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    while levels.len() < rows || (present == 0 && values.len() < rows) {
        let levels_wanted = (present > 0).then_some(&mut levels);
        let (records, ..) = reader.read_records(rows, levels_wanted, None, &mut values)?;
        if records == 0 {
            break;
        }
        if present == 0 {
            levels.resize(values.len(), 0);
        }
    }
    let mut values = values.into_iter().map(convert);
    Ok(levels
        .iter()
        .map(|level| if *level == present { values.next().unwrap_or(f64::NAN) } else { f64::NAN })
        .collect())
}
