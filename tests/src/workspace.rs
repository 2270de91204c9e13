//! The workspace as files: its members, their manifests and their sources.

use std::fs;
use std::path::{Path, PathBuf};

/// Returns the folder of the workspace.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Returns the folders of the members, in the order of the workspace's manifest.
pub fn members() -> Vec<String> {
    let members = manifest("").remove("workspace").unwrap()["members"].as_array().unwrap().clone();
    members.iter().map(|member| member.as_str().unwrap().to_owned()).collect()
}

/// Returns the manifest in a folder of the workspace; an empty name means the workspace's own.
pub fn manifest(folder: &str) -> toml::Table {
    fs::read_to_string(root().join(folder).join("Cargo.toml")).unwrap().parse().unwrap()
}

/// Returns the Rust files of a folder and the folders in it, sorted by path.
pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
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

/// Returns the Rust files of a member's sources, each with its text without unit tests.
pub fn sources(member: &str) -> Vec<(PathBuf, String)> {
    let read = |path: PathBuf| {
        let code = without_tests(&fs::read_to_string(&path).unwrap());
        (path, code)
    };
    rust_files(&root().join(member).join("src")).into_iter().map(read).collect()
}

/// Returns a text without the items that are compiled for tests alone, as rustfmt lays them out.
pub fn without_tests(text: &str) -> String {
    let mut kept = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        let Some(indent) = line.strip_suffix("#[cfg(test)]") else {
            kept.push(line);
            continue;
        };
        let item = lines.find(|line| !line.trim_start().starts_with("#[")).unwrap_or_default();
        if !item.ends_with([';', '}']) {
            let end = format!("{indent}}}");
            lines.find(|line| line.starts_with(&end));
        }
    }
    kept.join("\n")
}

/// Returns every name that a text imports from other crates of the workspace, as `crate::path::Name`, groups resolved.
pub fn imports(code: &str) -> Vec<String> {
    let mut all = Vec::new();
    for statement in code.split("\nuse ").skip(1).chain(code.strip_prefix("use ")) {
        let path = statement.split(';').next().unwrap();
        let path: String = path.split_whitespace().collect::<Vec<_>>().join(" ");
        if path.starts_with("counterpoise_") {
            resolve("", &path, &mut all);
        }
    }
    all
}

/// Returns the paths of an import, its groups resolved: `a::{b, c::d}` gives `a::b` and `a::c::d`.
pub fn grouped_paths(import: &str) -> Vec<String> {
    let mut all = Vec::new();
    resolve("", import, &mut all);
    all
}

/// Takes one group of braces after the other apart.
fn resolve(prefix: &str, path: &str, all: &mut Vec<String>) {
    let Some((head, group)) = path.split_once('{') else {
        return all.push(format!("{prefix}{}", path.trim()));
    };
    let inside = group.trim().strip_suffix('}').unwrap_or(group);
    let (mut depth, mut start) = (0, 0);
    for (at, letter) in inside.char_indices().chain([(inside.len(), ',')]) {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                let item = inside[start..at].trim();
                if !item.is_empty() {
                    resolve(&format!("{prefix}{}", head.trim()), item, all);
                }
                start = at + 1;
            }
            _ => {}
        }
    }
}
