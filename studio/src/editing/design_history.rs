//! The history of designs: each with a name, its weights, its verification and the curve of its thumbnail, in a file beside the project.
//!
//! The file is text: one block for each design, oldest first, without dates and with rounded numbers. A block that is not changed keeps its
//! bytes, so that a version control system shows what a person did and nothing else.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::Deserialize;

use super::key_path::key_name;
use super::weight_text::split_sections;

/// The comment at the beginning of a new file.
const PREAMBLE: &str = "# Designs that the studio keeps for this project, oldest first. A design is its sections [synth] and [reduce];\n\
    # figures and verdicts are those of its verification.\n";
/// Significant digits of the figures in the file: more would differ between machines, and nobody reads them.
const FIGURE_DIGITS: usize = 5;
/// Significant digits of the ends of the curve of a thumbnail.
const END_DIGITS: usize = 3;
/// The name of the sections of the file.
const SECTION: &str = "design";

/// A design that is kept with a name.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NamedDesign {
    /// The name.
    pub name: String,
    /// First and last frequency of the thumbnail, Hz; its points lie at equal ratios.
    pub sensitivity_hz: [f64; 2],
    /// The sensitivity at these, dB.
    pub sensitivity_db: Vec<f64>,
    /// The sections of the project that make the design.
    pub weights: String,
    /// Figures of the loop and of its runs, by the names of the project file.
    #[serde(default)]
    pub figures: BTreeMap<String, f64>,
    /// The verdicts on the requirements, by the names of their figures; empty if the design was not verified.
    #[serde(default)]
    pub verdicts: BTreeMap<String, KeptVerdict>,
}

/// The verdict on a requirement when the design was kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum KeptVerdict {
    /// It held.
    Holds,
    /// It failed.
    Fails,
    /// It could not be judged.
    Open,
}

impl KeptVerdict {
    /// Returns the word of the file.
    pub fn word(self) -> &'static str {
        match self {
            KeptVerdict::Holds => "holds",
            KeptVerdict::Fails => "fails",
            KeptVerdict::Open => "open",
        }
    }
}

/// Damage of a history's text, with its place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HistoryDamage {
    /// The line, from 1.
    pub line: usize,
    /// What is wrong.
    pub message: String,
}

/// A block of the file: a design, and the text that describes it.
#[derive(Debug, Clone, PartialEq)]
struct DesignBlock {
    design: NamedDesign,
    text: String,
}

/// A design that was deleted, with its place.
#[derive(Debug, Clone, PartialEq)]
pub struct DeletedDesign {
    index: usize,
    block: DesignBlock,
}

impl DeletedDesign {
    /// Returns the name of the design.
    pub fn name(&self) -> &str {
        &self.block.design.name
    }
}

/// The designs of a project, oldest first.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DesignHistory {
    preamble: String,
    blocks: Vec<DesignBlock>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HistoryFileContent {
    #[serde(default, rename = "design")]
    designs: Vec<toml::Spanned<NamedDesign>>,
}

impl DesignHistory {
    /// Returns the history that a text describes.
    ///
    /// # Errors
    /// Returns what is wrong with the text, with its line.
    pub fn parse(text: &str) -> Result<Self, HistoryDamage> {
        let text = text.replace("\r\n", "\n");
        let line = |byte: usize| 1 + text.as_bytes().iter().take(byte).filter(|byte| **byte == b'\n').count();
        let content: HistoryFileContent = toml::from_str(&text).map_err(|error| HistoryDamage {
            line: line(error.span().map_or(0, |span| span.start)),
            message: error.message().replace('\n', ", "),
        })?;
        let mut history = Self::default();
        let mut texts: Vec<String> = Vec::new();
        for section in split_sections(&text) {
            let is_heading = section.text.lines().any(|line| line.trim_end() == "[[design]]");
            match texts.last_mut() {
                _ if section.name == SECTION && is_heading => texts.push(section.text.to_owned()),
                Some(last) => last.push_str(section.text),
                None => history.preamble.push_str(section.text),
            }
        }
        if texts.len() != content.designs.len() {
            let message = "a design is not written as a section [[design]] of its own".to_owned();
            return Err(HistoryDamage { line: 1, message });
        }
        for (design, text) in content.designs.into_iter().zip(texts) {
            let at = design.span().start;
            let design = design.into_inner();
            if history.find(&design.name).is_some() {
                let message = format!("a second design has the name \"{}\"", design.name);
                return Err(HistoryDamage { line: line(at), message });
            }
            history.blocks.push(DesignBlock { design, text });
        }
        Ok(history)
    }

