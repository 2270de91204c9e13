//! The English sentences of results, as a person reads them. All of them are made here.
//!
//! The crates below compute enums and numbers. What people read on the terminal, in a report and in the studio, what stands in result files, and
//! what stands in the headers of generated code is put into words here.
//!
//! Of a design and its verification: [`weights`], what each weight asks for; [`design_findings`], obstacles; [`errors`], why there is no result;
//! [`demanded_rate`]; [`schedule`], states of balance; [`certificates`], what is certified; [`reduction`]; [`figures`], the names of figures;
//! [`acceptance`], how each is judged and how it would be tested; [`designs`], the table of designs; [`tuned_pi`], what a tuned PI would leave; [`check`]; [`adaptation`]; [`code_header`] with `feedback_alone`,
//! the header of generated code.
//!
//! Of recordings: [`answer`], a diagnosis; `effects`, the effects of the library; [`file_remarks`], what is to be known of the file of a recording;
//! [`localisation`], which component in which regime; [`recordings`], what is wrong with recordings; [`learned`], free functions in place of an
//! unidentified effect; [`experiment`], the plan of the next one; [`held_out_recordings`], recordings that a diagnosis was not given; [`structure`],
//! the diagnosis of a structure; [`identification`].

pub mod acceptance;
pub mod adaptation;
pub mod answer;
pub mod certificates;
pub mod check;
pub mod code_header;
pub mod demanded_rate;
pub mod design_findings;
pub mod designs;
mod effects;
pub mod errors;
pub mod experiment;
mod feedback_alone;
pub mod figures;
pub mod file_remarks;
pub mod held_out_recordings;
pub mod identification;
pub mod learned;
pub mod localisation;
pub mod recordings;
pub mod reduction;
pub mod schedule;
pub mod structure;
pub mod tuned_pi;
pub mod weights;

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
