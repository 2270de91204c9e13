//! The reference of all keys, from the same walk that reads them: what is said there cannot differ from what is read.

use super::field::{Fallback, Field, Need, NumberRange, TableField};
use super::visit::{Count, Presence, Visit};

/// A table of the reference.
#[derive(Debug, Clone, PartialEq)]
struct Section {
    path: String,
    title: String,
    rows: Vec<Row>,
}

/// A choice made before a key in its table, under some names of which the key exists.
#[derive(Debug, Clone, PartialEq)]
struct Condition {
    key: &'static str,
    /// Number of names of the choice.
    count: usize,
    /// Those under which the key exists.
    names: Vec<&'static str>,
}

/// A key of the reference.
#[derive(Debug, Clone, PartialEq)]
struct Row {
    key: &'static str,
    unit: String,
    allowed: String,
    absent: String,
    meaning: &'static str,
    /// One for every choice made before it in the table.
    conditions: Vec<Condition>,
}

/// A walk that describes what it meets. The number of a walk, read as digits, says which name each choice of a table takes,
/// so that the walks together see all keys. In the first walks the choices of `[plant]` itself stay at their defaults: a key that
/// every kind of axis has is shown with the unit of a turning one.
#[derive(Debug, Default)]
pub(crate) struct Guide {
    turn: usize,
    stack: Vec<Frame>,
    sections: Vec<Section>,
}

/// The place in which a name means something.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Places {
    /// Paths of the sections that have a key of this name.
    pub of_key: Vec<String>,
    /// Paths of the sections of this name.
    pub sections: Vec<String>,
}

/// The table in which the walk stands, and the choices that were made in it.
#[derive(Debug, Default)]
struct Frame {
    path: String,
    /// Index of its section: a walk meets thousands of keys, and looking each time for the section by its path takes most of the time.
    section: usize,
    /// Weight of the next choice's digit.
    digit: usize,
    chosen: Vec<(&'static str, usize, &'static str)>,
}

/// Walks that see every combination of choices within a table and one level into it: 4320 of `[synth]`.
const TURNS: usize = 4320;
/// Combinations of choices up to which the items of a list are seen under each of them, as the factors of a product are. Behind more
/// (the blocks of `[synth]`) they start again: the walks would be ten times as many, and no key of theirs depends on those choices.
const MOST_INHERITED: usize = 480;
/// All walks: those that leave the choices of `[plant]` at their defaults, then those that make them too.
pub(crate) const WALKS: usize = 2 * TURNS;
/// Numbers of walks that together meet nearly every section and key, for hints: all walks take seconds.
pub(crate) const SOME_WALKS: [usize; 24] = [
    0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 4320, 4331, 4342, 4353, 4364, 4375, 4386, 4397, 4408, 4419, 4430,
    4441,
];
/// The table whose choices change the units of the keys in other tables.
const KEPT_FIRST: &str = "plant";

impl Guide {
    /// Starts a walk.
    pub fn turn(&mut self, turn: usize) {
        self.turn = turn;
        self.stack.clear();
        self.open(String::new(), || "at the top of the file".to_owned());
    }

    fn open(&mut self, path: String, title: impl FnOnce() -> String) {
        let known = self.sections.iter().position(|s| s.path == path);
        let section = known.unwrap_or_else(|| self.insert(&path, title()));
        self.stack.push(Frame { path, section, digit: 1, chosen: Vec::new() });
    }

    /// Inserts a new section at its place and returns its index; the open tables keep their sections.
    fn insert(&mut self, path: &str, title: String) -> usize {
        let at = self.place(path);
        self.sections.insert(at, Section { path: path.to_owned(), title, rows: Vec::new() });
        for frame in self.stack.iter_mut().filter(|frame| frame.section >= at) {
            frame.section += 1;
        }
        at
    }

