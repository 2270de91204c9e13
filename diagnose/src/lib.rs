//! From recordings of a machine and its model to what the model left out.
//!
//! In come a mechanism's parameters, recordings, and a simulator that replays them; out comes an [`answer::Answer`]:
//! a verdict, named effects with fitted parameters and their doubt, how the fit improved on data that was not
//! fitted, and what these recordings cannot tell.
//!
//! The road: recordings are examined before any physics ([`recorder`]); errors let in at every component say where and when ([`locate`], [`whereabouts`]); the first look ranks every
//! effect of the library by its linearised signature ([`look`]); the best are fitted in the simulator ([`fit`]) and judged on what they were not
//! fitted to ([`score`], [`search`]); what the noise in the loop alone would explain is taken off (`chance`); the judge puts it
//! into words ([`judge`]).
//!
//! *Invariant*: nothing here knows a weight, a file, a thread or a clock; processors are handed in as a [`bench::Pool`].
//!
//! Modules in reading order: [`mod@bench`], [`recorder`], [`mend`], [`qualify`], [`noise`], [`locate`], [`whereabouts`], [`library`], [`look`], [`fit`], [`score`], [`search`], [`judge`],
//! [`answer`], [`scaled`]; apart from them [`mod@refit`], a given structure fitted and judged, and [`identify`], the triangle-wave method.

pub mod answer;
pub mod bench;
mod chance;
pub mod diagnosis;
pub mod error;
pub mod fit;
mod heave;
pub mod identify;
mod joint;
pub mod judge;
pub mod library;
pub mod locate;
pub mod look;
pub mod mend;
pub mod noise;
pub mod qualify;
pub mod recorder;
pub mod refit;
pub mod replays;
pub mod residuals;
pub mod scaled;
mod scan;
pub mod score;
pub mod search;
mod series;
mod shape;
mod slopes;
pub mod tolerance;
mod trials;
pub mod whereabouts;

pub use diagnosis::Diagnosis;
pub use error::Error;
pub use refit::{Structure, refit};
pub use scaled::diagnose;
