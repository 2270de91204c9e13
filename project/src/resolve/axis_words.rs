//! The words and units of a linear axis: a walk whose fields have a mass for an inertia, N for N m and m for rad.

use counterpoise_models::Axis;

use crate::file::field::{Field, TableField};
use crate::file::visit::{Count, Presence, Visit};

/// Keys of a turning axis with those of a sliding one.
const KEYS: [(&str, &str); 3] = [("inertia", "mass"), ("hub_inertia", "mass"), ("beam_inertia", "tip_mass")];

/// Keys whose unit is that of an angle or a frequency on every axis.
const TURNING: [&str; 3] = ["natural_frequency", "bandwidth", "phase"];

/// A walk in the words of an axis.
pub(super) struct Words<'a> {
    axis: Axis,
    inner: &'a mut dyn Visit,
}

impl<'a> Words<'a> {
    pub fn of(axis: Axis, inner: &'a mut dyn Visit) -> Self {
        Self { axis, inner }
    }

    fn field(&self, field: &Field) -> Field {
        match self.axis {
            Axis::Rotary => *field,
            Axis::Linear if TURNING.contains(&field.key) => *field,
            // what lies between a motor that turns and a slide
            Axis::Linear if field.key == "ratio" && field.unit.is_empty() => {
                Field { unit: "rad/m", meaning: "motor's angle per travel of the slide", ..*field }
            }
            Axis::Linear => Field { key: sliding_key(field.key), unit: self.axis.unit(field.unit), ..*field },
        }
    }

    fn key(&self, key: &str) -> String {
        let known = KEYS.iter().find(|(turning, _)| *turning == key && self.axis == Axis::Linear);
        known.map_or_else(|| key.to_owned(), |(_, sliding)| (*sliding).to_owned())
    }
}

/// Returns the key of a sliding axis; the same if it has none of its own.
fn sliding_key(key: &'static str) -> &'static str {
    KEYS.iter().find(|(turning, _)| *turning == key).map_or(key, |(_, sliding)| sliding)
}

impl Visit for Words<'_> {
    fn number(&mut self, field: &Field, value: &mut f64) {
        self.inner.number(&self.field(field), value);
    }

    fn whole(&mut self, field: &Field, value: &mut u32) {
        self.inner.whole(&self.field(field), value);
    }

    fn text(&mut self, field: &Field, value: &mut String) {
        self.inner.text(&self.field(field), value);
    }

    fn choice(&mut self, field: &Field, allowed: &[&'static str], value: &mut &'static str) {
        self.inner.choice(&self.field(field), allowed, value);
    }

    fn numbers(&mut self, field: &Field, count: Count, value: &mut Vec<f64>) {
        self.inner.numbers(&self.field(field), count, value);
    }

    fn texts(&mut self, field: &Field, value: &mut Vec<String>) {
        self.inner.texts(&self.field(field), value);
    }

    fn pairs(&mut self, field: &Field, value: &mut Vec<[f64; 2]>) {
        self.inner.pairs(&self.field(field), value);
    }

    fn enter(&mut self, table: &TableField, presence: Presence) -> bool {
        self.inner.enter(table, presence)
    }

    fn leave(&mut self) {
        self.inner.leave();
    }

    fn enter_list(&mut self, table: &TableField, length: usize) -> usize {
        self.inner.enter_list(table, length)
    }

    fn enter_item(&mut self, index: usize) {
        self.inner.enter_item(index);
    }

    fn leave_list(&mut self) {
        self.inner.leave_list();
    }

    fn complain(&mut self, key: &str, allowed: &str, hint: Option<String>) {
        let key = self.key(key);
        self.inner.complain(&key, allowed, hint);
    }

    fn attached_text(&mut self, name: &str) -> Option<Result<String, String>> {
        self.inner.attached_text(name)
    }

    fn attached_bytes(&mut self, name: &str) -> Option<Result<Vec<u8>, String>> {
        self.inner.attached_bytes(name)
    }

    fn shorthand(&mut self, key: &str, value: &mut String) -> bool {
        self.inner.shorthand(key, value)
    }

    fn has(&self, key: &str) -> bool {
        self.inner.has(key)
    }

    fn sees_every_section(&self) -> bool {
        self.inner.sees_every_section()
    }

    fn assume(&mut self, field: &Field, value: f64) {
        self.inner.assume(&self.field(field), value);
    }
}
