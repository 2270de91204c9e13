//! HDF5, and MATLAB files of version 7.3, which are HDF5 behind a header: every numeric data set as columns.
//!
//! The names are those of the version 5 reader: `structure.field`, `matrix_1` to `matrix_k`.

use std::collections::BTreeSet;

use hdf5_pure::{DType, Dataset, Error as Hdf5Error, File, FormatError, Group};
use ndarray::{Array2, ShapeBuilder};

use super::arrays::{DecodedArrays, NamedArray};
use super::budget::Budget;
use crate::remark::UnreadReason;
use crate::table::{TIME_NAMES, name_and_unit};
use crate::{Channel, Error};

/// Groups may lie in groups this deep.
const DEEPEST: usize = 8;
/// Most groups and data sets of a file. A group can hold itself, so that a small file can have any number of them.
const MOST_OBJECTS: usize = 10_000;
/// Files of more bytes are not searched for names of links.
const LARGEST_SEARCHED: usize = 16 << 20;
/// Attributes that hold the unit of a data set: the first is that of netCDF's conventions.
const UNIT_ATTRIBUTES: [&str; 4] = ["units", "unit", "Units", "Unit"];

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
    found: DecodedArrays,
    objects: usize,
    /// Channels of which a data set was found.
    channels: BTreeSet<Channel>,
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

/// Returns the arrays of an HDF5 file. Should the library panic over a damaged file, that too is an error.
pub(super) fn read(bytes: &[u8], file: &str, order: Order) -> Result<DecodedArrays, Error> {
    let unreadable = |why: String| Error::Unreadable { file: file.to_owned(), kind: "HDF5", why };
    let read = std::panic::catch_unwind(|| {
        let opened = File::from_bytes(bytes.to_vec())?;
        let budget = Budget::new(file, bytes.len());
        let mut reader = Reader {
            file,
            order,
            budget,
            found: DecodedArrays::default(),
            objects: 0,
            channels: BTreeSet::new(),
        };
        reader.group(&opened.root(), "", 0)?;
        reader.links(bytes);
        Ok::<_, Stop>(reader.found)
    });
    match read {
        Ok(Ok(found)) => Ok(found),
        Ok(Err(Stop::Ours(error))) => Err(error),
        Ok(Err(Stop::Library(error))) => Err(unreadable(describe_error(&error))),
        Err(_) => Err(unreadable("the file is damaged".to_owned())),
    }
}

