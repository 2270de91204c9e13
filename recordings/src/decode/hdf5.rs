//! HDF5, and MATLAB files of version 7.3, which are HDF5 behind a header: every numeric data set as columns.
//!
//! MATLAB stores arrays with their dimensions in reverse order: an N x k matrix is a k x N data set, whose rows are
//! the matrix's columns. The names are those of the version 5 reader: `structure.field`, `matrix_1` to `matrix_k`.

use hdf5_pure::{Error as Hdf5Error, File, Group};

use super::matlab::{Array, columns};
use crate::{Column, Error};

/// Groups may lie in groups this deep.
const DEEPEST: usize = 8;

/// The numeric columns of an HDF5 file. Should the library panic over a damaged file, that too is told as an error.
pub(super) fn read(bytes: &[u8], file: &str) -> Result<Vec<Column>, Error> {
    let unreadable = |why: String| Error::Unreadable { file: file.to_owned(), kind: "HDF5", why };
    let found = std::panic::catch_unwind(|| {
        let opened = File::from_bytes(bytes.to_vec())?;
        let mut arrays = Vec::new();
        collect(&opened.root(), "", 0, &mut arrays)?;
        Ok::<_, Hdf5Error>(arrays)
    });
    match found {
        Ok(outcome) => outcome.map(columns).map_err(|e| unreadable(e.to_string())),
        Err(_) => Err(unreadable("the file is damaged".to_owned())),
    }
}

/// The arrays of a group and of the groups in it, in order of name. MATLAB's own groups begin with `#`.
fn collect(group: &Group, path: &str, depth: usize, arrays: &mut Vec<Array>) -> Result<(), Hdf5Error> {
    let (mut names, mut inner) = (group.datasets()?, group.groups()?);
    names.sort();
    inner.sort();
    for name in names {
        let set = group.dataset(&name)?;
        let shape = set.shape()?;
        // text, references and other things that are no numbers are left out
        let Ok(values) = set.read_f64() else { continue };
        let rows = shape.last().and_then(|n| usize::try_from(*n).ok()).unwrap_or(1);
        let rows = if rows == 1 { values.len() } else { rows };
        arrays.push(Array { name: format!("{path}{name}"), rows, values });
    }
    for name in inner.iter().filter(|n| depth < DEEPEST && !n.starts_with('#')) {
        collect(&group.group(name)?, &format!("{path}{name}."), depth + 1, arrays)?;
    }
    Ok(())
}
