//! The map is law: ARCHITECTURE.md's table of crates is compared with Cargo's own manifests.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

use counterpoise_tests::workspace::{imports, manifest, members, root, sources};

type Graph = BTreeMap<String, BTreeSet<String>>;

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
    members().into_iter().map(|folder| (folder.clone(), uses(&folder))).collect()
}

fn uses(folder: &str) -> BTreeSet<String> {
    let manifest = manifest(folder);
    let names = manifest["dependencies"].as_table().unwrap().keys();
    // the command line is the package that has the product's own name
    let folder = |name: &str| match name {
        "counterpoise" => Some("app".to_owned()),
        _ => name.strip_prefix("counterpoise-").map(str::to_owned),
    };
    names.filter_map(|name| folder(name)).collect()
}

#[test]
fn architecture_page_matches_cargo() {
    assert_eq!(graph_on_the_map(), graph_in_cargo());
}

#[test]
fn nothing_below_host_touches_the_operating_system() {
    let forbidden = ["std::fs", "std::thread", "std::time", "std::env", "println!", "eprintln!", "rayon"];
    for room in [
        "pool",
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
        for (file, code) in sources(room) {
            let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
            for line in lines {
                for word in forbidden {
                    assert!(!line.contains(word), "{}: {word} in: {line}", file.display());
                }
            }
        }
    }
}

#[test]
fn front_ends_reach_files_threads_clocks_and_programs_through_host() {
    let forbidden = [
        "std::fs",
        "std::thread",
        "process::Command",
        "time::Instant",
        "Instant::now",
        "rayon",
        ".read_dir()",
        ".canonicalize()",
    ];
    for front_end in ["app", "studio", "python"] {
        let own = sources(front_end).into_iter();
        // the page of the commands is written by a test
        for (file, code) in own.filter(|(file, _)| !file.ends_with("commands_page.rs")) {
            let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
            for line in lines {
                for word in forbidden {
                    assert!(!line.contains(word), "{}: {word} in: {line}", file.display());
                }
            }
        }
    }
}

/// Crates that compute. What a report imports from them must be a type or a constant, never a function or a module of functions.
const COMPUTING: [&str; 12] = [
    "linalg",
    "lti",
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
];

#[test]
fn a_report_presents_results_and_calls_nothing_that_computes() {
    for (file, code) in sources("report") {
        let imported = imports(&code);
        let computing =
            |path: &&String| COMPUTING.iter().any(|name| path.starts_with(&format!("counterpoise_{name}::")));
        for path in imported.iter().filter(computing) {
            let name = path.rsplit("::").next().unwrap();
            assert!(
                name.starts_with(char::is_uppercase),
                "{} imports {path}, which is no type",
                file.display()
            );
            let calls = format!("{name}::");
            let lines = code.lines().filter(|line| !line.trim_start().starts_with("use "));
            for line in lines {
                for (at, _) in
                    line.match_indices(&calls).filter(|(at, _)| !line[..*at].ends_with(is_part_of_name))
                {
                    let called = &line[at + calls.len()..];
                    assert!(!called.starts_with(char::is_lowercase), "{}: {line}", file.display());
                }
            }
        }
        for name in COMPUTING {
            for (at, _) in code.match_indices(&format!("counterpoise_{name}::")) {
                let path: String = code[at..]
                    .chars()
                    .take_while(|c| is_part_of_name(*c) || *c == ':' || *c == '{')
                    .collect();
                let is_import = code[..at].ends_with("use ");
                let last = path.rsplit("::").next().unwrap();
                assert!(is_import || last.starts_with(char::is_uppercase), "{}: {path}", file.display());
            }
        }
    }
}

/// What people read is worded for them: no value is shown by the name that it has in the code.
#[test]
fn nothing_that_people_read_is_printed_as_debug_prints_it() {
    for front_end in ["report", "app"] {
        for (file, code) in sources(front_end) {
            let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
            for line in lines {
                assert!(!line.contains(":?}"), "{}: {line}", file.display());
            }
        }
    }
}