    /// Returns the index of a new section: after the last section with the same parent.
    fn place(&self, path: &str) -> usize {
        let parent = path.rsplit_once('.').map_or("", |(parent, _)| parent);
        let last = self.sections.iter().rposition(|s| !parent.is_empty() && s.path.starts_with(parent));
        last.map_or(self.sections.len(), |at| at + 1)
    }

    fn path(&self, key: &str) -> String {
        match self.stack.last() {
            Some(Frame { path, .. }) if !path.is_empty() => format!("{path}.{key}"),
            _ => key.to_owned(),
        }
    }

    fn row(&mut self, field: &Field, kind: impl FnOnce() -> String) {
        let Some(frame) = self.stack.last() else { return };
        let Some(section) = self.sections.get_mut(frame.section) else { return };
        let at = section.rows.iter().position(|r| r.key == field.key).unwrap_or(section.rows.len());
        if at == section.rows.len() {
            let &Field { key, unit, meaning, second_unit, .. } = field;
            let unit = match second_unit {
                Some(second) => format!("{unit}, {}", if second.is_empty() { "1" } else { second }),
                None => unit.to_owned(),
            };
            section.rows.push(Row {
                key,
                unit,
                allowed: kind(),
                absent: absence_text(field),
                meaning,
                conditions: Vec::new(),
            });
        }
        for (key, count, name) in &frame.chosen {
            note(&mut section.rows[at].conditions, key, *count, name);
        }
    }

    /// Returns the sections in which a key, or a section of this name, may stand; the empty path is the top of the file.
    pub fn places_of(&self, name: &str) -> Places {
        let paths = |is_meant: &dyn Fn(&Section) -> bool| {
            self.sections
                .iter()
                .filter(|section| is_meant(section))
                .map(|section| section.path.clone())
                .collect()
        };
        Places {
            of_key: paths(&|section| section.rows.iter().any(|row| row.key == name)),
            sections: paths(&|section| section.path.rsplit('.').next() == Some(name)),
        }
    }

    /// Returns the reference as Markdown.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for (index, section) in self.sections.iter().enumerate().filter(|(_, s)| !s.rows.is_empty()) {
            let same = self.sections[..index].iter().find(|s| s.rows == section.rows && s.rows.len() > 1);
            text += &heading(section);
            text += &same.map_or_else(|| table(&section.rows), |s| format!("Keys as in `[{}]`.\n", s.path));
        }
        text
    }
}

fn heading(section: &Section) -> String {
    let Section { path, title, .. } = section;
    if path.is_empty() { format!("\n## {title}\n\n") } else { format!("\n## `[{path}]`: {title}\n\n") }
}

fn note(conditions: &mut Vec<Condition>, key: &'static str, count: usize, name: &'static str) {
    let at = conditions.iter().position(|one| one.key == key).unwrap_or(conditions.len());
    if at == conditions.len() {
        conditions.push(Condition { key, count, names: Vec::new() });
    }
    if !conditions[at].names.contains(&name) {
        conditions[at].names.push(name);
    }
}

fn table(rows: &[Row]) -> String {
    let head = "| key | unit | allowed | if absent | meaning |\n|---|---|---|---|---|\n";
    let line = |row: &Row| {
        format!(
            "| `{}` | {} | {} | {} | {}{} |\n",
            row.key,
            row.unit,
            row.allowed,
            row.absent,
            row.meaning,
            condition(row)
        )
    };
    rows.iter().fold(head.to_owned(), |text, row| text + &line(row))
}

/// Under which choices a key exists, if it does not under all.
fn condition(row: &Row) -> String {
    let some = row.conditions.iter().filter(|one| one.names.len() < one.count);
    let words: Vec<String> = some.map(|one| format!("`{}` {}", one.key, one.names.join(", "))).collect();
    if words.is_empty() { String::new() } else { format!("; only with {}", words.join(" and ")) }
}

