//! The reading of numbers: bare, with a unit, or with a tolerance; and what it notes of them.

use super::Reader;
use crate::assumption::{Assumption, KeyTolerance, ToleranceKind};
use crate::diagnostic::DiagnosticKind;
use crate::file::field::{DefaultRule, Fallback, Field, NumberRange, UnitHint, UsualRange};
use crate::file::setting::UNLIMITED;
use crate::file::source::Remark;
use crate::file::tree::{Entry, Node, Value};
use crate::tolerance::NUMBER_SIZES;
use crate::unit::read_quantity;

/// The section of physical quantities: what is absent in it is assumed.
pub(super) const PHYSICAL: &str = "plant.";

impl<'a> Reader<'a> {
    /// Returns the number at a key, which may have a tolerance.
    pub(super) fn keyed_number(&mut self, path: &str, node: &'a Node, field: &Field) -> Option<f64> {
        let may_be_unlimited = field.default == Fallback::Number(f64::INFINITY);
        if may_be_unlimited && matches!(&node.value, Value::Text(text) if UNLIMITED.contains(&text.as_str()))
        {
            return Some(f64::INFINITY);
        }
        let Value::Table(entries) = &node.value else { return self.number_at(path, node, field) };
        let Some(value) = entries.iter().find(|entry| entry.key == "value") else {
            self.wrong_type(path, node, &format!("a number{}", in_unit(field.unit)));
            return None;
        };
        let number = self.number_at(path, &value.node, field)?;
        self.tolerance(path, entries, number, field);
        Some(number)
    }

    /// Reads the tolerance of a value, and whatever else stands beside the value.
    fn tolerance(&mut self, path: &str, entries: &'a [Entry], value: f64, field: &Field) {
        for entry in entries.iter().filter(|entry| !["value", "tolerance"].contains(&entry.key.as_str())) {
            let path = format!("{path}.{}", entry.key);
            let allowed = "there is no such key; known here: value, tolerance";
            self.report(entry.key_span.start, Remark::new(DiagnosticKind::UnknownKey, &path, allowed));
        }
        let Some(entry) = entries.iter().find(|entry| entry.key == "tolerance") else { return };
        let (path_of_it, node) = (format!("{path}.tolerance"), &entry.node);
        let Some((half_width, kind)) = self.half_width(&path_of_it, node, value, field) else { return };
        if half_width == 0.0 {
            return;
        }
        let (low, high) = (value - half_width, value + half_width);
        if !(field.limit.holds(low) && field.limit.holds(high)) {
            let u = if field.unit.is_empty() { String::new() } else { format!(" {}", field.unit) };
            let what =
                format!("reaches from {low} to {high}{u}, but {path} {}", field.limit.words(field.unit));
            self.refuse(&path_of_it, node, DiagnosticKind::Conflict, what);
            return;
        }
        self.tolerances.push(KeyTolerance {
            key: path.to_owned(),
            value,
            half_width,
            unit: field.unit,
            kind,
        });
    }

    /// Returns the half-width of a tolerance: relative if it is a pure number, else in the unit of the value.
    fn half_width(
        &mut self,
        path: &str,
        node: &'a Node,
        value: f64,
        field: &Field,
    ) -> Option<(f64, ToleranceKind)> {
        let relative = match &node.value {
            Value::Number(value) => Ok(*value),
            Value::Whole(value) => Ok(*value as f64),
            Value::Text(text) => read_quantity(text, ""),
            _ => {
                self.wrong_type(path, node, "a number (relative), or a quantity (absolute)");
                return None;
            }
        };
        let (half_width, kind) = match (relative, &node.value) {
            (Ok(relative), _) => (relative * value.abs(), ToleranceKind::Relative),
            (Err(_), Value::Text(text)) if !field.unit.is_empty() => {
                let absolute = read_quantity(text, field.unit);
                let told = |error: &crate::unit::QuantityError| format!("{error}; or a relative half-width");
                match absolute {
                    Ok(absolute) => (absolute, ToleranceKind::Absolute),
                    Err(error) => {
                        self.refuse(path, node, DiagnosticKind::WrongType, told(&error));
                        return None;
                    }
                }
            }
            (Err(error), _) => {
                self.refuse(path, node, DiagnosticKind::WrongType, error.to_string());
                return None;
            }
        };
        if half_width.is_finite() && half_width >= 0.0 {
            return Some((half_width, kind));
        }
        self.refuse(
            path,
            node,
            DiagnosticKind::OutOfRange,
            "must be a finite number that is at least 0".to_owned(),
        );
        None
    }

