//! Reports: one HTML page that carries everything it needs.
//!
//! In comes a [`Report`] (plain data); out goes HTML with the figures inside as SVG, light or dark as the viewer likes, and fit for
//! printing. The first screen answers whether the design is good: a headline, the main figures, the verdicts. The evidence follows.
//!
//! *Invariant*: nothing here computes, measures or judges; results come in complete from the pipeline. Nothing here reads a file, a clock
//! or the network. Same report, same bytes.
//!
//! Modules in reading order: [`page`], [`html`], [`style`], [`figure_tables`], [`bode`]; a verification's report: [`summary`], [`evidence`], [`loop_charts`], [`spectra`],
//! [`verification`], [`difference`], [`triangle`]; a design's: [`design`], [`first_design`], [`alternatives`], [`designs`], [`targets`], [`trade_off`], [`front`]; the other commands'
//! reports: [`check`], [`key_reference`], [`commission`], [`model`], [`fra`], [`adaptation`], [`sweep`], [`robustness`], [`certificate`], [`two_axes`], [`error_budget`], `error_budget_figures`, [`advice`], [`identify`], [`replay`],
//! [`diagnosis`], [`experiment`], `learned`, [`residual`], [`structure`]; what result files hold: [`results`]; what commands print: [`terminal`]; and every sentence about a
//! result: [`wording`].

pub mod adaptation;
pub mod advice;
pub mod alternatives;
pub mod bode;
pub mod certificate;
pub mod check;
pub mod commission;
pub mod design;
pub mod designs;
pub mod diagnosis;
pub mod difference;
pub mod error_budget;
mod error_budget_figures;
pub mod evidence;
pub mod experiment;
pub mod figure_tables;
pub mod first_design;
pub mod fra;
pub mod front;
pub mod html;
pub mod identify;
pub mod key_reference;
mod learned;
mod localisation;
pub mod loop_charts;
pub mod model;
pub mod page;
pub mod replay;
pub mod residual;
pub mod results;
pub mod robustness;
pub mod spectra;
pub mod structure;
pub mod style;
pub mod summary;
pub mod sweep;
pub mod targets;
pub mod terminal;
mod tolerance;
pub mod trade_off;
pub mod triangle;
pub mod two_axes;
pub mod verification;
pub mod wording;

pub use design::{of_design, of_synthesis};
pub use html::html_page;
pub use page::{
    FigureTile, Headline, OutcomeTone, ProvenanceEntry, Report, ReportCell, ReportColumn, ReportOrigin,
    ReportSection, ReportTable,
};
pub use verification::{VerificationContext, of_verification};
