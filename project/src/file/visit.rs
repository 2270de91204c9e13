//! One walk over a section serves reading, writing and comparing: it names each key once, beside the field it fills.

use super::field::{Field, TableField};

/// The number of items of a list of numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Count {
    AtLeastOne,
    Exactly(usize),
}

/// The presence in the structure of what a table describes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Presence {
    Present,
    Absent,
}

impl From<bool> for Presence {
    fn from(is_there: bool) -> Self {
        if is_there { Self::Present } else { Self::Absent }
    }
}

/// The operation on each key: read it into the field, or list the field's value.
pub(crate) trait Visit {
    fn number(&mut self, field: &Field, value: &mut f64);
    fn whole_number(&mut self, field: &Field, value: &mut u32);
    fn text(&mut self, field: &Field, value: &mut String);
    fn choice(&mut self, field: &Field, allowed: &[&'static str], value: &mut &'static str);
    fn numbers(&mut self, field: &Field, count: Count, value: &mut Vec<f64>);
    fn texts(&mut self, field: &Field, value: &mut Vec<String>);
    /// A list of pairs of numbers, or the name of a file handed in that holds them.
    fn pairs(&mut self, field: &Field, value: &mut Vec<[f64; 2]>);
    /// Steps into a table, which the structure may lack; returns false if it is not there (then `leave` must not follow).
    fn enter(&mut self, table: &TableField, presence: Presence) -> bool;
    fn leave(&mut self);
    /// Steps into a list of tables of which the structure holds `length`; returns how many there are.
    fn enter_list(&mut self, table: &TableField, length: usize) -> usize;
    fn enter_item(&mut self, index: usize);
    fn leave_list(&mut self);
    /// Reports an error about the last key that its type and range do not cover.
    fn complain(&mut self, _key: &str, _allowed: &str, _hint: Option<String>) {}
    /// Returns the text of a file that was handed in, or why there is none; `None` if nothing is read.
    fn attached_text(&mut self, _name: &str) -> Option<Result<String, String>> {
        None
    }
    /// Returns a file that was handed in, or why there is none; `None` if nothing is read.
    fn attached_bytes(&mut self, _name: &str) -> Option<Result<Vec<u8>, String>> {
        None
    }
    /// Reads a text that stands where a table could; returns true if it is there.
    fn shorthand(&mut self, _key: &str, _value: &mut String) -> bool {
        false
    }
    /// Returns whether a key is written in the table, or in one within it (`motor.inertia`); false if nothing is read.
    fn has(&self, _key: &str) -> bool {
        false
    }
    /// Returns whether the walk sees sections that exclude each other, as the reference does.
    fn sees_every_section(&self) -> bool {
        false
    }
    /// Records that a value is assumed because nothing is written: used where a whole section is absent. An absent key of a section
    /// that is there is recorded without a call.
    fn assume(&mut self, _field: &Field, _value: f64) {}
}

/// An enumeration whose values a project file spells by names.
pub trait NamedChoice: Copy + PartialEq + 'static {
    /// Every value with the name that a project file spells it by.
    const NAMES: &'static [(&'static str, Self)];

    /// Returns the name of the value in a project file.
    fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, value)| *value == self).map_or("", |(name, _)| name)
    }
}

/// A key with one of a list of names.
pub(crate) fn choose<T: NamedChoice>(v: &mut dyn Visit, field: &Field, value: &mut T) {
    let allowed: Vec<&'static str> = T::NAMES.iter().map(|(name, _)| *name).collect();
    let mut name = value.name();
    v.choice(field, &allowed, &mut name);
    if let Some((_, chosen)) = T::NAMES.iter().find(|(known, _)| *known == name) {
        *value = *chosen;
    }
}

/// A table that is filled where it is there.
pub(crate) fn table<T>(
    v: &mut dyn Visit,
    field: &TableField,
    value: &mut T,
    walk: impl FnOnce(&mut dyn Visit, &mut T),
) {
    if v.enter(field, Presence::Present) {
        walk(v, value);
        v.leave();
    }
}

/// A table whose absence means that the thing is not there.
pub(crate) fn visit_optional<T>(
    v: &mut dyn Visit,
    field: &TableField,
    slot: &mut Option<T>,
    blank: T,
    walk: impl FnOnce(&mut dyn Visit, &mut T),
) {
    if v.enter(field, Presence::from(slot.is_some())) {
        let mut value = slot.take().unwrap_or(blank);
        walk(v, &mut value);
        v.leave();
        *slot = Some(value);
    } else {
        *slot = None;
    }
}

/// A list of tables.
pub(crate) fn list<T: Clone>(
    v: &mut dyn Visit,
    field: &TableField,
    items: &mut Vec<T>,
    blank: T,
    walk: impl Fn(&mut dyn Visit, &mut T),
) {
    let count = v.enter_list(field, items.len());
    items.resize(count, blank);
    for (index, item) in items.iter_mut().enumerate() {
        v.enter_item(index);
        walk(v, item);
        v.leave();
    }
    v.leave_list();
}

/// A list of exactly two numbers.
pub(crate) fn pair(v: &mut dyn Visit, field: &Field, value: &mut [f64; 2]) {
    let mut numbers = value.to_vec();
    v.numbers(field, Count::Exactly(2), &mut numbers);
    if let [near, far] = numbers[..] {
        *value = [near, far];
    }
}

/// A number that may be absent and then means nothing.
pub(crate) fn maybe_number(v: &mut dyn Visit, field: &Field, slot: &mut Option<f64>) {
    let mut value = slot.unwrap_or(f64::NAN);
    v.number(&field.or(f64::NAN), &mut value);
    *slot = (!value.is_nan()).then_some(value);
}
