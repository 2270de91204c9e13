//! The desktop studio.
pub mod command;
pub mod journal;
pub mod keys;
pub mod knobs;
pub mod live;
pub mod session;
pub mod worker;
