//! All suites of `counterpoise-tests` in one program, so that it is linked once and the suites share the processors. Each is a file beside this one:
//! `cargo test --release -p counterpoise-tests --test all NAME` runs one.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod adaptation_trials;
mod bench;
mod certificates;
mod choices;
mod comments;
mod contributing;
mod data_sheets;
#[cfg(feature = "evidence")]
mod design_table;
mod designs;
mod every_example;
#[cfg(feature = "evidence")]
mod exported_recordings;
mod fuzz;
mod glossary;
mod imported_controllers;
mod kinds_diagnosed;
mod large_steps;
mod machine_kinds;
mod map;
mod module_circles;
mod plants;
mod practice;
mod random_machines;
mod realisations;
mod recorded_controllers;
mod recorder_examined;
mod recorder_faults;
mod saved_models;
mod sealed;
mod supply;
mod thesis_examples;
mod tidy;
mod tolerances;
