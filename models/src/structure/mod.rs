//! The structure: finite elements of the beam, or matrices from elsewhere, down to a few modes or two inertias.
//!
//! In comes [`crate::Beam`] with what is fitted to it (or M, C, K as text); out go frequencies, shapes, effective masses,
//! the [`crate::plant::Body`] of the plant and the derived [`crate::LumpedStructure`].
//!
//! *Invariant*: nothing here knows the drive, a file or time.
//!
//! Modules in reading order: [`profile`], [`power_law`], [`element`], [`mesh`], [`fe`], [`mod@modes`], [`damping`],
//! [`reduction`], [`refinement`], [`configuration`], [`sparse_structure`], `supported_modes`, [`balanced_shapes`], [`large`], [`import`].
//!
//! ```
//! use counterpoise_models::structure::{FeModel, FeOptions, AttachedMasses, reduce_to_lumped};
//! let rig = counterpoise_models::reference::rig();
//! let beam = rig.beam.ok_or(counterpoise_models::Error::NoStructure)?;
//! let model = FeModel::beam(&beam, &AttachedMasses::default(), &FeOptions::default())?;
//! let two_inertias = reduce_to_lumped(&model, &beam.modal_damping)?;
//! assert!((two_inertias.hub_inertia_kg_m2 - 74.1).abs() < 0.1);
//! # Ok::<(), counterpoise_models::Error>(())
//! ```

pub mod balanced_shapes;
pub mod configuration;
pub mod damping;
pub mod element;
pub mod fe;
pub mod import;
pub mod large;
pub mod mesh;
pub mod modes;
pub mod power_law;
pub mod profile;
pub mod reduction;
pub mod refinement;
pub mod sparse_structure;
mod supported_modes;

pub use configuration::{ConfiguredStructure, with_derived_lumped};
pub use element::{Integration, Theory};
pub use fe::{AttachedMasses, FeModel, FeOptions, NodeRows, Truncation};
pub use large::{Condensation, Shapes};
pub use mesh::ElementMesh;
pub use modes::{Direction, Modes, Support, undamped_modes};
pub use profile::Profile;
pub use reduction::{
    LockedMode, LockedStructure, PinnedStructure, locked_modes, pinned_modes, reduce_to_lumped,
};
pub use sparse_structure::SparseStructure;
