//! The structured singular value: how far a linear loop is from instability when several of its parameters are off at once.
//!
//! ```text
//!     1 / mu(M) = the smallest size of a structured perturbation Delta with det(I - M Delta) = 0
//! ```
//!
//! It cannot be computed, only bounded: from above by scalings ([`upper`]), from below by perturbations that were
//! found ([`lower`], [`vertices`]).
//! [`loops`] pulls the uncertain parameters out of a closed loop, [`closing`] closes the loop with a perturbation, exactly as it is
//! sampled, and [`stability`] is the whole road over all frequencies.
//!
//! Modules in reading order: [`blocks`], [`hermitian`], [`upper`], [`lower`], [`vertices`], [`factor`], [`places`], `channels`, [`loops`],
//! [`closing`], [`problem`], `nearest`, [`stability`], [`taylor`].

pub mod blocks;
mod channels;
pub mod closing;
pub mod factor;
pub mod hermitian;
pub mod loops;
pub mod lower;
mod nearest_mechanism;
pub mod places;
pub mod problem;
pub mod stability;
pub mod taylor;
pub mod upper;
pub mod vertices;

pub use blocks::{PerturbationBlock, PerturbationStructure};
pub use loops::PulledLoop;
pub use lower::{Perturbation, lower_bound};
pub use places::Joints;
pub use problem::{Bounds, DestabilisingMechanism, Uncertainty};
pub use stability::{BoundProof, RobustStability, robust_stability, robust_stability_in};
pub use upper::{UpperBound, upper_bound};
pub use vertices::vertex_bound;
