//! Model selection: which effects, together, explain the recordings; stepwise, with swaps, judged on held-out data.
//!
//! Modules in reading order: [`sizes`]; `perturbations`, the directions along which an effect is tried; [`signature`], what an effect
//! changes in the residuals; `order_spectrum`, orders of a repeating torque; `parameter_scan`, starts found by a scan; `screening`, every effect ranked; [`candidate`], a fitted
//! model; [`searcher`], fits and assessments; [`baseline`], how the recordings stand to the model as it is; `validation`, recordings
//! of another kind predicted; `pairs`, two effects at once; `merging`, one effect in the place of two; [`stage`], one stage of the
//! search; `refinement`, what is done to accepted effects; `determination`, effects without a determined size; `curve_knots`, where the points of a curve lie; [`outcome`] and `search`.

pub mod baseline;
pub mod candidate;
mod curve_knots;
mod determination;
mod hose_spring;
mod merging;
mod order_spectrum;
pub mod outcome;
mod pairs;
pub(crate) mod parameter_scan;
mod perturbations;
mod refinement;
mod screening;
pub mod search;
pub mod searcher;
pub mod signature;
pub mod sizes;
pub mod stage;
mod validation;
