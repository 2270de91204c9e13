//! A result as a MATLAB file of version 5, which MATLAB, Octave and SciPy read: objects as structures, lists of numbers as columns, lists of rows
//! as matrices.
//!
//! Format: MathWorks, *MAT-File Format*, chapter 1. Nothing is compressed and no date is written, so the same result gives the same bytes.

use std::collections::BTreeSet;

use anyhow::{Result, ensure};
use serde_json::{Map, Value};

/// Types of elements (table 1-1).
const SIGNED_WORDS: u32 = 5;
const UNSIGNED_WORDS: u32 = 6;
const SIGNED_BYTES: u32 = 1;
const UNSIGNED_BYTES: u32 = 2;
const CHARACTERS: u32 = 4;
const DOUBLES: u32 = 9;
const MATRIX: u32 = 14;

/// Classes of arrays (table 1-3); an array of truth values is one of bytes with a flag.
const CELLS: u32 = 1;
const STRUCTURE: u32 = 2;
const TEXT: u32 = 4;
const NUMBERS: u32 = 6;
const BYTES: u32 = 9;
const LOGICAL: u32 = 0x0200;

/// Bytes of the name of a field with the zero that ends it: MATLAB cuts off names of more than 63 characters.
const FIELD_NAME: usize = 64;
/// Most bytes of a variable: MATLAB reads no larger one from a file of version 5.
const LARGEST_VARIABLE: usize = i32::MAX as usize;

/// Returns the file of a result; its keys are the variables.
///
/// A list of numbers is a column, a list of rows of equal length a matrix, a list of objects with the same keys an array of structures, and any
/// other list a cell array. A number that does not exist is NaN inside a list, and an empty matrix elsewhere.
///
/// # Errors
/// A variable of more than 2 GB, which no file of version 5 can have.
pub(super) fn matlab_file(result: &Map<String, Value>) -> Result<Vec<u8>> {
    let mut file = format!("{:116}", "MATLAB 5.0 MAT-file, written by counterpoise").into_bytes();
    file.extend([0; 8]);
    file.extend(0x0100_u16.to_le_bytes());
    file.extend(b"IM");
    for (name, value) in field_names(result.keys()).iter().zip(result.values()) {
        let start = file.len();
        write_array(&mut file, name, value);
        let size = file.len() - start;
        ensure!(
            size <= LARGEST_VARIABLE,
            "{name} has {size} bytes, and a MATLAB file of version 5 holds at most {LARGEST_VARIABLE} of a variable: take version 7.3 (--matlab 7.3), or leave out --histories"
        );
    }
    Ok(file)
}

/// Returns keys as names of variables or fields: letters, digits and underscores after a letter, each name once.
pub(super) fn field_names<'a>(keys: impl Iterator<Item = &'a String>) -> Vec<String> {
    let mut taken = BTreeSet::new();
    let mut one = |key: &String| {
        let mut name: String = key
            .chars()
            .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
            .take(FIELD_NAME - 1)
            .collect();
        if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
            name = format!("x{name}").chars().take(FIELD_NAME - 1).collect();
        }
        let (stem, mut number) = (name.clone(), 2);
        while !taken.insert(name.clone()) {
            let ending = format!("_{number}");
            name = stem.chars().take(FIELD_NAME - 1 - ending.len()).collect::<String>() + &ending;
            number += 1;
        }
        name
    };
    keys.map(&mut one).collect()
}

/// Writes an array with its name; the elements of structures and cells have an empty one.
fn write_array(out: &mut Vec<u8>, name: &str, value: &Value) {
    match value {
        Value::Null => write_numbers(out, name, [0, 0], &[]),
        Value::Bool(truth) => write_truths(out, name, &[*truth]),
        Value::Number(number) => write_numbers(out, name, [1, 1], &[number.as_f64().unwrap_or(f64::NAN)]),
        Value::String(text) => write_text(out, name, text),
        Value::Array(list) => write_list(out, name, list),
        Value::Object(object) => write_structures(out, name, &[object]),
    }
}

