//! The statements of a project, value by value.

use serde::Serialize;

use super::{Project, drive};
use crate::file::Document;
use crate::file::field::TableField;
use crate::file::lister::{Line, Lister};
use crate::file::visit::{Presence, Visit};
use crate::file::writer;

/// A section of a project with its values.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SectionStatement {
    /// Path of the section.
    pub path: String,
    /// Subject of the section.
    pub meaning: &'static str,
    /// Values.
    pub values: Vec<ValueStatement>,
}

/// A value of a project.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ValueStatement {
    /// Key in the section.
    pub key: String,
    /// The value in the unit of the key, as a project file spells it.
    pub value: String,
    /// The unit; empty for a pure number.
    pub unit: &'static str,
    /// Meaning of the value.
    pub meaning: &'static str,
    /// Tolerance, if it has one.
    pub tolerance: Option<String>,
    /// Text in the file, as it is written there; `None` if the value is a default or follows from other keys.
    pub written: Option<String>,
}

impl Project {
    /// Returns the sections of the project with the values that are not their keys' defaults.
    pub fn statements(&self) -> Vec<SectionStatement> {
        self.statements_where(|_| None)
    }

    /// Returns the sections of the project as a file states them: the values that the file writes, and those that are not their
    /// keys' defaults.
    pub fn statements_of(&self, document: &Document) -> Vec<SectionStatement> {
        let written_at = |path: &str| {
            let of_tolerance = document.source_text_at(&format!("{path}.value"));
            of_tolerance.or_else(|| document.source_text_at(path))
        };
        let mut sections = self.statements_where(written_at);
        let derived = sections.iter_mut().find(|section| section.path == "plant.amplifier");
        if let (Some(amplifier), true) = (derived, document.has("plant.drive")) {
            amplifier.meaning = "that is, the amplifier of the stated drive";
        }
        // A drive that takes a voltage stands in the file, and an amplifier in the project.
        if document.has("plant.drive") && !sections.iter().any(|section| section.path == "plant.drive") {
            let mut lister = Lister::default();
            if lister.enter(&TableField::mandatory("plant", ""), Presence::Present) {
                drive::list_voltage_drive(&mut lister, &self.plant);
                lister.leave();
            }
            let mut stated = statements_of_lines(lister.lines, written_at);
            let all = stated.iter_mut().flat_map(|section| section.values.iter_mut());
            let word = document.source_text_at("plant.drive").filter(|text| text.starts_with('"'));
            all.filter(|value| value.key == "kind").for_each(|kind| {
                kind.written = kind.written.take().or_else(|| word.clone());
            });
            sections.append(&mut stated);
        }
        sections
    }

    /// Returns the sections with the values that stand in a file or are not their keys' defaults.
    fn statements_where(&self, written_at: impl Fn(&str) -> Option<String>) -> Vec<SectionStatement> {
        statements_of_lines(self.lines(), written_at)
    }

    /// Returns every value of the project that is not as usual, one a line in fixed order: the same for two projects that mean the
    /// same, whatever their files look like and however their keys are explained.
    pub fn meaning(&self) -> String {
        let line = |line: &Line| match line {
            Line::Value { path, setting, usual: false, tolerance, .. } if path != "format" => {
                Some(format!("{path} = {}\n", writer::as_written(setting, tolerance)))
            }
            _ => None,
        };
        self.lines().iter().filter_map(line).collect()
    }
}

/// Returns the sections of lines with the values that stand in a file or are not their keys' defaults.
fn statements_of_lines(
    lines: Vec<Line>,
    written_at: impl Fn(&str) -> Option<String>,
) -> Vec<SectionStatement> {
    let mut sections: Vec<SectionStatement> = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    for line in lines {
        match line {
            Line::Open { path, meaning, .. } => {
                open.push(sections.len());
                sections.push(SectionStatement { path, meaning, values: Vec::new() });
            }
            Line::Close => {
                open.pop();
            }
            Line::Value { path, key, setting, unit, meaning, usual, tolerance } => {
                let written = written_at(&path);
                if usual && written.is_none() {
                    continue;
                }
                let value = setting.as_written();
                let value = ValueStatement { key, value, unit, meaning, tolerance, written };
                if let Some(section) = open.last().and_then(|at| sections.get_mut(*at)) {
                    section.values.push(value);
                }
            }
        }
    }
    sections.retain(|section| !section.values.is_empty());
    sections
}
