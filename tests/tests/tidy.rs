//! The code stays tidy: short functions, `lib.rs` pages that list their modules, no dependency that is not used.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::Path;

use counterpoise_tests::workspace::{manifest, members, root, rust_files, sources};

/// Most lines of a function, its signature and braces included.
const LONGEST_FUNCTION: usize = 60;

/// Returns the indent of a line on which a function with a body begins, whatever its visibility.
fn function_indent<'a>(lines: &[&'a str], start: usize) -> Option<&'a str> {
    let line = lines[start];
    let indent = &line[..line.len() - line.trim_start().len()];
    let mut words = line.split_whitespace().take(6).take_while(|word| !word.starts_with("//"));
    let ends_at_once = line.trim_end().ends_with([';', '}']);
    (words.any(|word| word == "fn") && !ends_at_once).then_some(indent)
}

/// Returns the lines of the function that begins on a line; `None` if it has no body.
fn function_length(lines: &[&str], start: usize) -> Option<usize> {
    let indent = function_indent(lines, start)?;
    let (close, declared) = (format!("{indent}}}"), format!("{indent})"));
    for (count, line) in lines[start..].iter().enumerate() {
        if *line == close {
            return Some(count + 1);
        }
        if line.starts_with(&declared) && line.trim_end().ends_with(';') {
            return None;
        }
    }
    None
}

#[test]
fn functions_are_short() {
    let mut long = Vec::new();
    for folder in members() {
        for file in rust_files(&root().join(&folder)) {
            let text = fs::read_to_string(&file).unwrap();
            let lines: Vec<&str> = text.lines().collect();
            for start in 0..lines.len() {
                if let Some(length) = function_length(&lines, start).filter(|n| *n > LONGEST_FUNCTION) {
                    long.push(format!("{}:{}: {length} lines", file.display(), start + 1));
                }
            }
        }
    }
    assert!(long.is_empty(), "functions over {LONGEST_FUNCTION} lines:\n{}", long.join("\n"));
}

/// Functions that take a `bool` or a tuple because a trait of another crate says so: the file of each, and its name.
const GIVEN: [(&str, &str); 11] = [
    ("host/src/json.rs", "begin_object_key"),
    ("host/src/json.rs", "begin_array_value"),
    ("linalg/src/mat.rs", "index"),
    ("linalg/src/mat.rs", "index_mut"),
    ("plot/src/bitmap.rs", "draw_rect"),
    ("plot/src/bitmap.rs", "draw_circle"),
    ("plot/src/ruler.rs", "map"),
    ("plot/src/svg.rs", "draw_rect"),
    ("plot/src/svg.rs", "draw_circle"),
    ("plot/src/svg.rs", "blit_bitmap"),
    ("project/src/file/visit.rs", "from"),
];

/// Returns whether a trait of another crate says what a function of a file takes.
fn is_given(file: &Path, name: &str) -> bool {
    let path = file.strip_prefix(root()).unwrap().to_str().unwrap().replace('\\', "/");
    GIVEN.contains(&(path.as_str(), name))
}

/// Returns the declared functions of a source: line number, name and the types of its arguments.
fn declared(code: &str) -> Vec<Declared<'_>> {
    let mut found = Vec::new();
    let mut offset = 0;
    for (number, line) in code.lines().enumerate() {
        let start = offset;
        offset += line.len() + 1;
        let words: Vec<&str> = line.split_whitespace().take_while(|word| !word.starts_with("//")).collect();
        let Some(place) = words.iter().take(5).position(|word| *word == "fn") else { continue };
        let name = words.get(place + 1).map_or("", |word| word.split(['(', '<']).next().unwrap_or(word));
        let rest = &code[start + line.find("fn ").unwrap_or(0)..];
        found.push(Declared { line: number + 1, name, types: argument_types(rest) });
    }
    found
}

/// A function's name and the types of its arguments.
struct Declared<'a> {
    line: usize,
    name: &'a str,
    types: Vec<&'a str>,
}

/// Returns the types of the arguments of a declaration that begins with `fn`.
fn argument_types(declaration: &str) -> Vec<&str> {
    let (mut depth, mut start, mut types, mut before) = (0, None, Vec::new(), ' ');
    for (at, letter) in declaration.char_indices() {
        match letter {
            '(' | '[' | '<' => depth += 1,
            ')' | ']' => depth -= 1,
            '>' if before != '-' => depth -= 1,
            _ => {}
        }
        before = letter;
        let is_open = letter == '(' && depth == 1 && start.is_none();
        let ends = matches!(letter, ',') && depth == 1 || letter == ')' && depth == 0;
        if let (true, Some(from)) = (ends, start) {
            types.extend(declaration[from..at].split_once(": ").map(|(_, kind)| kind.trim()));
            start = Some(at + 1);
        }
        if is_open {
            start = Some(at + 1);
        }
        if letter == ')' && depth == 0 {
            break;
        }
    }
    types
}