fn write_list(out: &mut Vec<u8>, name: &str, list: &[Value]) {
    if let Some(values) = numbers_of(list) {
        return write_numbers(out, name, [values.len(), usize::from(!values.is_empty())], &values);
    }
    if let Some((size, values)) = matrix_of(list) {
        return write_numbers(out, name, size, &values);
    }
    if let Some(truths) = list.iter().map(Value::as_bool).collect::<Option<Vec<bool>>>() {
        return write_truths(out, name, &truths);
    }
    let objects: Option<Vec<&Map<String, Value>>> = list.iter().map(Value::as_object).collect();
    match objects {
        Some(objects) if objects.iter().all(|one| one.keys().eq(objects[0].keys())) => {
            write_structures(out, name, &objects);
        }
        _ => write_cells(out, name, list),
    }
}

/// Returns a list of numbers, with NaN for each that does not exist; `None` if it holds anything else.
pub(super) fn numbers_of(list: &[Value]) -> Option<Vec<f64>> {
    let number = |value: &Value| if value.is_null() { Some(f64::NAN) } else { value.as_f64() };
    list.iter().map(number).collect()
}

/// Returns rows and columns of a list of rows, and its numbers column by column; `None` if it is none.
pub(super) fn matrix_of(list: &[Value]) -> Option<([usize; 2], Vec<f64>)> {
    let rows: Vec<Vec<f64>> =
        list.iter().map(|row| row.as_array().and_then(|row| numbers_of(row))).collect::<Option<_>>()?;
    let columns = rows.first()?.len();
    if rows.iter().any(|row| row.len() != columns) {
        return None;
    }
    let values = (0..columns).flat_map(|j| rows.iter().map(move |row| row[j])).collect();
    Some(([rows.len(), columns], values))
}

/// Writes an element whose data `content` writes, padded to a multiple of 8 bytes.
fn write_element(out: &mut Vec<u8>, kind: u32, content: impl FnOnce(&mut Vec<u8>)) {
    out.extend(kind.to_le_bytes());
    let at = out.len();
    out.extend([0; 4]);
    let start = out.len();
    content(out);
    // a length of more than 32 bits is in a variable that `matlab_file` refuses
    let length = u32::try_from(out.len() - start).unwrap_or(u32::MAX);
    out[at..start].copy_from_slice(&length.to_le_bytes());
    out.resize(out.len().next_multiple_of(8), 0);
}

/// Writes an array: flags, dimensions and name, then the elements that `content` writes.
fn write_matrix(
    out: &mut Vec<u8>,
    name: &str,
    class: u32,
    size: [usize; 2],
    content: impl FnOnce(&mut Vec<u8>),
) {
    write_element(out, MATRIX, |out| {
        write_element(out, UNSIGNED_WORDS, |out| {
            out.extend(class.to_le_bytes());
            out.extend([0; 4]);
        });
        write_element(out, SIGNED_WORDS, |out| {
            size.iter().for_each(|length| out.extend((*length as i32).to_le_bytes()));
        });
        write_element(out, SIGNED_BYTES, |out| out.extend(name.as_bytes()));
        content(out);
    });
}

fn write_numbers(out: &mut Vec<u8>, name: &str, size: [usize; 2], values: &[f64]) {
    write_matrix(out, name, NUMBERS, size, |out| {
        write_element(out, DOUBLES, |out| values.iter().for_each(|value| out.extend(value.to_le_bytes())));
    });
}

fn write_truths(out: &mut Vec<u8>, name: &str, truths: &[bool]) {
    write_matrix(out, name, BYTES | LOGICAL, [truths.len(), 1], |out| {
        write_element(out, UNSIGNED_BYTES, |out| out.extend(truths.iter().map(|truth| u8::from(*truth))));
    });
}

fn write_text(out: &mut Vec<u8>, name: &str, text: &str) {
    let units: Vec<u16> = text.encode_utf16().collect();
    write_matrix(out, name, TEXT, [usize::from(!units.is_empty()), units.len()], |out| {
        write_element(out, CHARACTERS, |out| units.iter().for_each(|unit| out.extend(unit.to_le_bytes())));
    });
}

