//! The files of a crate use each other in one direction: no file uses itself through others.
//!
//! A file uses another if it imports from it, names a path into it or passes its items on; an item that is passed on counts as used from the
//! file that defines it. A folder's `mod.rs` and the crate's `lib.rs` are its first page: files of the folder may take the types of that
//! page, and the page may pass on what they define.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::{BTreeMap, BTreeSet};

use counterpoise_tests::workspace::{grouped_paths, members, root, sources, without_tests};

/// A module by the names on the way to it; empty for the crate itself.
type Module = Vec<String>;

/// The modules of a crate with their code, and where the items that they pass on come from.
struct Crate {
    modules: BTreeMap<Module, String>,
    passed_on: BTreeMap<(Module, String), Vec<String>>,
}

impl Crate {
    fn read(member: &str) -> Self {
        let source = root().join(member).join("src");
        let mut modules = BTreeMap::new();
        for (path, code) in sources(member) {
            let inside = path.strip_prefix(&source).unwrap().with_extension("");
            let mut names: Module = inside.iter().map(|name| name.to_string_lossy().into_owned()).collect();
            names.pop_if(|last| ["mod", "lib", "main"].contains(&last.as_str()));
            let lines = code.lines().map(|line| line.split("//").next().unwrap());
            modules.insert(names, lines.collect::<Vec<_>>().join("\n"));
        }
        let mut found = Self { modules, passed_on: BTreeMap::new() };
        for (module, code) in &found.modules {
            for path in passed_on_paths(code) {
                let Some(path) = found.absolute(module, &path) else { continue };
                found.passed_on.insert((module.clone(), path.last().unwrap().clone()), path);
            }
        }
        found
    }

    /// Returns a path from the root of the crate; `None` if it leads into another crate.
    fn absolute(&self, module: &Module, path: &[String]) -> Option<Vec<String>> {
        let (first, rest) = path.split_first()?;
        let mut base = module.clone();
        let mut rest = rest;
        match first.as_str() {
            "crate" => base.clear(),
            "self" => {}
            "super" => {
                base.pop();
                while rest.first().is_some_and(|name| name == "super") {
                    base.pop();
                    rest = &rest[1..];
                }
            }
            child => {
                base.push(child.to_owned());
                self.modules.contains_key(&base).then_some(())?;
            }
        }
        base.extend(rest.iter().cloned());
        Some(base)
    }

    /// Returns the module in which the item at a path from the root is defined.
    fn defining(&self, path: &[String], steps: usize) -> Module {
        let inside = (0..=path.len()).rev().find(|n| self.modules.contains_key(&path[..*n])).unwrap_or(0);
        let module = path[..inside].to_vec();
        let source = path.get(inside).and_then(|item| self.passed_on.get(&(module.clone(), item.clone())));
        match source {
            Some(source) if steps > 0 => self.defining(source, steps - 1),
            _ => module,
        }
    }

    /// Returns the modules that a module uses, the first pages above it apart.
    fn uses(&self, module: &Module, code: &str) -> BTreeSet<Module> {
        let mut own = imported_paths(code, "");
        own.extend(inline_paths(code));
        let targets = |paths: Vec<Vec<String>>| -> Vec<Module> {
            let absolute = paths.iter().filter_map(|path| self.absolute(module, path));
            absolute.map(|path| self.defining(&path, 4)).collect()
        };
        let passed_on =
            targets(passed_on_paths(code)).into_iter().filter(|target| !target.starts_with(module));
        let all = targets(own).into_iter().chain(passed_on);
        all.filter(|target| !module.starts_with(target)).collect()
    }
}

/// Returns the paths that the `use` statements of the given visibility import.
fn imported_paths(code: &str, visibility: &str) -> Vec<Vec<String>> {
    let all = statements(code, visibility).into_iter().flat_map(|statement| grouped_paths(&statement));
    all.map(|path| names(&path)).collect()
}

