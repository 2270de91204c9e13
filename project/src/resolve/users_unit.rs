//! New values in the unit and with the tolerance that the user wrote.

use std::collections::BTreeMap;

use crate::file::tree::{Node, Value};
use crate::file::{Document, EditError, SettingValue};
use crate::unit::rewrite_quantity;

/// Units of the keys by the bytes at which their quantities stand.
type Units = BTreeMap<usize, &'static str>;

impl Document {
    /// Returns the same file with one value set; comments, order and spaces stay. Sections on the way are made. A number that was
    /// written with a unit or a tolerance keeps both. A path names keys and items of lists (from 0), as in
    /// `plant.beam.section[1].to`.
    ///
    /// # Errors
    /// The text is not TOML, the path leads nowhere, the value cannot be written, or it stands in a part.
    pub fn set(&self, path: &str, setting: &SettingValue) -> Result<Self, EditError> {
        self.refuse_part(path)?;
        let (path, setting) = keep_unit(self, path, setting);
        self.replace(&path, &setting)
    }
}

/// Returns path and value that put a new value into the place of an old one, so that its unit and its tolerance stay.
fn keep_unit(document: &Document, path: &str, setting: &SettingValue) -> (String, SettingValue) {
    let Some(node) = document.node_at(path) else { return (path.to_owned(), setting.clone()) };
    let (path, node) = match (&node.value, setting) {
        (Value::Table(entries), SettingValue::Number(_) | SettingValue::Whole(_)) => {
            let value = entries.iter().find(|entry| entry.key == "value");
            value.map_or((path.to_owned(), node), |entry| (format!("{path}.value"), &entry.node))
        }
        _ => (path.to_owned(), node),
    };
    if !has_text(node) {
        return (path, setting.clone());
    }
    let units = super::units(document);
    (path, in_units(node, setting, &units))
}

fn has_text(node: &Node) -> bool {
    match &node.value {
        Value::Text(_) => true,
        Value::List(items) => items.iter().any(has_text),
        _ => false,
    }
}

/// Returns a setting with each number spelt as the old one was; what has another shape is left as it is.
fn in_units(node: &Node, setting: &SettingValue, units: &Units) -> SettingValue {
    let number = |value: f64| match &node.value {
        Value::Text(text) => {
            let unit = units.get(&node.span.start)?;
            rewrite_quantity(text, value, unit).map(SettingValue::Text)
        }
        _ => None,
    };
    let each = |values: Vec<SettingValue>| match &node.value {
        Value::List(items) if items.len() == values.len() => {
            let pairs = items.iter().zip(&values);
            Some(SettingValue::List(pairs.map(|(item, value)| in_units(item, value, units)).collect()))
        }
        _ => None,
    };
    let kept = match setting {
        SettingValue::Number(value) => number(*value),
        SettingValue::Whole(value) => number(*value as f64),
        SettingValue::Numbers(values) => {
            each(values.iter().map(|value| SettingValue::Number(*value)).collect())
        }
        SettingValue::Pairs(pairs) => {
            each(pairs.iter().map(|[a, b]| SettingValue::Numbers(vec![*a, *b])).collect())
        }
        SettingValue::Text(_) | SettingValue::Texts(_) | SettingValue::List(_) => None,
    };
    kept.unwrap_or_else(|| setting.clone())
}