    /// Returns the designs, oldest first.
    pub fn designs(&self) -> impl DoubleEndedIterator<Item = &NamedDesign> {
        self.blocks.iter().map(|block| &block.design)
    }

    /// Returns whether there is no design.
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// Returns the design of a name.
    pub fn find(&self, name: &str) -> Option<&NamedDesign> {
        self.designs().find(|design| design.name == name)
    }

    /// Adds a design at the end; one of the same name is replaced at its place.
    pub fn add(&mut self, design: NamedDesign) {
        let block = DesignBlock { text: block_text(&design), design };
        match self.index(&block.design.name) {
            Some(index) => self.blocks[index] = block,
            None => self.blocks.push(block),
        }
    }

    /// Removes the design of a name, and returns it with its place; `None` if there is none.
    pub fn remove(&mut self, name: &str) -> Option<DeletedDesign> {
        let index = self.index(name)?;
        Some(DeletedDesign { index, block: self.blocks.remove(index) })
    }

    /// Puts a deleted design back to its place.
    pub fn put_back(&mut self, deleted: DeletedDesign) {
        self.blocks.insert(deleted.index.min(self.blocks.len()), deleted.block);
    }

    /// Gives a design another name.
    pub fn rename(&mut self, name: &str, new_name: &str) {
        let Some(index) = self.index(name) else { return };
        let block = &mut self.blocks[index];
        new_name.clone_into(&mut block.design.name);
        let renamed = with_name(&block.text, new_name);
        let is_read = Self::parse(&renamed).is_ok_and(|read| read.designs().eq([&block.design]));
        block.text = if is_read { renamed } else { block_text(&block.design) };
    }

    fn index(&self, name: &str) -> Option<usize> {
        self.blocks.iter().position(|block| block.design.name == name)
    }

    /// Returns the text of the file.
    pub fn to_text(&self) -> String {
        let mut text = if self.preamble.is_empty() {
            PREAMBLE.to_owned()
        } else {
            self.preamble.trim_end().to_owned() + "\n"
        };
        for block in &self.blocks {
            text.push('\n');
            text.push_str(block.text.trim());
            text.push('\n');
        }
        text
    }
}

/// Returns the text of a block with another name.
fn with_name(text: &str, name: &str) -> String {
    let mut is_replaced = false;
    let line = |line: &str| {
        let is_name = !is_replaced && key_name(line).is_some_and(|key| key == "name");
        is_replaced |= is_name;
        if is_name { format!("name = {}\n", quote(name)) } else { line.to_owned() }
    };
    text.split_inclusive('\n').map(line).collect()
}

fn quote(value: &str) -> String {
    // a line for each key, whatever is in a name
    let value: String = value.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    toml::Value::String(value).to_string()
}

fn format_number(value: f64, digits: usize) -> String {
    let rounded: f64 = format!("{value:.*e}", digits - 1).parse().unwrap_or(value);
    toml::Value::Float(rounded).to_string()
}

/// Returns a number with one digit after the point: a tenth of a decibel is less than a pixel of a thumbnail.
fn format_tenths(value: f64) -> String {
    let text = format!("{value:.1}");
    if text == "-0.0" { "0.0".to_owned() } else { text }
}

fn block_text(design: &NamedDesign) -> String {
    let curve: Vec<String> = design.sensitivity_db.iter().map(|value| format_tenths(*value)).collect();
    let ends = design.sensitivity_hz.map(|value| format_number(value, END_DIGITS));
    let weights = design.weights.trim_end().to_owned() + "\n";
    let weights = match weights.contains("'''") || weights.contains('\r') {
        true => toml::Value::String(weights).to_string(),
        false => format!("'''\n{weights}'''"),
    };
    let mut text = format!(
        "[[design]]\nname = {}\nsensitivity_hz = [{}]\nsensitivity_db = [{}]\nweights = {weights}\n",
        quote(&design.name),
        ends.join(", "),
        curve.join(", "),
    );
    let values = design
        .figures
        .iter()
        .map(|(figure, value)| KeyLine { key: figure, value: format_number(*value, FIGURE_DIGITS) });
    write_table(&mut text, "figures", values.collect());
    let verdicts =
        design.verdicts.iter().map(|(figure, verdict)| KeyLine { key: figure, value: quote(verdict.word()) });
    write_table(&mut text, "verdicts", verdicts.collect());
    text
}

