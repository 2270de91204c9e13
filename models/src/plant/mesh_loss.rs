//! Torques at both sides of the mesh.

/// Torques that an imperfect mesh adds at either side.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MeshLoss {
    /// Torque added at the motor shaft, N m.
    pub motor_nm: f64,
    /// Torque added at the hub, N m.
    pub hub_nm: f64,
}