fn absence_text(field: &Field) -> String {
    match field.default {
        Fallback::Required => "must be there".to_owned(),
        _ if field.assumed.is_some() => {
            field.assumed.map_or(String::new(), |assumed| assumed.rule.to_owned())
        }
        Fallback::Number(value) if value.is_finite() => value.to_string(),
        Fallback::Text(text) if !text.is_empty() => format!("`{text}`"),
        Fallback::Number(_) | Fallback::Text(_) | Fallback::Empty => String::new(),
    }
}

fn range(limit: NumberRange) -> String {
    match limit {
        NumberRange::Any => "any number".to_owned(),
        NumberRange::Above(low) => format!("> {low}"),
        NumberRange::AtLeast(low) => format!(">= {low}"),
        NumberRange::Between(low, high) => format!("{low} to {high}"),
        NumberRange::AboveTo(low, high) => format!("> {low}, <= {high}"),
        NumberRange::Not0 => "not 0".to_owned(),
    }
}

impl Visit for Guide {
    fn number(&mut self, field: &Field, _value: &mut f64) {
        self.row(field, || range(field.limit));
    }

    fn whole_number(&mut self, field: &Field, _value: &mut u32) {
        self.row(field, || format!("whole, {}", range(field.limit)));
    }

    fn text(&mut self, field: &Field, _value: &mut String) {
        self.row(field, || "text".to_owned());
    }

    fn choice(&mut self, field: &Field, allowed: &[&'static str], value: &mut &'static str) {
        self.row(field, || allowed.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "));
        let Some(frame) = self.stack.last_mut().filter(|_| !allowed.is_empty()) else { return };
        let turn = if frame.path == KEPT_FIRST { self.turn / TURNS } else { self.turn % TURNS };
        let at = turn / frame.digit % allowed.len();
        *value = allowed[at];
        frame.digit *= allowed.len();
        frame.chosen.push((field.key, allowed.len(), value));
    }

    fn numbers(&mut self, field: &Field, count: Count, _value: &mut Vec<f64>) {
        let many =
            || if let Count::Exactly(n) = count { format!("{n} numbers") } else { "numbers".to_owned() };
        self.row(field, || format!("list of {}, {}", many(), range(field.limit)));
    }

    fn texts(&mut self, field: &Field, _value: &mut Vec<String>) {
        self.row(field, || "list of texts".to_owned());
    }

    fn pairs(&mut self, field: &Field, _value: &mut Vec<[f64; 2]>) {
        self.row(field, || "list of pairs of numbers".to_owned());
    }

    fn enter(&mut self, table: &TableField, _presence: Presence) -> bool {
        let note = if table.need == Need::Optional { " (may be absent)" } else { "" };
        let title = if table.meaning.is_empty() { "where the channel comes from" } else { table.meaning };
        self.open(self.path(table.key), || format!("{title}{note}"));
        true
    }

    fn leave(&mut self) {
        self.stack.pop();
    }

    fn sees_every_section(&self) -> bool {
        true
    }

    /// Enters a list and returns the number of its items to show: one, which shows what an item is, or none if the list is nested in
    /// an item of the same kind.
    fn enter_list(&mut self, table: &TableField, _length: usize) -> usize {
        let path = self.path(table.key);
        let again = path.split('.').filter(|part| *part == table.key).count() > 1;
        let digit = self.stack.last().map_or(1, |f| if f.digit > MOST_INHERITED { 1 } else { f.digit });
        if again {
            self.stack.push(Frame::default());
        } else {
            self.open(path, || format!("{} (a list: `[[...]]`)", table.meaning));
        }
        self.stack.last_mut().into_iter().for_each(|frame| frame.digit = digit);
        usize::from(!again)
    }

    fn enter_item(&mut self, _index: usize) {
        let list = self.stack.last().map(|f| (f.path.clone(), f.section, f.digit));
        let (path, section, digit) = list.unwrap_or((String::new(), 0, 1));
        self.stack.push(Frame { path, section, digit, chosen: Vec::new() });
    }

    fn leave_list(&mut self) {
        self.stack.pop();
    }
}
