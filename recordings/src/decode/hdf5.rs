//! HDF5, and MATLAB files of version 7.3, which are HDF5 behind a header: every numeric data set as columns.
//!
//! The names are those of the version 5 reader: `structure.field`, `matrix_1` to `matrix_k`.

use hdf5_pure::{AttrValue, DType, Dataset, Error as Hdf5Error, File, FormatError, Group};
use ndarray::{Array2, ShapeBuilder};

use super::Decoded;
use super::arrays::{Array, Found};
use super::budget::Budget;
use crate::Error;
use crate::remark::Unread;

/// Groups may lie in groups this deep.
const DEEPEST: usize = 8;

/// In which order the dimensions of an array are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    /// As the array has them, the last one running fastest.
    AsWritten,
    /// Reversed, as MATLAB does: an N x k matrix is a k x N data set.
    Matlab,
}

/// Reads the data sets of one file.
struct Reader<'a> {
    file: &'a str,
    order: Order,
    budget: Budget<'a>,
    found: Found,
}

/// Why reading stops: the library's error, or ours.
enum Stop {
    Library(Hdf5Error),
    Ours(Error),
}

impl From<Hdf5Error> for Stop {
    fn from(error: Hdf5Error) -> Self {
        Self::Library(error)
    }
}

/// Returns the columns of an HDF5 file. Should the library panic over a damaged file, that too is an error.
pub(super) fn read(bytes: &[u8], file: &str, order: Order) -> Result<Decoded, Error> {
    let unreadable = |why: String| Error::Unreadable { file: file.to_owned(), kind: "HDF5", why };
    let read = std::panic::catch_unwind(|| {
        let opened = File::from_bytes(bytes.to_vec())?;
        let budget = Budget::new(file, bytes.len());
        let mut reader = Reader { file, order, budget, found: Found::default() };
        reader.group(&opened.root(), "", 0)?;
        Ok::<_, Stop>(reader.found)
    });
    match read {
        Ok(Ok(found)) => Ok(found.columns()),
        Ok(Err(Stop::Ours(error))) => Err(error),
        Ok(Err(Stop::Library(error))) => Err(unreadable(error.to_string())),
        Err(_) => Err(unreadable("the file is damaged".to_owned())),
    }
}

impl Reader<'_> {
    /// Reads the data sets of a group and of the groups in it, in order of name. MATLAB's own groups begin with `#`.
    fn group(&mut self, group: &Group, path: &str, depth: usize) -> Result<(), Stop> {
        let (mut names, mut inner) = (group.datasets()?, group.groups()?);
        names.sort();
        inner.sort();
        for name in names {
            self.data_set(&group.dataset(&name)?, format!("{path}{name}"))?;
        }
        for name in inner.iter().filter(|n| !n.starts_with('#')) {
            let full = format!("{path}{name}");
            let within = group.group(name)?;
            if within.attrs().is_ok_and(|attributes| attributes.contains_key("MATLAB_sparse")) {
                self.found.holds(&full, "a sparse matrix");
            } else if depth < DEEPEST {
                self.group(&within, &format!("{full}."), depth + 1)?;
            } else {
                self.found.holds(&full, "groups that lie too deep");
            }
        }
        Ok(())
    }

    fn data_set(&mut self, set: &Dataset, name: String) -> Result<(), Stop> {
        let shape = set.shape()?;
        let count = shape.iter().fold(1_u64, |product, n| product.saturating_mul(*n));
        if let Some(holds) = holds(&set.dtype()?) {
            if count > 1 {
                self.found.holds(&name, &holds);
            }
            return Ok(());
        }
        if count == 0 || is_text(set) {
            return Ok(());
        }
        self.budget.take(&name, count).map_err(Stop::Ours)?;
        let Some(shape) = self.rows_and_columns(&shape) else {
            self.found.unread(&name, Unread::Shape { shape });
            return Ok(());
        };
        match set.read_f64() {
            Ok(values) => self.array(name, shape, values),
            Err(Hdf5Error::Format(
                damage @ (FormatError::Fletcher32Mismatch { .. } | FormatError::ChecksumMismatch { .. }),
            )) => {
                let file = self.file.to_owned();
                return Err(Stop::Ours(Error::Checksum { file, column: name, why: damage.to_string() }));
            }
            Err(other) => self.found.unread(&name, Unread::Undecodable { why: other.to_string() }),
        }
        Ok(())
    }

    fn array(&mut self, name: String, (rows, columns): (usize, usize), values: Vec<f64>) {
        let array = match self.order {
            Order::AsWritten => Array2::from_shape_vec((rows, columns), values),
            Order::Matlab => Array2::from_shape_vec((rows, columns).f(), values),
        };
        match array {
            Ok(values) => self.found.arrays.push(Array { name, values }),
            Err(error) => self.found.unread(&name, Unread::Undecodable { why: error.to_string() }),
        }
    }

    /// Returns rows and columns of an array; `None` if it has more than two dimensions of more than one value.
    fn rows_and_columns(&self, shape: &[u64]) -> Option<(usize, usize)> {
        let sizes: Vec<usize> =
            shape.iter().filter(|n| **n != 1).map(|n| usize::try_from(*n).ok()).collect::<Option<_>>()?;
        match (&sizes[..], self.order) {
            ([], _) => Some((1, 1)),
            ([rows], _) => Some((*rows, 1)),
            ([rows, columns], Order::AsWritten) | ([columns, rows], Order::Matlab) => Some((*rows, *columns)),
            _ => None,
        }
    }
}

/// Returns whether MATLAB wrote the data set as a text, which it stores as numbers.
fn is_text(set: &Dataset) -> bool {
    let class = set.attrs().ok().and_then(|mut attributes| attributes.remove("MATLAB_class"));
    match class {
        Some(AttrValue::String(class) | AttrValue::AsciiString(class)) => class == "char",
        Some(AttrValue::StringSized { value, .. }) => value == "char",
        _ => false,
    }
}

/// Returns what a data set holds that is not read, in the plural; `None` if it holds numbers.
fn holds(kind: &DType) -> Option<String> {
    let written = match kind {
        DType::F32 | DType::F64 => return None,
        DType::I8 | DType::I16 | DType::I32 | DType::I64 => return None,
        DType::U8 | DType::U16 | DType::U32 | DType::U64 => return None,
        DType::String | DType::VariableLengthString => "texts",
        DType::Compound(fields) => {
            let names: Vec<&str> = fields.iter().map(|(name, _)| name.as_str()).collect();
            let is_complex = [["r", "i"], ["real", "imag"]].iter().any(|pair| names == pair);
            if is_complex { "complex numbers" } else { "records of several fields" }
        }
        DType::Enum(_) => "enumerated values",
        DType::Array(..) => "arrays",
        DType::ObjectReference => "references",
        other => return Some(format!("values of type {other}")),
    };
    Some(written.to_owned())
}
