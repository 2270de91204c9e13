//! Recordings as bytes: CSV, Parquet and MATLAB files to columns in SI units, and columns to the channels of the
//! mechanism. No file is opened here.

mod columnar;
mod error;
mod hierarchical;
mod mapping;
mod matlab;
mod road;
mod shaping;
mod text;
mod timing;
mod unit;

pub use error::RecordingError;
pub use mapping::{Channel, ChannelSource, Mapping};
pub use road::road;
pub use timing::{Finding, Record};
pub use unit::Unit;

/// A table of numbers: named columns of one length.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Name of the file.
    pub name: String,
    /// Columns in the file's order.
    pub columns: Vec<Column>,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name without its unit.
    pub name: String,
    /// Unit as written; none where the file gives none.
    pub unit: Option<String>,
    /// Values as written; NaN where a value is missing.
    pub values: Vec<f64>,
}

/// First bytes of a Parquet file.
const PARQUET: &[u8] = b"PAR1";
/// First bytes of a MATLAB file of version 5.
const MATLAB: &[u8] = b"MATLAB 5.0";
/// First bytes of a MATLAB file of version 7.3, and of HDF5.
const MATLAB_7_3: &[u8] = b"MATLAB 7.3";
const HDF5: &[u8] = b"\x89HDF";

impl Table {
    /// Reads the bytes of a recording, whose kind is seen from its first bytes: Parquet, MATLAB version 5 or 7.3, HDF5, else CSV
    /// with one header row `name [unit]`.
    ///
    /// # Errors
    /// What is wrong with the file, with row, column and value where they are known.
    pub fn read(bytes: &[u8], name: &str) -> Result<Self, RecordingError> {
        let columns = if bytes.starts_with(PARQUET) {
            columnar::read(bytes, name)?
        } else if bytes.starts_with(MATLAB) {
            matlab::read(bytes, name)?
        } else if bytes.starts_with(MATLAB_7_3) || bytes.starts_with(HDF5) {
            hierarchical::read(bytes, name)?
        } else {
            text::read(bytes, name)?
        };
        let table = Self { name: name.to_owned(), columns };
        table.checked()
    }

    /// The values of a column in SI units.
    ///
    /// # Errors
    /// There is no such column, or its unit is not known.
    pub fn in_si(&self, column: &str) -> Result<(Vec<f64>, Unit), RecordingError> {
        let found = self.column(column)?;
        let unit = match &found.unit {
            Some(written) => self.unit(column, written)?,
            None => Unit::ONE,
        };
        Ok((found.values.iter().map(|v| unit.to_si(*v)).collect(), unit))
    }

    /// A column by its name.
    ///
    /// # Errors
    /// There is no such column; the nearest name and all names are told.
    pub fn column(&self, name: &str) -> Result<&Column, RecordingError> {
        self.columns.iter().find(|c| c.name == name).ok_or_else(|| {
            let names = self.columns.iter().map(|c| c.name.as_str());
            let hint = crate::diagnostic::nearest(name, names.clone()).map(str::to_owned);
            let known = names.collect::<Vec<_>>().join(", ");
            RecordingError::NoColumn { file: self.name.clone(), column: name.to_owned(), known, hint }
        })
    }

    pub(crate) fn unit(&self, column: &str, written: &str) -> Result<Unit, RecordingError> {
        let unknown = || RecordingError::UnknownUnit {
            file: self.name.clone(),
            column: column.to_owned(),
            unit: written.to_owned(),
        };
        Unit::parse(written).ok_or_else(unknown)
    }

    /// The table, if it has rows, its columns are of one length, and their names differ.
    fn checked(self) -> Result<Self, RecordingError> {
        let rows = self.columns.first().map_or(0, |c| c.values.len());
        if rows == 0 {
            return Err(RecordingError::Empty { file: self.name });
        }
        for (index, column) in self.columns.iter().enumerate() {
            if self.columns[..index].iter().any(|c| c.name == column.name) {
                return Err(RecordingError::SameName {
                    file: self.name.clone(),
                    column: column.name.clone(),
                });
            }
            if column.values.len() != rows {
                let (column, length) = (column.name.clone(), column.values.len());
                return Err(RecordingError::Length { file: self.name.clone(), column, length, rows });
            }
        }
        Ok(self)
    }
}

impl Column {
    /// A column from a heading `name [unit]` or `name (unit)`.
    pub(crate) fn headed(heading: &str, values: Vec<f64>) -> Self {
        let heading = heading.trim().trim_matches('"').trim();
        let split = |open, close| {
            let (name, rest) = heading.split_once(open)?;
            let unit = rest.trim_end().strip_suffix(close)?;
            Some((name.trim().to_owned(), Some(unit.trim().to_owned())))
        };
        let (name, unit) =
            split('[', ']').or_else(|| split('(', ')')).unwrap_or_else(|| (heading.to_owned(), None));
        Self { name, unit, values }
    }
}
