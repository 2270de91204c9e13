//! Readers with corrupted input: project files, recordings of five formats, texts for comments of generated code. Nothing panics,
//! nothing hangs, and no text leaves its comment.
//!
//! `FUZZ_SECONDS=600 cargo test --release -p counterpoise-tests --test all fuzz -- --nocapture` runs each for ten minutes; another
//! `FUZZ_SEED` gives other changes. Inputs that once failed are kept in `tests/data/fuzz`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

#[path = "support/mutate.rs"]
mod mutate;

use counterpoise_controller::{Controller, Parts};
use counterpoise_export::ExportSource::Unverified;
use counterpoise_export::fmi::{PlantUnit, controller_unit, plant_unit};
use counterpoise_export::{CodeOptions, File, Provenance, c99, rust_crate};
use counterpoise_models::{Plant, reference};
use counterpoise_project::{Attachments, Document, Project, Purpose};
use counterpoise_recordings::{CsvParts, Mapping, RecordingTable};
use mutate::{corpus, fuzz};

#[test]
fn project_files() {
    let words: [&[u8]; 12] = [
        b"1e308",
        b"-1e-308",
        b"nan",
        b"inf",
        b"[[",
        b"\"\\u001b\"",
        b"= [",
        b"99999999999999999999",
        b"\n[plant]\n",
        b"0.0",
        b"true",
        b"'''",
    ];
    let stored =
        corpus(&["examples", "project/tests/data", "project/src", "tests/data/fuzz/project"], &["toml"]);
    fuzz("project", &stored, &words, &|bytes| {
        let Ok(document) = Document::from_bytes(bytes, "project.toml") else { return };
        for purpose in [Purpose::Design, Purpose::Replay, Purpose::Sweep] {
            match Project::resolve_for(&document, &Attachments::none(), purpose) {
                Ok(parsed) => assert!(!parsed.project.to_text().is_empty()),
                Err(errors) => errors.iter().take(20).for_each(|error| drop(error.excerpt(document.text()))),
            }
        }
    });
}

fn read_recording(bytes: &[u8]) {
    if let Ok(table) = RecordingTable::read(bytes, "run") {
        let clock = Mapping { sample_period_s: Some(1e-3), ..Mapping::default() };
        drop(clock.recordings(&table));
    }
}

/// One test a format, so that each gets its time.
fn recordings(ending: &str) {
    let words: [&[u8]; 8] = [
        b"PAR1",
        b"MATLAB 5.0",
        b"\x89HDF\r\n\x1a\n",
        b"time [s],hub_rate [deg/s]\n",
        b"1e308,nan,,",
        &[0xff; 8],
        &[0x7f; 4],
        &[0; 16],
    ];
    let folders = ["recordings/tests/data", "app/tests/data", "tests/data/fuzz/recording", "examples"];
    let mut stored = corpus(&folders, &[ending]);
    // Large files are cut: what a reader does with a header and a beginning is what matters, and it should do it often.
    stored.iter_mut().for_each(|(_, bytes)| bytes.truncate(200_000));
    fuzz(ending, &stored, &words, &read_recording);
}

#[test]
fn csv_recordings() {
    recordings("csv");
}

#[test]
fn parquet_recordings() {
    recordings("parquet");
}

#[test]
fn matlab_recordings() {
    recordings("mat");
}

#[test]
fn hdf5_recordings() {
    recordings("h5");
}

/// Returns whether a table has one column of a name.
fn is_unique(name: &str, table: &RecordingTable) -> bool {
    table.columns.iter().filter(|column| column.name == name).count() == 1
}

