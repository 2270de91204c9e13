//! Suites that cross crates: the map, the golden projects, the road from project file to code, the sealed machines.
//!
//! The suites are in `tests/tests`; comparisons with tools that somebody else wrote are in `tests/peers`.
//!
//! *Invariant*: nothing here is used by the product.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

pub mod sealed;
