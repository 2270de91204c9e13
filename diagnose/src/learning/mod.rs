//! A model for what has no name: free functions, fitted in the simulator at the places where they explain most.
//!
//! Modules in reading order: [`visited_ranges`] (which values the recordings have of each regime variable), `templates` (the functions that
//! are tried), `held_out_stretches` (what a function promises on stretches that did not choose it, and how smooth it should be), [`learner`]
//! (the fit), [`reading`] (a fitted curve in the words of physics), `library_forms` (a curve that is an effect of the library),
//! `simple_forms` (a curve that is held to a simple form),
//! `comparison` (effects of the library against a free function).

pub(crate) mod comparison;
mod held_out_stretches;
pub mod learner;
mod library_forms;
pub mod reading;
mod simple_forms;
mod templates;
pub mod visited_ranges;

pub(crate) use templates::is_at;

pub use learner::{LearnedModel, LearnedPart, LearningTask, learn_functions};
