//! The numbers of a section of the project file, as its text holds them: by group, each with the path at which it is set.

use toml::{Table, Value};

/// Numbers that stand together.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// What they are of, where the section has several such.
    pub heading: Option<String>,
    /// The path of their table.
    pub path: String,
    /// Keys with values; an item of a list has its index behind the key.
    pub numbers: Vec<(String, f64)>,
}

/// The table at a path of keys.
fn at<'a>(table: &'a Table, path: &str) -> Option<&'a Table> {
    path.split('.').try_fold(table, |table, key| table.get(key)?.as_table())
}

/// Whether the file has such a section.
pub fn has(table: &Table, path: &str) -> bool {
    at(table, path).is_some()
}

/// The groups of a section: its own numbers, then those of the tables inside it, by their keys.
pub fn groups(table: &Table, path: &str) -> Vec<Group> {
    let mut all = Vec::new();
    if let Some(found) = at(table, path) {
        gather(found, path, None, &mut all);
    }
    all
}

fn gather(table: &Table, path: &str, heading: Option<String>, all: &mut Vec<Group>) {
    let numbers: Vec<(String, f64)> = table.iter().flat_map(|(key, value)| numbers(key, value)).collect();
    if !numbers.is_empty() {
        all.push(Group { heading, path: path.to_owned(), numbers });
    }
    for (key, value) in table {
        let words = key.replace('_', " ");
        match value {
            Value::Table(inside) => gather(inside, &format!("{path}.{key}"), Some(words), all),
            Value::Array(items) => {
                for (k, inside) in items.iter().enumerate().filter_map(|(k, i)| Some((k, i.as_table()?))) {
                    let number = (k + 1).to_string();
                    let name = inside.get("name").and_then(Value::as_str).unwrap_or(&number);
                    gather(inside, &format!("{path}.{key}[{k}]"), Some(format!("{words} {name}")), all);
                }
            }
            _ => {}
        }
    }
}

/// A number, or the numbers of a list.
fn numbers(key: &str, value: &Value) -> Vec<(String, f64)> {
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
        let all = groups(&table, "plant.beam");
        assert_eq!(all[0].heading, None);
        assert!(all[0].numbers.iter().any(|(key, v)| key == "youngs_modulus" && *v == 205e9));
        let rear = all.iter().find(|g| g.heading.as_deref() == Some("section rear tube")).unwrap();
        assert_eq!(rear.path, "plant.beam.section[1]");
        assert!(rear.numbers.contains(&("outer_diameter[1]".to_owned(), 0.105)));
        assert_eq!(all.iter().filter(|g| g.path.starts_with("plant.beam.mass[")).count(), 5);
        assert!(!has(&table, "plant.import"));
    }
}
