//! The project as it is edited: its text with undo, the journal on disk, and where a number's meaning comes from.
//!
//! Modules in reading order: [`session`], [`journal`], [`journal_writer`], [`project_lock`], [`key_reference`], [`weight_handles`],
//! [`recent_files`].

pub mod journal;
pub mod journal_writer;
pub mod key_reference;
pub mod project_lock;
pub mod recent_files;
pub mod session;
pub mod weight_handles;
