//! The project as it is edited: its text with undo, the journal on disk, and where a number's meaning comes from.
//!
//! Modules in reading order: [`session`], [`journal`], [`key_reference`], [`weight_handles`].

pub mod journal;
pub mod key_reference;
pub mod session;
pub mod weight_handles;
