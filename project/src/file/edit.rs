//! Changes single values of a file and leaves everything else of it, comments and order included, as it is.

use toml_edit::{DocumentMut, Item, Table, TableLike, Value};

use super::setting::SettingValue;

/// Why a value could not be set.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// The text is not TOML, so that nothing in it can be set.
    #[error("the file is not TOML: {why}")]
    NotToml {
        /// The message of the parser.
        why: String,
    },
    /// The path does not name a key.
    #[error("\"{path}\" does not name a key")]
    BadPath {
        /// The path.
        path: String,
    },
    /// The path leads through something that is not a table.
    #[error("\"{path}\": \"{part}\" is not a table")]
    NotATable {
        /// The path.
        path: String,
        /// The part that is no table.
        part: String,
    },
    /// An item beyond the end of a list.
    #[error("\"{path}\": there is no item {index} in \"{part}\" with its {length} items")]
    NoSuchItem {
        /// The path.
        path: String,
        /// The list.
        part: String,
        /// The index asked for, from 0.
        index: usize,
        /// Number of items.
        length: usize,
    },
    /// A value that stands in a part, which other projects may share.
    #[error(
        "\"{path}\" stands in the part \"{part}\", which other projects may share: change it in that file"
    )]
    InPart {
        /// The path.
        path: String,
        /// The part's file.
        part: String,
    },
    /// A number that a file cannot hold.
    #[error("\"{path}\" cannot be set to {value}")]
    BadValue {
        /// The path.
        path: String,
        /// The value as spelt.
        value: String,
    },
}

/// Returns an edited text with the line ends of the one that it came from: the editor writes those of Unix.
fn with_line_ends_of(given: &str, edited: String) -> String {
    let windows = given.matches("\r\n").count();
    if windows == 0 || windows < given.matches('\n').count() {
        return edited;
    }
    edited.replace("\r\n", "\n").replace('\n', "\r\n")
}

/// One step of a path: a key, and the item of a list of tables.
struct Step<'a> {
    key: &'a str,
    index: Option<usize>,
}

fn steps(path: &str) -> Result<Vec<Step<'_>>, EditError> {
    let bad = || EditError::BadPath { path: path.to_owned() };
    let step = |part| -> Result<Step<'_>, EditError> {
        let (key, index) = match str::split_once(part, '[') {
            None => (part, None),
            Some((key, rest)) => {
                (key, Some(rest.strip_suffix(']').and_then(|i| i.parse().ok()).ok_or_else(bad)?))
            }
        };
        if key.is_empty() { Err(bad()) } else { Ok(Step { key, index }) }
    };
    path.split('.').map(step).collect()
}

/// Returns the text with the value at the path set; tables on the way are made.
pub(crate) fn set(text: &str, path: &str, setting: &SettingValue) -> Result<String, EditError> {
    let mut document = parse_text(text)?;
    let value = setting
        .to_toml()
        .map_err(|_| EditError::BadValue { path: path.to_owned(), value: setting.as_written() })?;
    let steps = steps(path)?;
    let Some((last, way)) = steps.split_last() else {
        return Err(EditError::BadPath { path: path.to_owned() });
    };
    let table = walk(document.as_table_mut(), way, path)?;
    match last.index {
        None => put(table, last.key, value),
        Some(index) => put_item(table, last.key, index, value, path)?,
    }
    Ok(with_line_ends_of(text, document.to_string()))
}

/// Returns the text with a key of the outermost table set; a new key stands before all others.
pub(crate) fn set_first(text: &str, key: &str, setting: &SettingValue) -> Result<String, EditError> {
    let document = parse_text(text)?;
    if document.contains_key(key) {
        return set(text, key, setting);
    }
    let end = if text.contains("\r\n") { "\r\n" } else { "\n" };
    let line = format!("{key} = {}{end}", setting.as_written());
    // Comments at the top belong to the whole file: the key follows them, before an empty line or the first key.
    let top = text.lines().take_while(|line| line.trim_start().starts_with('#')).count();
    let at: usize = text.split_inclusive('\n').take(top).map(str::len).sum();
    let (before, after) = text.split_at(at);
    let gap = if before.is_empty() || before.ends_with('\n') { "" } else { "\n" };
    Ok(format!("{before}{gap}{line}{after}"))
}

