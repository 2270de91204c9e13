//! All suites of `counterpoise-synth` in one program, so that it is linked once and the suites share the processors. Each is a file beside this one:
//! `cargo test --release -p counterpoise-synth --test all NAME` runs one.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

mod adaptation;
mod alternatives;
mod assembly;
mod cascade;
mod complaints;
mod feedback;
mod feedforward;
mod first_design;
mod generalised;
mod joint;
mod limits;
#[path = "../../linalg/tests/support/odd.rs"]
mod odd;
mod odd_calls;
mod preflight;
mod ramp;
mod rig;
mod sampled_data;
mod schedule;
mod search;
