//! The sections to which keys belong that are unknown in theirs.

use std::sync::OnceLock;

use super::{Project, file};
use crate::diagnostic::{Diagnostic, DiagnosticKind};
use crate::file::Document;
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

/// Drops findings that are no more than the consequence of another one: keys that a choice has which is missing or which a unit asks for, and units of a loop whose
/// sensor is missing.
pub(super) fn drop_consequences(document: &Document, findings: &mut Vec<Diagnostic>) {
    drop_keys_of_missing_choices(document, findings);
    let names_choice = |d: &Diagnostic| {
        d.problem == DiagnosticKind::WrongType && d.hint.as_ref().is_some_and(|h| h.contains("add kind"))
    };
    let sections: Vec<String> = findings
        .iter()
        .filter(|d| names_choice(d))
        .filter_map(|d| Some(d.path.rsplit_once('.')?.0.to_owned()))
        .collect();
    let has_other_loop = findings.iter().any(|d| d.path == "synth.loop");
    // An inertia in the wrong place leaves its right place empty, or is not known there.
    let is_misplaced = |d: &Diagnostic| d.path == "plant.inertia" && d.problem == DiagnosticKind::OutOfRange;
    let has_misplaced_inertia = findings.iter().any(is_misplaced);
    findings.retain(|d| {
        let section = d.path.rsplit_once('.').map_or("", |(section, _)| section);
        let is_of_choice = d.problem == DiagnosticKind::UnknownKey
            && sections.iter().any(|named| named == section)
            && d.hint.as_ref().is_some_and(|hint| hint.contains(OTHER_CHOICES));
        let is_of_loop =
            has_other_loop && d.problem == DiagnosticKind::WrongType && d.path.starts_with("verify.");
        let is_of_inertia = has_misplaced_inertia
            && (d.path == "plant.lumped.hub_inertia" && d.problem == DiagnosticKind::Missing
                || d.path == "plant.inertia" && d.problem == DiagnosticKind::UnknownKey);
        !is_of_choice && !is_of_loop && !is_of_inertia
    });
}

/// Keys that choose which other keys a section has.
const CHOICES: [&str; 4] = ["kind", "model", "shape", "damping"];

/// Leaves of the keys of a section that a missing choice would have the first, with the choice as a hint, and drops what the choice that stands in for it would need.
fn drop_keys_of_missing_choices(document: &Document, findings: &mut Vec<Diagnostic>) {
    let section_of = |d: &Diagnostic| d.path.rsplit_once('.').map_or("", |(section, _)| section).to_owned();
    let is_key_of = |key: &str, section: &str| {
        guide().places_of(key).of_key.iter().any(|path| *path == without_numbers(section))
    };
    let missing_choice = |section: &str| {
        let choice = CHOICES.iter().find(|key| is_key_of(key, section));
        choice.filter(|key| !document.has(&format!("{section}.{key}")))
    };
    let is_of_other_choice = |d: &Diagnostic| {
        let key = d.path.rsplit('.').next().unwrap_or(&d.path);
        d.problem == DiagnosticKind::UnknownKey && is_key_of(key, &section_of(d))
    };
    let mut named: Vec<String> = Vec::new();
    let is_kept = |d: &mut Diagnostic| {
        let section = section_of(d);
        let Some(choice) = missing_choice(&section) else { return true };
        if named.contains(&section) {
            // What is in no section that the guide knows belongs to a choice within the choice.
            let is_unknown = d.problem == DiagnosticKind::UnknownKey && d.hint.is_none();
            return !is_unknown && !is_of_other_choice(d);
        }
        if is_of_other_choice(d) {
            d.hint = Some(format!(
                "[{section}] has it {OTHER_CHOICES}: state `{choice}`, of which the reference has the names"
            ));
            named.push(section);
        }
        true
    };
    findings.retain_mut(is_kept);
    // A drive without its kind takes a torque, which has no current to measure.
    let of_drive = named.iter().any(|section| section == "plant.drive");
    findings.retain(|d| {
        let is_needed = d.problem == DiagnosticKind::Missing && named.contains(&section_of(d));
        !(is_needed || of_drive && d.path == "plant.sensors.current")
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
