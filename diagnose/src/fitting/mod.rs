//! Output-error fits of effects to recordings, and how well they explain what they were not fitted to.
//!
//! Modules in reading order: `initial_states`, the recordings' initial states as nuisance parameters; `normal_equations`, the damped
//! step; [`output_error`], the fit; `exact_slopes`, its Jacobian from exact derivatives; [`score`], its likelihood on other data; `null_gain`, what noise alone would gain;
//! [`refit`](mod@refit), a given structure fitted; [`fitted_start`], the initial state alone; [`residual_tests`], whether anything is left in a residual.

mod exact_slopes;
pub mod fitted_start;
mod initial_states;
mod normal_equations;
pub(crate) mod null_gain;
pub mod output_error;
pub mod refit;
pub mod residual_tests;
pub mod score;

pub(crate) use initial_states::StartColumns;
