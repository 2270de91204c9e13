//! All suites of `counterpoise-pipeline` in one program, so that it is linked once and the suites share the processors. Each is a file beside this one:
//! `cargo test --release -p counterpoise-pipeline --test all NAME` runs one.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod bare_header;
mod commission;
mod first_steps;
mod fra;
mod inertial_unit;
mod preview;
mod requirements;
mod road;
mod two_axes;
mod weights_carried;
