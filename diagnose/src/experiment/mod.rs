//! The next experiment: of a menu of demands within stated limits, the one that best separates the machines that recordings leave possible.
//!
//! Modules in reading order: [`menu`] (the demands), [`separation`] (what two machines would record, and how sure a decision between
//! them would be), [`plan`](mod@plan) (the choice).

pub mod menu;
pub mod plan;
pub mod separation;

pub use menu::{Demand, DemandShape, Limits};
pub use plan::{
    ExperimentExtremes, ExperimentPlan, ExperimentRequest, MachineMotion, PlannedExperiment,
    choose_experiment,
};
pub use separation::{PossibleMachine, Refit, Separation};
