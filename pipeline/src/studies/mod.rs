//! Studies around a design: each varies one thing and returns its figures as plain data.
//!
//! Modules in reading order: [`model`] (everything that is stated about a plant), [`comparison`] (other methods with the same figures), [`cost_basis`] (what its total cost is computed from), [`designs`] (every design in one table, simulated), [`front`] (the designs of every kind between which objectives are traded), [`tuned_pi`] (a tuned PI beside the design), [`trade_off`] (error against effort),
//! [`search`] (weights for stated requirements), [`advice`] (what to change where a requirement fails), [`adapt`] (adaptation to a changing out-of-balance), [`adaptation_trials`] (where a method of adaptation can fail), [`adaptation_choice`] (where the default acts), [`adaptation`] (runs and trials), [`fra`], [`fra_plan`], [`fra_summary`] and [`fra_totals`]
//! (frequency response analyser), [`sweep`] (robustness campaign), [`certificate`] (stability in every regime),
//! [`verification`] (everything that is stated about a verified controller), [`assumptions`] (what matters of what a file leaves open), [`accuracy`] (error of the simulator).

pub mod accuracy;
pub mod adapt;
pub mod adaptation;
pub mod adaptation_choice;
pub mod adaptation_trials;
pub mod advice;
pub mod assumptions;
pub mod certificate;
pub mod comparison;
pub mod cost_basis;
pub mod designs;
pub mod fra;
pub mod fra_plan;
pub mod fra_points;
pub mod fra_summary;
pub mod fra_totals;
pub mod front;
mod front_edges;
pub mod model;
pub mod search;
pub mod sweep;
pub mod trade_off;
pub mod tuned_pi;
pub mod verification;
