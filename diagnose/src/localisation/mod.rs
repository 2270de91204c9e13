//! Localisation: which component is in error, and in which regime.
//!
//! Modules in reading order: [`torque_balances`], balances of motion and torque formed from the measured signals; `ports`, where an error
//! may act; `error_hypotheses`, what may act there; `free_functions`, functions of one variable; `trend`, what such a function looks
//! like; `whitening` and `residual_regression`, what each hypothesis explains; [`error_map`], component by regime.

pub mod error_hypotheses;
pub mod error_map;
mod free_functions;
mod ports;
pub mod residual_regression;
pub mod torque_balances;
pub mod trend;
mod whitening;
