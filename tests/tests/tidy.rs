//! The code stays tidy: short functions, `lib.rs` pages that list their modules, no dependency that is not used.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;

use counterpoise_tests::workspace::{manifest, members, root, rust_files};

/// Most lines of a function, its signature and braces included.
const LONGEST_FUNCTION: usize = 60;

/// Returns the indent of a line on which a function with a body begins.
fn function_indent<'a>(lines: &[&'a str], start: usize) -> Option<&'a str> {
    let line = lines[start];
    let indent = &line[..line.len() - line.trim_start().len()];
    let words: Vec<&str> = line.split_whitespace().take_while(|word| !word.contains('(')).collect();
    let is_function = words.contains(&"fn") || line.trim_start().starts_with("fn ");
    let is_comment = line.trim_start().starts_with("//");
    let ends_at_once = line.trim_end().ends_with([';', '}']);
    (is_function && !is_comment && !ends_at_once).then_some(indent)
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
        for file in rust_files(&root().join(&folder).join("src")) {
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
    for folder in members().iter().filter(|folder| *folder != "tests") {
        let manifest = manifest(folder);
        let Some(dependencies) = manifest.get("dependencies") else { continue };
        let sources: String = rust_files(&root().join(folder).join("src"))
            .iter()
            .map(|file| fs::read_to_string(file).unwrap())
            .collect();
        for name in dependencies.as_table().unwrap().keys() {
            assert!(sources.contains(&name.replace('-', "_")), "{folder} does not use {name}");
        }
    }
}
