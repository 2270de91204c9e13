//! The findings of a diagnosis: the verdict, the findings with their intervals, and what the recordings cannot tell.
//!
//! Modules in reading order: [`channel_fits`], how well a model fits; [`answer`], the data; [`instrument_findings`], faults of instruments as findings; [`verdict`], from a search to an answer; [`localisation_chart`], component by
//! regime; [`axis_units`], the units of a linear axis; [`similarity`], machines of another size.

pub mod answer;
pub mod axis_units;
pub mod channel_fits;
pub mod instrument_findings;
pub mod localisation_chart;
pub mod similarity;
pub mod verdict;
