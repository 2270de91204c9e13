//! The description of a key of the file: its unit, range, default and meaning.

use counterpoise_models::Range;

/// One key of a table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Field {
    pub key: &'static str,
    pub unit: &'static str,
    pub limit: NumberRange,
    pub default: Fallback,
    pub meaning: &'static str,
    /// The canonical text has the key even where absence means the same.
    pub shown: bool,
    /// Unit of the second number of each pair, if it is not that of the first.
    pub second_unit: Option<&'static str>,
    /// By which rule the default stands in for a value that is not known.
    pub assumed: Option<DefaultRule>,
    /// Advice for a required key whose value is not known.
    pub unknown: &'static str,
    /// Units of another quantity that people write here, each with what to add.
    pub unit_hints: &'static [UnitHint],
}

/// A unit of another quantity, which means another choice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct UnitHint {
    pub unit: &'static str,
    /// Advice for a value in this unit.
    pub add: &'static str,
}

/// By which rule a default stands in for a value that is not known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DefaultRule {
    /// The rule, as in "equal to the torque constant".
    pub rule: &'static str,
    /// Why the rule holds, or where it comes from.
    pub source: &'static str,
    /// Usual deviation of the true value from the default.
    pub usual: UsualRange,
}

/// The usual distance of the true value from a default.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum UsualRange {
    /// From the first to the second multiple of the default.
    Factors(f64, f64),
    /// From the first to the second value, in the unit of the key.
    Values(f64, f64),
    /// Nothing is known about it.
    Unknown,
}

/// The range of a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum NumberRange {
    Any,
    Above(f64),
    AtLeast(f64),
    Between(f64, f64),
    AboveTo(f64, f64),
    Not0,
}

/// The meaning of a key that is not written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Fallback {
    /// The key must be written.
    Required,
    Number(f64),
    Text(&'static str),
    Empty,
}

/// The form of a table in the file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TableField {
    pub key: &'static str,
    pub need: Need,
    pub form: TableForm,
    pub meaning: &'static str,
    /// The smallest content, for a table that must be there; empty if there is none to name.
    pub smallest: &'static str,
}

/// The need for a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Need {
    Required,
    Optional,
}

/// The form in which the canonical writer sets a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum TableForm {
    Section,
    Inline,
}

impl Field {
    /// Returns a key that must be there, of any value.
    pub const fn new(key: &'static str, meaning: &'static str) -> Self {
        Self {
            key,
            unit: "",
            limit: NumberRange::Any,
            default: Fallback::Required,
            meaning,
            shown: false,
            second_unit: None,
            assumed: None,
            unknown: "",
            unit_hints: &[],
        }
    }

    /// Declares what a value in the unit of another quantity means.
    pub const fn with_unit_hints(mut self, hints: &'static [UnitHint]) -> Self {
        self.unit_hints = hints;
        self
    }

    pub const fn unit(mut self, unit: &'static str) -> Self {
        self.unit = unit;
        self
    }

    /// Returns the units of the two numbers of each pair.
    pub const fn units(mut self, first: &'static str, second: &'static str) -> Self {
        self.unit = first;
        self.second_unit = Some(second);
        self
    }

    /// Returns the field of one number of a list: the second one of a pair has a unit of its own.
    pub fn item(self, index: usize) -> Self {
        match self.second_unit {
            Some(unit) if index % 2 == 1 => Self { unit, ..self },
            _ => self,
        }
    }

    /// Declares that the default stands in for a value that is not known, by a rule. The rule and its source are phrases without a
    /// full stop.
    pub const fn with_assumption(
        mut self,
        rule: &'static str,
        source: &'static str,
        usual: UsualRange,
    ) -> Self {
        self.assumed = Some(DefaultRule { rule, source, usual });
        self
    }

    /// Returns what to do if the value of this required key is not known.
    pub const fn if_unknown(mut self, what: &'static str) -> Self {
        self.unknown = what;
        self
    }

    pub const fn limit(mut self, limit: NumberRange) -> Self {
        self.limit = limit;
        self
    }

    pub const fn show_default(mut self) -> Self {
        self.shown = true;
        self
    }

    /// Returns the number that is meant when the key is absent.
    pub const fn or(mut self, default: f64) -> Self {
        self.default = Fallback::Number(default);
        self
    }

    /// Returns the text that is meant when the key is absent.
    pub const fn or_text(mut self, default: &'static str) -> Self {
        self.default = Fallback::Text(default);
        self
    }

    /// Declares that an absent key means an empty list.
    pub const fn or_empty(mut self) -> Self {
        self.default = Fallback::Empty;
        self
    }
}

impl TableField {
    pub const fn mandatory(key: &'static str, meaning: &'static str) -> Self {
        Self { key, need: Need::Required, form: TableForm::Section, meaning, smallest: "" }
    }

    pub const fn optional(key: &'static str, meaning: &'static str) -> Self {
        Self { key, need: Need::Optional, form: TableForm::Section, meaning, smallest: "" }
    }

    pub const fn inline(key: &'static str, meaning: &'static str) -> Self {
        Self { key, need: Need::Optional, form: TableForm::Inline, meaning, smallest: "" }
    }

    /// Sets the smallest content, as it is written in a file.
    pub const fn with_smallest(mut self, content: &'static str) -> Self {
        self.smallest = content;
        self
    }
}

impl NumberRange {
    /// Returns the limit that stands for a range of the models.
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

    /// Returns the range in words, with the unit.
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
