//! The structured singular value: how far a linear loop is from instability when several of its parameters are off at once.
//!
//! ```text
//!     1 / mu(M) = the smallest size of a structured perturbation Delta with det(I - M Delta) = 0
//! ```
//!
//! It cannot be computed, only bounded: from above by scalings ([`scalings`]), from below by perturbations that were
//! found ([`power_iteration`], [`vertices`]).
//! [`loops`] pulls the uncertain parameters out of a closed loop, [`closing`] closes the loop with a perturbation, exactly as it is
//! sampled, and [`stability`] is the whole road over all frequencies.
//!
//! Modules in reading order: [`blocks`], [`hermitian`], [`scalings`], [`power_iteration`], [`vertices`], [`factor`], [`places`], `channels`, [`loops`],
//! [`closing`], [`problem`], `nearest`, [`stability`], [`taylor`].

pub mod blocks;
mod channels;
pub mod closing;
pub mod factor;
pub mod hermitian;
pub mod loops;
mod nearest_mechanism;
pub mod places;
pub mod power_iteration;
pub mod problem;
pub mod scalings;
pub mod stability;
pub mod taylor;
pub mod vertices;

pub use blocks::{PerturbationBlock, PerturbationStructure};
pub use loops::PulledLoop;
pub use places::Joints;
pub use power_iteration::{Perturbation, lower_bound};
pub use problem::{Bounds, DestabilisingMechanism, Uncertainty};
pub use scalings::{UpperBound, upper_bound};
pub use stability::{BoundProof, RobustStability, robust_stability, robust_stability_in};
pub use vertices::vertex_bound;
