//! All suites of `counterpoise-diagnose` in one program, so that it is linked once and the suites share the processors. Each is a file beside this one:
//! `cargo test --release -p counterpoise-diagnose --test all NAME` runs one.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

mod alignment;
mod exact_slopes;
mod friction_laws;
mod hose;
mod identify;
mod intervals;
mod learning;
mod loads;
mod reading;
mod search;