/// Returns the paths whose items a file passes on.
fn passed_on_paths(code: &str) -> Vec<Vec<String>> {
    let visible = ["pub ", "pub(crate) ", "pub(super) "];
    visible.iter().flat_map(|visibility| imported_paths(code, visibility)).collect()
}

/// Returns what each `use` statement of the given visibility imports.
fn statements(code: &str, visibility: &str) -> Vec<String> {
    let start = format!("{visibility}use ");
    let lines = code.lines().scan(0, |at, line| {
        let here = *at;
        *at += line.len() + 1;
        Some((here, line))
    });
    let starts = lines.filter(|(_, line)| line.trim_start().starts_with(&start));
    starts
        .map(|(at, line)| {
            let from = at + line.find(&start).unwrap() + start.len();
            let statement = code[from..].split(';').next().unwrap();
            statement.split_whitespace().collect::<Vec<_>>().join(" ")
        })
        .collect()
}

/// Returns the names of a path, without what it is imported as.
fn names(path: &str) -> Vec<String> {
    let path = path.split(" as ").next().unwrap();
    path.split("::").map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect()
}

/// Returns whether an import begins on a line, whatever its visibility.
fn is_import(line: &str) -> bool {
    let line = line.trim_start();
    ["use ", "pub use ", "pub(crate) use ", "pub(super) use "].iter().any(|start| line.starts_with(start))
}

/// Returns the paths that stand in the code itself, outside of imports.
fn inline_paths(code: &str) -> Vec<Vec<String>> {
    let is_part = |letter: char| letter.is_alphanumeric() || letter == '_' || letter == ':';
    let statements = code.split_inclusive(';');
    let own = statements.filter(|statement| !statement.lines().any(is_import));
    let words = own.flat_map(|statement| statement.split(|letter: char| !is_part(letter)));
    words.filter(|word| word.contains("::") && !word.ends_with(':')).map(names).collect()
}

/// Returns whether `goal` is reached from `from` along the uses.
fn reaches(graph: &BTreeMap<Module, BTreeSet<Module>>, from: &Module, goal: &Module) -> bool {
    let (mut open, mut seen) = (vec![from], BTreeSet::new());
    while let Some(module) = open.pop() {
        for next in graph.get(module).into_iter().flatten() {
            if next == goal {
                return true;
            }
            if seen.insert(next) {
                open.push(next);
            }
        }
    }
    false
}

/// Returns the files of a crate that use themselves through others.
fn circular_files(member: &str) -> Vec<String> {
    let found = Crate::read(member);
    let graph: BTreeMap<Module, BTreeSet<Module>> =
        found.modules.iter().map(|(module, code)| (module.clone(), found.uses(module, code))).collect();
    let circular = graph.keys().filter(|module| reaches(&graph, module, module));
    circular.map(|module| format!("{member}: {}", module.join("::"))).collect()
}

#[test]
fn no_file_uses_itself_through_others() {
    let circular: Vec<String> = members().iter().flat_map(|member| circular_files(member)).collect();
    assert!(circular.is_empty(), "files that use each other in a circle:\n{}", circular.join("\n"));
}

#[test]
fn uses_are_found() {
    let found = Crate::read("report");
    let uses = |module: &str| found.uses(&vec![module.to_owned()], &found.modules[&vec![module.to_owned()]]);
    assert!(uses("verification").contains(&vec!["summary".to_owned()]), "a path in the code");
    assert!(uses("summary").contains(&vec!["page".to_owned()]), "an item that lib.rs passes on");
    let text = "mod a {\n    #[cfg(test)]\n    mod tests;\n    fn b() {}\n}\n#[cfg(test)]\nmod tests {\n    use super::*;\n}\nfn c() {}";
    assert_eq!(without_tests(text), "mod a {\n    fn b() {}\n}\nfn c() {}");
    assert!(
        uses("diagnosis").contains(&vec!["wording".to_owned(), "answer".to_owned()]),
        "an import of a group"
    );
}
