//! The discrete controller as it runs on the target: what it reads, and every operation in order.
//!
//! In come discrete transfer paths; out goes a controller whose arithmetic is fixed to the last bit.
//!
//! *Invariant*: nothing here knows how a controller was designed, or what plant it drives.
//!
//! Modules in reading order: [`sampled`].
#![allow(non_snake_case)]

pub mod sampled;

pub use sampled::{ProportionalIntegral, Readings, SampledController};
