//! The files of the studio use each other in one direction: there is no circle among them.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

type Module = Vec<String>;

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries
        .flat_map(|path| match path.is_dir() {
            true => rust_files(&path),
            false => vec![path],
        })
        .collect()
}

/// Returns every module of the crate with the code of its file.
fn modules() -> BTreeMap<Module, String> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let module = |path: &PathBuf| -> Module {
        let inside = path.strip_prefix(&source).unwrap().with_extension("");
        let mut names: Module = inside.iter().map(|name| name.to_string_lossy().into_owned()).collect();
        names.pop_if(|last| last == "mod");
        names
    };
    let code = |path: &PathBuf| {
        let text = fs::read_to_string(path).unwrap();
        let lines = text.lines().filter(|line| !line.trim_start().starts_with("//"));
        lines.collect::<Vec<_>>().join("\n")
    };
    let all = rust_files(&source).into_iter().map(|path| (module(&path), code(&path)));
    all.filter(|(module, _)| !["lib", "main"].contains(&module[0].as_str())).collect()
}

/// Returns the paths that begin with `crate::` or `super::`, with the items of one level of braces.
fn used_paths(own: &Module, code: &str) -> Vec<Module> {
    let mut paths = Vec::new();
    for (prefix, base) in [("crate::", Vec::new()), ("super::", own[..own.len() - 1].to_vec())] {
        for (start, _) in code.match_indices(prefix) {
            let rest = &code[start + prefix.len()..];
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_' && c != ':').unwrap_or(rest.len());
            let path = rest[..end].split("::").filter(|name| !name.is_empty()).map(str::to_owned);
            let path: Module = base.iter().cloned().chain(path).collect();
            if let Some(items) = rest[end..].strip_prefix('{').and_then(|list| list.split('}').next()) {
                for item in items.split(',') {
                    let names = item.trim().split("::").map(str::to_owned);
                    paths.push(path.iter().cloned().chain(names).collect());
                }
            }
            paths.push(path);
        }
    }
    paths
}

fn reaches(graph: &BTreeMap<Module, BTreeSet<Module>>, from: &Module, goal: &Module) -> bool {
    let (mut open, mut seen) = (vec![from.clone()], BTreeSet::new());
    while let Some(module) = open.pop() {
        for next in &graph[&module] {
            if next == goal {
                return true;
            }
            if seen.insert(next.clone()) {
                open.push(next.clone());
            }
        }
    }
    false
}

#[test]
fn no_file_uses_itself_through_others() {
    let modules = modules();
    let resolved = |path: &Module| {
        (1..=path.len()).rev().map(|n| path[..n].to_vec()).find(|module| modules.contains_key(module))
    };
    let uses = |(own, code): (&Module, &String)| {
        let found = used_paths(own, code).iter().filter_map(&resolved).filter(|used| used != own).collect();
        (own.clone(), found)
    };
    let graph: BTreeMap<Module, BTreeSet<Module>> = modules.iter().map(uses).collect();
    assert!(graph.values().map(BTreeSet::len).sum::<usize>() > 100, "the uses are found");
    let circular: Vec<String> =
        graph.keys().filter(|module| reaches(&graph, module, module)).map(|m| m.join("::")).collect();
    assert!(circular.is_empty(), "files that use each other in a circle: {circular:?}");
}
