//! The desktop studio: weights in the hand, consequences at once.
//!
//! In come a project file and what a user does; out come the same project file, edited, and the same exported code that the
//! command line writes: both run the one pipeline of the project crate.
//!
//! Three states are kept apart. The *project* ([`session::Session`]) is text with revisions; every edit is a
//! [`command::Command`], noted in a [`journal`], undone and redone. *Results* ([`results::Results`]) bear the revision they came
//! from. The *view* ([`view::View`]) is neither saved nor undone. Work is done by [`worker::Worker`]s; no frame waits for one.
//!
//! *Invariant*: no equation of the field stands here, and nothing can be done here that the command line cannot do.
//!
//! Modules in reading order: [`command`], [`session`], [`journal`], [`keys`], [`knobs`], [`live`], [`worker`], [`watch`],
//! [`measure`], [`portrait`], [`exporting`], [`pyramid`], [`recordings`], [`browser`], [`noted`], [`errands`], [`jobs`],
//! [`results`], [`view`], [`studio`], [`filing`],
//! [`rounds`], [`theme`], [`number`], [`thinning`], [`axes`], [`chart`], [`picture`], [`shell`], [`palette`], [`places`], [`files`],
//! [`replay`], [`window`].
//!
//! ```
//! use counterpoise_studio::{command::Command, session::Session};
//! use counterpoise_project::Attachments;
//! let mut session = Session::new("[plant]\nname = \"rig\"\n", "project.toml", Attachments::none());
//! session.apply(&Command::SetText { path: "plant.name".into(), value: "crane".into() })?;
//! session.apply(&Command::Undo)?;
//! assert!(!session.is_changed());
//! # Ok::<(), counterpoise_project::file::EditError>(())
//! ```

pub mod axes;
pub mod browser;
pub mod chart;
pub mod command;
pub mod errands;
pub mod exporting;
pub mod filing;
pub mod jobs;
pub mod journal;
pub mod keys;
pub mod knobs;
pub mod live;
pub mod measure;
pub mod noted;
pub mod number;
pub mod palette;
pub mod picture;
pub mod places;
pub mod portrait;
pub mod pyramid;
pub mod recordings;
pub mod replay;
pub mod results;
pub mod rounds;
pub mod session;
pub mod shell;
pub mod studio;
pub mod theme;
pub mod thinning;
pub mod view;
pub mod window;