impl Reader<'_> {
    /// Reads the data sets of a group and of the groups in it, in order of name. MATLAB's own groups begin with `#`.
    fn group(&mut self, group: &Group, path: &str, depth: usize) -> Result<(), Stop> {
        let listed = group.iter_datasets().map(Iterator::collect);
        if listed.as_ref().is_err_and(is_link) {
            return self.read_named_sets(group, path);
        }
        let mut sets: Vec<(String, Dataset)> = listed?;
        let mut inner: Vec<(String, Group)> = group.iter_groups()?.collect();
        self.count(sets.len() + inner.len())?;
        sets.sort_by(|a, b| a.0.cmp(&b.0));
        inner.sort_by(|a, b| a.0.cmp(&b.0));
        for (name, set) in &sets {
            self.data_set(set, format!("{path}{name}"))?;
        }
        for (name, within) in inner.iter().filter(|(name, _)| !name.starts_with('#')) {
            let full = format!("{path}{name}");
            if within.attrs().is_ok_and(|attributes| attributes.contains_key("MATLAB_sparse")) {
                self.found.holds(&full, "a sparse matrix");
            } else if depth < DEEPEST {
                self.group(within, &format!("{full}."), depth + 1)?;
            } else {
                self.found.holds(&full, "groups that lie too deep");
            }
        }
        Ok(())
    }

    /// Reads the data sets that have the name of a channel or of the time. The library lists no group in the older format that
    /// holds a symbolic link.
    fn read_named_sets(&mut self, group: &Group, path: &str) -> Result<(), Stop> {
        let names = Channel::ALL.into_iter().map(Channel::name).chain(TIME_NAMES);
        for name in names {
            if let Ok(set) = group.dataset(name) {
                self.data_set(&set, format!("{path}{name}"))?;
            }
        }
        let why = "it holds a link, and links are not followed; of its data sets only those with the name of a channel are read";
        self.found.note_unread(&format!("{path}*"), UnreadReason::Undecodable { why: why.to_owned() });
        Ok(())
    }

    /// Notes channels whose name stands in the file though it is no data set's: links are not followed, and not listed.
    fn links(&mut self, bytes: &[u8]) {
        if bytes.len() > LARGEST_SEARCHED {
            return;
        }
        for channel in
            Channel::ALL.into_iter().filter(|channel| !self.channels.contains(channel)).collect::<Vec<_>>()
        {
            if holds_word(bytes, channel.name().as_bytes()) {
                let why = "it is no data set; if it is a link, save the data set itself".to_owned();
                self.found.note_unread(channel.name(), UnreadReason::Undecodable { why });
            }
        }
    }

    /// Counts groups and data sets.
    fn count(&mut self, objects: usize) -> Result<(), Stop> {
        self.objects += objects;
        if self.objects <= MOST_OBJECTS {
            return Ok(());
        }
        let file = self.file.to_owned();
        let why = format!(
            "it holds more than {MOST_OBJECTS} groups and data sets, or a group that holds itself: save the channels alone"
        );
        Err(Stop::Ours(Error::Unreadable { file, kind: "HDF5", why }))
    }

    fn data_set(&mut self, set: &Dataset, name: String) -> Result<(), Stop> {
        self.channels.extend(channel(&name));
        let shape = set.shape()?;
        let count = shape.iter().fold(1_u64, |product, n| product.saturating_mul(*n));
        if let Some(holds) = holds(&set.dtype()?) {
            if count > 1 || channel(&name).is_some() {
                self.found.holds(&name, &holds);
            }
            return Ok(());
        }
        if is_text(set) {
            return Ok(());
        }
        self.budget.take(&name, count).map_err(Stop::Ours)?;
        // a chunk is unpacked whole, however few of its values belong to the data set
        let chunk = set.chunk_shape()?.unwrap_or_default();
        let chunk = chunk.iter().fold(1_u64, |product, n| product.saturating_mul(*n));
        self.budget.admits(&name, chunk).map_err(Stop::Ours)?;
        let unit = unit(set);
        if count == 0 {
            return self.array(name, unit, 0, 1, Vec::new()).map_err(Stop::Ours);
        }
        let Some((rows, columns)) = self.rows_and_columns(&shape) else {
            self.found.note_unread(&name, UnreadReason::Shape { shape });
            return Ok(());
        };
        match set.read_f64() {
            Ok(values) => self.array(name, unit, rows, columns, values).map_err(Stop::Ours),
            Err(Hdf5Error::Format(
                damage @ (FormatError::Fletcher32Mismatch { .. } | FormatError::ChecksumMismatch { .. }),
            )) => {
                let file = self.file.to_owned();
                Err(Stop::Ours(Error::Checksum { file, column: name, why: damage.to_string() }))
            }
            Err(other) if is_unsupported(&other) => {
                self.found.note_unread(&name, UnreadReason::Undecodable { why: other.to_string() });
                Ok(())
            }
            Err(other) => Err(Stop::Ours(self.damaged_column(&name, &other.to_string()))),
        }
    }

    /// Returns the error of a data set that does not hold what the file says.
    fn damaged_column(&self, name: &str, why: &str) -> Error {
        let why = format!(
            "column \"{name}\" is damaged or cut off ({why}): copy the file again from where it was recorded"
        );
        Error::Unreadable { file: self.file.to_owned(), kind: "HDF5", why }
    }

    fn array(
        &mut self,
        name: String,
        unit: Option<String>,
        rows: usize,
        columns: usize,
        values: Vec<f64>,
    ) -> Result<(), Error> {
        let (name, named_unit) = name_and_unit(&name);
        let unit = unit.or(named_unit);
        let array = match self.order {
            Order::AsWritten => Array2::from_shape_vec((rows, columns), values),
            Order::Matlab => Array2::from_shape_vec((rows, columns).f(), values),
        };
        let values = array.map_err(|error| self.damaged_column(&name, &error.to_string()))?;
        self.found.arrays.push(NamedArray { name, unit, values });
        Ok(())
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

/// Returns whether a data set is sound, but written in a way that is not read.
fn is_unsupported(error: &Hdf5Error) -> bool {
    use FormatError as F;
    let Hdf5Error::Format(error) = error else { return false };
    matches!(
        error,
        F::UnsupportedFilter(_)
            | F::UnsupportedVirtualLayout
            | F::UnsupportedExternalStorage
            | F::UnsupportedFilteredHeapObject
            | F::UnsupportedMessage(_)
            | F::UnsupportedVersion(_)
            | F::UnsupportedZfp(_)
    )
}

/// Returns whether a group cannot be listed because of a link: its address is that of no place in the file.
fn is_link(error: &Hdf5Error) -> bool {
    matches!(error, Hdf5Error::Format(FormatError::UnexpectedEof { expected: usize::MAX, .. }))
}

/// Returns what is said of a file that the library cannot take apart.
fn describe_error(error: &Hdf5Error) -> String {
    match error {
        error if is_link(error) => {
            "it holds a link to another place or file, and links are not followed: save the data sets themselves".to_owned()
        }
        _ => format!("{error}: copy the file again from where it was recorded, or save it again"),
    }
}

/// Returns the channel that the last part of a name, without its unit, is the name of.
fn channel(name: &str) -> Option<Channel> {
    let (name, _) = name_and_unit(name);
    let last = name.rsplit('.').next().unwrap_or_default();
    Channel::ALL.into_iter().find(|channel| channel.name() == last)
}

/// Returns whether bytes hold a word that is not part of a longer one.
fn holds_word(bytes: &[u8], word: &[u8]) -> bool {
    let is_letter = |at: Option<usize>| {
        let byte = at.and_then(|at| bytes.get(at));
        byte.is_some_and(|byte| byte.is_ascii_alphanumeric() || *byte == b'_')
    };
    let mut places = bytes.windows(word.len()).enumerate().filter(|(_, found)| *found == word);
    places.any(|(at, _)| !is_letter(at.checked_sub(1)) && !is_letter(Some(at + word.len())))
}

/// Returns the unit that an attribute of the data set states; `None` if there is none.
fn unit(set: &Dataset) -> Option<String> {
    let attributes = set.attrs().ok()?;
    let stated = UNIT_ATTRIBUTES.iter().find_map(|name| attributes.get(*name)?.as_str());
    stated.map(|unit| unit.trim().to_owned()).filter(|unit| !unit.is_empty())
}

/// Returns whether MATLAB wrote the data set as a text, which it stores as numbers.
fn is_text(set: &Dataset) -> bool {
    let class =
        set.attrs().ok().and_then(|attributes| Some(attributes.get("MATLAB_class")?.as_str()? == "char"));
    class.unwrap_or(false)
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
