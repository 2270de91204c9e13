//! All suites of `counterpoise-linalg` in one program, so that it is linked once and the suites share the processors. Each is a file beside this one:
//! `cargo test --release -p counterpoise-linalg --test all NAME` runs one.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

mod equations;
mod hard;
#[path = "support/odd.rs"]
mod odd;
mod odd_calls;
mod riccati;
mod riccati_parametric;
mod riccati_singular;
mod schur;
mod stiff;
mod symmetric;
