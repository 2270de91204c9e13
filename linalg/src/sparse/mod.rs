//! Sparse symmetric matrices of large structures: storage, Cholesky factors, the lowest modes of a structure, and a count of
//! its modes below a limit.
//!
//! Modules in reading order: [`matrix`], [`cholesky`], [`modes`], [`inertia`].

pub mod cholesky;
pub mod inertia;
pub mod matrix;
pub mod modes;

pub use cholesky::SparseCholesky;
pub use inertia::count_below;
pub use matrix::{Entry, Sparse};
pub use modes::{Cut, LowestModes, Progress, Wanted, Watch, lowest_modes};
