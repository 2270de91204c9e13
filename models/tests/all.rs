//! All suites of `counterpoise-models` in one program, so that it is linked once and the suites share the processors. Each is a file beside this one:
//! `cargo test --release -p counterpoise-models --test all NAME` runs one.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod cylinder;
mod friction;
mod kinds;
mod learned;
mod learned_table;
mod loads;
mod plant;
mod structure;
