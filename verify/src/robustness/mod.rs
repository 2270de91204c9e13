//! Robustness: one parameter at a time, many at once, and the worst that can be found. The controller stays as it is exported.
//!
//! Modules in reading order: [`varied_parameters`], [`sampling`], [`sobol`](mod@sobol), [`selected_figures`], [`family`], [`campaign`], [`statistics`], [`worst_case`].

pub mod campaign;
pub mod family;
pub mod sampling;
pub mod selected_figures;
pub mod sobol;
pub mod statistics;
pub mod varied_parameters;
pub mod worst_case;

pub use campaign::{Campaign, Layout, Sample, Variation, merge_shards};
pub use family::{Family, FamilyMember, MemberDifference, compare_configurations, one_at_a_time};
pub use sampling::{Distribution, PointLayout, latin_hypercube};
pub use selected_figures::{figures_of, history_of};
pub use sobol::sobol;
pub use statistics::{ParameterInfluence, Sense, Summary, rank_parameters, summarise_requirement};
pub use varied_parameters::VariedParameter;
pub use worst_case::{WorstMechanism, worst_case};
