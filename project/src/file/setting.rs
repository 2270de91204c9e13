//! A value to be put into a file, and how it is spelt.

/// A value of a key.
#[derive(Debug, Clone, PartialEq)]
pub enum SettingValue {
    /// A number.
    Number(f64),
    /// A whole number.
    Whole(i64),
    /// A text.
    Text(String),
    /// A list of numbers.
    Numbers(Vec<f64>),
    /// A list of texts.
    Texts(Vec<String>),
    /// A list of pairs of numbers.
    Pairs(Vec<[f64; 2]>),
    /// A list of values of any kind.
    List(Vec<SettingValue>),
}

/// Words for a number without a limit, where its absence means the same.
pub(crate) const UNLIMITED: [&str; 2] = ["unlimited", "rigid"];

/// Below this size, and from the next on, a number is written with an exponent.
const SMALLEST_PLAIN: f64 = 1e-3;
const LARGEST_PLAIN: f64 = 1e6;

/// Returns a number in the shortest form that reads back as the same number.
pub(crate) fn number(value: f64) -> String {
    let size = value.abs();
    if value == f64::INFINITY {
        return quote(UNLIMITED[0]);
    }
    if value == 0.0 || (SMALLEST_PLAIN..LARGEST_PLAIN).contains(&size) {
        format!("{value:?}")
    } else {
        format!("{value:e}")
    }
}

/// Returns a text in quotes.
pub(crate) fn quote(text: &str) -> String {
    toml_edit::Value::from(text).to_string()
}

fn list<T>(items: &[T], spell: impl Fn(&T) -> String) -> String {
    format!("[{}]", items.iter().map(spell).collect::<Vec<_>>().join(", "))
}

impl SettingValue {
    /// Returns the value as the file spells it.
    pub fn as_written(&self) -> String {
        match self {
            Self::Number(value) => number(*value),
            Self::Whole(value) => value.to_string(),
            Self::Text(text) => quote(text),
            Self::Numbers(values) => list(values, |v| number(*v)),
            Self::Texts(texts) => list(texts, |t| quote(t)),
            Self::Pairs(pairs) => list(pairs, |[a, b]| format!("[{}, {}]", number(*a), number(*b))),
            Self::List(items) => list(items, Self::as_written),
        }
    }

    /// Returns whether the value can be written.
    pub(crate) fn is_finite(&self) -> bool {
        !matches!(self, Self::Number(value) if !value.is_finite())
    }

    pub(crate) fn to_toml(&self) -> Result<toml_edit::Value, toml_edit::TomlError> {
        self.as_written().parse()
    }
}