/// Returns whether a type is a tuple, a reference to one, or an optional one. `(T)` and `(T + U)` are no tuples, and a list of pairs is
/// a table.
fn is_tuple(kind: &str) -> bool {
    let mut inner = kind;
    loop {
        let shorter = inner.trim_start_matches('&').trim_start_matches("mut ").trim_start();
        let shorter = match shorter.strip_prefix('\'').and_then(|rest| rest.split_once(' ')) {
            Some((_, rest)) => rest,
            None => shorter,
        };
        let shorter =
            ["Option<", "Box<"].iter().find_map(|outer| shorter.strip_prefix(outer)).unwrap_or(shorter);
        if shorter == inner {
            break;
        }
        inner = shorter;
    }
    inner.starts_with('(') && has_comma(inner)
}

/// Returns whether the bracket that a type begins with holds a comma of its own.
fn has_comma(kind: &str) -> bool {
    let (mut depth, mut before) = (0, ' ');
    for letter in kind.chars() {
        match letter {
            '(' | '[' | '<' => depth += 1,
            ')' | ']' => depth -= 1,
            '>' if before != '-' => depth -= 1,
            ',' if depth == 1 => return true,
            _ => {}
        }
        before = letter;
        if depth == 0 {
            return false;
        }
    }
    false
}

