//! A result as a folder of files for other programs: every table as CSV, the whole result as a MATLAB file, and a list of the files.
//!
//! Modules in reading order: [`tables`] (which tables a result has), [`matlab`], [`matlab_hdf5`].

mod matlab;
mod matlab_hdf5;
mod tables;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use serde::Serialize;
use serde_json::Value;

use crate::projects::write_file;

pub use tables::{ResultTable, number_cell};

/// Most characters of a file's name before its ending: file systems allow 255 bytes.
const LONGEST_NAME: usize = 120;

/// Version of a MATLAB file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MatlabVersion {
    /// Version 5, which MATLAB, Octave and SciPy read; a variable has at most 2 GB.
    #[default]
    Five,
    /// Version 7.3, which is HDF5 and has no such limit.
    SevenThree,
}

/// A folder of files of one result.
pub struct ResultFolder {
    folder: PathBuf,
    matlab: MatlabVersion,
    /// Names in small letters: some file systems do not tell capitals apart.
    names: BTreeSet<String>,
    contents: Vec<Vec<String>>,
}

impl ResultFolder {
    /// Returns a folder to which nothing has been written.
    pub fn new(folder: &Path) -> Self {
        let (names, contents) = (BTreeSet::new(), Vec::new());
        Self { folder: folder.to_owned(), matlab: MatlabVersion::default(), names, contents }
    }

    /// Returns the same with another version of the MATLAB file.
    pub fn with_matlab(self, matlab: MatlabVersion) -> Self {
        Self { matlab, ..self }
    }

    /// Writes every table of a result, and the whole result as `result.mat`.
    ///
    /// # Errors
    /// A file that cannot be written, and a result that is too large for its MATLAB file.
    pub fn write_result<T: Serialize>(&mut self, result: &T) -> Result<()> {
        let value = serde_json::to_value(result)?;
        let Value::Object(object) = &value else { bail!("a result is an object of named values") };
        tables::visit_tables(&value, &mut |table| self.write_table(&table))?;
        let file = match self.matlab {
            MatlabVersion::Five => matlab::matlab_file(object),
            MatlabVersion::SevenThree => matlab_hdf5::matlab_hdf5_file(object),
        };
        let file =
            file.with_context(|| format!("cannot make {}", self.folder.join("result.mat").display()))?;
        write_file(&self.folder.join("result.mat"), &file)
    }

    /// Writes a table as CSV under its name.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_table(&mut self, table: &ResultTable) -> Result<()> {
        let name = self.free_name(&table.name);
        write_file(&self.folder.join(&name), &csv_bytes(&table.columns, &table.rows)?)?;
        self.contents.push(vec![
            name,
            table.name.clone(),
            table.rows.len().to_string(),
            table.columns.join("; "),
        ]);
        Ok(())
    }

    /// Writes the list of the tables, `contents.csv`.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_contents(&self) -> Result<()> {
        let columns = ["file", "table", "rows", "columns"].map(str::to_owned);
        write_file(&self.folder.join("contents.csv"), &csv_bytes(&columns, &self.contents)?)
    }

    /// Returns the name of a file that no other table has.
    fn free_name(&mut self, table: &str) -> String {
        let sound = |c: char| if c.is_ascii_alphanumeric() || "._-".contains(c) { c } else { '_' };
        let stem: String = table.chars().map(sound).take(LONGEST_NAME).collect();
        let stem = stem.trim_matches('.').to_owned();
        let candidates = std::iter::once(stem.clone()).chain((2_usize..).map(|k| format!("{stem}_{k}")));
        let is_reserved = |name: &str| name.is_empty() || name == "contents";
        for name in candidates {
            let low = name.to_ascii_lowercase();
            if !is_reserved(&low) && self.names.insert(low) {
                return format!("{name}.csv");
            }
        }
        "table.csv".to_owned()
    }
}

fn csv_bytes(columns: &[String], rows: &[Vec<String>]) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(columns)?;
    rows.iter().try_for_each(|row| writer.write_record(row))?;
    Ok(writer.into_inner().map_err(|error| error.into_error())?)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_folder_lists_its_tables_and_no_name_leaves_it() {
        let folder = tempfile::tempdir().unwrap();
        let mut files = ResultFolder::new(folder.path());
        let named = |name: &str| serde_json::json!({"name": name, "t": [1, 2], "u": [3, 4]});
        let mut result = serde_json::json!({"a": [named("../../etc/x"), named("A/b"), named("a_B")]});
        for key in ["contents", "", &"n".repeat(400)] {
            result[key] = serde_json::json!([{"x": 1}]);
        }
        files.write_result(&result).unwrap();
        files.write_contents().unwrap();
        let mut names: Vec<String> = std::fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        assert_eq!(names.len(), 9, "{names:?}");
        assert!(names.contains(&"a.A_b.csv".to_owned()) && names.contains(&"a.a_B_2.csv".to_owned()));
        let contents = std::fs::read_to_string(folder.path().join("contents.csv")).unwrap();
        assert_eq!(contents.lines().count(), 8);
        let history = std::fs::read_to_string(folder.path().join("a.A_b.csv")).unwrap();
        assert_eq!(history, "t,u\n1,3\n2,4\n");
    }
}