/// Returns the paths `crate::module::Item` of a page, each of two parts at least, whose first one is a member of the workspace.
fn code_paths(page: &str) -> Vec<String> {
    let known = members();
    let pieces = page.split('`').skip(1).step_by(2);
    let is_path = |piece: &&str| {
        piece.contains("::") && piece.chars().all(|letter| is_part_of_name(letter) || letter == ':')
    };
    let begins = |piece: &&str| {
        piece.split("::").next().is_some_and(|first| known.iter().any(|member| member == first))
    };
    pieces.filter(is_path).filter(begins).map(str::to_owned).collect()
}

/// Returns whether a source declares an item: a module, a type, a function, a constant, a variant or a re-export of one.
fn declares(code: &str, name: &str) -> bool {
    let is_word = |at: usize| {
        !code[..at].ends_with(is_part_of_name) && !code[at + name.len()..].starts_with(is_part_of_name)
    };
    let keywords = ["mod ", "struct ", "enum ", "trait ", "type ", "fn ", "const ", "static "];
    code.match_indices(name).filter(|(at, _)| is_word(*at)).any(|(at, _)| {
        keywords.iter().any(|keyword| code[..at].ends_with(keyword))
            || code[..at].rsplit('\n').next().is_some_and(|line| line.trim().is_empty())
    })
}

#[test]
fn every_item_that_the_architecture_names_exists() {
    let page = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let mut wrong = Vec::new();
    for path in code_paths(&page) {
        let (member, items) = path.split_once("::").unwrap();
        let sources = sources(member);
        for item in items.split("::") {
            let is_file = |file: &std::path::Path| file.file_stem().is_some_and(|stem| stem == item);
            if !sources.iter().any(|(file, code)| is_file(file) || declares(code, item)) {
                wrong.push(format!("{path}: {member} has no {item}"));
            }
        }
    }
    assert!(wrong.is_empty(), "ARCHITECTURE.md names what is not there:\n{}", wrong.join("\n"));
    assert!(code_paths(&page).len() > 10);
}

#[test]
fn declared_items_are_told_from_mentioned_ones() {
    let code =
        "pub struct Mat {\n}\nimpl Mat {\n    pub fn zeros() {}\n}\nenum One {\n    Two,\n}\nuse a::Three;\n";
    assert!(["Mat", "zeros", "One", "Two"].iter().all(|name| declares(code, name)));
    assert!(!["Three", "Ma", "Four"].iter().any(|name| declares(code, name)));
}

fn is_part_of_name(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_'
}

#[test]
fn groups_of_imports_are_resolved() {
    let code = "use counterpoise_verify::{Figure, structured::{Bounds, bounds}};\nuse std::fs;\nuse counterpoise_linalg::C64;\n";
    let found = imports(code);
    for path in ["verify::Figure", "verify::structured::Bounds", "verify::structured::bounds", "linalg::C64"]
    {
        assert!(found.contains(&format!("counterpoise_{path}")), "{path} in {found:?}");
    }
    assert_eq!(found.len(), 4);
}

/// Returns the dependencies that Cargo chooses for a selection of packages, each with its features, as it compiles them for the target.
fn chosen_dependencies(selection: &[&str], kinds: &str) -> BTreeSet<String> {
    let mut cargo = std::process::Command::new(env!("CARGO"));
    cargo.current_dir(root()).args(["tree", "--offline", "--prefix=none", "--format={p} {f}"]);
    let output = cargo.args(["--edges", kinds]).args(selection).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().map(|line| line.trim_end_matches(" (*)").to_owned()).collect()
}

/// Whoever builds one package, the command line say, and then everything compiles no dependency twice.
#[test]
fn every_selection_of_packages_chooses_the_same_features() {
    let whole = chosen_dependencies(&["--workspace"], "normal,dev,no-proc-macro");
    for folder in members() {
        let name = manifest(&folder)["package"]["name"].as_str().unwrap().to_owned();
        let own = chosen_dependencies(&["--package", &name], "normal,no-proc-macro");
        let other: Vec<&String> = own.difference(&whole).collect();
        assert!(
            other.is_empty(),
            "{name} chooses other features than the workspace: {other:?}; see features/Cargo.toml"
        );
    }
}
