//! The roughness of a road, by the classes of ISO 8608.

/// Roughness class of ISO 8608.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RoadClass {
    /// Very good.
    A,
    /// Good.
    B,
    /// Average.
    C,
    /// Poor.
    D,
    /// Very poor: rough track.
    E,
}
