//! Systems, weights, responses and time histories as plain data for other programs, in one schema with a version.
//!
//! A system has its matrices as lists of rows, its signals by name and unit, and its sample time in seconds, 0 for continuous time: what
//! `control.ss(A, B, C, D, dt)` of python-control and `ss(A, B, C, D, Ts)` of MATLAB take.
//!
//! Modules in reading order: [`unit_value`], [`systems`], [`balance`], [`structure`], [`run_history`], [`verification_data`], [`pulled_loop`], [`error_budget`],
//! [`targets`], [`controller_file`].

pub mod balance;
pub mod controller_file;
pub mod error_budget;
pub mod pulled_loop;
pub mod run_history;
pub mod structure;
pub mod systems;
pub mod targets;
pub mod unit_value;
pub mod verification_data;

pub use balance::BalanceResult;
pub use controller_file::ControllerResult;
pub use error_budget::{ErrorBudgetResult, SightValues, error_budget_result};
pub use pulled_loop::PulledLoopResult;
pub use run_history::{RunHistory, RunSignal, WithHistories};
pub use structure::StructureResult;
pub use systems::{DesignSignals, ResponseResult, SignalResult, SystemResult, TransferFunctionResult};
pub use targets::TargetsResult;
pub use unit_value::UnitValue;
pub use verification_data::{HistoryResult, VerifiedLoop, controllers_of, plants_of, verified_loop};

/// Name and version of the schema of every result. The number rises when a key changes its meaning or goes; new keys
/// leave it as it is.
pub const SCHEMA: &str = "counterpoise.results/2";
