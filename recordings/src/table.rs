//! A table: the columns of a file as written.

use std::collections::BTreeSet;

use ndarray::Array1;

use crate::{Error, Remark, Unit};

/// Names of a column that is the time without being mapped; the last one is what PlotJuggler writes.
pub(crate) const TIME_NAMES: [&str; 4] = ["time", "t", "Time", "__time"];

/// A table of numbers: named columns of one length.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordingTable {
    /// Name of the file.
    pub name: String,
    /// Columns in the file's order.
    pub columns: Vec<RecordingColumn>,
    /// Parts of the file that were left out.
    pub remarks: Vec<Remark>,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordingColumn {
    /// Name without its unit.
    pub name: String,
    /// Unit as written; `None` if the file gives none.
    pub unit: Option<String>,
    /// Values as written; NaN if a value is missing.
    pub values: Array1<f64>,
}

impl RecordingTable {
    /// Returns the table if its columns fit together.
    ///
    /// # Errors
    /// See [`RecordingTable::check`].
    pub(crate) fn into_checked(self) -> Result<Self, Error> {
        self.check()?;
        Ok(self)
    }

    /// Returns the values of a column in SI units, and its unit.
    ///
    /// # Errors
    /// There is no such column, or its unit is not known.
    pub fn convert_to_si(&self, column: &str) -> Result<(Array1<f64>, Unit), Error> {
        let found = self.column(column)?;
        let unit = match &found.unit {
            Some(written) => self.unit(column, written)?,
            None => Unit::ONE,
        };
        Ok((found.values.mapv(|v| unit.to_si(v)), unit))
    }

    /// Returns the values of a column in SI units, if it has no unit or one of the wanted quantity. `channel` names that quantity in
    /// errors.
    ///
    /// # Errors
    /// There is no such column, its unit is not known, or its unit is of another quantity.
    pub fn quantity(
        &self,
        column: &str,
        channel: &'static str,
        wanted: &'static str,
    ) -> Result<Array1<f64>, Error> {
        let (values, unit) = self.convert_to_si(column)?;
        let written = self.column(column)?.unit.clone();
        if written.is_none() || Unit::parse(wanted).is_some_and(|u| u.is_like(&unit)) {
            return Ok(values);
        }
        let (file, column) = (self.name.clone(), column.to_owned());
        Err(Error::WrongUnit { file, column, unit: written.unwrap_or_default(), channel, wanted })
    }

    /// Returns a column by its name.
    ///
    /// # Errors
    /// There is no such column; the error lists the columns that there are and names the nearest.
    pub fn column(&self, name: &str) -> Result<&RecordingColumn, Error> {
        self.find(name).ok_or_else(|| {
            let names = self.columns.iter().map(|c| c.name.as_str());
            let hint = nearest_name(name, names.clone()).map(str::to_owned);
            let known = names.collect::<Vec<_>>().join(", ");
            Error::NoColumn { file: self.name.clone(), column: name.to_owned(), known, hint }
        })
    }

    /// Returns a column by its name; `None` if there is none of that name.
    pub fn find(&self, name: &str) -> Option<&RecordingColumn> {
        self.columns.iter().find(|c| c.name == name)
    }

    /// Returns the unit of a column from what is written.
    pub(crate) fn unit(&self, column: &str, written: &str) -> Result<Unit, Error> {
        let unknown = || Error::UnknownUnit {
            file: self.name.clone(),
            column: column.to_owned(),
            unit: written.to_owned(),
        };
        Unit::parse(written).ok_or_else(unknown)
    }

    /// Returns the error of a table without rows, which says what was left out.
    fn empty(&self) -> Error {
        let unread = self.remarks.iter().find_map(|remark| match remark {
            Remark::Unread { column, why } => Some((column.clone(), why.clone())),
            _ => None,
        });
        let file = self.name.clone();
        unread.map_or(Error::Empty { file: file.clone() }, |(column, why)| Error::NothingRead {
            file,
            column,
            why,
        })
    }

    /// Refuses a table without rows, with columns of different length, or with two columns of one name.
    fn check(&self) -> Result<(), Error> {
        let file = || self.name.clone();
        let rows = self.columns.first().map_or(0, |c| c.values.len());
        if rows == 0 {
            return Err(self.empty());
        }
        let mut names = BTreeSet::new();
        for column in &self.columns {
            let (name, length) = (column.name.clone(), column.values.len());
            if !names.insert(column.name.as_str()) {
                return Err(Error::SameName { file: file(), column: name });
            }
            if length != rows {
                return Err(Error::Length { file: file(), column: name, length, rows });
            }
        }
        Ok(())
    }
}

impl RecordingColumn {
    /// Returns a column from a heading `name [unit]` or `name (unit)`.
    pub(crate) fn from_heading(heading: &str, values: impl Into<Array1<f64>>) -> Self {
        let (name, unit) = name_and_unit(heading);
        Self { name, unit, values: values.into() }
    }
}

/// Returns the name and the unit of a heading `name [unit]` or `name (unit)`.
pub(crate) fn name_and_unit(heading: &str) -> (String, Option<String>) {
    let heading = heading.trim().trim_matches('"').trim();
    let split = |open, close| {
        let (name, rest) = heading.split_once(open)?;
        let unit = rest.trim_end().strip_suffix(close)?;
        Some((name.trim().to_owned(), Some(unit.trim().to_owned())))
    };
    split('[', ']').or_else(|| split('(', ')')).unwrap_or_else(|| (heading.to_owned(), None))
}

/// Returns the name in `known` that is nearest to `written`; `None` if none is near enough to be meant.
///
/// A name is near enough if at most a third of its letters differ (a letter in another case counts as none), or if one of the
/// two names begins with the other.
pub(crate) fn nearest_name<'a>(written: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let distance = |name: &str| strsim::damerau_levenshtein(&written.to_lowercase(), name);
    let extends = |name: &str| {
        name.len() >= 3 && written.len() >= 3 && (written.starts_with(name) || name.starts_with(written))
    };
    let length = written.chars().count();
    let is_close = |distance: usize| distance <= (length / 3).max(1) && 2 * distance <= length;
    let near = |name: &&str| is_close(distance(name)) || extends(name);
    known.into_iter().filter(near).min_by_key(|name| distance(name))
}
