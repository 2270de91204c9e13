//! Files that a project file names, handed in by whoever has them.

use std::collections::BTreeMap;

/// Files by the names that the project file uses.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Attachments {
    files: BTreeMap<String, Vec<u8>>,
    problems: BTreeMap<String, String>,
}

/// Largest text that is read as a part of a project, bytes.
pub(crate) const LARGEST_TEXT: usize = 16 << 20;

impl Attachments {
    /// Returns attachments without files.
    pub fn none() -> Self {
        Self::default()
    }

    /// Returns the same with one file more.
    #[must_use]
    pub fn with(mut self, name: &str, bytes: Vec<u8>) -> Self {
        self.files.insert(name.to_owned(), bytes);
        self
    }

    /// Returns the same with the reason why a file could not be read.
    #[must_use]
    pub fn with_problem(mut self, name: &str, problem: String) -> Self {
        self.problems.insert(name.to_owned(), problem);
        self
    }

    /// Returns a file as text.
    pub(crate) fn text(&self, name: &str) -> Result<String, String> {
        let bytes = self.bytes(name)?;
        if bytes.len() > LARGEST_TEXT {
            let (size, most) = (bytes.len() >> 20, LARGEST_TEXT >> 20);
            return Err(format!(
                "the file \"{name}\" has {size} MB; a text that a project names has at most {most} MB"
            ));
        }
        String::from_utf8(bytes.to_vec()).map_err(|_| format!("the file \"{name}\" is not UTF-8 text"))
    }

    /// Returns the bytes of a file.
    pub(crate) fn bytes(&self, name: &str) -> Result<&[u8], String> {
        let missing = || match self.problems.get(name) {
            Some(problem) => format!("the file \"{name}\" cannot be read: {problem}"),
            None => format!("the file \"{name}\" was not found in the folder of the project file"),
        };
        self.files.get(name).map(Vec::as_slice).ok_or_else(missing)
    }

    /// Returns the first two numeric columns of a CSV file with a header row; lines that start with # are
    /// comments.
    pub(crate) fn pairs(&self, name: &str) -> Result<Vec<[f64; 2]>, String> {
        let bytes = self.bytes(name)?;
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .flexible(true)
            .from_reader(bytes);
        let unreadable = |e: csv::Error| format!("\"{name}\": {e}");
        let headings = reader.headers().map_err(unreadable)?.clone();
        if !headings.is_empty() && headings.iter().all(|heading| heading.parse::<f64>().is_ok()) {
            let first = headings.iter().collect::<Vec<_>>().join(",");
            return Err(format!(
                "the first row of \"{name}\" ({first}) holds numbers, but must name the columns: put a row of names before it"
            ));
        }
        let pairs: Vec<[f64; 2]> = reader
            .records()
            .map(|record| pair(name, &record.map_err(unreadable)?))
            .collect::<Result<_, _>>()?;
        if pairs.is_empty() {
            return Err(format!(
                "the file \"{name}\" has no row of numbers: it needs two columns of numbers under its header"
            ));
        }
        Ok(pairs)
    }
}

fn pair(name: &str, record: &csv::StringRecord) -> Result<[f64; 2], String> {
    let line = record.position().map_or(0, csv::Position::line);
    let number = |column: usize| {
        let written = record.get(column).unwrap_or_default();
        let value: f64 = written.parse().map_err(|_| {
            format!("\"{name}\" line {line} column {}: \"{written}\" is not a number", column + 1)
        })?;
        if value.is_finite() {
            Ok(value)
        } else {
            Err(format!("\"{name}\" line {line} column {}: {written} is not finite", column + 1))
        }
    };
    Ok([number(0)?, number(1)?])
}
