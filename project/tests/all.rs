//! All suites of `counterpoise-project` in one program, so that it is linked once and the suites share the processors. Each is a file beside this one:
//! `cargo test --release -p counterpoise-project --test all NAME` runs one.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod bad_files;
mod base_motion;
mod cylinder;
mod every_section;
mod import_cache;
mod imported_controllers;
mod omissions;
mod parts_and_tolerances;
mod plant_and_platform;
mod project_file;
mod quantities;
mod reference;
mod saved_drives;
