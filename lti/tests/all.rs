//! All suites of `counterpoise-lti` in one program, so that it is linked once and the suites share the processors. Each is a file beside this one:
//! `cargo test --release -p counterpoise-lti --test all NAME` runs one.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod descriptor;
mod hard;
mod high_order;
mod margins;
#[path = "../../linalg/tests/support/odd.rs"]
mod odd;
mod odd_calls;
mod properties;
mod stiff;