/// Returns the text without the key, table or item of a list of tables at the path; the same text if it is
/// not there.
pub(crate) fn remove(text: &str, path: &str) -> Result<String, EditError> {
    let mut document = parse_text(text)?;
    let steps = steps(path)?;
    let Some((last, way)) = steps.split_last() else {
        return Err(EditError::BadPath { path: path.to_owned() });
    };
    let table = walk(document.as_table_mut(), way, path)?;
    match (last.index, table.get_mut(last.key)) {
        (None, _) => {
            table.remove(last.key);
        }
        (Some(index), Some(Item::ArrayOfTables(items))) if index < items.len() => {
            items.remove(index);
        }
        (Some(_), _) => {}
    }
    Ok(with_line_ends_of(text, document.to_string()))
}

fn parse_text(text: &str) -> Result<DocumentMut, EditError> {
    text.parse().map_err(|e: toml_edit::TomlError| EditError::NotToml { why: e.message().to_owned() })
}

/// Puts a value in the place of the old one, with the old one's spaces and comment.
fn put(table: &mut dyn TableLike, key: &str, mut value: Value) {
    match table.get_mut(key) {
        Some(Item::Value(old)) => {
            *value.decor_mut() = old.decor().clone();
            *old = value;
        }
        _ => {
            table.insert(key, Item::Value(value));
        }
    }
}

/// Puts a value in the place of an item of a list of values.
fn put_item(
    table: &mut dyn TableLike,
    key: &str,
    index: usize,
    mut value: Value,
    path: &str,
) -> Result<(), EditError> {
    let list = table.get_mut(key).and_then(Item::as_array_mut);
    let length = list.as_ref().map_or(0, |items| items.len());
    let Some(old) = list.and_then(|items| items.get_mut(index)) else {
        return Err(EditError::NoSuchItem { path: path.to_owned(), part: key.to_owned(), index, length });
    };
    *value.decor_mut() = old.decor().clone();
    *old = value;
    Ok(())
}

fn walk<'t>(
    table: &'t mut dyn TableLike,
    way: &[Step<'_>],
    path: &str,
) -> Result<&'t mut dyn TableLike, EditError> {
    let Some((step, rest)) = way.split_first() else { return Ok(table) };
    let item =
        table.entry(step.key).or_insert_with(|| if step.index.is_some() { no_items() } else { implicit() });
    let next = match step.index {
        None => item.as_table_like_mut(),
        Some(index) => item_of(item, step.key, index, path)?,
    };
    let next =
        next.ok_or_else(|| EditError::NotATable { path: path.to_owned(), part: step.key.to_owned() })?;
    walk(next, rest, path)
}

/// Returns a new table that gets a header only when it has keys of its own.
fn implicit() -> Item {
    let mut table = Table::new();
    table.set_implicit(true);
    Item::Table(table)
}

fn no_items() -> Item {
    Item::ArrayOfTables(toml_edit::ArrayOfTables::new())
}

/// Returns an item of a list of tables; the one after the last is made.
fn item_of<'t>(
    item: &'t mut Item,
    key: &str,
    index: usize,
    path: &str,
) -> Result<Option<&'t mut dyn TableLike>, EditError> {
    let length = item
        .as_array_of_tables()
        .map_or_else(|| item.as_array().map_or(0, toml_edit::Array::len), toml_edit::ArrayOfTables::len);
    if let (Item::ArrayOfTables(tables), true) = (&mut *item, index == length) {
        tables.push(Table::new());
    } else if index >= length {
        return Err(EditError::NoSuchItem { path: path.to_owned(), part: key.to_owned(), index, length });
    }
    Ok(match item {
        Item::ArrayOfTables(tables) => tables.get_mut(index).map(|t| t as &mut dyn TableLike),
        Item::Value(Value::Array(items)) => {
            items.get_mut(index).and_then(Value::as_inline_table_mut).map(|t| t as &mut dyn TableLike)
        }
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    const TEXT: &str = "[[beam.section]]\nouter = [0.2,  0.1] # m\n[[beam.section]]\nouter = [0.1]\n";

    #[test]
    fn an_item_of_a_list_is_set_and_the_rest_of_the_file_stays() {
        let set = |path: &str| set(TEXT, path, &SettingValue::Number(0.15));
        let done = set("beam.section[0].outer[1]").unwrap();
        assert_eq!(done, TEXT.replace("0.2,  0.1]", "0.2,  0.15]"));
        assert_eq!(set("beam.section[1].outer[0]").unwrap(), TEXT.replace("outer = [0.1]", "outer = [0.15]"));
        let why = set("beam.section[1].outer[4]").unwrap_err();
        assert!(matches!(why, EditError::NoSuchItem { index: 4, length: 1, .. }), "{why}");
        assert!(set("beam.section[1].inner[0]").is_err(), "a list that is not there has no items");
    }
}
