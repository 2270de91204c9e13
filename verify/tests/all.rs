//! All suites of `counterpoise-verify` in one program, so that it is linked once and the suites share the processors. Each is a file beside this one:
//! `cargo test --release -p counterpoise-verify --test all NAME` runs one.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

mod base_motion;
mod linear_loop;
mod multipliers;
mod robust;
mod root_locus;
mod sight_budget;
mod structured;
mod verification;
