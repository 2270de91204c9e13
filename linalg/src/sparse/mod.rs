//! Sparse symmetric matrices of large structures: storage, Cholesky factors, and the lowest modes of a structure.
//!
//! Modules in reading order: [`matrix`], [`cholesky`], [`modes`].

pub mod cholesky;
pub mod matrix;
pub mod modes;

pub use cholesky::SparseCholesky;
pub use matrix::{Entry, Sparse};
pub use modes::{LowestModes, Progress, Wanted, Watch, lowest_modes};