fn write_cells(out: &mut Vec<u8>, name: &str, list: &[Value]) {
    write_matrix(out, name, CELLS, [list.len(), 1], |out| {
        list.iter().for_each(|value| write_array(out, "", value));
    });
}

/// Writes objects with the same keys as an array of structures.
fn write_structures(out: &mut Vec<u8>, name: &str, objects: &[&Map<String, Value>]) {
    let names = objects.first().map_or_else(Vec::new, |first| field_names(first.keys()));
    write_matrix(out, name, STRUCTURE, [objects.len(), 1], |out| {
        // Octave reads this element only in its short form, which has the length beside the type
        out.extend((4 << 16 | SIGNED_WORDS).to_le_bytes());
        out.extend((FIELD_NAME as u32).to_le_bytes());
        write_element(out, SIGNED_BYTES, |out| {
            for field in &names {
                out.extend(field.as_bytes());
                out.extend(std::iter::repeat_n(0, FIELD_NAME - field.len()));
            }
        });
        for object in objects {
            object.values().for_each(|value| write_array(out, "", value));
        }
    });
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use counterpoise_recordings::read_arrays;
    use serde_json::json;

    fn written(value: &Value) -> Vec<u8> {
        matlab_file(value.as_object().unwrap()).unwrap()
    }

    fn arrays(value: &Value) -> Vec<(String, [usize; 2], Vec<f64>)> {
        let (arrays, _) = read_arrays(&written(value), "result.mat").unwrap();
        let values = |array: &counterpoise_recordings::NamedArray| array.values.iter().copied().collect();
        arrays.iter().map(|a| (a.name.clone(), a.values.dim().into(), values(a))).collect()
    }

    #[test]
    fn numbers_come_back_to_the_last_bit() {
        let values = [f64::MIN_POSITIVE, -0.0, 1.0 / 3.0, f64::MAX, 5e-324];
        let found = arrays(&json!({"a": {"b": values}}));
        assert_eq!(found[0].0, "a.b");
        assert_eq!(found[0].1, [5, 1]);
        assert!(found[0].2.iter().zip(values).all(|(one, other)| one.to_bits() == other.to_bits()));
    }

    #[test]
    fn rows_are_a_matrix_of_their_shape_and_null_is_no_number() {
        let found = arrays(&json!({"A": [[1.0, 2.0, 3.0], [4.0, null, 6.0]], "n": 7}));
        assert_eq!((found[0].0.as_str(), found[0].1), ("A", [2, 3]));
        assert_eq!(found[0].2[..4], [1.0, 2.0, 3.0, 4.0]);
        assert!(found[0].2[4].is_nan());
        assert_eq!(found[1], ("n".to_owned(), [1, 1], vec![7.0]));
    }

    #[test]
    fn keys_become_names_that_matlab_allows() {
        let long = "k".repeat(80);
        let keys = ["a-b", "a_b", "2nd", "", "é", &long, &format!("{long}x")].map(str::to_owned);
        let names = field_names(keys.iter());
        assert_eq!(names[..5], ["a_b", "a_b_2", "x2nd", "x", "x_"]);
        assert_eq!(names[5].len(), 63);
        assert_eq!(names[6], format!("{}_2", "k".repeat(61)));
        let distinct: BTreeSet<&String> = names.iter().collect();
        assert_eq!(distinct.len(), names.len());
    }

    #[test]
    fn every_shape_of_a_result_is_written_and_the_same_twice() {
        let value = json!({
            "empty": {}, "none": null, "list": [], "words": ["a", "", "Höhe"], "mixed": [1, "a", [2, 3], null],
            "ragged": [[1], [2, 3]], "same": [{"x": 1, "y": [1, 2]}, {"x": 2, "y": []}], "other": [{"x": 1}, {"z": 2}],
            "truths": [true, false], "columnless": [[], []]
        });
        let bytes = written(&value);
        assert_eq!(bytes.len() % 8, 0);
        assert_eq!(bytes, written(&value));
        assert!(read_arrays(&bytes, "result.mat").is_ok());
        assert_eq!(written(&json!({})).len(), 128);
    }
}
