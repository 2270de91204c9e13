//! What a project states, value by value.

use serde::Serialize;

use super::Project;
use crate::file::lister::Line;
use crate::file::writer;

/// A section of a project with its values.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SectionStatement {
    /// Path of the section.
    pub path: String,
    /// What the section describes.
    pub meaning: &'static str,
    /// Its values.
    pub values: Vec<ValueStatement>,
}

/// A value of a project.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ValueStatement {
    /// Its key in the section.
    pub key: String,
    /// The value in the unit of the key, as a project file spells it.
    pub value: String,
    /// The unit; empty for a pure number.
    pub unit: &'static str,
    /// What the value means.
    pub meaning: &'static str,
    /// Its tolerance, if it has one.
    pub tolerance: Option<String>,
}

impl Project {
    /// Returns the sections of the project with the values that are not their keys' defaults.
    pub fn statements(&self) -> Vec<SectionStatement> {
        let mut sections: Vec<SectionStatement> = Vec::new();
        let mut open: Vec<usize> = Vec::new();
        for line in self.lines() {
            match line {
                Line::Open { path, meaning, .. } => {
                    open.push(sections.len());
                    sections.push(SectionStatement { path, meaning, values: Vec::new() });
                }
                Line::Close => {
                    open.pop();
                }
                Line::Value { key, setting, unit, meaning, usual: false, tolerance, .. } => {
                    let value = ValueStatement { key, value: setting.as_written(), unit, meaning, tolerance };
                    if let Some(section) = open.last().and_then(|at| sections.get_mut(*at)) {
                        section.values.push(value);
                    }
                }
                Line::Value { .. } => {}
            }
        }
        sections.retain(|section| !section.values.is_empty());
        sections
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
