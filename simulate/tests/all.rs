//! All suites of `counterpoise-simulate` in one program, so that it is linked once and the suites share the processors. Each is a file beside this one:
//! `cargo test --release -p counterpoise-simulate --test all NAME` runs one.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

mod alignment;
mod base_motion;
mod convergence;
mod cylinder;
mod ensemble;
mod fra;
mod loads;
mod replay;
mod sampled_world;
mod second_method;
mod sensitivity;
mod sticking;
mod stiff_drive;
mod two_axes;
