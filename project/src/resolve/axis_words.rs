//! The words and units of a linear axis: a walk whose fields have a mass for an inertia, N for N m and m for rad.

use counterpoise_models::{AxisKind, Parameters, Transmission};

use crate::file::field::{DefaultRule, Field, TableField};
use crate::file::visit::{Count, Presence, Visit};

/// Keys of a turning axis with those of a sliding one.
const KEYS: [(&str, &str); 3] = [("inertia", "mass"), ("hub_inertia", "mass"), ("beam_inertia", "tip_mass")];

/// Keys whose unit is that of an angle or a frequency on every axis.
const TURNING: [&str; 3] = ["natural_frequency", "bandwidth", "phase"];

/// The words of a turning axis with those of a sliding one.
const TEXTS: [(&str, &str); 18] = [
    ("inertia at the hub", "mass that slides, with the nut or the carriage"),
    ("inertia added at the hub, without a first moment", "mass added to the slide, without weight along it"),
    ("hub to beam; rigid if absent", "between slide and tip mass; rigid if absent"),
    ("hub to beam; damping ratio 0.01 if absent", "between slide and tip mass; damping ratio 0.01 if absent"),
    (
        "spring between hub and platform; negative if it pushes away from its centre",
        "spring between slide and base; negative if it pushes away from its centre",
    ),
    (
        "angle of the hub on the platform at which that spring has no torque",
        "position of the slide at which that spring has no force",
    ),
    (
        "largest torque of a hose between hub and platform whose bending has hysteresis",
        "largest force of a hose between slide and base whose bending has hysteresis",
    ),
    ("gearbox between motor and hub", "gearbox between motor and slide"),
    ("belt between motor and hub", "belt between motor and slide"),
    ("cable between motor and hub", "cable between motor and slide"),
    ("harmonic drive between motor and hub", "harmonic drive between motor and slide"),
    ("friction at the hub pivot", "friction of the slide's guide"),
    ("part of the hub's inertia", "part of the mass that slides"),
    ("inertial rate of the hub", "inertial speed of the slide"),
    ("angle of the hub on the platform", "position of the slide on its base"),
    (
        "rate relative to the platform, which the loop controls",
        "speed relative to the base, which the loop controls",
    ),
    (
        "angle relative to the platform in counts, which the loop controls",
        "position relative to the base in counts, which the loop controls",
    ),
    (
        "angle relative to the platform, which the loop controls",
        "position relative to the base, which the loop controls",
    ),
];

/// A walk in the words of an axis.
pub(super) struct Words<'a> {
    axis: AxisKind,
    inner: &'a mut dyn Visit,
}

impl<'a> Words<'a> {
    pub fn of(axis: AxisKind, inner: &'a mut dyn Visit) -> Self {
        Self { axis, inner }
    }

    fn field(&self, field: &Field) -> Field {
        match self.axis {
            AxisKind::Rotary => *field,
            AxisKind::Linear if TURNING.contains(&field.key) => *field,
            // what lies between a motor that turns and a slide
            AxisKind::Linear if field.key == "ratio" && field.unit.is_empty() => {
                Field { unit: "rad/m", meaning: "motor's angle per travel of the slide", ..*field }
            }
            AxisKind::Linear => Field {
                key: sliding_key(field.key),
                unit: self.axis.unit(field.unit),
                meaning: sliding_text(field.meaning),
                assumed: field.assumed.map(|assumed| DefaultRule {
                    rule: sliding_text(assumed.rule),
                    source: sliding_text(assumed.source),
                    ..assumed
                }),
                ..*field
            },
        }
    }

    fn key(&self, key: &str) -> String {
        let known = KEYS.iter().find(|(turning, _)| *turning == key && self.axis == AxisKind::Linear);
        known.map_or_else(|| key.to_owned(), |(_, sliding)| (*sliding).to_owned())
    }
}

/// Returns whether what drives turns or slides: a motor without a transmission has the hub's units, and the piston of a cylinder slides.
pub(super) fn turning_of_motor(plant: &Parameters) -> AxisKind {
    match (plant.cylinder.is_some(), plant.gearbox.kind) {
        (true, _) => AxisKind::Linear,
        (false, Transmission::Direct) => plant.axis,
        (false, _) => AxisKind::Rotary,
    }
}

/// Returns the key of a sliding axis; the same if it has none of its own.
fn sliding_key(key: &'static str) -> &'static str {
    KEYS.iter().find(|(turning, _)| *turning == key).map_or(key, |(_, sliding)| sliding)
}

/// Returns the text of a sliding axis; the same if it has none of its own.
fn sliding_text(text: &'static str) -> &'static str {
    TEXTS.iter().find(|(turning, _)| *turning == text).map_or(text, |(_, sliding)| sliding)
}

impl Visit for Words<'_> {
    fn number(&mut self, field: &Field, value: &mut f64) {
        self.inner.number(&self.field(field), value);
    }

    fn whole_number(&mut self, field: &Field, value: &mut u32) {
        self.inner.whole_number(&self.field(field), value);
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
        let own = match self.axis {
            AxisKind::Rotary => *table,
            AxisKind::Linear => TableField { meaning: sliding_text(table.meaning), ..*table },
        };
        self.inner.enter(&own, presence)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slide_is_called_a_slide() {
        assert!(TEXTS.iter().all(|(turning, sliding)| turning != sliding && !sliding.contains("hub")));
        assert_eq!(sliding_text("cable between motor and hub"), "cable between motor and slide");
        assert_eq!(sliding_text("voltage gain"), "voltage gain");
    }
}