#[test]
fn csv_in_parts() {
    let words: [&[u8]; 5] = [b"\n", b",", b"\"", b"\xef\xbb\xbf", b"#"];
    let mut stored = corpus(&["app/tests/data", "tests/data/fuzz/recording"], &["csv"]);
    stored.iter_mut().for_each(|(_, bytes)| bytes.truncate(20_000));
    fuzz("csv-parts", &stored, &words, &|bytes| {
        // What is read in parts is what is read at once, wherever both can be read.
        let Ok(parts) = CsvParts::new(bytes, "run.csv", 7) else { return };
        let parts: Result<Vec<RecordingTable>, _> = parts.collect();
        if let (Ok(parts), Ok(whole)) = (parts, RecordingTable::read(bytes, "run.csv")) {
            for column in whole.columns.iter().filter(|column| is_unique(&column.name, &whole)) {
                let alike = |part: &RecordingTable| {
                    part.columns.iter().find(|other| other.name == column.name).cloned()
                };
                let joined: Vec<u64> = parts
                    .iter()
                    .flat_map(|part| alike(part).unwrap().values.into_iter().map(f64::to_bits))
                    .collect();
                assert_eq!(joined, column.values.iter().map(|v| v.to_bits()).collect::<Vec<_>>());
            }
        }
    });
}

/// The files of all generated languages for a text that stands wherever a project's texts do.
fn generate_files(controller: &Controller, plant: &Plant, text: &str) -> Vec<File> {
    let text = text.to_owned();
    let provenance = Provenance {
        generator: text.clone(),
        project: text.clone(),
        project_hash: text.clone(),
        weights: vec![text.clone()],
        verdicts: vec![text.clone()],
        loop_signals: Some(text.clone()),
        feedback_alone: vec![text],
        ..Provenance::default()
    };
    let options = CodeOptions::double("axis");
    let mut files = c99(Unverified(controller), &provenance, &options).unwrap();
    files.extend(c99(Unverified(controller), &provenance, &CodeOptions::single("axis")).unwrap());
    files.extend(rust_crate(Unverified(controller), &provenance, &options).unwrap());
    files.extend(controller_unit(Unverified(controller), &provenance, &options).unwrap());
    files.extend(plant_unit(PlantUnit { plant, name: "axis_plant" }, &provenance).unwrap());
    files
}

/// The sequences that no text of a project may add to a file: those that end a comment, an attribute or a line, in any of the languages.
const ENDS: [&str; 18] = [
    "*/", "/*", "??/", "\\", "\u{2028}", "\u{2029}", "\u{85}", "\r", "\0", "\u{b}", "\u{c}", "\"", "<",
    "-->", "]]>", "&", "{", "(*",
];

/// The same for XML.
const MARKUP_ENDS: [&str; 3] = ["<", ">", "\""];

#[test]
fn texts_of_comments() {
    let controller = Controller::new(Parts::new(1e-3, 10.0)).unwrap();
    let plant = Plant::from_lumped(&reference::rig()).unwrap();
    let words: [&[u8]; 14] = [
        b"*/",
        b"/*",
        b"\\",
        b"??/",
        b"\n",
        "\u{2028}".as_bytes(),
        "\u{85}".as_bytes(),
        b"-->",
        b"\r",
        b"]]>",
        b"\"",
        b"{{ 7 }}",
        b"*)",
        b"\n#include </etc/passwd>\n",
    ];
    let plain = generate_files(&controller, &plant, "plain");
    let stored = corpus(&["tests/data/fuzz/comment"], &["txt"]);
    fuzz("comment", &stored, &words, &|bytes| {
        let found = generate_files(&controller, &plant, &String::from_utf8_lossy(bytes));
        for (file, plain) in found.iter().zip(&plain) {
            assert_eq!(file.name, plain.name);
            // Texts in XML are escaped: its comments and attributes have ends of their own.
            let is_markup = file.name.ends_with(".xml");
            for end in if is_markup { &MARKUP_ENDS[..] } else { &ENDS[..] } {
                let count = |text: &str| text.matches(end).count();
                assert_eq!(count(&file.text), count(&plain.text), "{end:?} in {}", file.name);
            }
            if is_markup {
                continue;
            }
            // A long text takes more lines, all of them in the comment.
            let is_comment = |line: &&str| [" * ", "//!"].iter().any(|mark| line.starts_with(mark));
            let code = |text: &str| text.lines().filter(|line| !is_comment(line)).count();
            assert_eq!(code(&file.text), code(&plain.text), "{}", file.name);
        }
    });
}
