//! All suites of `counterpoise-reduce` in one program, so that it is linked once and the suites share the processors. Each is a file beside this one:
//! `cargo test --release -p counterpoise-reduce --test all NAME` runs one.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod large;
mod meaning;
#[path = "../../linalg/tests/support/odd.rs"]
mod odd;
mod odd_calls;
mod properties;
#[path = "../../linalg/tests/common/mod.rs"]
mod random;
mod rigid;
mod units;
