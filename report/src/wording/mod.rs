//! The English sentences of results: what the diagnosis and the identification find, as a person reads it.
//!
//! The crates below compute enums and numbers. Here, and nowhere else, they become sentences: [`answer`], a diagnosis; `effects`, the effects
//! of the library; [`localisation`], where and when; [`recordings`], what is wrong with recordings; [`learned`], a model without a name; [`experiment`], the plan of the next one; [`held_out`], recordings
//! that a diagnosis was not given; [`identification`].

pub mod answer;
mod effects;
pub mod experiment;
pub mod held_out;
pub mod identification;
pub mod learned;
pub mod localisation;
pub mod recordings;

pub use effects::{EffectText, describe_effect, experiment_for};
