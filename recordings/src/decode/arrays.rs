//! Arrays of MATLAB and HDF5 files as columns of one length.

use ndarray::{Array2, ArrayView1};

use super::DecodedFile;
use crate::remark::UnreadReason;
use crate::{Channel, RecordingColumn, Remark};

/// An array with more columns than this is not a set of channels, and does not decide which length the table has.
const MOST_COLUMNS: usize = 64;

/// A named array of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedArray {
    /// Name; a field of a structure is `structure.field`.
    pub name: String,
    /// Unit; `None` if the file gives none.
    pub unit: Option<String>,
    /// Values, rows x columns; a vector is a single column.
    pub values: Array2<f64>,
}

/// Arrays and what was left out, in the order in which they are found.
#[derive(Default)]
pub(super) struct DecodedArrays {
    pub(super) arrays: Vec<NamedArray>,
    pub(super) remarks: Vec<Remark>,
}

impl DecodedArrays {
    /// Adds an array that is not read.
    pub(super) fn note_unread(&mut self, column: &str, why: UnreadReason) {
        self.remarks.push(Remark::Unread { column: column.to_owned(), why });
    }

    /// Adds an array that is not read because of what it holds.
    pub(super) fn holds(&mut self, column: &str, holds: &str) {
        self.note_unread(column, UnreadReason::Type { holds: holds.to_owned() });
    }

    /// Returns the arrays as columns of one length: that of a time column, else the most frequent (the longer one of two that are
    /// equally frequent). A matrix gives the columns `name_1` to `name_k` along its longer dimension.
    pub(super) fn columns(mut self) -> DecodedFile {
        let rows = rows(&self.arrays);
        let mut columns = Vec::new();
        for array in std::mem::take(&mut self.arrays) {
            let (length, count) = array.extent();
            if length == rows && rows > 1 && count <= MOST_COLUMNS {
                columns.extend(array.split());
            } else if length > 1 || array.is_channel() {
                self.note_unread(&array.name, array.left_out(rows));
            }
        }
        DecodedFile { columns, remarks: self.remarks }
    }
}

/// Returns the length of the table.
fn rows(arrays: &[NamedArray]) -> usize {
    let candidates: Vec<&NamedArray> =
        arrays.iter().filter(|a| a.extent().0 > 1 && a.extent().1 <= MOST_COLUMNS).collect();
    let frequency = |rows: usize| {
        candidates.iter().map(|a| a.extent()).filter(|e| e.0 == rows).map(|e| e.1).sum::<usize>()
    };
    let longest = |arrays: &mut dyn Iterator<Item = &&NamedArray>| {
        arrays.map(|a| a.extent().0).max_by_key(|rows| (frequency(*rows), *rows))
    };
    let timed = longest(&mut candidates.iter().filter(|a| a.is_time()));
    timed.or_else(|| longest(&mut candidates.iter())).unwrap_or(0)
}

impl NamedArray {
    /// Returns the number of samples and of columns: the longer dimension is time.
    fn extent(&self) -> (usize, usize) {
        let (rows, columns) = self.values.dim();
        (rows.max(columns), rows.min(columns))
    }

    /// Returns whether it is a vector with the name of a time column.
    fn is_time(&self) -> bool {
        self.extent().1 == 1 && ["time", "t"].contains(&self.last_name().to_ascii_lowercase().as_str())
    }

    /// Returns whether it has the name of a channel: a parameter of one value may stand beside the columns, a channel may not.
    fn is_channel(&self) -> bool {
        Channel::ALL.iter().any(|channel| channel.name() == self.last_name())
    }

    /// Returns its name without those of the structures that hold it.
    fn last_name(&self) -> &str {
        self.name.rsplit('.').next().unwrap_or_default()
    }

    fn split(self) -> Vec<RecordingColumn> {
        let (rows, columns) = self.values.dim();
        let of = |k: usize| if rows >= columns { self.values.column(k) } else { self.values.row(k) };
        let column = |name: String, values: ArrayView1<'_, f64>| RecordingColumn {
            name,
            unit: self.unit.clone(),
            values: values.to_owned(),
        };
        match self.extent().1 {
            1 => vec![column(self.name.clone(), of(0))],
            count => (0..count).map(|k| column(format!("{}_{}", self.name, k + 1), of(k))).collect(),
        }
    }

    fn left_out(&self, rows: usize) -> UnreadReason {
        let (length, count) = self.extent();
        match count {
            0 | 1 => UnreadReason::Length { length, rows },
            _ => UnreadReason::Shape { shape: self.values.shape().iter().map(|n| *n as u64).collect() },
        }
    }
}
