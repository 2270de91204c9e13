//! Robustness: one parameter at a time, many at once, and the worst that can be found. The controller stays as it is exported.
//!
//! Modules in reading order: [`varied`], [`sampling`], [`sobol`], [`selected`], [`family`], [`campaign`], [`statistics`], [`worst`].

pub mod campaign;
pub mod family;
pub mod sampling;
pub mod selected;
pub mod sobol;
pub mod statistics;
pub mod varied;
pub mod worst;

pub use campaign::{Campaign, Layout, Sample, Variation, merge};
pub use family::{Family, Member, configurations, one_at_a_time};
pub use sampling::{Distribution, Points, latin_hypercube};
pub use selected::{figures_of, history_of};
pub use sobol::sobol;
pub use statistics::{Ranked, Sense, Summary, ranking, summary};
pub use varied::Varied;
pub use worst::{Worst, worst_case};
