//! The file as written: a tree of values, each with its place in the text.

use std::ops::Range;

use toml::de::{DeTable, DeValue};

/// A value and where it stands.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    pub span: Range<usize>,
    pub value: Value,
}

/// The kinds of values.
#[derive(Debug, Clone)]
pub(crate) enum Value {
    Number(f64),
    Whole(i64),
    Text(String),
    Flag,
    Date,
    List(Vec<Node>),
    Table(Vec<Entry>),
}

/// A key with its value.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub key: String,
    pub key_span: Range<usize>,
    pub node: Node,
}

/// A mistake in the syntax: where and what.
pub(crate) struct SyntaxError {
    pub span: Range<usize>,
    pub message: String,
}

/// Byte at which a text begins in the count of all texts.
#[derive(Clone, Copy)]
pub(crate) struct Start(pub usize);

impl Start {
    fn shift(self, span: &Range<usize>) -> Range<usize> {
        self.0 + span.start..self.0 + span.end
    }

    fn entries(self, table: &DeTable<'_>) -> Vec<Entry> {
        let entry =
            |(key, value): (&toml::Spanned<toml::de::DeString<'_>>, &toml::Spanned<DeValue<'_>>)| Entry {
                key: key.get_ref().to_string(),
                key_span: self.shift(&key.span()),
                node: self.node(value),
            };
        let mut all: Vec<Entry> = table.iter().map(entry).collect();
        all.sort_by_key(|e| e.key_span.start);
        all
    }

    fn node(self, value: &toml::Spanned<DeValue<'_>>) -> Node {
        Node { span: self.shift(&value.span()), value: self.convert(value.get_ref()) }
    }

    fn convert(self, value: &DeValue<'_>) -> Value {
        match value {
            DeValue::String(text) => Value::Text(text.to_string()),
            DeValue::Integer(whole) => i64::from_str_radix(whole.as_str(), whole.radix())
                .map_or_else(|_| Value::Number(whole.as_str().parse().unwrap_or(f64::NAN)), Value::Whole),
            DeValue::Float(number) => Value::Number(number.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Boolean(_) => Value::Flag,
            DeValue::Datetime(_) => Value::Date,
            DeValue::Array(items) => Value::List(items.iter().map(|item| self.node(item)).collect()),
            DeValue::Table(table) => Value::Table(self.entries(table)),
        }
    }
}

/// Returns the tree of a text that begins at a byte; with mistakes in the syntax, what could still be read.
pub(crate) fn parse(text: &str, start: Start) -> (Vec<Entry>, Vec<SyntaxError>) {
    let (table, errors) = DeTable::parse_recoverable(text);
    let error = |e: &toml::de::Error| SyntaxError {
        span: start.shift(&e.span().unwrap_or(0..0)),
        message: e.message().to_owned(),
    };
    (start.entries(table.get_ref()), errors.iter().map(error).collect())
}

impl Value {
    /// Returns what the value is, in words.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Number(_) => "a number",
            Self::Whole(_) => "a whole number",
            Self::Text(_) => "a text",
            Self::Flag => "true or false",
            Self::Date => "a date",
            Self::List(_) => "a list",
            Self::Table(_) => "a table",
        }
    }
}

/// Returns the node at a path such as `plant.beam.section[1].to`, and whether the whole path is there: if it is not, the node is
/// that of the nearest thing around it.
pub(crate) fn find<'e>(entries: &'e [Entry], path: &str) -> (Option<&'e Node>, Lookup) {
    let (mut entries, mut nearest) = (entries, None);
    for part in path.split('.') {
        let (key, index) = part
            .split_once('[')
            .map_or((part, None), |(k, i)| (k, i.trim_end_matches(']').parse::<usize>().ok()));
        let Some(entry) = entries.iter().find(|e| e.key == key) else { return (nearest, Lookup::Enclosing) };
        let node = match (&entry.node.value, index) {
            (Value::List(items), Some(index)) => match items.get(index) {
                Some(item) => item,
                None => return (Some(&entry.node), Lookup::Enclosing),
            },
            _ => &entry.node,
        };
        nearest = Some(node);
        entries = if let Value::Table(inside) = &node.value { inside } else { &[] };
    }
    (nearest, Lookup::Exact)
}

/// The result of a search: the thing itself or not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Lookup {
    /// The thing itself.
    Exact,
    /// Something around it.
    Enclosing,
}
