//! Text of a project file stays inside the comments of generated code, whatever it holds.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::support;

use counterpoise_export::ExportSource::Unverified;
use counterpoise_export::fmi::{PlantUnit, controller_unit, plant_unit};
use counterpoise_export::{CodeOptions, File, Provenance, c99, rust_crate};
use counterpoise_models::{Plant, reference};
use support::typical_controller;

/// Texts that end a comment in one of the generated languages, or did after an earlier, unordered clean-up.
const HOSTILE: [&str; 10] = [
    "*/ int evil(void) { return 1; } /*",
    "*\\ int evil(void) { return 1; } /\\*",
    "*\\/ x",
    "??/\n#include </etc/passwd>",
    "a\u{2028}int evil;\u{2029}int worse;\u{85}",
    "\\\n*/",
    "*??/\n/",
    "--> <script>alert(1)</script> ]]>",
    "{{ 7 * 7 }}{% raw %}",
    "\r\n*/\0",
];

/// The texts that could end a comment, open one, continue a line, or reach a template engine.
const FORBIDDEN: [&str; 12] =
    ["*/", "/*", "\\", "??/", "\u{2028}", "\u{2029}", "\u{85}", "\r", "\0", "-->", "<script", "{{"];

fn generate_files(text: &str) -> Vec<File> {
    let provenance = Provenance {
        generator: "counterpoise".into(),
        project: text.into(),
        project_hash: "0".into(),
        weights: vec![text.into()],
        verdicts: vec![text.into()],
        ..Provenance::default()
    };
    let controller = typical_controller();
    let options = CodeOptions::double("axis");
    let plant = Plant::from_lumped(&reference::rig()).unwrap();
    let mut files = c99(Unverified(&controller), &provenance, &options).unwrap();
    files.extend(rust_crate(Unverified(&controller), &provenance, &options).unwrap());
    files.extend(controller_unit(Unverified(&controller), &provenance, &options).unwrap());
    files.extend(plant_unit(PlantUnit { plant: &plant, name: "axis_plant" }, &provenance).unwrap());
    files
}

fn count(text: &str, part: &str) -> usize {
    text.matches(part).count()
}

#[test]
fn hostile_text_adds_no_end_of_comment_to_any_generated_file() {
    let plain = generate_files("plain");
    for hostile in HOSTILE {
        for (file, plain) in generate_files(hostile).iter().zip(&plain) {
            assert_eq!(file.name, plain.name);
            for part in FORBIDDEN {
                assert_eq!(count(&file.text, part), count(&plain.text, part), "{part:?} in {}", file.name);
            }
        }
    }
}

/// Every line that the hostile text adds or changes is a line of a comment.
#[test]
fn hostile_text_changes_comments_only() {
    let plain = generate_files("plain");
    for hostile in HOSTILE {
        for (file, plain) in generate_files(hostile).iter().zip(&plain) {
            let code = |text: &str| {
                let is_comment = |line: &&str| line.starts_with(" * ") || line.starts_with("//! ");
                text.lines().filter(|line| !is_comment(line)).map(str::to_owned).collect::<Vec<_>>()
            };
            let differing = code(&file.text).into_iter().zip(code(&plain.text)).filter(|(a, b)| a != b);
            // The instantiation token of a unit, and the mark of a set, are hashes of all their text.
            let is_hash = |line: &str| (line.contains("{") && line.contains("-")) || line.contains("SET");
            let unexpected: Vec<_> = differing.filter(|(a, _)| !is_hash(a)).collect();
            assert!(unexpected.is_empty(), "{}: {unexpected:?}", file.name);
            assert_eq!(code(&file.text).len(), code(&plain.text).len(), "{}", file.name);
        }
    }
}
