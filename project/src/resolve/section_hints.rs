//! The sections to which keys belong that are unknown in theirs.

use std::sync::OnceLock;

use super::{Project, file};
use crate::diagnostic::{Diagnostic, DiagnosticKind};
use crate::file::guide::{Guide, Places, SOME_WALKS};
use crate::file::reader::synonyms::keys_meant_by;

/// Most sections that a hint names: a key of more places means something else in each.
const MOST_PLACES: usize = 3;
/// Most sections of the section in which an unknown key stands that a hint names: there they are alike.
const MOST_PARTS: usize = 10;

/// Adds to each unknown key without a hint the sections that have a key, or are a section, of that name.
pub(super) fn hint_at_sections(findings: &mut [Diagnostic]) {
    let unknown = |d: &&mut Diagnostic| d.problem == DiagnosticKind::UnknownKey && d.hint.is_none();
    for finding in findings.iter_mut().filter(unknown) {
        let (own, name) = finding.path.rsplit_once('.').unwrap_or(("", &finding.path));
        let own = without_numbers(own);
        let at = |name: &str| words(&own, name, &guide().places_of(name));
        // A name of data sheets may mean a key of another section.
        finding.hint = at(name).or_else(|| keys_meant_by(name).find_map(at));
    }
}

/// Drops findings that are no more than the consequence of another one: keys that a choice has which a unit asks for, and units of a loop whose sensor is missing.
pub(super) fn drop_consequences(findings: &mut Vec<Diagnostic>) {
    let names_choice = |d: &Diagnostic| {
        d.problem == DiagnosticKind::WrongType && d.hint.as_ref().is_some_and(|h| h.contains("add kind"))
    };
    let sections: Vec<String> = findings
        .iter()
        .filter(|d| names_choice(d))
        .filter_map(|d| Some(d.path.rsplit_once('.')?.0.to_owned()))
        .collect();
    let has_other_loop = findings.iter().any(|d| d.path == "synth.loop");
    findings.retain(|d| {
        let section = d.path.rsplit_once('.').map_or("", |(section, _)| section);
        let is_of_choice = d.problem == DiagnosticKind::UnknownKey
            && sections.iter().any(|named| named == section)
            && d.hint.as_ref().is_some_and(|hint| hint.contains(OTHER_CHOICES));
        let is_of_loop =
            has_other_loop && d.problem == DiagnosticKind::WrongType && d.path.starts_with("verify.");
        !is_of_choice && !is_of_loop
    });
}

/// Words of the hint at a key that other choices have.
const OTHER_CHOICES: &str = "only with other choices than these";

fn guide() -> &'static Guide {
    static GUIDE: OnceLock<Guide> = OnceLock::new();
    GUIDE.get_or_init(|| {
        let mut guide = Guide::default();
        for walk in SOME_WALKS {
            guide.turn(walk);
            file(&mut guide, &mut Project::blank());
        }
        guide
    })
}

/// Returns a path without the numbers of items: the guide knows lists, not their lengths.
fn without_numbers(path: &str) -> String {
    path.split('.').map(|part| part.split('[').next().unwrap_or(part)).collect::<Vec<_>>().join(".")
}

fn words(own: &str, name: &str, places: &Places) -> Option<String> {
    let section =
        |path: &str| if path.is_empty() { "the top of the file".to_owned() } else { format!("[{path}]") };
    let list = |paths: &[String]| paths.iter().map(|path| section(path)).collect::<Vec<_>>().join(" or ");
    let few = |paths: &[String]| (1..=MOST_PLACES).contains(&paths.len());
    if places.of_key.iter().any(|path| path == own) {
        return Some(format!("{} has the key \"{name}\" {OTHER_CHOICES}", section(own)));
    }
    if few(&places.of_key) {
        return Some(format!("\"{name}\" is a key of {}", list(&places.of_key)));
    }
    let is_part = |path: &&String| path.rsplit_once('.').is_some_and(|(outer, _)| outer == own);
    let parts: Vec<String> = places.of_key.iter().filter(is_part).cloned().collect();
    if (1..=MOST_PARTS).contains(&parts.len()) {
        return Some(format!("\"{name}\" is a key of {}", list(&parts)));
    }
    few(&places.sections).then(|| format!("the section of this name is {}", list(&places.sections)))
}
