//! The numbers of a section of the project file, in groups, each with the path at which it is set.

use toml::{Table, Value};

/// Numbers of one table.
#[derive(Debug, Clone, PartialEq)]
pub struct NumberGroup {
    /// The name of the table, if the section has several.
    pub heading: Option<String>,
    /// The path of the table.
    pub path: String,
    /// Keys with values; an item of a list has its index behind the key.
    pub numbers: Vec<(String, f64)>,
}

/// Returns the table at a path of keys.
fn table_at<'a>(table: &'a Table, path: &str) -> Option<&'a Table> {
    path.split('.').try_fold(table, |table, key| table.get(key)?.as_table())
}

/// Returns whether the file has a section.
pub fn has_section(table: &Table, path: &str) -> bool {
    table_at(table, path).is_some()
}

/// Returns the groups of a section: its own numbers, then those of the tables inside it.
pub fn number_groups(table: &Table, path: &str) -> Vec<NumberGroup> {
    let mut all = Vec::new();
    if let Some(found) = table_at(table, path) {
        collect_groups(found, path, None, &mut all);
    }
    all
}

fn collect_groups(table: &Table, path: &str, heading: Option<String>, all: &mut Vec<NumberGroup>) {
    let numbers: Vec<(String, f64)> = table.iter().flat_map(|(key, value)| numbers_of(key, value)).collect();
    if !numbers.is_empty() {
        all.push(NumberGroup { heading, path: path.to_owned(), numbers });
    }
    for (key, value) in table {
        let words = key.replace('_', " ");
        match value {
            Value::Table(inside) => collect_groups(inside, &format!("{path}.{key}"), Some(words), all),
            Value::Array(items) => {
                for (k, inside) in items.iter().enumerate().filter_map(|(k, i)| Some((k, i.as_table()?))) {
                    let number = (k + 1).to_string();
                    let name = inside.get("name").and_then(Value::as_str).unwrap_or(&number);
                    collect_groups(
                        inside,
                        &format!("{path}.{key}[{k}]"),
                        Some(format!("{words} {name}")),
                        all,
                    );
                }
            }
            _ => {}
        }
    }
}

/// Returns a number, or the numbers of a list.
fn numbers_of(key: &str, value: &Value) -> Vec<(String, f64)> {
    let number = |value: &Value| value.as_float().or_else(|| value.as_integer().map(|v| v as f64));
    match value {
        Value::Array(items) => {
            let one = |(k, item): (usize, &Value)| Some((format!("{key}[{k}]"), number(item)?));
            items.iter().enumerate().filter_map(one).collect()
        }
        _ => number(value).map(|v| (key.to_owned(), v)).into_iter().collect(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn sections_masses_and_items_of_lists_have_paths() {
        let text = include_str!("../../../examples/reference-rig/project.toml");
        let table: Table = text.parse().unwrap();
        let all = number_groups(&table, "plant.beam");
        assert_eq!(all[0].heading, None);
        assert!(all[0].numbers.iter().any(|(key, v)| key == "youngs_modulus" && *v == 205e9));
        let rear = all.iter().find(|g| g.heading.as_deref() == Some("section rear tube")).unwrap();
        assert_eq!(rear.path, "plant.beam.section[1]");
        assert!(rear.numbers.contains(&("outer_diameter[1]".to_owned(), 0.105)));
        assert_eq!(all.iter().filter(|g| g.path.starts_with("plant.beam.mass[")).count(), 5);
        assert!(!has_section(&table, "plant.import"));
    }
}
