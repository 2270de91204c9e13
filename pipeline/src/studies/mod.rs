//! Studies around a design: each varies one thing and returns its figures as plain data.
//!
//! Modules in reading order: [`comparison`] (other methods with the same figures), [`trade_off`] (error against effort),
//! [`search`] (weights for stated requirements), [`adapt`] (adaptation to a changing out-of-balance), [`fra`] (frequency
//! response analyser), [`sweep`] (robustness campaign), [`accuracy`] (error of the simulator).

pub mod accuracy;
pub mod adapt;
pub mod comparison;
pub mod fra;
pub mod search;
pub mod sweep;
pub mod trade_off;
