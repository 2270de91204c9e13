//! Recordings before any physics: repaired, checked, and without the faults of their instruments.
//!
//! Modules in reading order: `series`, what is done to any series of samples; [`measured_signals`], the signals of one recording;
//! [`gap_repair`]; [`sanity_checks`]; [`noise`], how much of a channel is noise; `unknown_heave`; [`instrument_faults`].

pub mod gap_repair;
pub mod instrument_faults;
pub mod measured_signals;
pub mod noise;
pub mod remarks;
pub mod sanity_checks;
pub(crate) mod series;
pub(crate) mod unknown_heave;
