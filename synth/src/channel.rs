//! The two disturbances that a design knows.

/// Channel of a disturbance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum DisturbanceChannel {
    /// The vertical motion of the pivot.
    Heave,
    /// The rotation of the platform.
    Pitch,
}
