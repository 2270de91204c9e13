//! Sparse symmetric matrices of large structures: storage, factors, the lowest modes of a structure, a count of its modes below a
//! limit, solutions at complex frequencies, and low-rank Gramians.
//!
//! Modules in reading order: [`matrix`], `dissection` (the order of elimination), [`analysis`] (the pattern of the factors), `numeric`
//! (the factors), [`cholesky`], [`modes`], [`inertia`], [`pencil`],
//! `ritz` (the poles within a subspace), [`gramians`] (low-rank factors).

pub mod analysis;
pub mod cholesky;
mod dissection;
pub mod gramians;
pub mod inertia;
pub mod matrix;
pub mod modes;
mod numeric;
pub mod pencil;
mod ritz;

pub use analysis::Analysis;
pub use cholesky::SparseCholesky;
pub use gramians::{BalancedDirections, GramianAccuracy, LowRankGramians, StructurePorts, low_rank_gramians};
pub use inertia::{ModeCounter, count_below};
pub use matrix::{Entry, Sparse, VectorEntry};
pub use modes::{Cut, LowestModes, ModeRequest, ProgressObserver, StageProgress, highest_cut, lowest_modes};
pub use pencil::{QuadraticPencil, ShiftedPencil};