    /// Returns a number at a node that obeys a field's range.
    pub(super) fn number_at(&mut self, path: &str, node: &Node, field: &Field) -> Option<f64> {
        let value = match &node.value {
            Value::Number(value) => *value,
            Value::Whole(value) => *value as f64,
            Value::Text(text) => self.quantity(path, node, text, field)?,
            _ => {
                self.wrong_type(path, node, &format!("a number{}", in_unit(field.unit)));
                return None;
            }
        };
        if !value.is_finite() {
            let range = if field.limit == NumberRange::Any {
                String::new()
            } else {
                format!("; it {}", field.limit.words(field.unit))
            };
            self.refuse(path, node, DiagnosticKind::NotFinite, format!("must be a finite number{range}"));
            return None;
        }
        if value != 0.0 && !NUMBER_SIZES.contains(&value.abs()) {
            let allowed = format!(
                "must be 0 or of a size between {:e} and {:e}",
                NUMBER_SIZES.start(),
                NUMBER_SIZES.end()
            );
            self.refuse(path, node, DiagnosticKind::OutOfRange, allowed);
            return None;
        }
        if !field.limit.holds(value) {
            self.refuse(path, node, DiagnosticKind::OutOfRange, field.limit.words(field.unit));
            return None;
        }
        Some(value)
    }

    /// Returns a number with a unit, in the unit of the field.
    pub(super) fn quantity(&mut self, path: &str, node: &Node, text: &str, field: &Field) -> Option<f64> {
        self.units.insert(node.span.start, field.unit);
        match read_quantity(text, field.unit) {
            Ok(value) => Some(value),
            Err(error) => {
                let remark = Remark::new(DiagnosticKind::WrongType, path, error.to_string())
                    .with_value(self.source.quote(&node.span))
                    .hint(meant_by_unit(text, field).or_else(|| error.hint()));
                self.report(node.span.start, remark);
                None
            }
        }
    }

    /// Notes that a default stands in for a physical quantity that is not written.
    pub(super) fn note_default(&mut self, field: &Field) {
        let Fallback::Number(value) = field.default else { return };
        let path = self.path(field.key);
        if !value.is_nan() && path.starts_with(PHYSICAL) {
            self.note(path, field, value);
        }
    }

    /// Notes that a physical quantity is written that has the value of its default.
    pub(super) fn note_stated(&mut self, field: &Field, value: f64) {
        let path = self.path(field.key);
        if field.default == Fallback::Number(value) && path.starts_with(PHYSICAL) {
            self.stated_defaults.insert(path);
        }
    }

    pub(super) fn note(&mut self, key: String, field: &Field, value: f64) {
        let silent = self.frames.last().is_none_or(|frame| frame.silent);
        if silent || self.assumptions.len() >= super::MOST_FINDINGS {
            return;
        }
        let DefaultRule { rule, source, usual } = field.assumed.unwrap_or_else(|| usual_rule(value));
        let usual = match usual {
            UsualRange::Factors(low, high) => Some([value * low, value * high]),
            UsualRange::Values(low, high) => Some([low, high]),
            UsualRange::Unknown => None,
        };
        let (unit, meaning) = (field.unit, field.meaning);
        self.assumptions.push(Assumption { key, value, unit, meaning, rule, source, usual });
    }
}

/// Returns what to add to the file if a value has the unit of another quantity.
fn meant_by_unit(text: &str, field: &Field) -> Option<String> {
    let has_unit = |other: &&UnitHint| read_quantity(text, other.unit).is_ok();
    field.unit_hints.iter().find(has_unit).map(|other| other.add.to_owned())
}

/// Returns the rule of a default that has none of its own: an ideal element.
fn usual_rule(value: f64) -> DefaultRule {
    let (rule, source) = if value == 0.0 {
        ("none, as in an ideal machine", "what is left out is ideal")
    } else if value.is_infinite() {
        ("unlimited, as in an ideal machine", "what is left out is ideal")
    } else {
        ("the default of the key", "a typical value")
    };
    DefaultRule { rule, source, usual: UsualRange::Unknown }
}

fn in_unit(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" in {unit}") }
}
