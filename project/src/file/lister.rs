//! Lists the fields of resolved sections in canonical order, with path, value and comment.

use super::field::{Fallback, Field, TableField, TableForm};
use super::setting::SettingValue;
use super::visit::{Count, Presence, Visit};

/// One line of the canonical file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Line {
    /// A table starts.
    Open { path: String, form: TableForm, item: bool, meaning: &'static str },
    /// A table ends.
    Close,
    /// A key with its value; `usual` if it is what absence means.
    Value {
        path: String,
        key: String,
        setting: SettingValue,
        unit: &'static str,
        meaning: &'static str,
        usual: bool,
        /// The tolerance as the file spells it, if the value has one.
        tolerance: Option<String>,
    },
}

/// The paths of the tables and lists in which a walk stands.
#[derive(Debug, Default)]
pub(crate) struct Paths {
    tables: Vec<String>,
    lists: Vec<String>,
}

impl Paths {
    /// Returns the path of a key of the table in which the walk stands.
    pub fn of(&self, key: &str) -> String {
        match self.tables.last() {
            Some(path) => format!("{path}.{key}"),
            None => key.to_owned(),
        }
    }

    pub fn enter(&mut self, key: &str) {
        self.tables.push(self.of(key));
    }

    pub fn leave(&mut self) {
        self.tables.pop();
    }

    pub fn enter_list(&mut self, key: &str) {
        self.lists.push(self.of(key));
    }

    /// Steps into an item of the list and returns its path.
    pub fn enter_item(&mut self, index: usize) -> String {
        let path = format!("{}[{index}]", self.lists.last().map_or("", String::as_str));
        self.tables.push(path.clone());
        path
    }

    pub fn leave_list(&mut self) {
        self.lists.pop();
    }
}

/// A walk that changes nothing and writes down what it meets.
#[derive(Debug, Default)]
pub(crate) struct Lister {
    paths: Paths,
    meanings: Vec<&'static str>,
    pub lines: Vec<Line>,
}

impl Lister {
    fn value(&mut self, field: &Field, setting: SettingValue) {
        let &Field { key, unit, meaning, .. } = field;
        self.lines.push(Line::Value {
            path: self.paths.of(key),
            key: key.to_owned(),
            usual: is_usual(field, &setting),
            setting,
            unit,
            meaning,
            tolerance: None,
        });
    }
}

/// Returns whether a value is what the absence of its key means, so that it need not be written.
fn is_usual(field: &Field, setting: &SettingValue) -> bool {
    let is_default = match (setting, &field.default) {
        (SettingValue::Number(value), Fallback::Number(default)) if default == value => true,
        (SettingValue::Number(value), _) => !value.is_finite(),
        (SettingValue::Whole(value), Fallback::Number(default)) => *default == *value as f64,
        (SettingValue::Text(value), Fallback::Text(default)) => default == value,
        (SettingValue::Numbers(values), default) => *default != Fallback::Required && values.is_empty(),
        (SettingValue::Texts(values), default) => *default != Fallback::Required && values.is_empty(),
        (SettingValue::Pairs(values), default) => *default != Fallback::Required && values.is_empty(),
        _ => false,
    };
    is_default && !(field.shown && setting.is_finite())
}

impl Visit for Lister {
    fn number(&mut self, field: &Field, value: &mut f64) {
        self.value(field, SettingValue::Number(*value));
    }

    fn whole_number(&mut self, field: &Field, value: &mut u32) {
        self.value(field, SettingValue::Whole(i64::from(*value)));
    }

    fn text(&mut self, field: &Field, value: &mut String) {
        self.value(field, SettingValue::Text(value.clone()));
    }

    fn choice(&mut self, field: &Field, _allowed: &[&'static str], value: &mut &'static str) {
        self.value(field, SettingValue::Text((*value).to_owned()));
    }

    fn numbers(&mut self, field: &Field, _count: Count, value: &mut Vec<f64>) {
        self.value(field, SettingValue::Numbers(value.clone()));
    }

    fn texts(&mut self, field: &Field, value: &mut Vec<String>) {
        self.value(field, SettingValue::Texts(value.clone()));
    }

    fn pairs(&mut self, field: &Field, value: &mut Vec<[f64; 2]>) {
        self.value(field, SettingValue::Pairs(value.clone()));
    }

    fn enter(&mut self, table: &TableField, presence: Presence) -> bool {
        if presence == Presence::Present {
            let path = self.paths.of(table.key);
            self.lines.push(Line::Open { path, form: table.form, item: false, meaning: table.meaning });
            self.paths.enter(table.key);
        }
        presence == Presence::Present
    }

    fn leave(&mut self) {
        self.paths.leave();
        self.lines.push(Line::Close);
    }

    fn enter_list(&mut self, table: &TableField, length: usize) -> usize {
        self.paths.enter_list(table.key);
        self.meanings.push(table.meaning);
        length
    }

    fn enter_item(&mut self, index: usize) {
        let meaning = self.meanings.last().copied().unwrap_or_default();
        let path = self.paths.enter_item(index);
        self.lines.push(Line::Open { path, form: TableForm::Section, item: true, meaning });
    }

    fn leave_list(&mut self) {
        self.paths.leave_list();
        self.meanings.pop();
    }
}
