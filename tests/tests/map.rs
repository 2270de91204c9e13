//! The map is law: ARCHITECTURE.md's table of crates is compared with Cargo's own manifests.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

type Graph = BTreeMap<String, BTreeSet<String>>;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Rows `| `folder/` | package | may use | ...` of the table headed by "crate".
fn graph_on_the_map() -> Graph {
    let page = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let rows = page.lines().skip_while(|line| !line.starts_with("| crate")).skip(2);
    rows.take_while(|line| line.starts_with('|')).map(row).collect()
}

fn row(line: &str) -> (String, BTreeSet<String>) {
    let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
    let folder = cells[0].trim_matches('`').trim_end_matches('/').to_owned();
    let uses = cells[2].split(',').map(str::trim).filter(|name| !name.is_empty() && *name != "-");
    (folder, uses.map(str::to_owned).collect())
}

/// Every member of the workspace with the members it depends on (development dependencies apart).
fn graph_in_cargo() -> Graph {
    let workspace: toml::Table = fs::read_to_string(root().join("Cargo.toml")).unwrap().parse().unwrap();
    let members = workspace["workspace"]["members"].as_array().unwrap();
    members
        .iter()
        .map(|member| member.as_str().unwrap())
        .map(|folder| (folder.to_owned(), uses(folder)))
        .collect()
}

fn uses(folder: &str) -> BTreeSet<String> {
    let manifest = fs::read_to_string(root().join(folder).join("Cargo.toml")).unwrap();
    let manifest: toml::Table = manifest.parse().unwrap();
    let names = manifest["dependencies"].as_table().unwrap().keys();
    names.filter_map(|name| name.strip_prefix("counterpoise-")).map(str::to_owned).collect()
}

#[test]
fn architecture_page_matches_cargo() {
    assert_eq!(graph_on_the_map(), graph_in_cargo());
}

#[test]
fn nothing_below_host_touches_the_operating_system() {
    let forbidden = ["std::fs", "std::thread", "std::time", "std::env", "println!", "eprintln!", "rayon"];
    for room in [
        "linalg",
        "lti",
        "recordings",
        "controller",
        "models",
        "reduce",
        "synth",
        "simulate",
        "verify",
        "diagnose",
        "export",
        "project",
        "pipeline",
        "plot",
        "report",
        "claims",
    ] {
        for file in rust_files(&root().join(room).join("src")) {
            let text = fs::read_to_string(&file).unwrap();
            let code = text.split("#[cfg(test)]").next().unwrap();
            let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
            for line in lines {
                for word in forbidden {
                    assert!(!line.contains(word), "{}: {word} in: {line}", file.display());
                }
            }
        }
    }
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(rust_files(&path));
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}
