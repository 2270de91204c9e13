//! All suites of `counterpoise-studio` in one program, so that it is linked once and the suites share the processors. Each is a file beside this one:
//! `cargo test --release -p counterpoise-studio --test all NAME` runs one.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

mod commissioning;
mod crash_recovery;
mod cross_plot;
mod design_history;
mod examples;
mod file_commands;
mod frame_times;
mod help;
mod journal_fuzz;
mod page_contents;
mod pages;
mod pictures;
mod plot_tiles;
mod project_text;
mod requirement_limits;
mod same_recordings;
mod save_kills;
mod slow_disk;
mod studies;
mod trust;
mod user_actions;
