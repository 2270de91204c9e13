//! A file with one section or key left out: it is read, with what is assumed, or fails with one sentence that names what to add.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_project::{Attachments, Document, Project};

const GOOD: &str = include_str!("data/rig.toml");

/// Keys whose absence means something else than a value: names, choices, lists.
fn is_no_quantity(key: &str) -> bool {
    let last = key.rsplit('.').next().unwrap_or(key);
    key.contains('[') || ["name", "model", "shape", "map"].contains(&last)
}

/// Every key of a project, and every section, in the order of its file.
fn paths(project: &Project) -> Vec<String> {
    let sections = project.statements();
    let keys = sections.iter().flat_map(|s| s.values.iter().map(move |v| format!("{}.{}", s.path, v.key)));
    let named = sections.iter().map(|s| s.path.clone()).filter(|path| !path.ends_with(']'));
    named.chain(keys).collect()
}

/// Checks what is said of a file without one key or section.
fn judged(document: &Document, path: &str) -> Option<String> {
    match Project::resolve(document, &Attachments::none()) {
        Ok(parsed) => {
            let physical = path.starts_with("plant.") && !is_no_quantity(path);
            let is_key = !parsed.project.statements().iter().any(|s| s.path == path);
            let listed =
                parsed.assumptions.iter().any(|a| a.key == path || a.key.starts_with(&format!("{path}.")));
            (physical && is_key && !listed && !is_optional_section(path))
                .then(|| format!("{path}: read, but not listed as assumed"))
        }
        Err(errors) => {
            let said: Vec<String> = errors.iter().map(ToString::to_string).collect();
            let parent = path.rsplit_once('.').map_or(path, |(parent, _)| parent);
            let last = path.rsplit('.').next().unwrap_or(path);
            let names = |line: &String| {
                line.contains(path)
                    || (line.contains(parent) && line.contains(last.split('[').next().unwrap()))
            };
            (said.len() != 1 || !said.iter().any(names)).then(|| format!("{path}: {}", said.join("\n    ")))
        }
    }
}

/// Sections whose absence is a machine without the thing: nothing is assumed of what is not there.
fn is_optional_section(path: &str) -> bool {
    let sections = [
        "beam",
        "lumped",
        "import",
        "configuration",
        "motor_tachometer",
        "hub_resolver",
        "amplifier",
        "friction",
        "sensors",
        "gearbox",
        "motor",
    ];
    path.split('.').skip(1).any(|part| sections.contains(&part)) && path.matches('.').count() < 3
}

#[test]
fn each_key_left_out_is_assumed_or_asked_for_in_one_sentence() {
    let document = Document::parse(GOOD, "rig.toml");
    let project = Project::resolve(&document, &Attachments::none()).unwrap().project;
    let paths = paths(&project);
    assert!(paths.len() > 150, "{}", paths.len());
    let wrong: Vec<String> = paths
        .iter()
        .filter_map(|path| {
            let without = document.remove(path).unwrap();
            judged(&without, path)
        })
        .collect();
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), paths.len(), wrong.join("\n"));
}