/// A key with its value as text.
struct KeyLine<'a> {
    key: &'a str,
    value: String,
}

fn write_table(text: &mut String, name: &str, lines: Vec<KeyLine>) {
    if lines.is_empty() {
        return;
    }
    let _ = write!(text, "\n[design.{name}]\n");
    for KeyLine { key, value } in lines {
        let _ = writeln!(text, "{} = {value}", quote(key));
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::super::weight_text::design_sections;
    use super::*;

    const RIG: &str = include_str!("../../../examples/reference-rig/project.toml");

    fn design(name: &str, weights: &str) -> NamedDesign {
        NamedDesign {
            name: name.to_owned(),
            sensitivity_hz: [0.1, 10.0],
            sensitivity_db: vec![-60.0, 2.5],
            weights: weights.to_owned(),
            figures: BTreeMap::from([("pitch_compensated_drr_db at 1.5 Hz".to_owned(), -31.25)]),
            verdicts: BTreeMap::from([("pitch_compensated_drr_db at 1.5 Hz".to_owned(), KeptVerdict::Fails)]),
        }
    }

    fn history(names: &[&str]) -> DesignHistory {
        let mut history = DesignHistory::default();
        names.iter().for_each(|name| history.add(design(name, &design_sections(RIG))));
        DesignHistory::parse(&history.to_text()).unwrap()
    }

    #[test]
    fn a_new_design_is_added_at_the_end_and_the_old_lines_stay() {
        let mut designs = history(&["soft \"start\"", "middle"]);
        let before = designs.to_text();
        assert!(designs.designs().all(|kept| kept.weights.trim_end() == design_sections(RIG).trim_end()));
        designs.add(design("stiff", "[synth]\nx = '''a'''\n"));
        let after = designs.to_text();
        assert!(after.starts_with(&before), "the old lines stay");
        let read = DesignHistory::parse(&after).unwrap();
        assert!(read.designs().eq(designs.designs()));
        assert_eq!(read.to_text(), after, "what is read is written with the same bytes");
        assert!(after.contains("\"pitch_compensated_drr_db at 1.5 Hz\" = -31.25\n"), "a figure is one line");
    }

    #[test]
    fn what_a_person_wrote_beside_another_design_stays() {
        let text = history(&["a", "b", "c"]).to_text();
        let commented = text
            .replace("[[design]]\nname = \"b\"", "# of the trial in spring\n[[design]]\nname   =   \"b\"");
        let mut designs = DesignHistory::parse(&commented).unwrap();
        designs.rename("a", "one");
        let deleted = designs.remove("c").unwrap();
        assert_eq!(deleted.name(), "c");
        let shorter = designs.to_text();
        assert!(shorter.contains("# of the trial in spring\n[[design]]\nname   =   \"b\""), "{shorter}");
        assert!(shorter.contains("name = \"one\"") && !shorter.contains("name = \"c\""));
        designs.put_back(deleted);
        designs.rename("one", "a");
        assert_eq!(designs.to_text(), commented, "both steps are taken back to the last byte");
    }

    #[test]
    fn damage_has_its_line() {
        let text = history(&["a", "b"]).to_text();
        let damage = |text: &str| DesignHistory::parse(text).unwrap_err();
        let line_of = |text: &str, part: &str| 1 + text[..text.find(part).unwrap()].matches('\n').count();
        let broken = text.replace("name = \"b\"", "name = 3");
        assert_eq!(damage(&broken).line, line_of(&broken, "name = 3"));
        let merged = text.replace("name = \"b\"", "<<<<<<< ours\nname = \"b\"");
        assert_eq!(damage(&merged).line, line_of(&merged, "<<<"));
        let twice = damage(&text.replace("name = \"b\"", "name = \"a\""));
        assert!(twice.message.contains("second design has the name \"a\""), "{twice:?}");
        let newer = damage(&text.replace("name = \"b\"", "name = \"b\"\nphase = 3.0"));
        assert!(newer.message.contains("phase"), "a key that would be lost is refused: {newer:?}");
    }
}
