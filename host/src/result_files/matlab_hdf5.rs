//! A result as a MATLAB file of version 7.3, which is HDF5: no variable of it has a limit of 2 GB. Lists of objects are cell arrays of structures.
//!
//! Format: MathWorks, *MAT-File Versions*; the conventions on HDF5 are those of the crate `hdf5-pure`. No date is written, so the same result gives the
//! same bytes.

use anyhow::Result;
use hdf5_pure::mat::identifier::is_valid_name;
use hdf5_pure::mat::{MatBuilder, MatClass, MatError, Options};
use serde_json::{Map, Value};

use super::matlab::{field_names, matrix_of, numbers_of};

/// Returns the file of a result; its keys are the variables, and its values as in a file of version 5.
///
/// # Errors
/// A value that the file cannot hold.
pub(super) fn matlab_hdf5_file(result: &Map<String, Value>) -> Result<Vec<u8>> {
    let mut file = MatBuilder::new(Options::default());
    write_fields(&mut file, result)?;
    Ok(file.finish()?)
}

fn write_fields(file: &mut MatBuilder, object: &Map<String, Value>) -> Result<(), MatError> {
    let mut names = field_names(object.keys());
    // words of the language are fields of a structure in version 5, and are refused here
    names.iter_mut().filter(|name| !is_valid_name(name)).for_each(|name| name.push('_'));
    names.iter().zip(object.values()).try_for_each(|(name, value)| write_value(file, name, value))
}

fn write_value(file: &mut MatBuilder, name: &str, value: &Value) -> Result<(), MatError> {
    match value {
        Value::Null => file.write_empty(name, MatClass::Double, &[0, 0])?,
        Value::Bool(truth) => file.write_scalar_logical(name, *truth)?,
        Value::Number(number) => file.write_scalar_f64(name, number.as_f64().unwrap_or(f64::NAN))?,
        Value::String(text) => file.write_char(name, text)?,
        Value::Array(list) => return write_list(file, name, list),
        Value::Object(object) if object.is_empty() => file.write_empty_struct_array(name)?,
        Value::Object(object) => file.struct_(name, |inside| write_fields(inside.builder(), object))?,
    };
    Ok(())
}

fn write_list(file: &mut MatBuilder, name: &str, list: &[Value]) -> Result<(), MatError> {
    if let Some(values) = numbers_of(list) {
        file.write_f64(name, &[values.len(), usize::from(!values.is_empty())], &values)?;
    } else if let Some((size, values)) = matrix_of(list) {
        file.write_f64(name, &size, &values)?;
    } else if let Some(truths) = list.iter().map(Value::as_bool).collect::<Option<Vec<bool>>>() {
        let bytes: Vec<u8> = truths.into_iter().map(u8::from).collect();
        file.write_logical(name, &[bytes.len(), 1], &bytes)?;
    } else {
        file.cell(name, &[list.len(), 1], |cell| {
            list.iter().try_for_each(|value| {
                // the name of an element is its reference, which the cell gives it
                cell.push_with(|inside| write_value(inside, "element", value)).map(|_| ())
            })
        })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use hdf5_pure::File;
    use serde_json::json;

    fn written(value: &Value) -> Vec<u8> {
        matlab_hdf5_file(value.as_object().unwrap()).unwrap()
    }

    #[test]
    fn numbers_matrices_texts_and_structures_are_found_again() {
        let value = json!({
            "a": 2.5, "none": null, "list": [1.0, null, 3.0], "m": [[1, 2, 3], [4, 5, 6]], "yes": true,
            "flags": [true, false], "text": "\u{b5}m", "inside": {"deep": {"b": 7}}, "mixed": ["x", 1, [2, 3]],
            "rows": [{"k": 1}, {"k": 2}], "empty": [], "2 bad name": 9, "nothing": {}, "methods": 4
        });
        let bytes = written(&value);
        assert_eq!(bytes, written(&value), "the same result gives the same bytes");
        assert!(bytes.starts_with(b"MATLAB 7.3 MAT-file"));
        let file = File::from_bytes(bytes).unwrap();
        let read = |path: &str| file.dataset(path).unwrap().read_f64().unwrap();
        assert_eq!(
            (read("a"), read("inside/deep/b"), read("x2_bad_name")),
            (vec![2.5], vec![7.0], vec![9.0])
        );
        // columns first: MATLAB sees the rows as they are written
        assert_eq!(read("m"), [1.0, 4.0, 2.0, 5.0, 3.0, 6.0]);
        assert_eq!(file.dataset("m").unwrap().shape().unwrap(), [3, 2]);
        assert!(read("list")[1].is_nan() && read("methods_") == [4.0]);
        assert!(
            file.dataset("rows").is_ok() && file.dataset("mixed").is_ok() && file.dataset("nothing").is_ok()
        );
    }
}
