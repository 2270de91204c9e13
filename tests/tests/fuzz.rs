//! Readers fed what nobody meant: project files, recordings of five formats, texts for comments of generated code. Nothing panics,
//! nothing hangs, and no text leaves its comment.
//!
//! `FUZZ_SECONDS=600 cargo test --release -p counterpoise-tests --test fuzz -- --nocapture` runs each for ten minutes; another
//! `FUZZ_SEED` gives other changes. Inputs that once failed are kept in `tests/data/fuzz`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

#[path = "support/mutate.rs"]
mod mutate;

use counterpoise_controller::{Controller, Parts};
use counterpoise_export::Source::Unverified;
use counterpoise_export::{Options, Provenance, c99, rust_crate};
use counterpoise_project::{Attachments, Document, Project, Purpose};
use counterpoise_recordings::{CsvParts, Mapping, Table};
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
    if let Ok(table) = Table::read(bytes, "run") {
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

#[test]
fn csv_in_parts() {
    let words: [&[u8]; 5] = [b"\n", b",", b"\"", b"\xef\xbb\xbf", b"#"];
    let mut stored = corpus(&["app/tests/data", "tests/data/fuzz/recording"], &["csv"]);
    stored.iter_mut().for_each(|(_, bytes)| bytes.truncate(20_000));
    fuzz("csv-parts", &stored, &words, &|bytes| {
        // What is read in parts is what is read at once, wherever both can be read.
        let Ok(parts) = CsvParts::new(bytes, "run.csv", 7) else { return };
        let parts: Result<Vec<Table>, _> = parts.collect();
        if let (Ok(parts), Ok(whole)) = (parts, Table::read(bytes, "run.csv")) {
            for (k, column) in whole.columns.iter().enumerate() {
                let joined: Vec<u64> = parts
                    .iter()
                    .flat_map(|part| part.columns[k].values.iter().map(|v| v.to_bits()))
                    .collect();
                assert_eq!(joined, column.values.iter().map(|v| v.to_bits()).collect::<Vec<_>>());
            }
        }
    });
}

#[test]
fn texts_of_comments() {
    let controller = Controller::new(Parts::new(1e-3, 10.0)).unwrap();
    let words: [&[u8]; 9] =
        [b"*/", b"/*", b"\\", b"??/", b"\n", "\u{2028}".as_bytes(), "\u{85}".as_bytes(), b"-->", b"\r"];
    let stored = corpus(&["tests/data/fuzz/comment"], &["txt"]);
    fuzz("comment", &stored, &words, &|bytes| {
        let text = String::from_utf8_lossy(bytes).into_owned();
        let provenance = Provenance {
            project: text.clone(),
            weights: vec![text.clone()],
            feedback_alone: vec![text],
            ..Provenance::default()
        };
        let options = Options::double("axis");
        let c = c99(Unverified(&controller), &provenance, &options).unwrap();
        let plain = c99(Unverified(&controller), &Provenance::default(), &options).unwrap();
        let ends = |text: &str, end: &str| text.matches(end).count();
        for (file, plain) in c.iter().zip(&plain) {
            for end in ["*/", "/*", "??/", "\\\n", "\u{2028}", "\r"] {
                assert_eq!(ends(&file.text, end), ends(&plain.text, end), "{end:?} in {}", file.name);
            }
        }
        let rust = rust_crate(Unverified(&controller), &provenance, &options).unwrap();
        let code = |text: &str| text.lines().filter(|line| !line.starts_with("//!")).count();
        let plain = rust_crate(Unverified(&controller), &Provenance::default(), &options).unwrap();
        rust.iter().zip(&plain).for_each(|(file, plain)| assert_eq!(code(&file.text), code(&plain.text)));
    });
}