#[test]
fn arguments_have_names_for_their_values() {
    let mut wrong = Vec::new();
    for folder in members() {
        for (file, code) in sources(&folder) {
            for found in declared(&code).into_iter().filter(|found| !is_given(&file, found.name)) {
                let mut place = |what: &str| {
                    wrong.push(format!("{}:{}: {} takes {what}", file.display(), found.line, found.name));
                };
                if found.types.contains(&"bool") {
                    place("a bare bool: an enum says what it means");
                }
                if found.types.iter().any(|kind| is_tuple(kind)) {
                    place("a tuple: a struct or arguments of their own have names");
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn arguments_are_read_from_declarations() {
    let code = "pub fn one<T: Fn(f64) -> bool>(\n    a: &(f64, f64),\n    is_b: bool,\n) -> bool {\n}\n    fn two(&self, c: [f64; 2]) {}\n";
    let found = declared(code);
    assert_eq!((found[0].name, found[0].line), ("one", 1));
    assert_eq!(found[0].types, ["&(f64, f64)", "bool"]);
    assert_eq!((found[1].name, found[1].line), ("two", 6));
    assert_eq!(found[1].types, ["[f64; 2]"]);
}

#[test]
fn tuples_are_told_from_bounds() {
    let tuples = [
        "(f64, f64)",
        "&mut (A, Vec<B>)",
        "&'a (A, B)",
        "Option<(f64, u32)>",
        "Option<&(A, B)>",
        "(impl A, B)",
    ];
    assert!(tuples.iter().all(|kind| is_tuple(kind)));
    let others = [
        "()",
        "&(dyn Fn(A, B) + Sync)",
        "&(impl A<B, C> + D)",
        "Option<Box<A>>",
        "&[(A, B)]",
        "impl Fn(A, B)",
        "(A)",
    ];
    assert!(!others.iter().any(|kind| is_tuple(kind)));
}

#[test]
fn every_crate_lists_its_modules_on_its_first_page() {
    for folder in members().iter().filter(|folder| *folder != "tests") {
        let Ok(text) = fs::read_to_string(root().join(folder).join("src/lib.rs")) else { continue };
        let page: String = text.lines().filter(|line| line.starts_with("//!")).collect();
        for module in text.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';')) {
            let forms = [format!("[`{module}`]"), format!("[`mod@{module}`]"), format!("(mod@{module})")];
            assert!(
                forms.iter().any(|form| page.contains(form)),
                "{folder}/src/lib.rs does not list {module}"
            );
        }
    }
}

#[test]
fn every_dependency_is_used() {
    // `features` depends on packages for their features alone
    for folder in members().iter().filter(|folder| !["tests", "features"].contains(&folder.as_str())) {
        let manifest = manifest(folder);
        let Some(dependencies) = manifest.get("dependencies") else { continue };
        let sources: String = rust_files(&root().join(folder).join("src"))
            .iter()
            .map(|file| fs::read_to_string(file).unwrap())
            .collect();
        for name in dependencies.as_table().unwrap().keys().filter(|name| *name != "counterpoise-features") {
            assert!(sources.contains(&name.replace('-', "_")), "{folder} does not use {name}");
        }
    }
}

#[test]
fn crates_that_run_no_unit_tests_have_none() {
    for folder in members() {
        let manifest = manifest(&folder);
        let runs = manifest
            .get("lib")
            .and_then(|lib| lib.get("test"))
            .is_none_or(|test| test.as_bool() != Some(false));
        if runs {
            continue;
        }
        for file in rust_files(&root().join(&folder).join("src")) {
            let text = fs::read_to_string(&file).unwrap();
            let has_tests = text.lines().any(|line| line.trim_start().starts_with("#[cfg(test)]"));
            assert!(
                !has_tests,
                "{}: [lib] test = false in {folder}/Cargo.toml: its tests would not run",
                file.display()
            );
        }
    }
}

/// Returns the names and texts of a crate's test programs beside the one of all suites: evidence with features of its own.
fn programs_apart(folder: &str) -> Vec<(String, String)> {
    let manifest = manifest(folder);
    let programs = manifest.get("test").and_then(|tests| tests.as_array()).cloned().unwrap_or_default();
    let names = programs.iter().map(|program| program["name"].as_str().unwrap().to_owned());
    names
        .filter(|name| name != "all")
        .map(|name| {
            let code = fs::read_to_string(root().join(folder).join(format!("tests/{name}.rs"))).unwrap();
            (name, code)
        })
        .collect()
}

/// Returns whether a Rust file, or one in a folder, has a test.
fn holds_tests(path: &Path) -> bool {
    if path.is_dir() {
        return rust_files(path).iter().any(|file| holds_tests(file));
    }
    let is_rust = path.extension().is_some_and(|ending| ending == "rs");
    is_rust && fs::read_to_string(path).unwrap().contains("#[test]")
}

#[test]
fn every_suite_is_in_the_program_of_its_crate() {
    for folder in members() {
        let Ok(listed) = fs::read_to_string(root().join(&folder).join("tests/all.rs")) else { continue };
        let apart = programs_apart(&folder);
        for entry in fs::read_dir(root().join(&folder).join("tests")).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_stem().unwrap().to_str().unwrap();
            let is_suite = name != "all" && holds_tests(&path);
            let is_apart =
                apart.iter().any(|(program, code)| program == name || code.contains(&format!("mod {name};")));
            assert!(
                !is_suite || is_apart || listed.contains(&format!("mod {name};")),
                "{folder}/tests/all.rs does not list {name}: its tests would not run"
            );
        }
    }
}

#[test]
fn no_crate_passes_on_the_items_of_another() {
    for folder in members() {
        for (file, code) in sources(&folder) {
            let passed_on = code.lines().find(|line| {
                let line = line.trim_start();
                line.starts_with("pub use counterpoise_") || line.starts_with("pub use faer")
            });
            assert!(passed_on.is_none(), "{}: {}", file.display(), passed_on.unwrap_or_default());
        }
    }
}

/// Files with numbers below 1e-5 that decide nothing: units, physical values, ends of axes, and a probability that follows from its neighbour.
const SMALL_NUMBERS: [&str; 13] = [
    "claims/src/structure.rs",
    "diagnose/src/library/drive.rs",
    "export/src/rounding.rs",
    "linalg/src/compact.rs",
    "pipeline/src/reduction_views.rs",
    "recordings/src/clock.rs",
    "recordings/src/decode/numpy.rs",
    "recordings/src/time_unit.rs",
    "recordings/src/unit.rs",
    "report/src/targets.rs",
    "studio/src",
    "verify/src/image_motion.rs",
    "verify/src/signals/iso_road.rs",
];

/// Returns whether a line of code has a number below 1e-5.
fn has_small_number(line: &str) -> bool {
    let code = line.split("//").next().unwrap();
    code.match_indices("e-").any(|(at, _)| {
        let is_number = code[..at].ends_with(|letter: char| letter.is_ascii_digit());
        let exponent: String = code[at + 2..].chars().take_while(char::is_ascii_digit).collect();
        is_number && exponent.parse::<u32>().is_ok_and(|exponent| exponent > 5)
    })
}

#[test]
fn tolerances_stand_in_the_tolerance_file_of_their_crate() {
    let mut wrong = Vec::new();
    for folder in members() {
        for (file, code) in sources(&folder) {
            let path = file.strip_prefix(root()).unwrap().to_str().unwrap().replace('\\', "/");
            let is_exempt = SMALL_NUMBERS.iter().any(|exempt| path.starts_with(exempt));
            if is_exempt || path.contains("tolerance") || path.ends_with("tests.rs") || folder == "tests" {
                continue;
            }
            let lines = code.lines().enumerate().filter(|(_, line)| has_small_number(line));
            wrong.extend(lines.map(|(number, line)| format!("{path}:{}: {}", number + 1, line.trim())));
        }
    }
    assert!(wrong.is_empty(), "numbers that may decide, outside of a tolerance file:\n{}", wrong.join("\n"));
}

#[test]
fn comments_say_if_and_not_where_for_a_condition() {
    let mut wrong = Vec::new();
    for folder in members() {
        for file in rust_files(&root().join(folder).join("src")) {
            let text = fs::read_to_string(&file).unwrap();
            let says = |line: &&str| line.contains("`None` where") || line.contains("None where");
            wrong
                .extend(text.lines().filter(says).map(|line| format!("{}: {}", file.display(), line.trim())));
        }
    }
    assert!(wrong.is_empty(), "write \"returns `None` if\":\n{}", wrong.join("\n"));
}
