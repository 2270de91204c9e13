//! All suites of `counterpoise-plot` in one program, so that it is linked once and the suites share the processors. Each is a file beside this one:
//! `cargo test --release -p counterpoise-plot --test all NAME` runs one.

mod figures;
mod ticks;
