//! Sets one number of a resolved project by its path.

use super::field::{Fallback, Field, TableField};
use super::lister::Paths;
use super::visit::{Count, Presence, Visit};

/// Sections of whose keys something is assumed where they are absent.
const OF_ABSENT_PARTS: [&str; 2] = ["plant.sensors.hub_gyro.", "plant.drive."];

/// A walk that changes the number at one path.
#[derive(Debug)]
pub(crate) struct Setter<'p> {
    path: &'p str,
    value: f64,
    paths: Paths,
    /// `true` if the number was met.
    pub is_set: bool,
    /// Path of the damping of what was rigid before its stiffness was set: it gets the damping of a compliance of which nothing is known.
    undamped: Option<String>,
}

impl<'p> Setter<'p> {
    pub fn new(path: &'p str, value: f64) -> Self {
        Self { path, value, paths: Paths::default(), is_set: false, undamped: None }
    }
}

impl Visit for Setter<'_> {
    fn number(&mut self, field: &Field, value: &mut f64) {
        let path = self.paths.of(field.key);
        if path == self.path {
            let was_rigid = value.is_infinite() && self.value.is_finite();
            let section = path.strip_suffix("stiffness").filter(|_| was_rigid);
            self.undamped = section.map(|section| format!("{section}damping"));
            (*value, self.is_set) = (self.value, true);
        } else if *value == 0.0
            && self.undamped.as_ref() == Some(&path)
            && let Fallback::Number(usual) = field.default
        {
            *value = usual;
        }
    }

    fn whole_number(&mut self, field: &Field, value: &mut u32) {
        if self.paths.of(field.key) == self.path {
            (*value, self.is_set) = (self.value.round() as u32, true);
        }
    }

    fn text(&mut self, _field: &Field, _value: &mut String) {}

    fn choice(&mut self, _field: &Field, _allowed: &[&'static str], _value: &mut &'static str) {}

    /// A list of which every number is the same: what is assumed for a list is one number.
    fn numbers(&mut self, field: &Field, count: Count, value: &mut Vec<f64>) {
        if count == Count::AtLeastOne && self.paths.of(field.key) == self.path {
            (*value, self.is_set) = (vec![self.value], true);
        }
    }

    fn texts(&mut self, _field: &Field, _value: &mut Vec<String>) {}

    fn pairs(&mut self, _field: &Field, _value: &mut Vec<[f64; 2]>) {}

    fn enter(&mut self, table: &TableField, presence: Presence) -> bool {
        // What is assumed of an absent part is set as if its section were there.
        let leads_to_it = || self.path.starts_with(&format!("{}.", self.paths.of(table.key)));
        let is_assumed = OF_ABSENT_PARTS.iter().any(|part| self.path.starts_with(part)) && leads_to_it();
        let enters = presence == Presence::Present || is_assumed;
        if enters {
            self.paths.enter(table.key);
        }
        enters
    }

    fn leave(&mut self) {
        self.paths.leave();
    }

    fn enter_list(&mut self, table: &TableField, length: usize) -> usize {
        self.paths.enter_list(table.key);
        length
    }

    fn enter_item(&mut self, index: usize) {
        let _ = self.paths.enter_item(index);
    }

    fn leave_list(&mut self) {
        self.paths.leave_list();
    }
}
