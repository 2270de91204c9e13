//! The project as it is edited: its text with undo, the journal on disk, and where a number's meaning comes from.
//!
//! Modules in reading order: [`text_change`], [`session`], [`journal`], [`key_reference`], [`key_path`], [`limit_paths`],
//! [`weight_handles`], [`weight_text`], [`design_history`].

pub mod design_history;
pub mod journal;
pub mod key_path;
pub mod key_reference;
pub mod limit_paths;
pub mod session;
pub mod text_change;
pub mod weight_handles;
pub mod weight_text;
