//! Suites that cross crates: the map, the golden projects, the road from project file to code.
//!
//! The suites are in `tests/tests`; comparisons with tools that somebody else wrote are in `tests/peers`.
//!
//! *Invariant*: nothing here is used by the product.
