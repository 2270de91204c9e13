//! Lists the fields of resolved sections in canonical order, with path, value and comment.

use super::field::{Fallback, Field, Form, TableField};
use super::setting::Setting;
use super::visit::{Count, Visit};

/// One line of the canonical file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Line {
    /// A table starts.
    Open { path: String, form: Form, item: bool, meaning: &'static str },
    /// A table ends.
    Close,
    /// A key with its value; `usual` if it is what absence means.
    Value {
        path: String,
        key: String,
        setting: Setting,
        unit: &'static str,
        meaning: &'static str,
        usual: bool,
    },
}

/// A walk that changes nothing and writes down what it meets.
#[derive(Debug, Default)]
pub(crate) struct Lister {
    paths: Vec<String>,
    lists: Vec<(String, &'static str)>,
    pub lines: Vec<Line>,
}

impl Lister {
    fn path(&self, key: &str) -> String {
        match self.paths.last() {
            Some(path) => format!("{path}.{key}"),
            None => key.to_owned(),
        }
    }

    fn value(&mut self, field: &Field, setting: Setting, usual: bool) {
        let &Field { key, unit, meaning, shown, .. } = field;
        let usual = usual && !(shown && setting.is_finite());
        self.lines.push(Line::Value {
            path: self.path(key),
            key: key.to_owned(),
            setting,
            unit,
            meaning,
            usual,
        });
    }

    fn open(&mut self, path: String, form: Form, item: bool, meaning: &'static str) {
        self.lines.push(Line::Open { path: path.clone(), form, item, meaning });
        self.paths.push(path);
    }
}

impl Visit for Lister {
    fn number(&mut self, field: &Field, value: &mut f64) {
        let usual = matches!(field.default, Fallback::Number(d) if d == *value) || !value.is_finite();
        self.value(field, Setting::Number(*value), usual);
    }

    fn whole(&mut self, field: &Field, value: &mut u32) {
        let usual = matches!(field.default, Fallback::Number(d) if d == f64::from(*value));
        self.value(field, Setting::Whole(i64::from(*value)), usual);
    }

    fn text(&mut self, field: &Field, value: &mut String) {
        let usual = matches!(field.default, Fallback::Text(d) if d == value);
        self.value(field, Setting::Text(value.clone()), usual);
    }

    fn choice(&mut self, field: &Field, _allowed: &[&'static str], value: &mut &'static str) {
        let usual = matches!(field.default, Fallback::Text(d) if d == *value);
        self.value(field, Setting::Text((*value).to_owned()), usual);
    }

    fn numbers(&mut self, field: &Field, _count: Count, value: &mut Vec<f64>) {
        let usual = field.default != Fallback::Required && value.is_empty();
        self.value(field, Setting::Numbers(value.clone()), usual);
    }

    fn texts(&mut self, field: &Field, value: &mut Vec<String>) {
        let usual = field.default != Fallback::Required && value.is_empty();
        self.value(field, Setting::Texts(value.clone()), usual);
    }

    fn pairs(&mut self, field: &Field, value: &mut Vec<[f64; 2]>) {
        let usual = field.default != Fallback::Required && value.is_empty();
        self.value(field, Setting::Pairs(value.clone()), usual);
    }

    fn enter(&mut self, table: &TableField, present: bool) -> bool {
        if present {
            self.open(self.path(table.key), table.form, false, table.meaning);
        }
        present
    }

    fn leave(&mut self) {
        self.paths.pop();
        self.lines.push(Line::Close);
    }

    fn enter_list(&mut self, table: &TableField, length: usize) -> usize {
        self.lists.push((self.path(table.key), table.meaning));
        length
    }

    fn enter_item(&mut self, index: usize) {
        let (path, meaning) = self.lists.last().cloned().unwrap_or_default();
        self.open(format!("{path}[{index}]"), Form::Section, true, meaning);
    }

    fn leave_list(&mut self) {
        self.lists.pop();
    }

    fn complain(&mut self, _key: &str, _allowed: &str, _hint: Option<String>) {}

    fn attached(&mut self, _name: &str) -> Option<Result<String, String>> {
        None
    }

    fn shorthand(&mut self, _key: &str, _value: &mut String) -> bool {
        false
    }
}
