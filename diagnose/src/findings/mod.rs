//! What a diagnosis finds: the verdict, the findings with their intervals, and what the recordings cannot tell.
//!
//! Modules in reading order: [`answer`], the data; [`verdict`], from a search to an answer; [`localisation_chart`], component by
//! regime; [`similarity`], machines of another size.

pub mod answer;
pub mod localisation_chart;
pub mod similarity;
pub mod verdict;
