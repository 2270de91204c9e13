//! The English sentences of results: what the diagnosis and the identification find, as a person reads it.
//!
//! The crates below compute enums and numbers. What people read on the terminal, in a report and in the studio is put into words here: [`answer`],
//! a diagnosis; `effects`, the effects of the library; [`file_remarks`], what is to be known of the file of a recording; [`localisation`], which component in which regime; [`recordings`], what is wrong with
//! recordings; [`learned`], free functions in place of an unidentified effect; [`experiment`], the plan of the next one; [`held_out_recordings`], recordings that a diagnosis was not given;
//! [`structure`], the diagnosis of a structure; [`identification`]. Sentences that stand in result files or in generated code are made in
//! `pipeline::wording`, below this crate.

pub mod answer;
mod effects;
pub mod experiment;
pub mod file_remarks;
pub mod held_out_recordings;
pub mod identification;
pub mod learned;
pub mod localisation;
pub mod recordings;
pub mod structure;

pub use effects::{EffectText, describe_effect, experiment_for};

/// Returns the text with a capital first letter.
pub fn capitalise_first(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// Returns the name of an effect, a component or a regime in words: its key without underscores.
pub(crate) fn name_in_words(key: &str) -> String {
    key.replace('_', " ")
}
