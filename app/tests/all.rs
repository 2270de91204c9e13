//! All suites of `counterpoise` in one program, so that it is linked once and the suites share the processors. Each is a file beside this one:
//! `cargo test --release -p counterpoise --test all NAME` runs one.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

mod check;
mod commission;
mod data_files;
mod exit_codes;
mod front;
mod hostile_projects;
mod improved;
mod interrupts;
mod kills;
mod new;
mod pages;
mod recordings;
mod refusals;
mod report;
mod results_page;
mod shards;
mod surroundings;
mod sweep;
