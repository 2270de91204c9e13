//! All suites of `counterpoise-export` in one program, so that it is linked once and the suites share the processors. Each is a file beside this one:
//! `cargo test --release -p counterpoise-export --test all NAME` runs one.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

mod analysers;
mod blocks;
mod c99;
mod estimators;
mod faults;
mod fixed;
mod fmi;
mod hostile_text;
mod interrupt;
mod plants;
mod processor;
mod rust_crate;
