//! Commissioning: what a round of experiments on a machine needs, and what its recordings tell.
//!
//! A round begins with a project: a model with values that are known within tolerances, and the controller that is designed for all of them.
//! [`plan_runs`] lists the experiments with what the model predicts of each. A machine program runs them ([`machine_runs`] is what the product's
//! own does, with a second project as the true machine). [`judge_run`] compares a recording with its prediction, [`judge_requirements`] the recordings with
//! the requirements, and [`update_model`] makes the project of the next round: tolerances shrink to what the recordings leave of them
//! ([`posterior`]), and what no value explains is diagnosed. [`story`] says why a commissioning ends.
//!
//! The idea of letting experiment and design alternate is that of Z. Zang, R. Bitmead and M. Gevers, Iterative weighted least-squares identification
//! and weighted LQG control design, Automatica 31 (1995), 1577.

pub mod acceptance;
pub mod machine_runs;
pub mod posterior;
pub mod run_plan;
mod screening;
pub mod story;
pub mod update;

pub use acceptance::{MachineVerdict, RecordedRun, RunJudgement, judge_requirements, judge_run};
pub use machine_runs::{MachineRun, RunRequest, simulate_run};
pub use posterior::{FittedValue, Posterior, fit_tolerances};
pub use run_plan::{PlannedRun, PlannedRuns, PredictedChannel, ReplayUse, plan_runs};
pub use story::{RoundSummary, StopReason, machine_time_s, stop_after_update, stop_before_update};
pub use update::{ModelUpdate, assign_controller, update_model};
