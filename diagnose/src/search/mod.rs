//! The search for what, together, explains the recordings: stepwise, with swaps, judged on what was not fitted.
//!
//! Modules in reading order: [`select`], the stages; `candidate`, what is judged at one; `pairs`, two effects at a stage; `plain`, how the
//! recordings stand to the model as it is; `validate`, recordings of another kind predicted; `polish` and `simpler`, what is done to the
//! effects that were accepted; `knots`, where a curve's points lie.

mod candidate;
mod knots;
mod pairs;
mod plain;
mod polish;
pub mod select;
mod simpler;
mod validate;
