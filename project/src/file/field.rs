//! What a key of the file holds: its unit, range, default and meaning.

use counterpoise_models::Range;

/// One key of a table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Field {
    pub key: &'static str,
    pub unit: &'static str,
    pub limit: Limit,
    pub default: Fallback,
    pub meaning: &'static str,
    /// The canonical text has the key even where absence means the same.
    pub shown: bool,
}

/// The range of a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Limit {
    Any,
    Above(f64),
    AtLeast(f64),
    Between(f64, f64),
    AboveTo(f64, f64),
    Not0,
}

/// What a key that is not written means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Fallback {
    /// The key must be written.
    Required,
    Number(f64),
    Text(&'static str),
    Empty,
}

/// How a table stands in the file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TableField {
    pub key: &'static str,
    pub need: Need,
    pub form: Form,
    pub meaning: &'static str,
}

/// Whether a table must be there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Need {
    Required,
    Optional,
}

/// How the canonical writer sets a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Form {
    Section,
    Inline,
}

impl Field {
    /// A key that must be there, of any value.
    pub const fn new(key: &'static str, meaning: &'static str) -> Self {
        Self { key, unit: "", limit: Limit::Any, default: Fallback::Required, meaning, shown: false }
    }

    pub const fn unit(mut self, unit: &'static str) -> Self {
        self.unit = unit;
        self
    }

    pub const fn limit(mut self, limit: Limit) -> Self {
        self.limit = limit;
        self
    }

    pub const fn shown(mut self) -> Self {
        self.shown = true;
        self
    }

    /// The number that is meant when the key is absent.
    pub const fn or(mut self, default: f64) -> Self {
        self.default = Fallback::Number(default);
        self
    }

    /// The text that is meant when the key is absent.
    pub const fn or_text(mut self, default: &'static str) -> Self {
        self.default = Fallback::Text(default);
        self
    }

    /// An absent key means an empty list.
    pub const fn or_empty(mut self) -> Self {
        self.default = Fallback::Empty;
        self
    }
}

impl TableField {
    pub const fn required(key: &'static str, meaning: &'static str) -> Self {
        Self { key, need: Need::Required, form: Form::Section, meaning }
    }

    pub const fn optional(key: &'static str, meaning: &'static str) -> Self {
        Self { key, need: Need::Optional, form: Form::Section, meaning }
    }

    pub const fn inline(key: &'static str, meaning: &'static str) -> Self {
        Self { key, need: Need::Optional, form: Form::Inline, meaning }
    }
}

impl Limit {
    /// The limit that stands for a range of the models.
    pub const fn of(range: Range) -> Self {
        match range {
            Range::Any => Self::Any,
            Range::Above(low) => Self::Above(low),
            Range::AtLeast(low) => Self::AtLeast(low),
            Range::Between(low, high) => Self::Between(low, high),
            Range::AboveTo(low, high) => Self::AboveTo(low, high),
        }
    }

    pub fn holds(self, value: f64) -> bool {
        match self {
            Self::Any => true,
            Self::Above(low) => value > low,
            Self::AtLeast(low) => value >= low,
            Self::Between(low, high) => (low..=high).contains(&value),
            Self::AboveTo(low, high) => value > low && value <= high,
            Self::Not0 => value != 0.0,
        }
    }

    /// The range in words, with the unit.
    pub fn words(self, unit: &str) -> String {
        let u = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        match self {
            Self::Any => {
                format!("must be a finite number{}", if unit.is_empty() { u } else { format!(" in{u}") })
            }
            Self::Above(low) => format!("must be above {low}{u}"),
            Self::AtLeast(low) => format!("must be at least {low}{u}"),
            Self::Between(low, high) => format!("must be between {low} and {high}{u}"),
            Self::AboveTo(low, high) => format!("must be above {low} and at most {high}{u}"),
            Self::Not0 => format!("must not be 0{u}"),
        }
    }
}
