//! The desktop studio: weights are dragged on plots, and every consequence is shown at once.
//!
//! In come a project file and what a user does; out come the same project file, edited, and the same exported code that the
//! command line writes: both run the same pipeline.
//!
//! Three states are kept apart. The *project* ([`editing::session::Session`]) is text with revisions; every edit is a
//! [`command::Command`], which is written to a [`journal`](editing::journal), undone and redone. *Results* ([`results::ComputedResults`])
//! bear the revision that they came from. The *view* ([`view::StudioView`]) is never undone. Work is done by
//! [`BackgroundWorker`](counterpoise_host::worker::BackgroundWorker)s; no frame waits for one.
//!
//! *Invariant*: no equation of the field stands here, and nothing can be done here that the command line cannot do.
//!
//! Modules in reading order: [`commissioning_inputs`], [`study_inputs`], [`command`], [`editing`], [`examples`], [`versioned_results`], [`jobs`], [`results`], [`units`], [`theme`],
//! [`number_format`], [`charts`], [`help`], [`browser`], [`design_overlays`], [`tile_layout`], [`view`], [`settings`], [`file_queue`], [`studio`], [`text_difference`], [`shortcuts`], [`toolbar`],
//! [`status_bar`], [`banners`], [`close_question`], [`command_palette`], [`help_window`], [`pages`], [`main_window`], [`frame_log`], [`script`],
//! [`offscreen`], [`native_window`].
//!
//! ```
//! use counterpoise_studio::{command::Command, editing::session::Session};
//! use counterpoise_project::Attachments;
//! let mut session = Session::new("[plant]\nname = \"rig\"\n", "project.toml", Attachments::none());
//! session.apply(&Command::SetText { path: "plant.name".into(), value: "crane".into() })?;
//! session.apply(&Command::Undo)?;
//! assert!(!session.is_changed());
//! # Ok::<(), counterpoise_project::file::EditError>(())
//! ```

pub mod banners;
pub mod browser;
pub mod charts;
pub mod close_question;
pub mod command;
pub mod command_palette;
pub mod commissioning_inputs;
pub mod design_overlays;
pub mod editing;
pub mod examples;
pub mod file_queue;
pub mod frame_log;
pub mod help;
pub mod help_window;
pub mod jobs;
pub mod main_window;
pub mod native_window;
pub mod number_format;
pub mod offscreen;
pub mod pages;
pub mod results;
pub mod script;
pub mod settings;
pub mod shortcuts;
pub mod status_bar;
pub mod studio;
pub mod study_inputs;
pub mod text_difference;
pub mod theme;
pub mod tile_layout;
mod tolerance;
pub mod toolbar;
pub mod units;
pub mod versioned_results;
pub mod view;
